// The controls of a live scene: tools and steering over the stage, the clock below it, and the proof in the panel beside it.
import { button, choice, element } from './dom.js';
import { Panel } from './panel.js';
import { tools } from './live_tools.js';

/** A button that acts as long as it is held, by a pointer or by a key. */
function held(text, label, set) {
  const made = button(text, () => {}, { 'aria-label': label, title: label });
  const on = (is) => () => {
    made.classList.toggle('on', is);
    set(is);
  };
  made.addEventListener('pointerdown', (e) => {
    made.setPointerCapture(e.pointerId);
    on(true)();
  });
  for (const kind of ['pointerup', 'pointercancel', 'lostpointercapture', 'blur']) made.addEventListener(kind, on(false));
  made.addEventListener('keydown', (e) => { if (e.key === ' ' || e.key === 'Enter') on(true)(); });
  made.addEventListener('keyup', on(false));
  made.addEventListener('contextmenu', (e) => e.preventDefault());
  return made;
}

/** The tools, as one row of buttons. */
export function toolBar(chosen, wanted) {
  const row = element('div', { class: 'tools', role: 'toolbar', 'aria-label': 'Tools' });
  const choose = (mode) => {
    [...row.children].forEach((b, i) => b.setAttribute('aria-pressed', wanted[i][0] === mode));
    chosen(mode);
  };
  wanted.forEach(([mode, name, text], i) => row.append(button(name, () => choose(mode), { title: `${text} (key ${i + 1})` })));
  return { element: row, choose };
}

/** Steers a catheter: `input` has a push and a turn, from -1 to 1 each. */
export function steeringPad(input) {
  const keep = (name, value) => (on) => { input[name] = on ? value : 0; };
  return element('div', { class: 'pad', role: 'group', 'aria-label': 'Steer the catheter' },
    held('↺', 'Turn left', keep('turn', 1)), held('▲', 'Push', keep('push', 1)), held('↻', 'Turn right', keep('turn', -1)), held('▼', 'Pull back', keep('push', -1)));
}

/** The row below the stage. */
export class Clock {
  constructor({ toggle, once, undo, again, paceTo }) {
    this.play = button('❚❚', toggle, { 'aria-label': 'Pause', class: 'play' });
    this.undo = button('Undo', undo, { title: 'Back to before the last edit (Z)', disabled: true });
    const pace = choice('Steps in a picture', [1, 2, 4, 8].map((n) => [String(n), n === 1 ? '1 step a picture' : `${n} steps a picture`]), '1', (n) => paceTo(Number(n)));
    this.label = element('output', {});
    this.element = element('div', { class: 'time' }, this.play, button('Step', once, { title: 'One step (.)' }), this.undo,
      button('Start again', again), pace, this.label);
  }

  show(running) {
    this.play.textContent = running ? '❚❚' : '▶';
    this.play.setAttribute('aria-label', running ? 'Pause' : 'Go on');
  }
}

export class LivePanel extends Panel {
  particlePart() {
    const { live } = this.viewer;
    const row = (...all) => element('p', { class: 'row' }, ...all);
    this.proof = element('output', { class: 'proof', 'aria-live': 'polite' }, 'Every decision is an exact sign. So this page computes the same bits as the program natively.');
    const buttons = [button('State hash', () => live.hash()), button('Audit', () => live.audit()), button('Compare with native', () => live.compare())];
    const parts = [...this.scenePart(), element('h2', {}, 'The same bits'), row(...buttons), this.proof, element('h2', {}, 'Under your hand'),
      element('ul', { class: 'help' }, ...tools.filter(([mode]) => live.can(mode)).map(([, name, text]) => element('li', {}, element('b', {}, name), ` ${text}`)))];
    if (live.hasCatheter) parts.at(-1).prepend(element('li', {}, element('b', {}, 'Steer'), ' ↑ and ↓ push and pull the catheter, ← and → turn it; or use the buttons.'));
    return [...parts, element('h2', {}, 'Particles'), this.legend, element('label', {}, 'size', this.sizeSlider())];
  }

  /** Another scene starts in a fresh page. */
  scenePart() {
    const { data, name } = this.viewer.live;
    if (data.scenes.length < 2) return [];
    return [element('label', {}, 'scene', choice('Scene', data.scenes.map((s) => [s.name, s.name]), name, (wanted) => {
      window.location.hash = wanted;
      window.location.reload();
    }))];
  }

  filePart() {
    return [element('p', { class: 'row' }, button('Full screen', () => this.actions.wholeScreen()))];
  }
}
