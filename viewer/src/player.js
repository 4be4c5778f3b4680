// The time line: slider, play, speed, keys.
import { choice, element } from './dom.js';

const secondsOfAll = 10; // of a whole run at speed 1

export class Player {
  /** @param data the description; @param show called with a frame; @param ready how many frames can be shown */
  constructor({ frames, events }, show, ready) {
    Object.assign(this, { frames, show, ready, frame: 0, speed: 1, playing: false });
    this.button = element('button', { type: 'button', 'aria-label': 'Play', onclick: () => this.toggle() }, '▶');
    this.slider = element('input', { type: 'range', min: 0, max: Math.max(frames.length - 1, 0), step: 1, value: 0, 'aria-label': 'Time' });
    this.slider.addEventListener('input', () => this.go(Number(this.slider.value)));
    this.label = element('output', {});
    const rate = choice('Speed', [['0.25', '¼×'], ['0.5', '½×'], ['1', '1×'], ['2', '2×'], ['4', '4×']], '1', (v) => { this.speed = Number(v); });
    const track = element('div', { class: 'track' }, this.slider, ...this.marks(events));
    this.element = element('div', { class: 'time' }, this.button, track, rate, this.label);
  }

  marks(events) {
    const first = this.frames[0]?.time ?? 0;
    const span = (this.frames[this.frames.length - 1]?.time ?? 0) - first;
    return events.map((e) => {
      const mark = element('span', { class: 'mark', title: `${e.time.toPrecision(4)} s: ${e.text}` });
      mark.style.left = `${span > 0 ? Math.max(0, Math.min(1, (e.time - first) / span)) * 100 : 0}%`;
      return mark;
    });
  }

  /** Shows a frame, or the last one that is decoded. */
  go(f) {
    this.frame = Math.max(0, Math.min(f, this.frames.length - 1, this.ready() - 1));
    this.slider.value = this.frame;
    const { time, step } = this.frames[this.frame] ?? { time: 0, step: 0 };
    const text = `${time.toPrecision(4)} s, step ${step}`;
    this.label.textContent = text;
    this.slider.setAttribute('aria-valuetext', text);
    this.show(this.frame);
  }

  toggle() {
    this.playing = !this.playing;
    this.button.textContent = this.playing ? '❚❚' : '▶';
    this.button.setAttribute('aria-label', this.playing ? 'Pause' : 'Play');
    if (!this.playing) return;
    this.from = performance.now();
    this.position = this.frame >= this.frames.length - 1 ? 0 : this.frame;
    requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    if (!this.playing) return;
    const count = this.frames.length;
    this.position += ((now - this.from) / 1000 / secondsOfAll) * count * this.speed;
    this.from = now;
    if (this.position >= count) this.position %= count;
    const f = Math.floor(this.position);
    if (f !== this.frame) this.go(f);
    requestAnimationFrame((next) => this.tick(next));
  }

  /** Keys that work wherever the focus is in the view, but in no field of text. */
  key(event) {
    const steps = { ArrowRight: 1, ArrowLeft: -1, PageDown: 10, PageUp: -10 };
    if (event.key === ' ' && event.target.tagName !== 'BUTTON') this.toggle();
    else if (event.key === 'Home') this.go(0);
    else if (event.key === 'End') this.go(this.frames.length - 1);
    else if (event.key in steps && event.target.tagName !== 'SELECT') this.go(this.frame + steps[event.key]);
    else return false;
    return true;
  }
}
