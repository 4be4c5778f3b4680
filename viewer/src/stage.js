// The stage: canvas, camera, background, cutting plane. It draws on demand.
import {
  BackSide, Color, DepthTexture, DirectionalLight, FrontSide, HemisphereLight, Mesh, MeshBasicMaterial, OrthographicCamera,
  PerspectiveCamera, Plane, Scene, UnsignedIntType, Vector2, Vector3, WebGLRenderer, WebGLRenderTarget,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { linear, pageColours } from './colours.js';

const directions = {
  front: [[0, -1, 0], [0, 0, 1]], back: [[0, 1, 0], [0, 0, 1]], left: [[-1, 0, 0], [0, 0, 1]], right: [[1, 0, 0], [0, 0, 1]],
  top: [[0, 0, 1], [0, 1, 0]], bottom: [[0, 0, -1], [0, 1, 0]],
};
export const presets = Object.keys(directions);

export class Stage {
  /** Throws where there is no WebGL. */
  constructor(box, dimension, gravity = [0, 0, 0]) {
    this.box = box;
    this.standsUpright = Math.abs(gravity[2]) > 0.9 * Math.hypot(...gravity);
    this.dimension = dimension;
    this.canvas = document.createElement('canvas');
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('role', 'application');
    this.canvas.setAttribute('aria-label', 'The scene. Shift and arrow keys turn it, plus and minus zoom, N chooses the next particle.');
    const context = this.canvas.getContext('webgl2', { antialias: true, powerPreference: 'high-performance' });
    if (!context) throw new Error('WebGL is missing');
    this.renderer = new WebGLRenderer({ canvas: this.canvas, context, antialias: true });
    this.scene = new Scene();
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(1, -2, 3);
    this.scene.add(new HemisphereLight(0xffffff, 0x8a94a0, 1.9), sun);
    this.plane = new Plane(new Vector3(-1, 0, 0), 0);
    this.drawn = 0;
    this.observers = []; // called before a frame is drawn
    this.after = []; // called after one is drawn
    this.framed = [];
    this.direction = null; // that frame() looks from; null: it chooses one
    this.up = null; // that frame() has; null: it chooses one
    this.makeCamera();
    this.colour();
  }

  makeCamera() {
    const r = this.box.radius;
    this.camera = this.dimension === 2 ? new OrthographicCamera(-r, r, r, -r, r / 100, 10 * r) : new PerspectiveCamera(32, 1, r / 100, r * 100);
    this.setUp(this.dimension === 2 ? [0, 1, 0] : [0, 0, 1]);
  }

  /** Controls take their upward direction once. */
  setUp(up) {
    this.camera.up.set(...up);
    const target = this.controls?.target;
    this.controls?.dispose();
    this.controls = new OrbitControls(this.camera, this.canvas);
    if (target) this.controls.target.copy(target);
    this.controls.enableRotate = this.dimension === 3;
    this.controls.screenSpacePanning = true;
    this.controls.addEventListener('change', () => this.draw());
    // A vertical swipe scrolls the page; all others are for the scene.
    this.canvas.style.touchAction = 'pan-y';
  }

  /** Turns the camera so that what is visible fills the stage. `points`: its coordinates, one after another. */
  frame(points = this.framed) {
    if (points.length > 0) this.framed = points;
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < points.length; ++i) {
      low[i % 3] = Math.min(low[i % 3], points[i]);
      high[i % 3] = Math.max(high[i % 3], points[i]);
    }
    const centre = points.length > 0 ? new Vector3(...low.map((x, k) => (x + high[k]) / 2)) : new Vector3();
    const size = points.length > 0 ? high.map((x, k) => x - low[k]) : this.box.size;
    this.sizes = size.slice(0, 2);
    this.resize();
    if (this.dimension === 2) {
      this.camera.position.set(centre.x, centre.y, 5 * this.box.radius);
      this.camera.zoom = 1;
    } else {
      const { direction, up } = this.lookFrom(size);
      this.setUp(up);
      this.camera.position.copy(centre).addScaledVector(direction, this.distanceFor(direction, centre, points));
    }
    this.controls.target.copy(centre);
    this.resize();
    this.controls.update();
    this.framedHeight = this.heightAtTarget;
    this.draw();
  }

  /** Along the shorter horizontal side, from above a little; from above where the scene is flat. A long scene lies along the
   *  stage, if gravity does not say which way is down. */
  lookFrom([sx, sy, sz]) {
    const direction = this.direction ? new Vector3(...this.direction) : sy <= sx ? new Vector3(0.35, -1, 0.3) : new Vector3(1, -0.35, 0.3);
    const up = this.up ? [...this.up] : [0, 0, 1];
    const isWide = this.camera.aspect > 1.2;
    if (!this.direction && sz < 0.25 * Math.min(sx, sy)) direction.z = 1.2;
    else if (!this.direction && !this.up && isWide && !this.standsUpright && sz > 1.3 * Math.max(sx, sy)) {
      direction.set(...(sy <= sx ? [-0.3, -1, -0.15] : [-1, -0.3, -0.15]));
      up.splice(0, 3, ...(sy <= sx ? [-1, 0, 0] : [0, -1, 0]));
    }
    return { direction: direction.normalize(), up };
  }

  look(preset) {
    [this.direction, this.up] = directions[preset] ?? [null, null];
    // Nearly upright: a camera that looks along its upward direction cannot turn.
    this.frame();
    [this.direction, this.up] = [null, null];
  }

  /** From where all points are in view. */
  distanceFor(direction, centre, points) {
    const right = new Vector3().crossVectors(this.camera.up, direction).normalize();
    const top = new Vector3().crossVectors(direction, right);
    const tan = Math.tan((this.camera.fov * Math.PI) / 360);
    const across = tan * Math.max(this.camera.aspect, 1e-3);
    const p = new Vector3();
    let distance = 1e-3 * this.box.radius;
    for (let i = 0; i + 2 < points.length; i += 3) {
      p.fromArray(points, i).sub(centre);
      distance = Math.max(distance, p.dot(direction) + Math.max(Math.abs(p.dot(right)) / across, Math.abs(p.dot(top)) / tan));
    }
    return 1.06 * distance;
  }

  /** Turns around the target by angles, or moves nearer by a factor. */
  turn(across, upwards, nearer = 1) {
    const from = this.camera.position.clone().sub(this.controls.target);
    if (this.dimension === 2) {
      this.camera.zoom *= nearer;
      this.camera.updateProjectionMatrix();
    } else {
      const up = this.camera.up.clone().normalize();
      const polar = from.angleTo(up);
      from.applyAxisAngle(up, across);
      const right = new Vector3().crossVectors(up, from).normalize();
      from.applyAxisAngle(right, Math.max(0.02, Math.min(Math.PI - 0.02, polar - upwards)) - polar);
      this.camera.position.copy(this.controls.target).addScaledVector(from, 1 / nearer);
    }
    this.controls.update();
    this.draw();
  }

  /** What the stage shows of the plane through the target, from bottom to top. */
  get heightAtTarget() {
    if (this.dimension === 2) return (this.camera.top - this.camera.bottom) / this.camera.zoom;
    return 2 * this.camera.position.distanceTo(this.controls.target) * Math.tan((this.camera.fov * Math.PI) / 360);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    // A frame that asks the page itself for them makes it lay out everything.
    Object.assign(this, { width, height });
    this.pixelRatio = Math.min(window.devicePixelRatio || 1, 2);
    this.renderer.setPixelRatio(this.pixelRatio);
    this.renderer.setSize(width, height, false);
    if (this.dimension === 2) {
      const [sx, sy] = this.sizes ?? this.box.size;
      const half = 0.52 * Math.max(sy, (sx * height) / width, 1e-30);
      Object.assign(this.camera, { left: (-half * width) / height, right: (half * width) / height, top: half, bottom: -half });
    } else {
      this.camera.aspect = width / height;
    }
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  colour() {
    this.renderer.setClearColor(new Color().setRGB(...linear(pageColours().background)));
  }

  /** Cuts away what lies beyond a share of the box along a direction; null: nothing. */
  clip(direction, share) {
    if (direction) {
      const extent = this.box.size.reduce((sum, size, k) => sum + size * Math.abs(direction.getComponent(k)), 0);
      this.plane.set(direction.clone().negate(), (share - 0.5) * extent * 1.002);
    }
    this.renderer.clippingPlanes = direction ? [this.plane] : [];
    this.draw();
  }

  /** The direction to the viewer. */
  get towardsViewer() {
    return this.camera.position.clone().sub(this.controls.target).normalize();
  }

  /**
   * The depth of opaque walls, alone: a particle behind one is not drawn at all, so that no part of its disc sticks out.
   * Outer sides count as a little nearer than they are and inner sides as farther, so that particles on a wall are
   * seen from inside alone.
   */
  depthOf(mesh) {
    if (!mesh || mesh.geometry.index.count === 0 || !mesh.visible) return null;
    const size = this.renderer.getDrawingBufferSize(new Vector2());
    if (!this.depth) {
      this.depth = new WebGLRenderTarget(size.x, size.y, { depthTexture: new DepthTexture(size.x, size.y, UnsignedIntType) });
      const sided = (side, offset, units) => new MeshBasicMaterial({ side, colorWrite: false, polygonOffset: true, polygonOffsetFactor: offset, polygonOffsetUnits: units });
      this.depthScene = new Scene();
      this.depthMeshes = [new Mesh(mesh.geometry, sided(FrontSide, -1, -64)), new Mesh(mesh.geometry, sided(BackSide, 1, 4))];
      for (const m of this.depthMeshes) m.frustumCulled = false;
      this.depthScene.add(...this.depthMeshes);
    }
    for (const m of this.depthMeshes) m.geometry = mesh.geometry;
    this.depth.setSize(size.x, size.y);
    this.renderer.setRenderTarget(this.depth);
    this.renderer.clear();
    this.renderer.render(this.depthScene, this.camera);
    this.renderer.setRenderTarget(null);
    return this.depth.depthTexture;
  }

  /** Draws at the next occasion of the screen, once for all that ask. */
  draw() {
    this.asked ??= requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    if (this.asked) cancelAnimationFrame(this.asked);
    this.asked = undefined;
    this.camera.updateMatrixWorld();
    for (const observer of this.observers) observer();
    this.renderer.render(this.scene, this.camera);
    ++this.drawn;
    for (const observer of this.after) observer();
  }
}
