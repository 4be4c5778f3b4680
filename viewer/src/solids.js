// Bodies and catheters: skins, points, and tubes along a line.
import { BufferAttribute, BufferGeometry, CatmullRomCurve3, DoubleSide, Group, Mesh, MeshStandardMaterial, Points, PointsMaterial, TubeGeometry, Vector3 } from 'three';
import { readNumbers, Series } from './decode.js';
import { linear, pageColours } from './colours.js';

export class Solids {
  static async load(data, box) {
    const solids = new Solids();
    Object.assign(solids, { box, object: new Group() });
    solids.all = await Promise.all(data.map(async (d, i) => ({
      ...d, place: i,
      present: await readNumbers(d.present, Uint32Array),
      triangles: await readNumbers(d.corners, Uint32Array),
      series: new Series(d.position, 3 * d.items, 16),
    })));
    return solids;
  }

  get series() {
    return this.all.map((s) => s.series);
  }

  colour(solid) {
    const { categories } = pageColours();
    return categories[(solid.place + 1) % categories.length];
  }

  makeObject(solid) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(3 * solid.items), 3));
    if (solid.triangles) geometry.setIndex(new BufferAttribute(solid.triangles, 1));
    const object = solid.triangles ? new Mesh(geometry, new MeshStandardMaterial({ side: DoubleSide, flatShading: true, roughness: 0.55, metalness: 0.05 }))
      : solid.kind === 'catheter' ? new Mesh(geometry, new MeshStandardMaterial({ side: DoubleSide, roughness: 0.35, metalness: 0.25 }))
        : new Points(geometry, new PointsMaterial({ size: Math.max(2 * solid.radius, this.box.radius / 250) }));
    object.frustumCulled = false;
    this.object.add(object);
    return object;
  }

  tube(points, radius) {
    if (points.length < 2) return new BufferGeometry();
    return new TubeGeometry(new CatmullRomCurve3(points, false, 'centripetal'), Math.min(4 * points.length, 800), radius, 10, false);
  }

  /** Coordinates of all of them, as they are shown. */
  points() {
    return this.all.flatMap((s) => [...(s.shownPoints ?? [])]);
  }

  has(f) {
    return this.series.every((s) => s.has(f));
  }

  decodeAt(f) {
    return Promise.all(this.series.map((s) => s.decodeAt(f)));
  }

  /** Shows a moment, a frame's number with a part of the way to the next one. */
  show(time) {
    const f = Math.floor(time);
    for (const solid of this.all) {
      solid.object ??= this.makeObject(solid);
      const { object } = solid;
      const count = solid.present[f] ?? 0;
      const values = solid.series.frame(f).subarray(0, 3 * count);
      // A solid that grows or shrinks stands still until the next frame.
      const isSame = solid.present[f + 1] === count;
      const next = isSame ? solid.series.frame(f + 1).subarray(0, 3 * count) : values;
      const points = this.box.toScene(values, new Float32Array(values.length), next, time - f);
      solid.shownPoints = points;
      object.visible = count > 0;
      object.material.color.setRGB(...linear(this.colour(solid)));
      if (solid.kind === 'catheter') {
        const path = Array.from({ length: count }, (_, i) => new Vector3(points[3 * i], points[3 * i + 1], points[3 * i + 2]));
        object.geometry.dispose();
        object.geometry = this.tube(path, solid.radius > 0 ? solid.radius : this.box.radius / 160);
      } else {
        const attribute = object.geometry.getAttribute('position');
        attribute.array.set(points);
        attribute.needsUpdate = true;
        if (!solid.triangles) object.geometry.setDrawRange(0, count);
        object.geometry.computeBoundingSphere();
      }
    }
  }
}
