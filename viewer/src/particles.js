// The particles: points of some pixels, or spheres of their own size.
import { BufferAttribute, BufferGeometry, Points, ShaderMaterial } from 'three';
import { readNumbers, Series } from './decode.js';
import { pageColours, patchColour, scaleColour } from './colours.js';

const vertexShader = `
#include <clipping_planes_pars_vertex>
uniform float pixels; uniform float perRadius; uniform float orthographic;
attribute vec3 tint; attribute float radius;
varying vec3 colour; varying float isSphere;
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
  #include <clipping_planes_vertex>
  gl_Position = projectionMatrix * mvPosition;
  float size = radius * perRadius / (orthographic > 0.5 ? 1.0 : -mvPosition.z);
  isSphere = radius > 0.0 ? 1.0 : 0.0;
  gl_PointSize = radius > 0.0 ? max(size, 1.5) : pixels;
  colour = tint;
}`;
const fragmentShader = `
#include <clipping_planes_pars_fragment>
varying vec3 colour; varying float isSphere;
void main() {
  #include <clipping_planes_fragment>
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  float d = dot(p, p);
  if (d > 1.0) discard;
  float light = isSphere > 0.5 ? 0.45 + 0.55 * max(0.0, dot(vec3(p.x, -p.y, sqrt(1.0 - d)), normalize(vec3(-0.4, 0.6, 0.8)))) : 1.0 - 0.25 * d;
  gl_FragColor = vec4(colour * light, 1.0);
}`;

const kinds = ['vertex', 'edge', 'face', 'volume'];

export class ParticleCloud {
  /** @param data the member "particles" of the description */
  static async load(data, box, patches, frames) {
    const cloud = new ParticleCloud();
    Object.assign(cloud, { count: data.count, of: data.of, box, patches, frames, speedMax: data.speed.max });
    [cloud.id, cloud.first, cloud.last, cloud.start, cloud.radius] = await Promise.all([
      readNumbers(data.id, Uint32Array), readNumbers(data.first, Uint16Array), readNumbers(data.last, Uint16Array),
      readNumbers(data.start, Float32Array), readNumbers(data.radius, Float32Array)]);
    cloud.position = new Series(data.position, 3 * data.count, 16);
    cloud.speed = new Series(data.speed, data.count, 8);
    cloud.kind = new Series(data.kind, data.count, 8);
    cloud.patch = new Series(data.patch, data.count, 16);
    cloud.makeObject();
    return cloud;
  }

  get series() {
    return [this.position, this.speed, this.kind, this.patch];
  }

  makeObject() {
    const geometry = new BufferGeometry();
    this.positions = new BufferAttribute(new Float32Array(3 * this.count), 3);
    this.tints = new BufferAttribute(new Float32Array(3 * this.count), 3);
    geometry.setAttribute('position', this.positions);
    geometry.setAttribute('tint', this.tints);
    const radii = this.radius ?? new Float32Array(this.count);
    this.radii = new BufferAttribute(new Float32Array(this.count), 1);
    geometry.setAttribute('radius', this.radii);
    this.shownSlots = new Uint32Array(this.count);
    this.sizes = radii;
    this.material = new ShaderMaterial({
      uniforms: { pixels: { value: 4 }, perRadius: { value: 1 }, orthographic: { value: 0 } },
      vertexShader, fragmentShader, clipping: true,
    });
    this.object = new Points(geometry, this.material);
    this.object.frustumCulled = false;
  }

  isAlive(slot, f) {
    return this.first[slot] <= f && f <= this.last[slot];
  }

  /** What each slot is coloured by, as a number or the place of a category; and the legend. */
  quantity(name) {
    const residence = (slot, f) => this.frames[f].time - this.start[slot];
    switch (name) {
      case 'speed':
        return { low: 0, high: this.speedMax, unit: 'm/s', value: (slot, f) => (this.speed.frame(f)[slot] / 255) * this.speedMax };
      case 'kind':
        return { categories: kinds, colour: (i, page) => page.categories[i], value: (slot, f) => this.kind.frame(f)[slot] };
      case 'patch':
        return {
          categories: ['none yet', ...this.patches.map((p) => p || 'no patch')],
          colour: (i, page) => (i === 0 ? page.text : patchColour(i - 1, page)),
          value: (slot, f) => this.patch.frame(f)[slot],
        };
      case 'residence': {
        let high = 0;
        for (let slot = 0; slot < this.count; ++slot) high = Math.max(high, residence(slot, this.last[slot]));
        return { low: 0, high, unit: 's', value: residence };
      }
      default:
        return { low: this.id[0] ?? 0, high: this.id[this.count - 1] ?? 1, unit: '', value: (slot) => this.id[slot] };
    }
  }

  colourBy(name) {
    this.colouredBy = this.quantity(name);
  }

  colourOf(slot, f, page) {
    const q = this.colouredBy;
    const value = q.value(slot, f);
    if (q.categories) return q.colour(value, page);
    return scaleColour((value - q.low) / Math.max(q.high - q.low, 1e-300));
  }

  /** Fills the buffers with the particles that are there. */
  show(f) {
    const page = pageColours();
    const values = this.position.frame(f);
    const all = this.box.toScene(values, new Float32Array(values.length));
    let n = 0;
    for (let slot = 0; slot < this.count; ++slot) {
      if (!this.isAlive(slot, f)) continue;
      this.positions.array.set(all.subarray(3 * slot, 3 * slot + 3), 3 * n);
      this.tints.array.set(this.colourOf(slot, f, page), 3 * n);
      this.radii.array[n] = this.sizes[slot];
      this.shownSlots[n++] = slot;
    }
    this.shown = n;
    this.object.geometry.setDrawRange(0, n);
    for (const a of [this.positions, this.tints, this.radii]) a.needsUpdate = true;
  }

  /** Sizes on the screen follow the camera. */
  fit(camera, height) {
    const isOrthographic = camera.isOrthographicCamera === true;
    this.material.uniforms.orthographic.value = isOrthographic ? 1 : 0;
    this.material.uniforms.perRadius.value = height * camera.projectionMatrix.elements[5];
    this.material.uniforms.pixels.value = Math.max(2.5, Math.min(6, (180 / Math.sqrt(Math.max(this.count, 1)) + 2))) * this.pixelRatio;
  }

  visiblePoints() {
    return this.positions.array.subarray(0, 3 * this.shown);
  }

  kindName(slot, f) {
    return kinds[this.kind.frame(f)[slot]] ?? '';
  }
}
