// The camera at the tip of a catheter: what it sees, in a corner of the stage.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, PerspectiveCamera, Scene, ShaderMaterial, Vector3 } from 'three';
import { element } from './dom.js';

// A lamp sits at the camera: what is near and faces it is bright, what is far is dark. The wall looks like tissue.
const vertexShader = `
attribute vec3 tint;
varying vec3 eye; varying vec3 n; varying vec3 own;
void main() {
  vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
  eye = -mvPosition.xyz;
  n = normalMatrix * normal;
  own = tint;
  gl_Position = projectionMatrix * mvPosition;
}`;
const fragmentShader = `
uniform float reach;
varying vec3 eye; varying vec3 n; varying vec3 own;
void main() {
  float facing = abs(dot(normalize(n), normalize(eye)));
  float near = 1.0 / (1.0 + dot(eye, eye) / (reach * reach));
  vec3 tissue = mix(own, vec3(0.86, 0.36, 0.30), 0.8);
  float shine = pow(facing, 24.0);
  gl_FragColor = vec4(tissue * (0.10 + 0.95 * near * (0.25 + 0.75 * facing)) + 0.20 * shine * near, 1.0);
}`;

export class TipCamera {
  constructor(stage, walls, particles, solids) {
    Object.assign(this, { stage, walls, particles, solids });
    this.camera = new PerspectiveCamera(78, 1, stage.box.radius / 2000, 4 * stage.box.radius);
    this.scene = new Scene();
    this.scene.background = new Color(0x0c0706);
    this.material = new ShaderMaterial({ vertexShader, fragmentShader, side: DoubleSide, uniforms: { reach: { value: 0.12 * stage.box.radius } } });
    this.element = element('div', { class: 'tip' }, element('span', {}, 'tip camera'));
    stage.after.push(() => this.draw());
  }

  /** The walls have their places on the card already; here all of them are opaque. */
  takeWalls() {
    const { glass, shown, sets, attributes } = this.walls;
    if (!glass || this.of === sets[shown]) return;
    this.of = sets[shown];
    const geometry = new BufferGeometry();
    for (const name of ['position', 'normal', 'tint']) geometry.setAttribute(name, attributes[name]);
    geometry.setIndex(new BufferAttribute(this.of.shape.index, 1));
    this.mesh?.geometry.dispose();
    this.scene.clear();
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.scene.add(this.mesh);
  }

  /** Looks along the chain's last frame: who turns the catheter turns the picture. */
  place({ values }, frame) {
    this.camera.up.fromArray(frame, 3);
    this.camera.position.fromArray(values, values.length - 3);
    this.camera.lookAt(new Vector3().fromArray(frame).add(this.camera.position));
    this.camera.updateMatrixWorld();
  }

  draw() {
    const [catheter] = this.solids.catheters;
    this.element.hidden = !catheter || catheter.series.values.length < 9 || !this.walls.glass;
    if (this.element.hidden) return;
    this.takeWalls();
    this.place(catheter.series, catheter.tip);
    const { renderer, pixelRatio } = this.stage;
    const { offsetLeft: x, offsetTop: top, clientWidth: width, clientHeight: height } = this.element;
    const y = this.stage.height - top - height;
    const cut = renderer.clippingPlanes;
    renderer.clippingPlanes = [];
    renderer.setScissorTest(true);
    for (const set of ['setScissor', 'setViewport']) renderer[set](x + 1, y - 1, width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    renderer.render(this.scene, this.camera);
    this.drawParticles(renderer, height * pixelRatio);
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, this.stage.width, this.stage.height);
    renderer.clippingPlanes = cut;
  }

  /** The stage's own points, at sizes for this camera. */
  drawParticles(renderer, height) {
    const { uniforms, object } = this.particles;
    const own = [uniforms.perUnit.value, uniforms.hidesBehindWalls.value, uniforms.diameter.value];
    uniforms.diameter.value *= 0.4;
    uniforms.perUnit.value = (height * this.camera.projectionMatrix.elements[5]) / 2;
    uniforms.hidesBehindWalls.value = false;
    renderer.autoClear = false;
    renderer.render(object, this.camera);
    renderer.autoClear = true;
    [uniforms.perUnit.value, uniforms.hidesBehindWalls.value, uniforms.diameter.value] = own;
  }
}
