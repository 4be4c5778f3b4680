// What lies over the scene: axes, a scale bar, the values under the pointer.
import { Vector3 } from 'three';
import { element } from './dom.js';
import { shortLength } from './colours.js';

const svg = (tag, attributes) => {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
};
const names = ['x', 'y', 'z'];
const colours = ['var(--c1)', 'var(--axis-y)', 'var(--c0)'];

export class Overlay {
  constructor(stage) {
    this.stage = stage;
    this.axes = svg('svg', { class: 'axes', viewBox: '-36 -36 72 72', width: 72, height: 72, role: 'img', 'aria-label': 'Directions of the axes' });
    this.arms = names.slice(0, stage.dimension).map((name, k) => {
      const line = svg('line', { x1: 0, y1: 0, stroke: colours[k], 'stroke-width': 2.2, 'stroke-linecap': 'round' });
      const label = svg('text', { fill: colours[k], 'text-anchor': 'middle', 'dominant-baseline': 'central' });
      label.textContent = name;
      return { line, label, at: new Vector3() };
    });
    this.length = element('span', {});
    this.bar = element('i', {});
    this.scale = element('div', { class: 'scale' }, this.length, this.bar);
    this.hover = element('div', { class: 'hover', hidden: true });
    stage.after.push(() => this.update());
  }

  get elements() {
    return [this.axes, this.scale, this.hover];
  }

  update() {
    const { camera } = this.stage;
    camera.updateMatrixWorld();
    for (const [k, arm] of this.arms.entries()) arm.at.setComponent(k, 1).setComponent((k + 1) % 3, 0).setComponent((k + 2) % 3, 0).transformDirection(camera.matrixWorldInverse);
    for (const { line, label, at } of this.arms) {
      line.setAttribute('x2', 22 * at.x);
      line.setAttribute('y2', -22 * at.y);
      label.setAttribute('x', 30 * at.x);
      label.setAttribute('y', -30 * at.y);
    }
    // Nearer arms lie over those behind.
    const order = [...this.arms].sort((a, b) => a.at.z - b.at.z);
    if (order.some((arm, k) => arm !== this.order?.[k])) this.axes.replaceChildren(...order.flatMap(({ line, label }) => [line, label]));
    this.order = order;
    const perPixel = this.stage.heightAtTarget / Math.max(this.stage.height, 1);
    const most = 110 * perPixel;
    const unit = 10 ** Math.floor(Math.log10(most));
    this.measure = [5, 2, 1].find((m) => m * unit <= most) * unit;
    this.bar.style.width = `${this.measure / perPixel}px`;
    this.length.textContent = shortLength(this.measure);
  }

  /** Shows lines of text beside a place on the canvas; none hides them. */
  point(lines, x, y) {
    this.hover.hidden = lines.length === 0;
    if (lines.length === 0) return;
    this.hover.replaceChildren(...lines.map((line) => element('div', {}, line)));
    const { clientWidth: width, clientHeight: height } = this.stage.canvas;
    this.hover.style.left = `${Math.min(x + 14, width - this.hover.offsetWidth - 4)}px`;
    this.hover.style.top = `${Math.min(y + 14, height - this.hover.offsetHeight - 4)}px`;
  }
}
