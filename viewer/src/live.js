// A live scene: the engine runs in a worker, and the page shows each moment and hands inputs on.
//
// Phases: unpack and start the engine; lay out the page; then, at the display's pace, show the last moment, draw, ask for the next.
import { readBlock } from './decode.js';
import { element } from './dom.js';
import { Engine } from './live_engine.js';
import { Clock, LivePanel, steeringPad, toolBar } from './live_panel.js';
import { Flashes, LiveBox, LiveCloud, LiveSolids, LiveWalls } from './live_parts.js';
import { TipCamera } from './live_tip.js';
import { Tools, tools } from './live_tools.js';
import { Overlay } from './overlay.js';
import { Stage } from './stage.js';
import css from './viewer.css';
import worker from './live.worker.js';

const fastest = { push: 0.4, turn: 120 }; // of a catheter, m/s and rad/s

const text = async (block) => new TextDecoder().decode(await readBlock(block));
const nextFrame = () => new Promise((next) => requestAnimationFrame(next));

export class Live {
  static async start(view, data, api) {
    const live = new Live();
    // A link to a scene names it behind the #.
    const chosen = data.scenes.find((s) => `#${s.name}` === window.location.hash) ?? data.scenes[0];
    Object.assign(live, { view, data, ...chosen, api, input: { push: 0, turn: 0 }, running: true, isSteered: false, scaledAt: -1, pace: 1, spent: [], edits: 0, done: Promise.resolve() });
    Object.assign(api, { live, viewer: live });
    const began = performance.now();
    document.head.append(element('style', {}, css));
    live.progress = view.querySelector('.fallback');
    live.say('Unpacking the engine …');
    // The package's program ends with what a worker of a page cannot have.
    live.program = (await text(data.engine.program)).split('// --- module')[0] + worker;
    live.engine = new Engine(live.program, (t) => live.say(t));
    const first = await live.engine.ask('start', await live.ofScene());
    live.layOut(first);
    live.take(first);
    live.stage.frame(live.walls.visiblePoints());
    api.firstDrawMs = performance.now() - began;
    api.ready = api.whole = true;
    live.loop();
  }

  /** What an engine needs to start. */
  async ofScene() {
    const names = Object.keys(this.files);
    const blocks = await Promise.all([this.data.engine.wasm, ...Object.values(this.files)].map(readBlock));
    return { wasm: blocks[0], scene: this.scene, files: Object.fromEntries(names.map((name, i) => [name, blocks[i + 1]])) };
  }

  can(mode) {
    return mode === 'look' || this.stage.dimension === 3;
  }

  layOut({ box, dimension, patches, solids, walls }) {
    const { view } = this;
    this.hasCatheter = solids.some((s) => s.kind === 'catheter');
    this.stage = new Stage(new LiveBox(box), dimension, this.gravity);
    this.walls = new LiveWalls(this.stage.box, dimension, patches);
    this.particles = new LiveCloud(this.stage.box, patches);
    this.solids = new LiveSolids(this.stage.box);
    this.flashes = new Flashes();
    for (const part of [this.walls, this.solids, this.flashes, this.particles]) this.stage.scene.add(part.object);
    this.stage.observers.push(() => {
      this.walls.sort(this.stage.camera);
      this.particles.fit(this.stage, this.stage.depthOf(this.walls.opaque));
      this.flashes.uniforms.pixels.value = 7 * (this.stage.pixelRatio ?? 1);
    });
    this.overlay = new Overlay(this.stage);
    this.tip = new TipCamera(this.stage, this.walls, this.particles, this.solids);
    this.tools = new Tools({ stage: this.stage, walls: this.walls, act: (what, argument, said) => this.act(what, argument, said), say: (t) => this.say(t) });
    this.bar = toolBar((mode) => this.tools.choose(mode), tools.filter(([mode]) => this.can(mode)));
    this.clock = new Clock({
      toggle: () => this.toggle(), once: () => this.once(), undo: () => this.undo(), again: () => this.again(), paceTo: (n) => { this.pace = n; },
    });
    this.live = this; // what the panel asks for
    this.walls.update(walls);
    this.panel = new LivePanel(this, { frame: () => this.frame(), wholeScreen: () => (document.fullscreenElement ? document.exitFullscreen() : view.requestFullscreen()) });
    this.progress = element('p', { class: 'loading', 'aria-live': 'polite' });
    const over = [this.progress, this.tip.element, ...this.overlay.elements, this.tools.line, this.bar.element, this.hasCatheter ? steeringPad(this.input) : null];
    view.replaceChildren(element('div', { class: 'stage' }, this.stage.canvas, ...over.filter((e) => e)), this.panel.element, this.clock.element);
    view.classList.add('live', 'engine');
    this.stage.resize();
    this.bar.choose('look');
    this.listen();
  }

