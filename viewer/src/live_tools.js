// The tools of the pointer: look, cut along a line, tie a vessel, pull at the wall, drop a barrel.
import { ArrowHelper, Color, Plane, Vector3 } from 'three';
import { linear, pageColours, shortLength } from './colours.js';
import { alongRay, directionAt, hitsOf, middleOf, rayAt } from './live_pick.js';

export const tools = [
  ['look', 'Look', 'Drag turns the scene; the wheel or two fingers zoom.'],
  ['cut', 'Cut', 'Draw a line: the tissue along it is cut.'],
  ['tie', 'Tie', 'Touch the vessel: it is tied there, and nothing flows through.'],
  ['pull', 'Pull', 'Take the wall and draw: it is pulled along, and stays there.'],
  ['drop', 'Drop', 'Touch the vessel: a barrel is put there, and falls.'],
];

export class Tools {
  /** @param act called with the name of an edit and what it needs; @param say called with a text for the reader */
  constructor({ stage, walls, act, say }) {
    Object.assign(this, { stage, walls, act, say, mode: 'look', from: null });
    this.arrow = new ArrowHelper(new Vector3(1, 0, 0), new Vector3(), 1);
    this.arrow.visible = false;
    for (const part of [this.arrow.line, this.arrow.cone]) Object.assign(part.material, { depthTest: false, transparent: true });
    stage.scene.add(this.arrow);
    this.line = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    this.line.setAttribute('class', 'stroke');
    this.line.append(document.createElementNS('http://www.w3.org/2000/svg', 'line'));
    const { canvas } = stage;
    canvas.addEventListener('pointerdown', (e) => this.down(e));
    canvas.addEventListener('pointermove', (e) => this.move(e));
    canvas.addEventListener('pointerup', (e) => this.up(e));
    canvas.addEventListener('pointercancel', () => this.stop());
  }

  choose(mode) {
    this.mode = mode;
    this.stop();
    // Another view may have made other controls.
    this.stage.controls.enabled = mode === 'look';
    this.stage.canvas.classList.toggle('armed', mode !== 'look');
  }

  stop() {
    this.from = null;
    this.arrow.visible = false;
    this.line.classList.remove('shown');
  }

  down(e) {
    this.stage.controls.enabled = this.mode === 'look';
    if (this.mode === 'look' || !e.isPrimary) return;
    const ray = rayAt(this.stage, e.offsetX, e.offsetY);
    this.from = { x: e.offsetX, y: e.offsetY, ray };
    this.stage.canvas.setPointerCapture(e.pointerId);
    if (this.mode !== 'pull') return;
    const [first] = hitsOf(this.walls, ray);
    if (first === undefined) {
      this.from = null;
      this.say('There is no wall under the pointer.');
    } else this.from.place = alongRay(ray, first);
  }

  move(e) {
    if (!this.from) return;
    const { x, y } = this.from;
    if (this.mode === 'cut') {
      this.line.classList.add('shown');
      for (const [name, value] of Object.entries({ x1: x, y1: y, x2: e.offsetX, y2: e.offsetY })) this.line.firstChild.setAttribute(name, value);
    } else if (this.mode === 'pull') {
      const by = this.drawn(e);
      const length = by.length();
      this.arrow.visible = length > 0;
      if (length === 0) return;
      this.arrow.position.copy(this.from.place);
      this.arrow.setDirection(by.normalize());
      this.arrow.setLength(length, 0.3 * length, 0.16 * length);
      this.arrow.setColor(new Color().setRGB(...linear(pageColours().categories[2])));
      this.stage.draw();
    }
  }

  /** From the place that was taken to the pointer, across the view. */
  drawn(e) {
    const plane = new Plane().setFromNormalAndCoplanarPoint(this.stage.towardsViewer, this.from.place);
    const { origin, direction } = rayAt(this.stage, e.offsetX, e.offsetY);
    return alongRay({ origin, direction }, -plane.distanceToPoint(origin) / plane.normal.dot(direction)).sub(this.from.place);
  }

  up(e) {
    const { from, mode } = this;
    if (!from) return;
    const by = mode === 'pull' ? this.drawn(e) : null;
    this.stop();
    this.stage.draw();
    if (mode === 'tie') this.tie(from.ray);
    else if (mode === 'drop') this.drop(from.ray);
    else if (Math.hypot(e.offsetX - from.x, e.offsetY - from.y) < 6) this.say(mode === 'cut' ? 'Draw a line to cut along it.' : 'Draw to pull.');
    else if (mode === 'cut') this.cut(from, rayAt(this.stage, e.offsetX, e.offsetY), e);
    else this.act('pull', { point: from.place.toArray(), displacement: by.toArray(), reach: 0.22 * this.stage.box.radius }, `pulled by ${shortLength(by.length())}`);
  }

  /** Through the line on the screen, along the view: a disc around the middle of the vessels under the line. */
  cut({ ray: one, x, y }, other, e) {
    const middles = [0.1, 0.3, 0.5, 0.7, 0.9].map((s) => rayAt(this.stage, x + (e.offsetX - x) * s, y + (e.offsetY - y) * s))
      .map((ray) => middleOf(this.walls, ray)).filter((m) => m);
    if (middles.length === 0) return this.say('The line meets no vessel.');
    const centre = middles.reduce((sum, m) => sum.add(m.place), new Vector3()).divideScalar(middles.length);
    const depth = (ray) => alongRay(ray, centre.clone().sub(ray.origin).dot(this.stage.towardsViewer) / ray.direction.dot(this.stage.towardsViewer));
    const along = depth(other).sub(depth(one));
    const normal = along.clone().cross(depth(one).add(along.clone().multiplyScalar(0.5)).sub(this.stage.camera.position)).normalize();
    const width = 0.026 * this.stage.box.radius;
    return this.act('cut', { point: centre.toArray(), normal: normal.toArray(), radius: along.length() / 2, width }, `cut along ${shortLength(along.length())}`);
  }

  drop(ray) {
    const middle = middleOf(this.walls, ray);
    if (!middle) return this.say('There is no vessel under the pointer.');
    return this.act('drop', { point: middle.place.toArray(), size: 0.4 * middle.half }, 'dropped a barrel');
  }

  tie(ray) {
    const middle = middleOf(this.walls, ray);
    const normal = middle && directionAt(this.walls, middle.place, 1.5 * middle.half);
    if (!normal) return this.say('There is no vessel under the pointer.');
    return this.act('tie', { point: middle.place.toArray(), normal: normal.toArray(), reach: 1.5 * middle.half }, 'tied');
  }
}
