// The particles: shaded discs with an outline, and tails that show where they come from. The graphics card has the values of two
// frames, and places all particles between them.
import {
  BufferAttribute, BufferGeometry, DataTexture, Group, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, NearestFilter, Points, RGBAFormat, ShaderMaterial, Vector2,
  Vector3,
} from 'three';
import { readNumbers, Series } from './decode.js';
import { pageColours, patchColour, scaleColour } from './colours.js';

// What both programs know of a particle: whether it is there, its value, its colour.
const common = `
#include <clipping_planes_pars_vertex>
uniform vec3 size; uniform float mixing; uniform float frame; uniform float finalFrame; uniform float now; uniform bool sinceStart;
uniform vec2 range; uniform bool isLog; uniform vec2 threshold; uniform sampler2D palette; uniform float classes;
attribute float value; attribute float nextValue; attribute float firstFrame; attribute float lastFrame;
vec3 placed(vec3 q) { return (q - 0.5) * size; }
// From 0 to 1: particles grow as they come, and shrink as they leave.
float presence() {
  float come = firstFrame <= frame ? 1.0 : firstFrame <= frame + 1.0 ? mixing : 0.0;
  float left = lastFrame > frame ? 1.0 : lastFrame < frame ? 0.0 : lastFrame >= finalFrame ? 1.0 : 1.0 - mixing;
  return come * left;
}
float valueNow() { return classes > 0.0 ? value : sinceStart ? now - value : mix(value, nextValue, mixing); }
bool isWanted(float v) { return v >= threshold.x && v <= threshold.y; }
vec3 colourOf(float v) {
  float share = (v - range.x) / max(range.y - range.x, 1e-30);
  if (isLog) share = log(1.0 + 99.0 * max(share, 0.0)) / log(100.0);
  float at = classes > 0.0 ? (v + 0.5) / 256.0 : (0.5 + 255.0 * clamp(share, 0.0, 1.0)) / 256.0;
  return texture2D(palette, vec2(at, 0.5)).rgb;
}`;
const vertexShader = `${common}
uniform vec2 screen; uniform float perUnit; uniform float diameter; uniform vec2 pixels; uniform float orthographic;
uniform sampler2D wallDepth; uniform bool hidesBehindWalls; uniform float luminance; uniform bool isDark;
attribute vec3 next; attribute float radius;
varying vec3 colour; varying vec3 ring; varying float border;
// The outline has a contrast of 4 to the page at least, and keeps the hue.
vec3 outlineOf(vec3 c) {
  vec3 light = pow(c, vec3(2.2));
  float is = dot(light, vec3(0.2126, 0.7152, 0.0722));
  float wanted = isDark ? 4.0 * (luminance + 0.05) - 0.05 : (luminance + 0.05) / 5.0 - 0.05;
  if (isDark && is < wanted) light = mix(light, vec3(1.0), (wanted - is) / (1.0 - is));
  if (!isDark && is > wanted) light *= wanted / is;
  return pow(light, vec3(1.0 / 2.2));
}
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(mix(placed(position), placed(next), mixing), 1.0);
  #include <clipping_planes_vertex>
  gl_Position = projectionMatrix * mvPosition;
  float there = presence();
  float v = valueNow();
  bool isHidden = there <= 0.0 || !isWanted(v);
  if (hidesBehindWalls) {
    // The neighbours count, too: at the rim of a wall the centre may be in a pixel beside it.
    vec3 at = gl_Position.xyz / gl_Position.w * 0.5 + 0.5;
    vec3 one = vec3(1.5 / screen, 0.0);
    float wall = min(texture2D(wallDepth, at.xy).r, min(min(texture2D(wallDepth, at.xy + one.xz).r, texture2D(wallDepth, at.xy - one.xz).r),
      min(texture2D(wallDepth, at.xy + one.zy).r, texture2D(wallDepth, at.xy - one.zy).r)));
    isHidden = isHidden || at.z > wall;
  }
  float away = orthographic > 0.5 ? 1.0 : -mvPosition.z;
  float across = radius > 0.0 ? max(2.0 * radius * perUnit / away, 1.5) : clamp(diameter * perUnit / away, pixels.x, pixels.y);
  gl_PointSize = there * across + 1.0;
  if (isHidden) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); gl_PointSize = 0.0; }
  colour = colourOf(v);
  ring = outlineOf(colour);
  border = gl_PointSize;
}`;
const fragmentShader = `
#include <clipping_planes_pars_fragment>
varying vec3 colour; varying vec3 ring; varying float border;
uniform float ringPixels;
void main() {
  vec4 diffuseColor = vec4(1.0); // that the next line writes to
  #include <clipping_planes_fragment>
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  float pixel = 2.0 / border;
  float d = length(p);
  float cover = clamp((1.0 - d) / pixel + 0.5, 0.0, 1.0);
  if (cover <= 0.02) discard;
  vec3 n = vec3(p.x, -p.y, sqrt(max(0.0, 1.0 - d * d)));
  float lit = dot(n, vec3(-0.37, 0.56, 0.74));
  float shine = max(lit, 0.0);
  shine *= shine; shine *= shine; shine *= shine; // to the power of 8
  vec3 ball = colour * (0.70 + 0.38 * lit) + 0.20 * shine * shine;
  float edge = smoothstep(1.0 - (ringPixels + 0.9) * pixel, 1.0 - ringPixels * pixel, d);
  gl_FragColor = vec4(mix(ball, ring, edge), cover);
}`;