  listen() {
    new ResizeObserver(() => this.stage.resize()).observe(this.stage.canvas);
    const steers = { ArrowUp: ['push', 1], ArrowDown: ['push', -1], ArrowLeft: ['turn', 1], ArrowRight: ['turn', -1] };
    const isField = (e) => ['INPUT', 'SELECT'].includes(e.target.tagName) || e.ctrlKey || e.metaKey || e.altKey;
    document.addEventListener('keydown', (e) => {
      if (isField(e)) return;
      if (this.hasCatheter && !e.shiftKey && e.key in steers) [this.input[steers[e.key][0]]] = [steers[e.key][1]];
      else if (!this.key(e)) return;
      e.preventDefault();
    });
    document.addEventListener('keyup', (e) => { if (e.key in steers) this.input[steers[e.key][0]] = 0; });
    window.addEventListener('blur', () => Object.assign(this.input, { push: 0, turn: 0 }));
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.stage.colour();
      for (const part of [this.walls, this.particles, this.flashes]) part.restyle();
      this.panel.refresh();
      this.redraw();
    });
  }

  key(e) {
    const turns = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12] };
    const tool = this.bar.element.children[Number(e.key) - 1];
    if (e.key in turns) this.stage.turn(...turns[e.key]);
    else if (tool) tool.click();
    else if (e.key === ' ' && e.target.tagName !== 'BUTTON') this.toggle();
    else if (e.key === '.') this.once();
    else if (e.key === 'z' || e.key === 'Z') this.undo();
    else if (e.key === 'f' || e.key === 'F') this.frame();
    else if (e.key === '+' || e.key === '=') this.stage.turn(0, 0, 1.15);
    else if (e.key === '-') this.stage.turn(0, 0, 1 / 1.15);
    else return false;
    return true;
  }

  frame() {
    this.stage.frame(this.walls.visiblePoints());
  }

  redraw() {
    this.walls.show(0);
    this.particles.show(0);
    this.solids.show(0);
    this.stage.draw();
  }

  say(t) {
    if (this.progress) this.progress.textContent = t;
  }

  /** Takes a moment over into what is drawn. */
  take(state) {
    this.state = state;
    this.walls.update(state.walls);
    this.particles.update(state);
    this.solids.update(state.solids);
    this.flashes.update(state.contacts);
    if (state.ms > 0) this.spent = [...this.spent.slice(-119), state.ms];
    // The colours' range follows the speeds, ever more rarely.
    if (state.count > 0 && state.steps > 2 * this.scaledAt) {
      this.scaledAt = state.steps;
      this.particles.scaleTo(state.speeds);
      this.panel.refresh();
    }
    const median = [...this.spent].sort((a, b) => a - b)[this.spent.length >> 1] ?? 0;
    this.clock.label.textContent = `${state.time.toFixed(4)} s, step ${state.steps} · ${state.count.toLocaleString('en')} particles · ${median.toFixed(1)} ms a step`;
    this.clock.undo.disabled = !state.canUndo;
  }

  /** While one moment is drawn the worker computes the next one. */
  async loop() {
    let next = null;
    for (;;) {
      await nextFrame();
      if (this.edits > 0 || (!this.running && !next)) continue;
      next ??= this.ask();
      const state = await next;
      next = null;
      if (!state) continue;
      if (this.running && this.edits === 0) next = this.ask();
      this.take(state);
      this.stage.drawNow();
      ++this.api.drawn;
    }
  }

  /** The next moment; nothing if the engine refuses to go on, which it says. */
  ask() {
    const { push, turn } = this.input;
    // Until a hand is on it, the catheter moves as its scene says.
    this.isSteered ||= push !== 0 || turn !== 0;
    return this.engine.ask('run', { steps: this.pace, steer: this.isSteered ? { push: push * fastest.push, turn: turn * fastest.turn } : null })
      .catch((error) => {
        this.say(error.message);
        this.running = false;
        this.clock.show(false);
      });
  }

  toggle() {
    this.running = !this.running;
    this.clock.show(this.running);
  }

  once() {
    if (this.running) this.toggle();
    return this.act('run', { steps: 1, steer: null }, '');
  }

  /** Edits, one after another, between steps. */
  act(what, argument, said) {
    ++this.edits;
    this.say(said ? '…' : '');
    this.done = this.engine.ask(what, argument).then((state) => {
      this.take(state);
      const time = state.editMs === undefined ? '' : `, in ${state.editMs.toFixed(0)} ms`;
      if (said) this.say(`${said[0].toUpperCase()}${said.slice(1)}${time}.`);
    }).catch((error) => this.say(error.message)).finally(() => {
      --this.edits;
      this.stage.draw();
    });
    return this.done;
  }

  again() {
    this.isSteered = false;
    return this.act('again', {}, 'started again');
  }

  undo() {
    return this.clock.undo.disabled ? this.done : this.act('undo', {}, 'the last edit is undone');
  }

  prove(...parts) {
    this.panel.proof.replaceChildren(...parts);
  }

  async hash() {
    const { hash, steps } = await this.engine.ask('hash');
    this.prove(`State hash after step ${steps}: `, element('code', {}, hash));
    return hash;
  }

  async audit() {
    const { checked, failed, steps } = await this.engine.ask('audit');
    this.prove(`Audit after step ${steps}: each of ${checked.toLocaleString('en')} particles is in the cell that it names, by exact signs: ${failed === 0 ? 'no failure' : `${failed} failures`}.`);
    return failed;
  }

  /** Another engine runs the scene, untouched, for as many steps as a native program has. */
  async compare() {
    const { native } = this;
    this.prove(`Running ${native.steps} steps from the start …`);
    const other = new Engine(this.program, () => {});
    await other.ask('start', await this.ofScene());
    await other.ask('run', { steps: native.steps, steer: null });
    const { hash } = await other.ask('hash');
    other.stop();
    const isSame = hash === native.hash;
    this.prove(isSame ? 'The same bits as natively. ' : 'Other bits than natively: please report this. ', `After ${native.steps} steps from the start, here: `, element('code', {}, hash),
      ', natively: ', element('code', {}, native.hash));
    return isSame;
  }
}
