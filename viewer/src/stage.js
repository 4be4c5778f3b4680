// The stage: canvas, camera and lights. It draws on demand.
import { AmbientLight, Color, DirectionalLight, HemisphereLight, OrthographicCamera, PerspectiveCamera, Plane, Scene, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { linear, pageColours } from './colours.js';

export class Stage {
  /** Throws where there is no WebGL. */
  constructor(box, dimension) {
    this.box = box;
    this.dimension = dimension;
    this.canvas = document.createElement('canvas');
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('aria-label', 'The scene. Drag to turn it, scroll to zoom, click a particle.');
    const context = this.canvas.getContext('webgl2', { antialias: true });
    if (!context) throw new Error('WebGL is missing');
    this.renderer = new WebGLRenderer({ canvas: this.canvas, context, antialias: true });
    this.scene = new Scene();
    this.makeCamera();
    this.plane = new Plane(new Vector3(-1, 0, 0), 0);
    this.drawn = 0;
    this.observers = [];
    this.framed = [];
    this.direction = null; // that frame() looks from; null: it chooses one
    this.colour();
  }

  makeCamera() {
    const r = this.box.radius;
    if (this.dimension === 2) {
      this.camera = new OrthographicCamera(-r, r, r, -r, r / 100, 10 * r);
    } else {
      this.camera = new PerspectiveCamera(32, 1, r / 100, r * 100);
      this.camera.up.set(0, 0, 1);
      const sky = new HemisphereLight(0xffffff, 0x8a94a0, 1.9);
      sky.position.set(0, 0, 1);
      const sun = new DirectionalLight(0xffffff, 1.5);
      sun.position.set(1, -2, 3);
      this.scene.add(sky, sun, new AmbientLight(0xffffff, 0.3));
    }
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableRotate = this.dimension === 3;
    this.controls.screenSpacePanning = true;
    this.controls.addEventListener('change', () => this.draw());
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
    const [sx, sy, sz] = points.length > 0 ? high.map((x, k) => x - low[k]) : this.box.size;
    this.sizes = [sx, sy];
    this.controls.target.copy(centre);
    if (this.dimension === 2) {
      this.camera.position.set(centre.x, centre.y, 5 * this.box.radius);
      this.camera.zoom = 1;
    } else {
      // The viewer looks along the shorter horizontal side, from above a little; from above where the scene is flat.
      const direction = this.direction ? new Vector3(...this.direction) : sy <= sx ? new Vector3(0.35, -1, 0.3) : new Vector3(1, -0.35, 0.3);
      if (!this.direction && sz < 0.25 * Math.min(sx, sy)) direction.z = 1.2;
      this.resize();
      const distance = this.distanceFor(direction.normalize(), centre, points);
      this.camera.position.copy(centre).addScaledVector(direction, distance);
    }
    this.resize();
    this.controls.update();
    this.draw();
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
    return 1.08 * distance;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
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
    this.scene.background = new Color().setRGB(...linear(pageColours().background));
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

  /** Draws at the next occasion of the screen, once for all that ask. */
  draw() {
    this.asked ??= requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    if (this.asked) cancelAnimationFrame(this.asked);
    this.asked = undefined;
    for (const observer of this.observers) observer();
    this.renderer.render(this.scene, this.camera);
    ++this.drawn;
  }
}
