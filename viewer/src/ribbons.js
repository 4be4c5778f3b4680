// Segments of a width in pixels: walls of the plane, paths. WebGL's own lines have one pixel.
import { BufferAttribute, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, ShaderMaterial, Vector2 } from 'three';

const vertexShader = `
#include <clipping_planes_pars_vertex>
uniform vec2 screen; uniform float width;
attribute vec3 a; attribute vec3 b; attribute vec4 tint; attribute vec4 tintB;
varying vec4 colour;
void main() {
  vec4 pa = projectionMatrix * modelViewMatrix * vec4(a, 1.0);
  vec4 pb = projectionMatrix * modelViewMatrix * vec4(b, 1.0);
  vec2 along = normalize((pb.xy / pb.w - pa.xy / pa.w) * screen + vec2(1e-6, 0.0));
  vec2 across = vec2(-along.y, along.x);
  vec4 mvPosition = modelViewMatrix * vec4(position.x < 0.5 ? a : b, 1.0);
  #include <clipping_planes_vertex>
  gl_Position = position.x < 0.5 ? pa : pb;
  gl_Position.xy += (across * position.y + along * (position.x - 0.5)) * width / screen * gl_Position.w;
  colour = position.x < 0.5 ? tint : tintB;
}`;
const fragmentShader = `
#include <clipping_planes_pars_fragment>
varying vec4 colour;
void main() {
  #include <clipping_planes_fragment>
  gl_FragColor = colour;
}`;

/** `segments`: how many; the attributes a, b (places), tint, tintB (colours with opacities) have values for each. */
export function makeRibbons(segments, { width, depthTest = true, order = 1 }) {
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]), 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  for (const [name, each] of [['a', 3], ['b', 3], ['tint', 4], ['tintB', 4]])
    geometry.setAttribute(name, new InstancedBufferAttribute(new Float32Array(each * segments), each));
  geometry.instanceCount = segments;
  const material = new ShaderMaterial({
    uniforms: { screen: { value: new Vector2(1, 1) }, width: { value: width } },
    vertexShader, fragmentShader, clipping: true, transparent: true, depthTest, depthWrite: false,
  });
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.renderOrder = order;
  mesh.onBeforeRender = (renderer) => {
    renderer.getDrawingBufferSize(material.uniforms.screen.value);
    material.uniforms.width.value = width * renderer.getPixelRatio();
  };
  return mesh;
}
