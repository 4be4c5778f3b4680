// The shape of walls: which corners share a normal, and the triangles from back to front.

const crease = Math.cos((40 * Math.PI) / 180); // sharper edges stay edges

/** The normal of a triangle, as long as twice its area, into `out`. */
function crossOf(points, corners, t, out) {
  const [a, b, c] = [3 * corners[3 * t], 3 * corners[3 * t + 1], 3 * corners[3 * t + 2]];
  const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
  const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
  out[0] = uy * vz - uz * vy;
  out[1] = uz * vx - ux * vz;
  out[2] = ux * vy - uy * vx;
}

/** The corners at each point: corner i of `list` from start[p] to start[p + 1]. */
function cornersByPoint(corners, points) {
  const start = new Uint32Array(points + 1);
  for (const p of corners) ++start[p + 1];
  for (let p = 0; p < points; ++p) start[p + 1] += start[p];
  const list = new Uint32Array(corners.length);
  const next = start.slice();
  for (let i = 0; i < corners.length; ++i) list[next[corners[i]]++] = i;
  return { start, list };
}

/**
 * Joins corners at a point whose triangles are of one face, or turn by less than the crease. Gives the number of the
 * normal of each corner, and how many there are.
 */
function joinNormals(points, corners, face, count) {
  const triangles = corners.length / 3;
  const normals = new Float32Array(3 * triangles);
  const n = [0, 0, 0];
  for (let t = 0; t < triangles; ++t) {
    crossOf(points, corners, t, n);
    const length = Math.hypot(...n) || 1;
    for (let k = 0; k < 3; ++k) normals[3 * t + k] = n[k] / length;
  }
  const { start, list } = cornersByPoint(corners, count);
  const group = new Uint32Array(corners.length);
  let groups = 0;
  const isJoined = (s, t) => face[s] === face[t]
    || normals[3 * s] * normals[3 * t] + normals[3 * s + 1] * normals[3 * t + 1] + normals[3 * s + 2] * normals[3 * t + 2] > crease;
  const seen = new Uint8Array(corners.length);
  for (let p = 0; p < count; ++p) {
    for (let i = start[p]; i < start[p + 1]; ++i) {
      if (seen[list[i]]) continue;
      const open = [list[i]];
      seen[list[i]] = 1;
      while (open.length > 0) {
        const corner = open.pop();
        group[corner] = groups;
        for (let j = start[p]; j < start[p + 1]; ++j) {
          if (seen[list[j]] || !isJoined(Math.floor(corner / 3), Math.floor(list[j] / 3))) continue;
          seen[list[j]] = 1;
          open.push(list[j]);
        }
      }
      ++groups;
    }
  }
  return { group, groups };
}

/** Vertices to draw: one for each normal at a point and patch. */
export class Shape {
  constructor(points, corners, face, patch) {
    this.corners = corners;
    const { group, groups } = joinNormals(points, corners, face, points.length / 3);
    const number = new Map();
    this.index = new Uint32Array(corners.length);
    const point = [], normal = [], ofPatch = [];
    for (let i = 0; i < corners.length; ++i) {
      const p = patch[Math.floor(i / 3)];
      const key = group[i] * 65536 + p;
      let v = number.get(key);
      if (v === undefined) {
        v = point.length;
        number.set(key, v);
        point.push(corners[i]);
        normal.push(group[i]);
        ofPatch.push(p);
      }
      this.index[i] = v;
    }
    this.point = new Uint32Array(point);
    this.normal = new Uint32Array(normal);
    this.patch = new Uint16Array(ofPatch);
    this.group = group;
    this.sums = new Float32Array(3 * groups);
  }

  get vertices() {
    return this.point.length;
  }

  /** Writes places and normals of all vertices. `areas`: those of the triangles, twice. */
  place(points, position, normals, areas) {
    const { corners, group, sums } = this;
    sums.fill(0);
    const n = [0, 0, 0];
    for (let t = 0; t < corners.length / 3; ++t) {
      crossOf(points, corners, t, n);
      areas[t] = Math.hypot(n[0], n[1], n[2]);
      for (let k = 0; k < 3; ++k) {
        const to = 3 * group[3 * t + k];
        sums[to] += n[0];
        sums[to + 1] += n[1];
        sums[to + 2] += n[2];
      }
    }
    for (let v = 0; v < this.point.length; ++v) {
      const from = 3 * this.point[v];
      const at = 3 * this.normal[v];
      const length = Math.hypot(sums[at], sums[at + 1], sums[at + 2]) || 1;
      for (let k = 0; k < 3; ++k) {
        position[3 * v + k] = points[from + k];
        normals[3 * v + k] = sums[at + k] / length;
      }
    }
  }
}

/** Writes the triangles of `chosen` into `out`, in their order along a direction: a sort by counting. */
export function sortTriangles(chosen, index, position, [dx, dy, dz], out) {
  const n = chosen.length;
  const depth = new Float32Array(n);
  let low = Infinity;
  let high = -Infinity;
  for (let i = 0; i < n; ++i) {
    let d = 0;
    for (let k = 0; k < 3; ++k) {
      const v = 3 * index[3 * chosen[i] + k];
      d += position[v] * dx + position[v + 1] * dy + position[v + 2] * dz;
    }
    depth[i] = d;
    low = Math.min(low, d);
    high = Math.max(high, d);
  }
  const bins = 4096;
  const scale = high > low ? (bins - 1) / (high - low) : 0;
  const start = new Uint32Array(bins + 1);
  for (let i = 0; i < n; ++i) ++start[Math.floor((depth[i] - low) * scale) + 1];
  for (let b = 0; b < bins; ++b) start[b + 1] += start[b];
  for (let i = 0; i < n; ++i) {
    const to = 3 * start[Math.floor((depth[i] - low) * scale)]++;
    const from = 3 * chosen[i];
    out[to] = index[from];
    out[to + 1] = index[from + 1];
    out[to + 2] = index[from + 2];
  }
}
