// The parts of a live scene: what the report's viewer draws of frames, drawn of the one moment that the engine gives.
import { AdditiveBlending, BufferAttribute, BufferGeometry, Group, NormalBlending, Points, ShaderMaterial, Vector3 } from 'three';
import { Box } from './decode.js';
import { pageColours } from './colours.js';
import { ParticleCloud } from './particles.js';
import { Solids } from './solids.js';
import { Walls } from './walls.js';

/** Coordinates are floats around its middle, and are drawn as they are. */
export class LiveBox extends Box {
  toScene(values, out) {
    out.set(values);
    return out;
  }
}

/** In place of a series: each frame is the moment. */
class Moment {
  constructor(values) {
    this.values = values;
    this.frames = 1;
  }

  frame() {
    return this.values;
  }

  has() {
    return true;
  }
}

export class LiveCloud extends ParticleCloud {
  constructor(box, patches) {
    super();
    Object.assign(this, { box, patches, count: 0, frames: [{ time: 0 }], speedMax: 1, speedUsual: 1, time: 0, scale: 0.7, ranges: {}, thresholds: {}, isLog: false });
    this.makeObject();
    this.uniforms.size.value.setScalar(2 * box.radius);
    this.hold(1024);
    this.colourBy('speed');
  }

  /** Makes room for particles. */
  hold(most) {
    this.most = most;
    this.points.geometry.dispose();
    this.attributes = Object.fromEntries(['position', 'speed', 'first', 'last', 'radius'].map((name) => {
      const each = name === 'position' ? 3 : 1;
      return [name, new BufferAttribute(new Float32Array(each * most), each)];
    }));
    this.points.geometry = new BufferGeometry();
    this.points.geometry.setAttribute('radius', this.attributes.radius);
  }

  attribute(name) {
    return this.attributes[name];
  }

  update({ count, positions, speeds, radii }) {
    if (count > this.most) this.hold(2 * count);
    this.count = count;
    const { position, speed, radius } = this.attributes;
    const size = 2 * this.box.radius;
    for (let i = 0; i < 3 * count; ++i) position.array[i] = positions[i] / size + 0.5;
    for (let i = 0; i < count; ++i) speed.array[i] = (255 * speeds[i]) / this.speedMax;
    if (radii) radius.array.set(radii);
    for (const attribute of [position, speed, radius]) attribute.needsUpdate = true;
    this.points.geometry.setDrawRange(0, count);
    this.show(0);
  }

  /** The colours' range: up to the speed of nearly all particles. */
  scaleTo(speeds) {
    const sorted = Float32Array.from(speeds).sort();
    this.speedMax = sorted[Math.floor(0.97 * sorted.length)] || 1;
    this.speedUsual = this.speedMax;
    this.colourBy('speed');
  }
}

export class LiveWalls extends Walls {
  constructor(box, dimension, patches) {
    super();
    const others = patches.some((p) => p && !p.startsWith('outer'));
    Object.assign(this, {
      box, dimension, patches, frames: [{ time: 0 }], object: new Group(), shown: -1, byHits: '', wires: false, isLog: false, sets: [], hasHits: false, time: 0,
      modes: patches.map((p) => (others && p.startsWith('outer') ? 'hidden' : 'transparent')),
    });
  }

  /** `faces`: triangles, or segments in the plane, and the patch of each. They come after an edit alone. */
  update({ points, faces }) {
    if (faces) {
      const { corners, patch } = faces;
      this.sets = [{
        first: 0, perFace: this.dimension === 2 ? 2 : 3, corners, patch, face: Uint32Array.from(patch.keys()), edges: edgesOf(corners, this.dimension), count: points.length / 3,
        polygons: patch.length, position: new Moment(points), hits: new Moment(new Float32Array(patch.length)), points: new Float32Array(points.length),
      }];
      this.shown = -1;
    }
    if (this.sets.length === 0) return;
    this.sets[0].position.values = points;
    this.show(0);
  }
}

