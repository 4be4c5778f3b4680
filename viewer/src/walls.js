// The walls: lit surfaces, transparent or not, each patch by itself; edges; hits as colours. In the plane: segments.
import { BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, ShaderMaterial, Vector3 } from 'three';
import { readNumbers, Series } from './decode.js';
import { linear, pageColours, patchColour, scaleColour } from './colours.js';
import { makeRibbons } from './ribbons.js';
import { Shape, sortTriangles } from './shape.js';

export const wallModes = ['transparent', 'shown', 'hidden'];
export const hitModes = [['', 'patch'], ['area', 'hits per area'], ['count', 'hits of a face']];

// Light from above, as the viewer sees it, from the sky around, and from a lamp beside the viewer. Walls have two sides, so
// that the side is a factor from -1 to 1, which passes through 0 at the rim.
const vertexShader = `
#include <clipping_planes_pars_vertex>
attribute vec3 tint; attribute vec4 heat;
uniform bool byHits;
varying vec4 lit; varying vec3 n; varying vec3 eye;
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
  #include <clipping_planes_vertex>
  gl_Position = projectionMatrix * mvPosition;
  n = normalMatrix * normal;
  eye = normalize(-mvPosition.xyz);
  float side = clamp(8.0 * dot(n, eye), -1.0, 1.0);
  float lamp = max(side * dot(n, vec3(-0.413, 0.688, 0.597)), 0.0);
  vec3 light = mix(vec3(0.60, 0.63, 0.70), vec3(0.86, 0.87, 0.88), 0.5 + 0.5 * side * n.y) + 0.34 * lamp;
  lit = byHits ? vec4(mix(tint, heat.rgb, heat.a) * light, heat.a) : vec4(tint * light, 0.0);
}`;
// Where a transparent wall is seen at a grazing angle it is denser (Fresnel), so that its shape is seen by its rim.
const fragmentShader = `
#include <clipping_planes_pars_fragment>
varying vec4 lit; varying vec3 n; varying vec3 eye;
uniform bool isGlass; uniform vec3 rim; uniform bool isDark;
void main() {
  #include <clipping_planes_fragment>
  vec3 m = normalize(n);
  float side = dot(m, eye);
  float away = 1.0 - min(abs(side), 1.0);
  float grazing = away * away * mix(away, 1.0, 0.3);
  float shine = max(sign(side) * dot(m, vec3(-0.231, 0.385, 0.893)), 0.0); // halfway between the lamp and the viewer
  shine *= shine; shine *= shine; shine *= shine; shine *= shine; shine *= shine; // to the power of 32
  if (isGlass) {
    vec3 glass = mix(lit.rgb, rim, (1.0 - lit.a) * min(1.3 * grazing, 1.0));
    gl_FragColor = vec4(min(glass + 0.55 * shine, 1.0), min(mix(0.09 + 0.75 * grazing, 0.92, lit.a) + 0.4 * shine, 1.0));
  } else {
    gl_FragColor = vec4(min(lit.rgb + 0.16 * shine + (isDark ? 0.10 : -0.06) * grazing, 1.0), 1.0);
  }
}`;

/** The walls of consecutive frames, between two cuts. */
class WallSet {
  static async load(data, dimension) {
    const set = new WallSet();
    set.first = data.first;
    set.perFace = dimension === 2 ? 2 : 3;
    [set.corners, set.patch, set.face, set.edges] = await Promise.all([
      readNumbers(data.corners, Uint32Array), readNumbers(data.face_patch, Uint16Array),
      readNumbers(data.face, Uint32Array), readNumbers(data.edges, Uint32Array)]);
    set.count = data.points;
    set.polygons = data.polygons;
    set.position = new Series(data.position, 3 * data.points, 16);
    set.hits = new Series(data.hits, data.polygons, 16);
    set.hitsPer = data.hits.per;
    set.points = new Float32Array(3 * data.points);
    return set;
  }
}

