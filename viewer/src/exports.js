// Pictures and films of what the stage shows, with its scale, legend and time.
import { css, pageColours } from './colours.js';

function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export class Exports {
  constructor(viewer) {
    this.viewer = viewer;
    this.canvas = document.createElement('canvas');
  }

  get name() {
    return document.title.replace(/[^\w-]+/g, '_') || 'run';
  }

  /** Draws the stage and the texts over it. */
  compose() {
    const { stage, overlay, player, particles } = this.viewer;
    stage.drawNow();
    const source = stage.canvas;
    const context = this.canvas.getContext('2d');
    if (this.canvas.width !== source.width || this.canvas.height !== source.height) Object.assign(this.canvas, { width: source.width, height: source.height });
    const unit = stage.pixelRatio ?? 1;
    const page = pageColours();
    context.drawImage(source, 0, 0);
    context.font = `${13 * unit}px system-ui, sans-serif`;
    context.fillStyle = context.strokeStyle = css(page.text);
    const bottom = source.height - 16 * unit;
    const length = (overlay.measure / stage.heightAtTarget) * source.height;
    context.lineWidth = 2 * unit;
    context.strokeRect(source.width - 18 * unit - length, bottom, length, 0.01);
    context.textAlign = 'right';
    context.fillText(overlay.length.textContent, source.width - 18 * unit, bottom - 6 * unit);
    context.textAlign = 'left';
    context.fillText(player.label.textContent, 18 * unit, bottom);
    if (particles && !particles.colouredBy.categories) this.drawLegend(context, unit);
    return this.canvas;
  }

  drawLegend(context, unit) {
    const { particles } = this.viewer;
    const { data } = particles.palette.image;
    const [x, y, width, height] = [18, 18, 180, 9].map((v) => v * unit);
    for (let i = 0; i < 256; ++i) {
      context.fillStyle = `rgb(${data[4 * i]} ${data[4 * i + 1]} ${data[4 * i + 2]})`;
      context.fillRect(x + (i / 256) * width, y, width / 256 + 1, height);
    }
    context.fillStyle = css(pageColours().text);
    const [low, high] = this.viewer.panel.rangeTexts();
    context.fillText(low, x, y + 24 * unit);
    context.textAlign = 'right';
    context.fillText(high, x + width, y + 24 * unit);
    context.textAlign = 'left';
  }

  picture() {
    return new Promise((done) => this.compose().toBlob(done, 'image/png'));
  }

  async savePicture() {
    save(await this.picture(), `${this.name}.png`);
  }

  /** The whole run at the present rate, as WebM. `progress`: called with shares from 0 to 1. */
  async film(progress = () => {}, seconds = null) {
    const { player } = this.viewer;
    player.pause();
    const all = player.frames[player.last].time - player.frames[0].time;
    const wall = seconds ?? Math.max(1, all / player.rate);
    this.compose();
    const kind = ['video/webm;codecs=vp8', 'video/webm'].find((k) => MediaRecorder.isTypeSupported(k));
    if (!kind) throw new Error('this browser writes no WebM');
    const stream = this.canvas.captureStream(0); // it has the frames that are asked for
    const [track] = stream.getVideoTracks();
    const recorder = new MediaRecorder(stream, { mimeType: kind, videoBitsPerSecond: 8e6 });
    const parts = [];
    recorder.ondataavailable = (e) => parts.push(e.data);
    const ended = new Promise((done) => { recorder.onstop = done; });
    recorder.start();
    const began = performance.now();
    for (let share = 0; share < 1;) {
      await new Promise((next) => requestAnimationFrame(next));
      share = Math.min(1, (performance.now() - began) / 1000 / wall);
      player.go(player.momentOf(player.frames[0].time + share * all));
      this.compose();
      track.requestFrame();
      progress(share);
    }
    // A slow encoder has not begun by the end of a short film.
    for (let i = 0; i < 50 && parts.reduce((sum, p) => sum + p.size, 0) < 500; ++i) {
      track.requestFrame();
      recorder.requestData();
      await new Promise((next) => setTimeout(next, 100));
    }
    recorder.stop();
    await ended;
    return new Blob(parts, { type: 'video/webm' });
  }

  async saveFilm(progress) {
    save(await this.film(progress), `${this.name}.webm`);
  }
}
