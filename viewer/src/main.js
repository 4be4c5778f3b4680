// The viewer of a report. Phases: read the description and the first frame, draw it, then decode the other frames while
// the page stays alive.
import { Box } from './decode.js';
import { Contacts, Selection } from './selection.js';
import { element } from './dom.js';
import { Panel } from './panel.js';
import { ParticleCloud } from './particles.js';
import { Player } from './player.js';
import { Solids } from './solids.js';
import { Stage } from './stage.js';
import { Walls } from './walls.js';
import css from './viewer.css';

const began = performance.now();

/** What tests can reach. */
const api = { ready: false, whole: false, drawn: 0 };
window.dartcastReport = api;

class Viewer {
  static async start(view, data) {
    const viewer = new Viewer();
    api.viewer = viewer;
    viewer.box = new Box(data.box);
    viewer.stage = new Stage(viewer.box, data.dimension);
    viewer.data = data;
    await viewer.load();
    await viewer.decodeFirst();
    viewer.layOut(view);
    viewer.player.go(0);
    viewer.frame();
    viewer.stage.drawNow();
    api.firstDrawMs = performance.now() - began;
    api.ready = true;
    await viewer.decodeRest();
    return viewer;
  }

  async load() {
    const { data, box, stage } = this;
    this.particles = data.particles && data.particles.count > 0 ? await ParticleCloud.load(data.particles, box, data.patches, data.frames) : null;
    this.walls = await Walls.load(data.walls, data.dimension, box, data.patches, data.hits_max ?? 0);
    this.solids = await Solids.load(data.solids, box);
    for (const part of [this.walls, this.solids, this.particles]) if (part) stage.scene.add(part.object);
    if (this.particles) {
      stage.observers.push(() => {
        this.particles.pixelRatio = stage.pixelRatio ?? 1;
        this.particles.fit(stage.camera, stage.canvas.height);
      });
    }
  }

  get series() {
    return [...(this.particles?.series ?? []), ...this.walls.series, ...this.solids.series];
  }

  async decodeFirst() {
    for (const s of this.series) if (s.decodedGroups === 0 && !s.isWhole) await s.decodeNext();
  }

  /** The frames that all parts can show. */
  get decoded() {
    const counts = [this.walls.decoded, this.data.frames.length];
    for (const s of [...(this.particles?.series ?? []), ...this.solids.series]) counts.push(s.isWhole ? this.data.frames.length : s.decoded);
    return Math.max(1, Math.min(...counts));
  }

  /** Group by group, so that the time line grows and the page answers in between. */
  async decodeRest() {
    for (let open = true; open;) {
      open = false;
      for (const s of this.series) {
        if (s.isWhole) continue;
        await s.decodeNext();
        open = open || !s.isWhole;
        await new Promise((next) => setTimeout(next));
      }
      const share = Math.round((100 * this.decoded) / this.data.frames.length);
      this.loading.textContent = share < 100 ? `decoding: ${share} %` : '';
    }
    this.loading.remove();
    api.whole = true;
    this.selection.show(this.player.frame);
    this.stage.draw();
  }

  layOut(view) {
    document.head.append(element('style', {}, css));
    const { stage, data } = this;
    this.loading = element('p', { class: 'loading' }, '');
    const picked = element('aside', { class: 'picked', 'aria-live': 'polite' });
    picked.hidden = true;
    this.player = new Player(data, (f) => this.show(f), () => this.decoded);
    this.panel = new Panel(this.particles, this.walls, stage, () => this.show(this.player.frame), () => this.frame());
    this.selection = new Selection(this.particles, new Contacts(data.contacts), stage, picked);
    this.selection.onClose = () => this.pick(-1);
    const box = element('div', { class: 'stage' }, stage.canvas, this.loading, picked);
    view.replaceChildren(box, this.panel.element, this.player.element);
    view.classList.add('live');
    if (window.matchMedia('(max-width: 720px)').matches) this.panel.element.querySelector('details').open = false;
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
    canvas.addEventListener('dblclick', () => this.frame());
    view.addEventListener('keydown', (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey || e.target.type === 'range') return;
      if (this.player.key(e)) e.preventDefault();
      else if (e.key === 'Escape') this.pick(-1);
      else if (e.key === 'f' || e.key === 'F') this.frame();
    });
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.stage.colour();
      this.walls.restyle();
      this.panel.refresh();
      this.show(this.player.frame);
    });
  }

  show(f) {
    this.walls.show(f);
    this.solids.show(f);
    this.particles?.show(f);
    this.selection?.show(f);
    this.stage.draw();
  }

  /** All that can be seen comes into view. */
  frame() {
    this.stage.frame([...this.walls.visiblePoints(), ...this.solids.points(), ...(this.particles?.visiblePoints() ?? [])]);
  }

  /** Chooses a particle; below 0 none. */
  async pick(slot) {
    await this.selection.pick(slot);
    this.show(this.player.frame);
    return slot;
  }

  pickAt(x, y) {
    return this.pick(this.selection.slotAt(x, y, this.player.frame));
  }
}

async function main() {
  const view = document.getElementById('view');
  try {
    const data = JSON.parse(document.getElementById('meta').textContent);
    await Viewer.start(view, data);
  } catch (error) {
    // The still picture stays, and says why.
    const text = view.querySelector('.fallback');
    if (text) text.textContent = `This is a still picture: ${error.message}.`;
    else view.append(element('p', { class: 'fallback' }, `The scene cannot be shown: ${error.message}.`));
    api.failed = error.message;
  }
}

main();
