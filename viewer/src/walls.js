// The walls: one mesh for each patch, so that each can be shown, transparent or hidden; wires; hits as colours.
import { BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial } from 'three';
import { readNumbers, Series } from './decode.js';
import { linear, pageColours, patchColour, scaleColour } from './colours.js';

export const wallModes = ['transparent', 'shown', 'hidden'];

/** The walls of consecutive frames, between two cuts. */
class WallSet {
  static async load(data, dimension) {
    const set = new WallSet();
    set.first = data.first;
    set.perFace = dimension === 2 ? 2 : 3;
    [set.corners, set.patch, set.hits, set.edges] = await Promise.all([
      readNumbers(data.corners, Uint32Array), readNumbers(data.face_patch, Uint16Array),
      readNumbers(data.face_hits, Uint32Array), readNumbers(data.edges, Uint32Array)]);
    set.position = new Series(data.position, 3 * data.points, 16);
    return set;
  }
}

export class Walls {
  static async load(data, dimension, box, patches, hitsMax) {
    const walls = new Walls();
    Object.assign(walls, { dimension, box, patches, hitsMax, object: new Group(), shown: -1, byHits: false, wires: false });
    walls.sets = await Promise.all(data.map((d) => WallSet.load(d, dimension)));
    const others = patches.some((p) => p && !p.startsWith('outer'));
    walls.modes = patches.map((p) => (others && p.startsWith('outer') ? 'hidden' : 'transparent'));
    return walls;
  }

  get series() {
    return this.sets.map((set) => set.position);
  }

  setAt(f) {
    let at = 0;
    while (at + 1 < this.sets.length && this.sets[at + 1].first <= f) ++at;
    return at;
  }

  /** The frames that can be shown, as far as the walls are concerned. */
  get decoded() {
    let frames = 0;
    for (let i = 0; i < this.sets.length; ++i) {
      const { first, position } = this.sets[i];
      if (position.decoded === 0) break;
      if (position.isWhole) frames = i + 1 < this.sets.length ? this.sets[i + 1].first : Infinity;
      else return first + position.decoded;
    }
    return frames;
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
  }

  /** Makes the objects of a set: one for each patch, and its wires. */
  build(set) {
    this.clear();
    this.parts = [];
    const page = pageColours();
    for (const patch of new Set(set.patch)) {
      const faces = [];
      set.patch.forEach((p, face) => p === patch && faces.push(face));
      const corners = new Uint32Array(faces.length * set.perFace);
      faces.forEach((face, i) => {
        for (let k = 0; k < set.perFace; ++k) corners[i * set.perFace + k] = set.corners[face * set.perFace + k];
      });
      this.parts.push(this.part(patch, faces, corners, page));
    }
    if (set.edges) {
      const part = this.part(-1, [], set.edges, page);
      this.parts.push(part);
    }
    this.style();
  }

  part(patch, faces, corners, page) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(3 * corners.length), 3));
    const isLine = patch < 0 || this.dimension === 2;
    const colour = patch < 0 ? page.line : patchColour(patch, page);
    const material = isLine ? new LineBasicMaterial({ transparent: true })
      : new MeshLambertMaterial({ side: DoubleSide, flatShading: true, transparent: true, depthWrite: false });
    const object = isLine ? new LineSegments(geometry, material) : new Mesh(geometry, material);
    object.frustumCulled = false;
    object.renderOrder = patch < 0 ? 2 : 1;
    this.object.add(object);
    return { patch, faces, corners, colour, object };
  }

  /** Colours and opacities as they are chosen. */
  style() {
    const set = this.sets[this.shown];
    for (const { patch, faces, object, colour } of this.parts) {
      const { material, geometry } = object;
      if (patch < 0) {
        object.visible = this.wires;
        material.color.setRGB(...linear(colour));
        material.opacity = 0.6;
        continue;
      }
      const mode = this.modes[patch] ?? 'transparent';
      object.visible = mode !== 'hidden';
      const isSolid = mode === 'shown' || this.dimension === 2;
      material.opacity = isSolid ? 1 : this.byHits ? 0.75 : 0.22;
      material.depthWrite = isSolid || this.byHits;
      material.vertexColors = this.byHits;
      if (this.byHits) {
        const perFace = this.dimension === 2 ? 2 : 3;
        const colours = new Float32Array(3 * perFace * faces.length);
        faces.forEach((face, i) => {
          const share = Math.log1p(set.hits?.[face] ?? 0) / Math.max(Math.log1p(this.hitsMax), 1e-9);
          for (let k = 0; k < perFace; ++k) colours.set(linear(scaleColour(share)), 3 * (perFace * i + k));
        });
        geometry.setAttribute('color', new BufferAttribute(colours, 3));
        material.color.setRGB(1, 1, 1);
      } else {
        material.color.setRGB(...linear(colour));
      }
      material.needsUpdate = true;
    }
  }

  restyle() {
    if (this.shown < 0) return;
    const shown = this.shown;
    this.build(this.sets[shown]);
    this.place(this.lastFrame);
  }

  place(f) {
    const set = this.sets[this.shown];
    const values = set.position.frame(f - set.first);
    const points = this.box.toScene(values, new Float32Array(values.length));
    for (const { corners, object } of this.parts) {
      const attribute = object.geometry.getAttribute('position');
      for (let i = 0; i < corners.length; ++i) {
        const from = 3 * corners[i];
        attribute.array[3 * i] = points[from];
        attribute.array[3 * i + 1] = points[from + 1];
        attribute.array[3 * i + 2] = points[from + 2];
      }
      attribute.needsUpdate = true;
    }
    this.lastFrame = f;
  }

  /** Coordinates of the walls that are not hidden. */
  visiblePoints() {
    const points = [];
    for (const { patch, object } of this.parts ?? []) {
      if (patch >= 0 && object.visible) for (const x of object.geometry.getAttribute('position').array) points.push(x);
    }
    return points;
  }

  show(f) {
    if (this.sets.length === 0) return;
    const at = this.setAt(f);
    const stands = at === this.shown && this.sets[at].position.frames === 1;
    if (at !== this.shown) {
      this.shown = at;
      this.build(this.sets[at]);
    } else if (stands) {
      return;
    }
    this.place(f);
  }
}