export class Walls {
  static async load(data, dimension, box, patches, frames) {
    const walls = new Walls();
    Object.assign(walls, { dimension, box, patches, frames, object: new Group(), shown: -1, byHits: '', wires: false, isLog: false });
    walls.sets = await Promise.all(data.map((d) => WallSet.load(d, dimension)));
    walls.hasHits = data.some((d) => d.hits.max > 0);
    const others = patches.some((p) => p && !p.startsWith('outer'));
    walls.modes = patches.map((p) => (others && p.startsWith('outer') ? 'hidden' : 'transparent'));
    walls.range = { area: null, count: [0, Math.max(1, ...data.map((d) => d.hits.max))] };
    return walls;
  }

  get series() {
    return this.sets.flatMap((set) => [set.position, set.hits]);
  }

  setAt(f) {
    let at = 0;
    while (at + 1 < this.sets.length && this.sets[at + 1].first <= f) ++at;
    return at;
  }

  has(f) {
    if (this.sets.length === 0) return true;
    const set = this.sets[this.setAt(f)];
    return set.position.has(f - set.first) && set.hits.has(f - set.first);
  }

  async decodeAt(f) {
    if (this.sets.length === 0) return;
    const set = this.sets[this.setAt(f)];
    await Promise.all([set.position.decodeAt(f - set.first), set.hits.decodeAt(f - set.first)]);
  }

  usedPatches() {
    const used = new Set();
    for (const set of this.sets) set.patch?.forEach((p) => used.add(p));
    return [...used].sort((a, b) => a - b);
  }

  clear() {
    for (const child of [...this.object.children]) {
      child.geometry.dispose();
      child.material.dispose();
      this.object.remove(child);
    }
    this.opaque = this.glass = this.lines = this.segments = null;
  }