// A tail: a strip through the places of the last frames, thinner and fainter towards its end.
const tailLength = 7;
const places = Array.from({ length: tailLength + 1 }, (_, i) => i);
const tailVertexShader = `${common}
uniform vec2 screen; uniform float width; uniform float seen;
${places.map((i) => `attribute vec3 q${i};`).join(' ')}
varying vec4 colour;
vec3 at(float i) {
  ${places.slice(0, -1).map((i) => `if (i < ${i}.5) return placed(mix(q${i + 1}, q${i}, mixing));`).join('\n  ')}
  return placed(q${tailLength});
}
void main() {
  float i = position.x;
  vec4 mvPosition = modelViewMatrix * vec4(at(i), 1.0);
  #include <clipping_planes_vertex>
  vec4 here = projectionMatrix * mvPosition;
  vec4 before = projectionMatrix * modelViewMatrix * vec4(at(max(i - 1.0, 0.0)), 1.0);
  vec4 after = projectionMatrix * modelViewMatrix * vec4(at(min(i + 1.0, ${tailLength - 1}.0)), 1.0);
  vec2 along = (before.xy / before.w - after.xy / after.w) * screen;
  along = length(along) > 1e-4 ? normalize(along) : vec2(1.0, 0.0);
  float share = 1.0 - i / ${tailLength - 1}.0;
  gl_Position = here;
  gl_Position.xy += vec2(-along.y, along.x) * position.y * width * mix(0.35, 1.0, share) / screen * here.w;
  float v = valueNow();
  float there = presence();
  if (there <= 0.0 || !isWanted(v)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  colour = vec4(colourOf(v), seen * there * share * share);
}`;
const tailFragmentShader = `
#include <clipping_planes_pars_fragment>
varying vec4 colour;
void main() {
  #include <clipping_planes_fragment>
  gl_FragColor = colour;
}`;

const kinds = ['vertex', 'edge', 'face', 'volume'];
export const quantities = [['speed', 'speed'], ['residence', 'time in the scene'], ['kind', 'place in the cell'], ['patch', 'patch met last'], ['id', 'number']];

