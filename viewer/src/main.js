// The viewer of a report. Phases: read the description and the frame to open on, draw it, then decode the other frames while
// the page stays alive; then play once.
import { Box } from './decode.js';
import { Contacts, Selection } from './selection.js';
import { element } from './dom.js';
import { shortNumber } from './colours.js';
import { Exports } from './exports.js';
import { Live } from './live.js';
import { Overlay } from './overlay.js';
import { Panel } from './panel.js';
import { ParticleCloud } from './particles.js';
import { Player } from './player.js';
import { Solids } from './solids.js';
import { Stage } from './stage.js';
import { Walls } from './walls.js';
import css from './viewer.css';

const began = performance.now();
const pauseBefore = 1200; // ms before it plays by itself

/** What tests can reach. */
const api = { ready: false, whole: false, drawn: 0 };
window.dartcastReport = api;

class Viewer {
  static async start(view, data) {
    const viewer = new Viewer();
    api.viewer = viewer;
    viewer.box = new Box(data.box);
    viewer.stage = new Stage(viewer.box, data.dimension, data.gravity);
    viewer.data = data;
    viewer.opening = Math.min(data.opening ?? 0, data.frames.length - 1);
    await viewer.load();
    await viewer.decodeAt(viewer.opening);
    viewer.layOut(view);
    viewer.player.go(viewer.opening);
    viewer.frame();
    viewer.stage.drawNow();
    api.firstDrawMs = performance.now() - began;
    api.ready = true;
    await viewer.decodeRest();
    viewer.playByItself(view);
    return viewer;
  }

  async load() {
    const { data, box, stage } = this;
    [this.particles, this.walls, this.solids] = await Promise.all([
      data.particles && data.particles.count > 0 ? ParticleCloud.load(data.particles, box, data.patches, data.frames) : null,
      Walls.load(data.walls, data.dimension, box, data.patches, data.frames), Solids.load(data.solids, box)]);
    this.parts = [this.walls, this.solids, this.particles].filter((p) => p);
    for (const part of this.parts) stage.scene.add(part.object);
    stage.observers.push(() => {
      this.walls.sort(stage.camera);
      this.particles?.fit(stage, stage.depthOf(this.walls.opaque));
    });
  }

  has(f) {
    return this.parts.every((p) => p.has(f));
  }

  decodeAt(f) {
    return Promise.all(this.parts.map((p) => p.decodeAt(f)));
  }

  /** Group by group, so that the page answers in between. */
  async decodeRest() {
    const count = this.data.frames.length;
    for (let f = 0; f < count; ++f) {
      if (this.has(f)) continue;
      await this.decodeAt(f);
      this.loading.textContent = `decoding: ${Math.round((100 * f) / count)} %`;
      await new Promise((next) => setTimeout(next));
    }
    this.loading.remove();
    api.whole = true;
    this.selection.show(this.player.moment);
    this.panel.refresh();
    this.stage.draw();
  }

  /** Once, unless the reader does something first, or wants no motion. */
  playByItself(view) {
    if (window.matchMedia('(prefers-reduced-motion: reduce)').matches || this.data.frames.length < 3) return;
    const stop = new AbortController();
    const timer = setTimeout(() => { if (!this.player.playing) this.player.playOnce(this.opening); }, pauseBefore);
    for (const kind of ['pointerdown', 'keydown', 'input'])
      view.addEventListener(kind, (e) => {
        clearTimeout(timer);
        stop.abort();
        // Who turns the scene goes on watching; who takes the time line wants it.
        if (kind !== 'pointerdown' && this.player.once && !e.shiftKey) this.player.pause();
      }, { signal: stop.signal, capture: true });
  }

  layOut(view) {
    document.head.append(element('style', {}, css));
    const { stage, data } = this;
    this.loading = element('p', { class: 'loading' }, '');
    const picked = element('aside', { class: 'picked', 'aria-live': 'polite' });
    picked.hidden = true;
    this.player = new Player(data, (m) => this.show(m), (f) => this.has(f));
    this.selection = new Selection(this.particles, new Contacts(data.contacts), stage, picked);
    this.selection.onClose = () => this.pick(-1);
    this.overlay = new Overlay(stage);
    this.exports = new Exports(this);
    this.panel = new Panel(this, {
      frame: () => this.frame(), savePicture: () => this.exports.savePicture(), saveFilm: (progress) => this.exports.saveFilm(progress),
      wholeScreen: () => (document.fullscreenElement ? document.exitFullscreen() : view.requestFullscreen()),
    });
    const box = element('div', { class: 'stage' }, stage.canvas, this.loading, ...this.overlay.elements, picked);
    view.replaceChildren(box, this.panel.element, this.player.element);
    view.classList.add('live');
    if (document.getElementById('caption')) stage.canvas.setAttribute('aria-describedby', 'caption');
    this.listen(view);
    stage.resize();
  }

