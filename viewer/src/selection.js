// A particle that was clicked: its path, its contacts, and what is known of it.
import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, Points, PointsMaterial, Vector3 } from 'three';
import { readNumbers } from './decode.js';
import { linear, pageColours, shortNumber } from './colours.js';
import { element } from './dom.js';

const kinds = ['vertex', 'edge', 'face', 'volume'];
const mostRows = 50;

/** The contacts of all slots, decoded when they are needed first. */
export class Contacts {
  constructor(data) {
    this.data = data;
  }

  async of(slot) {
    if (!this.data) return [];
    const d = this.data;
    this.loaded ??= Promise.all([readNumbers(d.offset, Uint32Array), readNumbers(d.time, Float32Array),
      readNumbers(d.patch, Uint16Array), readNumbers(d.kind, Uint8Array), readNumbers(d.point, Uint16Array)]);
    if (slot % d.kept_every !== 0) return null;
    const [offset, time, patch, kind, point] = await this.loaded;
    const list = [];
    for (let i = offset[slot]; i < offset[slot + 1]; ++i)
      list.push({ time: time[i], patch: patch[i], kind: kinds[kind[i]] ?? '', point: point.subarray(3 * i, 3 * i + 3) });
    return list;
  }
}

export class Selection {
  constructor(particles, contacts, stage, panel) {
    Object.assign(this, { particles, contacts, stage, panel, slot: -1, object: new Group(), list: [] });
    stage.scene.add(this.object);
  }

  /** The slot of the particle next to a place on the canvas; -1 where there is none near. Nearer ones win. */
  slotAt(x, y, f, reach = 16) {
    const { particles, stage } = this;
    if (!particles) return -1;
    const { clientWidth: width, clientHeight: height } = stage.canvas;
    const p = new Vector3();
    const view = new Vector3();
    const scale = (height * stage.camera.projectionMatrix.elements[5]) / 2;
    let best = -1;
    let bestScore = Infinity;
    for (let n = 0; n < particles.shown; ++n) {
      p.fromArray(particles.positions.array, 3 * n);
      if (stage.renderer.clippingPlanes.some((plane) => plane.distanceToPoint(p) < 0)) continue;
      view.copy(p).applyMatrix4(stage.camera.matrixWorldInverse);
      p.project(stage.camera);
      if (p.z < -1 || p.z > 1) continue;
      const distance = Math.hypot((p.x + 1) * width / 2 - x, (1 - p.y) * height / 2 - y);
      const size = particles.radii.array[n] * (stage.dimension === 2 ? scale : scale / -view.z);
      if (distance > Math.max(reach, size)) continue;
      // Inside a sphere the nearest sphere counts; among points the distance on the screen.
      const score = (distance <= size ? 0 : distance) + 1e-3 * -view.z / stage.box.radius;
      if (score < bestScore) [best, bestScore] = [particles.shownSlots[n], score];
    }
    return best;
  }

  async pick(slot) {
    this.slot = slot;
    this.list = [];
    if (slot >= 0) this.list = await this.contacts.of(slot);
  }

  clearObject() {
    for (const child of [...this.object.children]) {
      child.geometry.dispose();
      child.material.dispose();
      this.object.remove(child);
    }
  }

  line(points, colour, opacity) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    const line = new Line(geometry, new LineBasicMaterial({ transparent: true, opacity, depthTest: false }));
    line.material.color.setRGB(...linear(colour));
    line.renderOrder = 5;
    line.frustumCulled = false;
    this.object.add(line);
  }

  marks(points, colour, size) {
    if (points.length === 0) return;
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    const marks = new Points(geometry, new PointsMaterial({ size: size * (this.stage.pixelRatio ?? 1), sizeAttenuation: false, depthTest: false }));
    marks.material.color.setRGB(...linear(colour));
    marks.renderOrder = 6;
    marks.frustumCulled = false;
    this.object.add(marks);
  }

  /** The places of the chosen particle over the decoded frames. */
  path() {
    const { particles, slot } = this;
    const places = [];
    const last = Math.min(particles.last[slot], particles.position.decoded - 1);
    for (let f = particles.first[slot]; f <= last; ++f) {
      const q = particles.position.frame(f).subarray(3 * slot, 3 * slot + 3);
      places.push([...particles.box.toScene(q, new Float32Array(3))]);
    }
    return places;
  }

  show(f) {
    this.clearObject();
    this.panel.hidden = this.slot < 0;
    if (this.slot < 0) return;
    const { accent, categories } = pageColours();
    const places = this.path();
    const now = Math.max(0, Math.min(f - this.particles.first[this.slot], places.length - 1));
    if (places.length > 0) {
      this.line(places.slice(0, now + 1).flat(), accent, 1);
      this.line(places.slice(now).flat(), accent, 0.4);
      this.marks(places[now], accent, 11);
    }
    const { box } = this.particles;
    this.marks((this.list ?? []).flatMap((c) => [...box.toScene(c.point, new Float32Array(3))]), categories[1], 5);
    this.describe(f);
  }

  describe(f) {
    const { particles, slot, panel } = this;
    const alive = particles.isAlive(slot, f);
    const row = (name, value) => element('tr', {}, element('th', { scope: 'row' }, name), element('td', {}, value));
    const facts = element('table', {});
    if (alive) {
      const x = particles.box.toRun(particles.position.frame(f), slot);
      const speed = shortNumber((particles.speed.frame(f)[slot] / 255) * particles.speedMax);
      facts.append(row('position', x.map(shortNumber).join(', ') + ' m'),
        row('speed', speed + ' m/s'),
        row('is in a', particles.kindName(slot, f)),
        row('in the scene for', shortNumber(Math.max(0, particles.frames[f].time - particles.start[slot])) + ' s'));
    }
    if (particles.radius && particles.radius[slot] > 0) facts.append(row('radius', shortNumber(particles.radius[slot]) + ' m'));
    const close = element('button', { type: 'button', 'aria-label': 'Close', onclick: () => this.onClose?.() }, '×');
    panel.replaceChildren(element('header', {}, `Particle ${particles.id[slot]}`, close),
      alive ? facts : element('p', {}, 'It is not in the scene now.'), ...this.contactRows());
  }

  contactRows() {
    if (this.list === null)
      return [element('p', {}, `Contacts of every ${this.contacts.data.kept_every}th particle are in this report; those of this one are not.`)];
    if (this.list.length === 0) return [element('p', {}, 'No contacts.')];
    const table = element('table', {}, element('tr', {}, ...['time', 'patch', 'with a'].map((t) => element('th', { scope: 'col' }, t))));
    const names = this.particles.patches;
    for (const c of this.list.slice(0, mostRows))
      table.append(element('tr', {}, ...[`${shortNumber(c.time)} s`, names[c.patch - 1] || 'no patch', c.kind].map((t) => element('td', {}, t))));
    const more = this.list.length - mostRows;
    return [element('p', {}, `${this.list.length} contact${this.list.length === 1 ? '' : 's'}`), table, more > 0 ? element('p', {}, `and ${more} more`) : ''];
  }
}