export class ParticleCloud {
  /** @param data the member "particles" of the description */
  static async load(data, box, patches, frames) {
    const cloud = new ParticleCloud();
    Object.assign(cloud, { count: data.count, of: data.of, box, patches, frames, speedMax: data.speed.max, speedUsual: data.speed.usual ?? data.speed.max, time: 0 });
    [cloud.id, cloud.first, cloud.last, cloud.start, cloud.radius] = await Promise.all([
      readNumbers(data.id, Uint32Array), readNumbers(data.first, Uint16Array), readNumbers(data.last, Uint16Array),
      readNumbers(data.start, Float32Array), readNumbers(data.radius, Float32Array)]);
    cloud.position = new Series(data.position, 3 * data.count, 16);
    cloud.speed = new Series(data.speed, data.count, 8);
    cloud.kind = new Series(data.kind, data.count, 8);
    cloud.patch = new Series(data.patch, data.count, 16);
    cloud.cache = new Map();
    cloud.scale = 1; // of points, by the reader
    cloud.ranges = {};
    cloud.thresholds = {};
    cloud.isLog = false;
    cloud.makeObject();
    cloud.colourBy('speed');
    return cloud;
  }

  get series() {
    return [this.position, this.speed, this.kind, this.patch];
  }

  has(f) {
    return this.series.every((s) => s.has(f));
  }

  decodeAt(f) {
    return Promise.all(this.series.map((s) => s.decodeAt(f)));
  }

  makeObject() {
    this.palette = new DataTexture(new Uint8Array(4 * 256), 256, 1, RGBAFormat);
    this.palette.minFilter = this.palette.magFilter = NearestFilter;
    const shared = {
      size: new Vector3(...this.box.size), mixing: 0, frame: 0, finalFrame: this.frames.length - 1, now: 0, sinceStart: false,
      range: new Vector2(0, 1), isLog: false, threshold: new Vector2(-Infinity, Infinity), palette: this.palette, classes: 0,
      perUnit: 1, diameter: 1, pixels: new Vector2(2, 60), orthographic: 0, wallDepth: null, hidesBehindWalls: false, luminance: 1, isDark: false, ringPixels: 1,
      screen: new Vector2(1, 1), width: 2, seen: 0.5,
    };
    this.uniforms = Object.fromEntries(Object.entries(shared).map(([name, value]) => [name, { value }]));
    const geometry = new BufferGeometry();
    geometry.setAttribute('radius', new BufferAttribute(this.radius ?? new Float32Array(this.count), 1));
    this.points = new Points(geometry, new ShaderMaterial({ uniforms: this.uniforms, vertexShader, fragmentShader, clipping: true, alphaToCoverage: true }));
    this.points.frustumCulled = false;
    this.points.renderOrder = 1;
    this.object = new Group();
    this.object.add(this.points);
  }