  listen(view) {
    const { canvas } = this.stage;
    new ResizeObserver(() => this.stage.resize()).observe(canvas);
    let down = null;
    canvas.addEventListener('pointerdown', (e) => { down = [e.clientX, e.clientY]; });
    canvas.addEventListener('pointerup', (e) => {
      // A drag turns the scene; a click does not.
      if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < 5) this.pickAt(e.offsetX, e.offsetY);
      down = null;
    });
    canvas.addEventListener('pointermove', (e) => { if (!down && e.pointerType === 'mouse') this.hoverAt(e.offsetX, e.offsetY); });
    canvas.addEventListener('pointerleave', () => this.overlay.point([]));
    canvas.addEventListener('dblclick', () => this.frame());
    // The wheel scrolls the page until the reader has clicked the scene.
    view.addEventListener('wheel', (e) => {
      if (e.target === canvas && document.activeElement !== canvas && !e.ctrlKey && !document.fullscreenElement) e.stopPropagation();
    }, { capture: true });
    view.addEventListener('keydown', (e) => {
      const isField = e.target.tagName === 'INPUT' || e.target.tagName === 'SELECT';
      if (e.ctrlKey || e.metaKey || e.altKey || isField) return;
      if (this.player.key(e) || this.key(e)) e.preventDefault();
    });
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.stage.colour();
      this.walls.restyle();
      this.particles?.restyle();
      this.panel.refresh();
      this.redraw();
    });
  }

  /** Keys for the camera and the choice of a particle. */
  key(e) {
    const turns = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12] };
    if (e.shiftKey && e.key in turns) this.stage.turn(...turns[e.key]);
    else if (e.key === '+' || e.key === '=') this.stage.turn(0, 0, 1.15);
    else if (e.key === '-') this.stage.turn(0, 0, 1 / 1.15);
    else if ((e.key === 'n' || e.key === 'p') && this.particles) this.pick(this.selection.neighbour(e.key === 'n' ? 1 : -1));
    else if (e.key === 'Escape') this.pick(-1);
    else if (e.key === 'f' || e.key === 'F') this.frame();
    else return false;
    return true;
  }

  show(moment) {
    for (const part of this.parts) part.show(moment);
    this.selection?.show(moment);
    this.stage.draw();
  }

  redraw() {
    this.show(this.player.moment);
  }

  /** All that can be seen comes into view, at several moments if they are decoded. */
  frame() {
    const last = this.data.frames.length - 1;
    const moments = [this.player.moment, 0, 0.25, 0.5, 0.75, 1].map((s, i) => (i === 0 ? s : Math.round(s * last)));
    const walls = this.walls.visiblePoints(moments);
    // Particles that left the walls behind are not looked for.
    this.stage.frame(walls.length > 0 ? [...walls, ...this.solids.points()] : [...this.solids.points(), ...(this.particles?.visiblePoints() ?? [])]);
  }

  /** Chooses a particle; below 0 none. */
  async pick(slot) {
    await this.selection.pick(slot);
    this.redraw();
    return slot;
  }

  pickAt(x, y) {
    return this.pick(this.selection.slotAt(x, y));
  }

  hoverAt(x, y) {
    this.asked ??= requestAnimationFrame(() => {
      this.asked = undefined;
      const slot = this.selection.slotAt(...this.pointer, 9);
      if (slot < 0) return this.overlay.point([]);
      const { particles } = this;
      const { moment, frame } = this.player;
      const q = particles.colouredBy;
      const value = q.value(slot, moment);
      return this.overlay.point([`Particle ${particles.id[slot]}`,
        `speed: ${shortNumber(particles.quantity('speed').value(slot, moment))} m/s, in a ${particles.kindName(slot, frame)}`,
        ...(q.name === 'speed' || q.name === 'kind' ? [] : [`${q.categories ? q.categories[value] : `${shortNumber(value)} ${q.unit}`}`])], ...this.pointer);
    });
    this.pointer = [x, y];
  }
}

async function main() {
  const view = document.getElementById('view');
  try {
    const data = JSON.parse(document.getElementById('meta').textContent);
    await (data.engine ? Live.start(view, data, api) : Viewer.start(view, data));
  } catch (error) {
    // The still picture stays, and says why.
    const text = view.querySelector('.fallback');
    if (text) text.textContent = `${view.querySelector('.picture') ? 'This is a still picture' : 'The scene cannot be shown'}: ${error.message}.`;
    else view.append(element('p', { class: 'fallback' }, `The scene cannot be shown: ${error.message}.`));
    api.failed = error.message;
  }
}

main();
