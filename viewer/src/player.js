// The time line: slider, play, rate, keys. A moment is a frame's number with a part of the way to the next frame.
import { button, choice, element } from './dom.js';
import { shortNumber } from './colours.js';

const secondsOfAll = 16; // that a run takes to play, about
const roundRate = (x) => Number(x.toPrecision(1));

export class Player {
  /** @param data the description; @param show called with a moment; @param has whether a frame can be shown */
  constructor({ frames, events }, show, has) {
    Object.assign(this, { frames, show, has, moment: 0, playing: false, once: false });
    this.last = Math.max(frames.length - 1, 0);
    this.button = button('▶', () => this.toggle(), { 'aria-label': 'Play', class: 'play' });
    this.slider = element('input', { type: 'range', min: 0, max: this.last, step: 'any', value: 0, 'aria-label': 'Time' });
    this.slider.addEventListener('input', () => this.go(Number(this.slider.value)));
    this.label = element('output', {});
    const track = element('div', { class: 'track' }, this.slider, ...this.marks(events));
    this.element = element('div', { class: 'time' }, this.button, track, this.rates(), this.label);
  }

  /** Seconds of the run in a second of the reader: powers of two around a whole run in some seconds, and real time. */
  rates() {
    const all = (this.frames[this.last]?.time ?? 0) - (this.frames[0]?.time ?? 0) || 1;
    const usual = roundRate(all / secondsOfAll);
    const rates = [...new Set([usual / 4, usual / 2, usual, 2 * usual, 4 * usual, 1])].sort((a, b) => a - b);
    this.rate = usual;
    return choice('Seconds of the run in a second', rates.map((r) => [String(r), `${shortNumber(r)}×`]), String(usual), (v) => { this.rate = Number(v); });
  }

  marks(events) {
    const first = this.frames[0]?.time ?? 0;
    const span = (this.frames[this.last]?.time ?? 0) - first;
    return events.map((e) => {
      const mark = element('span', { class: 'mark', title: `${e.time.toPrecision(4)} s: ${e.text}` });
      mark.style.left = `${span > 0 ? Math.max(0, Math.min(1, (e.time - first) / span)) * 100 : 0}%`;
      return mark;
    });
  }

  get frame() {
    return Math.floor(this.moment);
  }

  /** Seconds of the run at a moment. */
  seconds(moment) {
    const f = Math.floor(moment);
    const [a, b] = [this.frames[f]?.time ?? 0, this.frames[Math.min(f + 1, this.last)]?.time ?? 0];
    return a + (b - a) * (moment - f);
  }

  /** The moment at which the run has had some seconds. */
  momentOf(seconds) {
    let f = this.frame;
    if (this.frames[f].time > seconds) f = 0;
    while (f < this.last && this.frames[f + 1].time <= seconds) ++f;
    if (f >= this.last) return this.last;
    const { time } = this.frames[f];
    return f + Math.max(0, Math.min(0.9999, (seconds - time) / (this.frames[f + 1].time - time || 1)));
  }

  /** Shows a moment; if it is not decoded, the frame before the gap. */
  go(moment) {
    let m = Math.max(0, Math.min(moment, this.last));
    if (!this.has(Math.ceil(m))) m = Math.floor(m);
    if (!this.has(m)) m = this.moment;
    this.moment = m;
    this.slider.value = m;
    const { step } = this.frames[this.frame] ?? { step: 0 };
    const text = `${this.seconds(m).toPrecision(4)} s, step ${step}`;
    this.label.textContent = text;
    this.slider.setAttribute('aria-valuetext', text);
    this.show(m);
  }

  /** Plays once from the start, and then shows a frame again. */
  playOnce(after) {
    this.pause();
    this.go(0);
    this.once = true;
    this.after = after;
    this.toggle();
    this.once = true;
  }

  pause() {
    if (this.playing) this.toggle();
  }

  toggle() {
    this.playing = !this.playing;
    this.once = false;
    this.button.textContent = this.playing ? '❚❚' : '▶';
    this.button.setAttribute('aria-label', this.playing ? 'Pause' : 'Play');
    if (!this.playing) return;
    if (this.moment >= this.last) this.go(0);
    this.from = performance.now();
    requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    if (!this.playing) return;
    const seconds = this.seconds(this.moment) + (Math.min(now - this.from, 250) / 1000) * this.rate;
    this.from = now;
    if (seconds >= this.frames[this.last].time) {
      if (this.once) {
        this.pause();
        this.go(this.after);
        return;
      }
      this.go(this.moment < this.last ? this.last : 0);
    } else {
      this.go(this.momentOf(seconds));
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  /** Keys that work wherever the focus is in the view, but in no field of text. */
  key(event) {
    const steps = { ArrowRight: 1, ArrowLeft: -1, PageDown: 10, PageUp: -10 };
    if (event.shiftKey) return false;
    if (event.key === ' ' && event.target.tagName !== 'BUTTON') this.toggle();
    else if (event.key === 'Home') this.go(0);
    else if (event.key === 'End') this.go(this.last);
    else if (event.key in steps && event.target.tagName !== 'SELECT') this.go(this.frame + steps[event.key] + (steps[event.key] < 0 && this.moment > this.frame ? 1 : 0));
    else return false;
    return true;
  }
}