  makeTails() {
    const geometry = new InstancedBufferGeometry();
    const strip = [];
    const index = [];
    for (let i = 0; i < tailLength; ++i) {
      strip.push(i, -1, 0, i, 1, 0);
      if (i > 0) index.push(2 * i - 2, 2 * i - 1, 2 * i, 2 * i - 1, 2 * i + 1, 2 * i);
    }
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(strip), 3));
    geometry.setIndex(index);
    geometry.instanceCount = this.count;
    this.tails = new Mesh(geometry, new ShaderMaterial({
      uniforms: this.uniforms, vertexShader: tailVertexShader, fragmentShader: tailFragmentShader, clipping: true, transparent: true, depthWrite: false, side: 2,
    }));
    this.tails.frustumCulled = false;
    this.tails.renderOrder = 2;
    this.object.add(this.tails);
  }

  get hasTails() {
    return this.tails?.visible === true;
  }

  set hasTails(on) {
    if (on && !this.tails) this.makeTails();
    if (this.tails) this.tails.visible = on;
    this.show(this.time);
  }

  /** The values of a frame as the card has them, once. */
  attribute(name, f, isInstanced) {
    const key = `${name} ${f} ${isInstanced}`;
    if (!this.cache.has(key)) {
      const kind = isInstanced ? InstancedBufferAttribute : BufferAttribute;
      const own = { start: this.start, id: this.id && Float32Array.from(this.id), first: this.first, last: this.last };
      const values = own[name] ?? this[name].frame(f);
      this.cache.set(key, new kind(values, name === 'position' ? 3 : 1, name === 'position'));
    }
    return this.cache.get(key);
  }

  isAlive(slot, f) {
    return this.first[slot] <= f && f <= this.last[slot];
  }

  /** What particles can be coloured by: the series behind it, how a value is read from it, and its range. */
  quantity(name) {
    const between = (series, slot, time) => {
      const f = Math.floor(time);
      const [a, b] = [series.frame(f)[slot], series.frame(f + 1)[slot]];
      return a + (b - a) * (time - f);
    };
    switch (name) {
      case 'speed':
        return { name, attribute: 'speed', low: 0, high: this.speedUsual, unit: 'm/s', perUnit: 255 / (this.speedMax || 1), value: (slot, t) => between(this.speed, slot, t) / 255 * this.speedMax };
      case 'kind':
        return { name, attribute: 'kind', categories: kinds, colour: (i, page) => page.categories[i], value: (slot, t) => this.kind.frame(Math.floor(t))[slot] };
      case 'patch':
        return {
          name, attribute: 'patch', categories: ['none yet', ...this.patches.map((p) => p || 'no patch')],
          colour: (i, page) => (i === 0 ? page.text : patchColour(i - 1, page)), value: (slot, t) => this.patch.frame(Math.floor(t))[slot],
        };
      case 'residence': {
        let high = 0;
        for (let slot = 0; slot < this.count; ++slot) high = Math.max(high, this.frames[this.last[slot]].time - this.start[slot]);
        return { name, attribute: 'start', low: 0, high, unit: 's', perUnit: 1, value: (slot, t) => this.secondsAt(t) - this.start[slot] };
      }
      default:
        return { name, attribute: 'id', low: this.id[0] ?? 0, high: this.id[this.count - 1] ?? 1, unit: '', perUnit: 1, value: (slot) => this.id[slot] };
    }
  }

  secondsAt(time) {
    const f = Math.min(Math.floor(time), this.frames.length - 1);
    const [a, b] = [this.frames[f].time, this.frames[Math.min(f + 1, this.frames.length - 1)].time];
    return a + (b - a) * (time - f);
  }

  colourBy(name) {
    this.colouredBy = this.quantity(name);
    this.restyle();
  }

  /** The range of the colours, as the reader has set it. */
  get range() {
    const { name, low, high } = this.colouredBy;
    const [l, h] = this.ranges[name] ?? [];
    return [l ?? low, h ?? high];
  }

  /** The values that are shown. */
  get threshold() {
    const [l, h] = this.thresholds[this.colouredBy.name] ?? [];
    return [l ?? -Infinity, h ?? Infinity];
  }

  /** Whether the reader's threshold lets a particle be seen. */
  isWanted(slot, time) {
    if (this.colouredBy.categories) return true;
    const value = this.colouredBy.value(slot, time);
    return value >= this.threshold[0] && value <= this.threshold[1];
  }

  restyle() {
    const page = pageColours();
    const q = this.colouredBy;
    const data = this.palette.image.data;
    for (let i = 0; i < 256; ++i) {
      const colour = !q.categories ? scaleColour(q.name, i / 255, page) : i < q.categories.length ? q.colour(i, page) : page.text;
      colour.forEach((c, k) => { data[4 * i + k] = Math.round(255 * c); });
      data[4 * i + 3] = 255;
    }
    this.palette.needsUpdate = true;
    const u = this.uniforms;
    u.classes.value = q.categories ? q.categories.length : 0;
    u.sinceStart.value = q.name === 'residence';
    u.isLog.value = this.isLog;
    u.range.value.set(...this.range.map((x) => x * (q.perUnit ?? 1)));
    const most = 1e30;
    u.threshold.value.set(...(q.categories ? [-most, most] : this.threshold.map((x) => Math.max(-most, Math.min(most, x * q.perUnit)))));
    u.luminance.value = page.luminance;
    u.isDark.value = page.isDark;
    u.seen.value = page.isDark ? 0.55 : 0.42;
  }

  /** Shows a moment, a frame's number with a part of the way to the next one. */
  show(time) {
    this.time = time;
    const f = Math.floor(time);
    const next = Math.min(f + 1, this.frames.length - 1);
    const u = this.uniforms;
    u.frame.value = f;
    u.mixing.value = time - f;
    u.now.value = this.secondsAt(time);
    const set = (geometry, isInstanced) => {
      const name = this.colouredBy.attribute;
      const at = (k) => (name === 'start' || name === 'id' ? 0 : k);
      const all = { value: [name, at(f)], nextValue: [name, at(next)], firstFrame: ['first', 0], lastFrame: ['last', 0] };
      for (const [to, from] of Object.entries(all)) geometry.setAttribute(to, this.attribute(...from, isInstanced));
    };
    const { geometry } = this.points;
    set(geometry, false);
    geometry.setAttribute('position', this.attribute('position', f, false));
    geometry.setAttribute('next', this.attribute('position', next, false));
    if (!this.hasTails) return;
    set(this.tails.geometry, true);
    for (const i of places) this.tails.geometry.setAttribute(`q${i}`, this.attribute('position', Math.max(0, this.firstReadable(i === 0 ? next : f + 1 - i)), true));
  }

  /** A tail ends at the earliest frame that is decoded. */
  firstReadable(f) {
    while (f < this.time && !this.position.has(Math.max(0, f))) ++f;
    return f;
  }

  /** Sizes on the screen follow the camera. `height`: of the stage at the start, in units of the scene. */
  fit(stage, wallDepth) {
    const { camera, canvas, pixelRatio = 1 } = stage;
    const u = this.uniforms;
    u.orthographic.value = camera.isOrthographicCamera ? 1 : 0;
    u.perUnit.value = (canvas.height * camera.projectionMatrix.elements[5]) / 2;
    // So large that ten thousand are a cloud and a hundred are beads; smaller on small screens.
    const room = Math.sqrt((stage.width * stage.height) / 7e5);
    const wanted = Math.max(4.2, Math.min(11, 110 / Math.sqrt(Math.max(this.count, 1)) + 4)) * Math.max(0.55, Math.min(1.4, room)) * this.scale;
    u.diameter.value = (wanted * (stage.framedHeight || stage.heightAtTarget)) / Math.max(stage.height, 1);
    u.pixels.value.set(2.5 * pixelRatio * Math.min(1, this.scale), 64 * pixelRatio);
    u.ringPixels.value = 0.8 * pixelRatio;
    u.wallDepth.value = wallDepth;
    u.hidesBehindWalls.value = wallDepth !== null;
    u.screen.value.set(canvas.width, canvas.height);
    u.width.value = 0.55 * wanted * pixelRatio;
  }

  /** The particles that are there now: slots, and places one after another. */
  now() {
    const f = Math.floor(this.time);
    const q = this.position.frame(f);
    const places_ = this.box.toScene(q, new Float32Array(q.length), this.position.frame(f + 1), this.time - f);
    const slots = [];
    for (let slot = 0; slot < this.count; ++slot) if (this.isAlive(slot, f) && this.isWanted(slot, this.time)) slots.push(slot);
    const points = new Float32Array(3 * slots.length);
    slots.forEach((slot, n) => points.set(places_.subarray(3 * slot, 3 * slot + 3), 3 * n));
    return { slots, points };
  }

  visiblePoints() {
    return this.now().points;
  }

  kindName(slot, f) {
    return kinds[this.kind.frame(f)[slot]] ?? '';
  }
}
