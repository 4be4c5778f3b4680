// Where pointers meet the walls: rays, the middle of a vessel, its direction.
import { Vector3 } from 'three';

/** The ray through a place on the canvas. */
export function rayAt(stage, x, y) {
  const { clientWidth: width, clientHeight: height } = stage.canvas;
  const at = (z) => new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, z).unproject(stage.camera);
  const origin = at(-1);
  return { origin, direction: at(1).sub(origin).normalize() };
}

/** Distances along a ray to the walls that are not hidden, increasing. */
export function hitsOf(walls, { origin, direction }) {
  const set = walls.sets[0];
  if (!set || set.perFace !== 3) return [];
  const [a, u, v, p, q] = Array.from({ length: 5 }, () => new Vector3());
  const found = [];
  for (let t = 0; t < set.patch.length; ++t) {
    if (walls.modes[set.patch[t]] === 'hidden') continue;
    a.fromArray(set.points, 3 * set.corners[3 * t]);
    u.fromArray(set.points, 3 * set.corners[3 * t + 1]).sub(a);
    v.fromArray(set.points, 3 * set.corners[3 * t + 2]).sub(a);
    p.crossVectors(direction, v);
    const det = u.dot(p);
    if (det === 0) continue;
    a.subVectors(origin, a);
    const s = a.dot(p) / det;
    q.crossVectors(a, u);
    const r = direction.dot(q) / det;
    const distance = v.dot(q) / det;
    if (s >= 0 && r >= 0 && s + r <= 1 && distance > 0) found.push(distance);
  }
  return found.sort((x, y) => x - y);
}

export const alongRay = ({ origin, direction }, distance) => origin.clone().addScaledVector(direction, distance);

/** The middle of the first vessel that a ray goes through, and half its width; none: undefined. */
export function middleOf(walls, ray) {
  const [first, second] = hitsOf(walls, ray);
  if (second === undefined) return undefined;
  return { place: alongRay(ray, (first + second) / 2), half: (second - first) / 2 };
}

/** The direction of a vessel at a place: the one that the walls around it face least. */
export function directionAt(walls, place, reach) {
  const set = walls.sets[0];
  const m = new Float64Array(9); // the sum of n n^T over the triangles, n as long as twice the area
  const [a, u, v] = [new Vector3(), new Vector3(), new Vector3()];
  for (let t = 0; t < set.patch.length; ++t) {
    a.fromArray(set.points, 3 * set.corners[3 * t]);
    if (a.distanceTo(place) > reach) continue;
    u.fromArray(set.points, 3 * set.corners[3 * t + 1]).sub(a);
    v.fromArray(set.points, 3 * set.corners[3 * t + 2]).sub(a);
    const n = u.cross(v).toArray();
    for (let i = 0; i < 9; ++i) m[i] += n[Math.floor(i / 3)] * n[i % 3];
  }
  const trace = m[0] + m[4] + m[8];
  if (!(trace > 0)) return undefined;
  // Powers of trace - m turn a vector to the least of m's axes.
  let axis = new Vector3(0.31, 0.48, 0.82);
  for (let i = 0; i < 60; ++i) {
    const [x, y, z] = axis.toArray();
    axis = new Vector3(trace * x - m[0] * x - m[1] * y - m[2] * z, trace * y - m[3] * x - m[4] * y - m[5] * z, trace * z - m[6] * x - m[7] * y - m[8] * z).normalize();
  }
  return axis;
}