  /** Makes the objects of a set. */
  build(set) {
    this.clear();
    this.placeOf(set, this.time);
    if (this.dimension === 2) {
      this.segments = makeRibbons(set.corners.length / 2, { width: 2.5 });
      this.object.add(this.segments);
    } else {
      set.shape ??= new Shape(set.points, set.corners, set.face, set.patch);
      this.makeSurfaces(set);
    }
    if (set.edges) {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(set.points, 3));
      geometry.setIndex(new BufferAttribute(set.edges, 1));
      this.lines = new LineSegments(geometry, new LineBasicMaterial({ transparent: true, opacity: 0.35, depthWrite: false }));
      this.lines.frustumCulled = false;
      this.lines.renderOrder = 4;
      this.object.add(this.lines);
    }
    this.style();
  }

  makeSurfaces(set) {
    const { vertices } = set.shape;
    const attributes = {};
    for (const [name, kind, each] of [['position', Float32Array, 3], ['normal', Float32Array, 3], ['tint', Uint8Array, 3], ['heat', Uint8Array, 4]])
      attributes[name] = new BufferAttribute(new kind(each * vertices), each, kind === Uint8Array);
    this.attributes = attributes;
    this.areas = new Float32Array(set.corners.length / 3);
    const uniforms = { rim: { value: new Vector3() }, byHits: { value: false }, isDark: { value: false } };
    const surface = (isGlass) => {
      const geometry = new BufferGeometry();
      for (const [name, attribute] of Object.entries(attributes)) geometry.setAttribute(name, attribute);
      const material = new ShaderMaterial({
        uniforms: { ...uniforms, isGlass: { value: isGlass } }, vertexShader, fragmentShader, clipping: true, side: DoubleSide,
        transparent: isGlass, depthWrite: !isGlass,
      });
      material.forceSinglePass = true;
      const mesh = new Mesh(geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = isGlass ? 3 : 0;
      this.object.add(mesh);
      return mesh;
    };
    this.uniforms = uniforms;
    this.opaque = surface(false);
    this.glass = surface(true);
  }

  /** Colours, and which triangles are drawn how. */
  style() {
    const set = this.sets[this.shown];
    const page = pageColours();
    const tintOf = (patch) => (this.isNeutral(patch) ? page.wall : patchColour(patch, page));
    if (this.lines) {
      this.lines.visible = this.wires;
      this.lines.material.color.setRGB(...linear(page.muted));
    }
    if (this.dimension === 2) return;
    const { tint } = this.attributes;
    set.shape.patch.forEach((patch, v) => tintOf(patch).forEach((c, k) => { tint.array[3 * v + k] = Math.round(255 * c); }));
    tint.needsUpdate = true;
    this.uniforms.rim.value.set(...page.rim);
    this.uniforms.isDark.value = page.isDark;
    const chosen = (mode) => [...set.patch.keys()].filter((t) => (this.modes[set.patch[t]] ?? 'transparent') === mode);
    const shown = chosen('shown');
    this.see = new Uint32Array(chosen('transparent'));
    const index = new Uint32Array(3 * shown.length);
    shown.forEach((t, i) => index.set(set.shape.index.subarray(3 * t, 3 * t + 3), 3 * i));
    this.opaque.geometry.setIndex(new BufferAttribute(index, 1));
    this.glass.geometry.setIndex(new BufferAttribute(new Uint32Array(3 * this.see.length), 1));
    this.sortedFrom = null;
  }

  /** No patch and the first one: most walls belong to them. */
  isNeutral(patch) {
    return patch <= 1;
  }

  restyle() {
    if (this.shown < 0) return;
    this.style();
    this.show(this.time);
  }

  placeOf(set, time) {
    const f = Math.floor(time) - set.first;
    set.position.frames > 1
      ? this.box.toScene(set.position.frame(f), set.points, set.position.frame(f + 1), time - Math.floor(time))
      : this.box.toScene(set.position.frame(0), set.points);
  }

  /** Hits of each face so far, between the frames in proportion. */
  hitsAt(set, time) {
    const f = Math.floor(time) - set.first;
    const [now, next] = [set.hits.frame(f), set.hits.frame(f + 1)];
    const hits = new Float32Array(set.polygons);
    for (let i = 0; i < hits.length; ++i) hits[i] = set.hitsPer * (now[i] + (next[i] - now[i]) * (time - Math.floor(time)));
    return hits;
  }

  /** Twice the areas of the faces; in the plane twice their lengths. */
  areasOfFaces(set) {
    const areas = new Float32Array(set.polygons);
    for (let t = 0; t < set.patch.length; ++t) {
      const p = set.points;
      const [a, b] = [3 * set.corners[set.perFace * t], 3 * set.corners[set.perFace * t + 1]];
      areas[set.face[t]] += this.dimension === 2 ? 2 * Math.hypot(p[b] - p[a], p[b + 1] - p[a + 1]) : this.areas[t];
    }
    return areas;
  }

  /** What is shown of the hits on each triangle's corners: hits over areas around a point, or those of the face. */
  values(set, time) {
    const hits = this.hitsAt(set, time);
    const out = new Float32Array(set.corners.length);
    if (this.byHits === 'count') {
      for (let i = 0; i < out.length; ++i) out[i] = hits[set.face[Math.floor(i / set.perFace)]];
      return out;
    }
    const areas = this.areasOfFaces(set);
    const key = (i) => set.corners[i] * 65536 + set.patch[Math.floor(i / set.perFace)];
    set.keys ??= (() => {
      const numbers = new Map();
      return Uint32Array.from(set.corners, (_, i) => numbers.get(key(i)) ?? (numbers.set(key(i), numbers.size), numbers.size - 1));
    })();
    const sums = new Float32Array(out.length);
    const around = new Float32Array(out.length);
    for (let i = 0; i < out.length; ++i) {
      const face = set.face[Math.floor(i / set.perFace)];
      sums[set.keys[i]] += hits[face];
      around[set.keys[i]] += areas[face] / 2;
    }
    for (let i = 0; i < out.length; ++i) out[i] = sums[set.keys[i]] / Math.max(around[set.keys[i]], 1e-30);
    return out;
  }

  /** The range of the colours: the whole run has one, so that colours grow with time. */
  rangeOf(mode) {
    if (this.range[mode]) return this.range[mode];
    const last = this.frames.length - 1;
    const set = this.sets[this.setAt(last)];
    if (this.shown !== this.sets.indexOf(set) || !this.has(last)) return [0, 1];
    const values = this.values(set, last).sort();
    // A few tiny faces with a hit have very high values.
    this.range[mode] = [0, values[Math.floor(0.995 * (values.length - 1))] || values[values.length - 1] || 1];
    return this.range[mode];
  }

  shareOf(value, mode = this.byHits) {
    const [low, high] = this.rangeOf(mode);
    const share = (x) => (this.isLog ? Math.log1p((99 * Math.max(0, x - low)) / Math.max(high - low, 1e-30)) / Math.log(100) : (x - low) / Math.max(high - low, 1e-30));
    return Math.max(0, Math.min(1, share(value)));
  }

  /** Hits as colours: the fewer, the clearer. */
  heat(set) {
    const page = pageColours();
    const values = this.values(set, this.time);
    const { heat } = this.attributes;
    for (let i = 0; i < values.length; ++i) {
      const share = this.shareOf(values[i]);
      const colour = scaleColour('hits', share, page);
      const at = 4 * set.shape.index[i];
      for (let k = 0; k < 3; ++k) heat.array[at + k] = Math.round(255 * colour[k]);
      heat.array[at + 3] = values[i] > 0 ? Math.round(255 * Math.min(1, 0.25 + 1.6 * share)) : 0;
    }
    heat.needsUpdate = true;
  }

  fillSegments(set) {
    const page = pageColours();
    const values = this.byHits ? this.values(set, this.time) : null;
    const { a, b, tint, tintB } = this.segments.geometry.attributes;
    for (let s = 0; s < set.patch.length; ++s) {
      for (let k = 0; k < 3; ++k) {
        a.array[3 * s + k] = set.points[3 * set.corners[2 * s] + k];
        b.array[3 * s + k] = set.points[3 * set.corners[2 * s + 1] + k];
      }
      const own = this.isNeutral(set.patch[s]) ? page.muted : patchColour(set.patch[s], page);
      const opacity = this.modes[set.patch[s]] === 'hidden' ? 0 : 1;
      [tint, tintB].forEach((to, k) => to.array.set([...(values && values[2 * s + k] > 0 ? scaleColour('hits', this.shareOf(values[2 * s + k]), page) : own), opacity], 4 * s));
    }
    for (const attribute of [a, b, tint, tintB]) attribute.needsUpdate = true;
  }

  /** Before a frame is drawn: transparent triangles from back to front. */
  sort(camera) {
    if (!this.glass || this.see.length === 0) return;
    const e = camera.matrixWorld.elements;
    const direction = [e[8], e[9], e[10]]; // towards the viewer
    const state = [...direction, ...camera.position.toArray(), this.time].join();
    if (state === this.sortedFrom) return;
    this.sortedFrom = state;
    const index = this.glass.geometry.index;
    sortTriangles(this.see, this.sets[this.shown].shape.index, this.attributes.position.array, direction, index.array);
    index.needsUpdate = true;
  }

  /** Coordinates of the walls that are not hidden, at some moments that are decoded. */
  visiblePoints(moments = [this.time]) {
    const points = [];
    for (const f of moments) {
      if (this.sets.length === 0 || !this.has(Math.floor(f))) continue;
      const set = this.sets[this.setAt(f)];
      const values = set.position.frame(Math.round(f) - set.first);
      const all = this.box.toScene(values, new Float32Array(values.length));
      const wanted = new Set();
      set.corners.forEach((p, i) => (this.modes[set.patch[Math.floor(i / set.perFace)]] !== 'hidden' ? wanted.add(p) : 0));
      for (const p of wanted) points.push(all[3 * p], all[3 * p + 1], all[3 * p + 2]);
    }
    return points;
  }

  /** Shows a moment, a frame's number with a part of the way to the next one. */
  show(time) {
    if (this.sets.length === 0) return;
    this.time = time;
    const at = this.setAt(time);
    const set = this.sets[at];
    // Between two frames with a cut in between, the walls stand still.
    if (at !== this.shown) {
      this.shown = at;
      this.build(set);
    }
    this.placeOf(set, time);
    if (this.lines) this.lines.geometry.getAttribute('position').needsUpdate = true;
    if (this.dimension === 2) {
      this.fillSegments(set);
      return;
    }
    const { position, normal } = this.attributes;
    set.shape.place(set.points, position.array, normal.array, this.areas);
    position.needsUpdate = normal.needsUpdate = true;
    this.uniforms.byHits.value = this.byHits !== '';
    if (this.byHits) this.heat(set);
    this.sortedFrom = null;
  }
}
