// A particle that was chosen: its path, its contacts, and what is known of it.
import { BufferAttribute, BufferGeometry, Group, Points, ShaderMaterial, Vector3 } from 'three';
import { readNumbers } from './decode.js';
import { pageColours, shortLength, shortNumber } from './colours.js';
import { button, element } from './dom.js';
import { makeRibbons } from './ribbons.js';

const kinds = ['vertex', 'edge', 'face', 'volume'];
const rowsOfPage = 12;

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

// Marks of their own shape: a ring around the particle, crosses at its contacts.
const markShader = {
  vertexShader: `
#include <clipping_planes_pars_vertex>
uniform float pixels;
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
  #include <clipping_planes_vertex>
  gl_Position = projectionMatrix * mvPosition;
  gl_PointSize = pixels;
}`,
  fragmentShader: `
#include <clipping_planes_pars_fragment>
uniform vec3 colour; uniform vec3 around; uniform bool isRing; uniform float pixels;
void main() {
  #include <clipping_planes_fragment>
  vec2 p = (gl_PointCoord - 0.5) * pixels;
  float d = isRing ? abs(length(p) - 0.36 * pixels) : max(min(abs(p.x - p.y), abs(p.x + p.y)) * 0.7, max(abs(p.x), abs(p.y)) - 0.36 * pixels);
  float width = 0.09 * pixels;
  if (d > 1.9 * width) discard;
  gl_FragColor = vec4(mix(colour, around, smoothstep(0.85 * width, 1.15 * width, d)), 1.0);
}`,
};

export class Selection {
  constructor(particles, contacts, stage, panel) {
    Object.assign(this, { particles, contacts, stage, panel, slot: -1, object: new Group(), list: [], page: 0 });
    stage.scene.add(this.object);
  }

  /** The slot of the particle next to a place on the canvas; -1 where there is none near. Nearer ones win. */
  slotAt(x, y, reach = 16) {
    const { particles, stage } = this;
    if (!particles) return -1;
    const { clientWidth: width, clientHeight: height } = stage.canvas;
    const p = new Vector3();
    const view = new Vector3();
    const scale = (height * stage.camera.projectionMatrix.elements[5]) / 2;
    const { slots, points } = particles.now();
    let best = -1;
    let bestScore = Infinity;
    for (let n = 0; n < slots.length; ++n) {
      p.fromArray(points, 3 * n);
      if (stage.renderer.clippingPlanes.some((plane) => plane.distanceToPoint(p) < 0)) continue;
      view.copy(p).applyMatrix4(stage.camera.matrixWorldInverse);
      p.project(stage.camera);
      if (p.z < -1 || p.z > 1) continue;
      const distance = Math.hypot((p.x + 1) * width / 2 - x, (1 - p.y) * height / 2 - y);
      const size = (particles.radius?.[slots[n]] ?? 0) * (stage.dimension === 2 ? scale : scale / -view.z);
      if (distance > Math.max(reach, size)) continue;
      // Inside a sphere the nearest sphere counts; among points the distance on the screen.
      const score = (distance <= size ? 0 : distance) + 1e-3 * -view.z / stage.box.radius;
      if (score < bestScore) [best, bestScore] = [slots[n], score];
    }
    return best;
  }

  /** The next particle that is there, by number; `step` -1: the one before. */
  neighbour(step) {
    const { slots } = this.particles.now();
    if (slots.length === 0) return -1;
    const at = slots.findIndex((s) => s >= this.slot);
    if (this.slot < 0 || at < 0) return slots[step > 0 ? 0 : slots.length - 1];
    return slots[(at + (step > 0 && slots[at] === this.slot ? 1 : step > 0 ? 0 : -1) + slots.length) % slots.length];
  }