/** Each side of the triangles once. */
function edgesOf(corners, dimension) {
  if (dimension === 2) return null;
  const edges = [];
  const seen = new Set();
  for (let i = 0; i < corners.length; ++i) {
    const [a, b] = [corners[i], corners[i % 3 === 2 ? i - 2 : i + 1]];
    const key = Math.min(a, b) * 2 ** 26 + Math.max(a, b);
    if (seen.has(key)) continue;
    seen.add(key);
    edges.push(a, b);
  }
  return new Uint32Array(edges);
}

export class LiveSolids extends Solids {
  constructor(box) {
    super();
    Object.assign(this, { box, object: new Group(), all: [] });
  }

  /** Bodies, tools and catheters: kind, name, points, perhaps triangles. They come and go. */
  update(solids) {
    const before = this.all;
    this.all = solids.map((given, place) => {
      const solid = before.find((b) => b.kind === given.kind && b.name === given.name) ?? { place, radius: 0, items: given.points.length / 3, series: new Moment() };
      Object.assign(solid, given, { present: Array(2).fill(given.points.length / 3) });
      solid.series.values = given.points;
      return solid;
    });
    for (const { object } of before.filter((b) => !this.all.includes(b))) {
      object.geometry.dispose();
      this.object.remove(object);
    }
    this.show(0);
  }

  /** A catheter is seen through all particles, so that it can be steered among them. */
  makeObject(solid) {
    const object = super.makeObject(solid);
    if (solid.kind === 'catheter') Object.assign(object.material, { depthTest: false, transparent: true });
    object.renderOrder = 2;
    return object;
  }

  colour(solid) {
    return solid.kind === 'catheter' ? pageColours().text : super.colour(solid);
  }

  get catheters() {
    return this.all.filter((s) => s.kind === 'catheter');
  }
}

// Contacts flash: each is a spot that grows and fades within some moments.
const flashLife = 9;
const flashVertexShader = `
#include <clipping_planes_pars_vertex>
attribute float born;
uniform float now; uniform float pixels;
varying float left;
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
  #include <clipping_planes_vertex>
  gl_Position = projectionMatrix * mvPosition;
  left = 1.0 - (now - born) / ${flashLife}.0;
  gl_PointSize = left > 0.0 ? pixels * (1.4 - 0.7 * left) : 0.0;
  if (left <= 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;
const flashFragmentShader = `
#include <clipping_planes_pars_fragment>
uniform vec3 colour; varying float left;
void main() {
  #include <clipping_planes_fragment>
  float d = length(2.0 * gl_PointCoord - 1.0);
  gl_FragColor = vec4(colour, left * left * smoothstep(1.0, 0.1, d));
}`;

export class Flashes {
  constructor(most = 4096) {
    this.next = 0;
    this.now = 0;
    this.position = new BufferAttribute(new Float32Array(3 * most), 3);
    this.born = new BufferAttribute(new Float32Array(most).fill(-1e9), 1);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', this.position);
    geometry.setAttribute('born', this.born);
    this.uniforms = { now: { value: 0 }, pixels: { value: 8 }, colour: { value: new Vector3() } };
    this.object = new Points(geometry, new ShaderMaterial({
      uniforms: this.uniforms, vertexShader: flashVertexShader, fragmentShader: flashFragmentShader, clipping: true, transparent: true, depthWrite: false,
    }));
    this.object.frustumCulled = false;
    this.object.renderOrder = 5;
    this.restyle();
  }

  restyle() {
    const page = pageColours();
    this.object.material.blending = page.isDark ? AdditiveBlending : NormalBlending;
    this.uniforms.colour.value.set(...page.categories[2]);
  }

  update(contacts) {
    ++this.now;
    const most = this.born.count;
    for (let i = 0; i + 2 < contacts.length; i += 3) {
      this.position.array.set(contacts.subarray(i, i + 3), 3 * this.next);
      this.born.array[this.next] = this.now;
      this.next = (this.next + 1) % most;
    }
    if (contacts.length > 0) this.position.needsUpdate = this.born.needsUpdate = true;
    this.uniforms.now.value = this.now;
  }
}