  async pick(slot) {
    this.slot = slot;
    this.page = 0;
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

  /** The path: what has been is a line that fades towards its start, what comes is fainter. */
  line(points, now, colour) {
    const segments = points.length - 1;
    if (segments < 1) return;
    const ribbons = makeRibbons(segments, { width: 3, depthTest: false, order: 5 });
    const { a, b, tint, tintB } = ribbons.geometry.attributes;
    const opacity = (i) => (i > now ? 0.3 : 0.25 + 0.75 * (i / Math.max(now, 1)));
    for (let s = 0; s < segments; ++s) {
      a.array.set(points[s], 3 * s);
      b.array.set(points[s + 1], 3 * s);
      tint.array.set([...colour, opacity(s)], 4 * s);
      tintB.array.set([...colour, opacity(s + 1)], 4 * s);
    }
    this.object.add(ribbons);
  }

  marks(points, colour, pixels, isRing, around) {
    if (points.length === 0) return;
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    const uniforms = { colour: { value: new Vector3(...colour) }, around: { value: new Vector3(...around) }, pixels: { value: pixels * (this.stage.pixelRatio ?? 1) }, isRing: { value: isRing } };
    const marks = new Points(geometry, new ShaderMaterial({ uniforms, ...markShader, depthTest: false, transparent: true, clipping: true }));
    marks.renderOrder = isRing ? 7 : 6;
    marks.frustumCulled = false;
    this.object.add(marks);
  }

  /** The places of the chosen particle over the decoded frames. */
  path() {
    const { particles, slot } = this;
    const places = [];
    for (let f = particles.first[slot]; f <= particles.last[slot]; ++f) {
      if (!particles.position.has(f)) continue;
      const q = particles.position.frame(f).subarray(3 * slot, 3 * slot + 3);
      places.push([...particles.box.toScene(q, new Float32Array(3))]);
    }
    return places;
  }

  show(time) {
    this.clearObject();
    this.panel.hidden = this.slot < 0;
    if (this.slot < 0) return;
    const page = pageColours();
    const { particles, slot } = this;
    const f = Math.floor(time);
    this.line(this.path(), time - particles.first[slot], page.accent);
    if (particles.isAlive(slot, f)) {
      const at = (k) => particles.position.frame(k).subarray(3 * slot, 3 * slot + 3);
      this.marks([...particles.box.toScene(at(f), new Float32Array(3), at(f + 1), time - f)], page.text, 22, true, page.background);
    }
    this.marks((this.list ?? []).flatMap((c) => [...particles.box.toScene(c.point, new Float32Array(3))]), page.categories[2], 13, false, page.background);
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
      facts.append(row('position', x.map(shortLength).join(', ')),
        row('speed', speed + ' m/s'),
        row('is in a', particles.kindName(slot, f)),
        row('in the scene for', shortNumber(Math.max(0, particles.frames[f].time - particles.start[slot])) + ' s'));
    }
    if (particles.radius && particles.radius[slot] > 0) facts.append(row('radius', shortLength(particles.radius[slot])));
    const close = button('×', () => this.onClose?.(), { 'aria-label': 'Close' });
    panel.replaceChildren(element('header', {}, `Particle ${particles.id[slot]}`, close),
      alive ? facts : element('p', {}, 'It is not in the scene now.'), ...this.contactRows());
  }

  contactRows() {
    if (this.list === null)
      return [element('p', {}, `Contacts of every ${this.contacts.data.kept_every}th particle are in this report; those of this one are not.`)];
    if (this.list.length === 0) return [element('p', {}, 'No contacts.')];
    const table = element('table', {}, element('tr', {}, ...['time', 'patch', 'with a'].map((t) => element('th', { scope: 'col' }, t))));
    const names = this.particles.patches;
    const first = this.page * rowsOfPage;
    for (const c of this.list.slice(first, first + rowsOfPage))
      table.append(element('tr', {}, ...[`${shortNumber(c.time)} s`, names[c.patch - 1] || 'no patch', c.kind].map((t) => element('td', {}, t))));
    const pages = Math.ceil(this.list.length / rowsOfPage);
    const turn = (by) => {
      this.page = (this.page + by + pages) % pages;
      this.describe(Math.floor(this.particles.time));
    };
    const many = element('p', {}, `${this.list.length} contact${this.list.length === 1 ? '' : 's'}`);
    if (pages < 2) return [many, table];
    return [many, table, element('div', { class: 'pages' }, button('‹', () => turn(-1), { 'aria-label': 'Contacts before these' }),
      `${first + 1} to ${Math.min(first + rowsOfPage, this.list.length)}`, button('›', () => turn(1), { 'aria-label': 'Contacts after these' }))];
  }
}
