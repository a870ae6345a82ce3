// Meshes in the unit sphere, and their intersection with rays.

/** Tolerance at edges: a ray along the edge of two triangles hits one of them, whatever the rounding. */
const EDGE = 1e-9;

class Shape {
  constructor(data) {
    this.positions = signed(data.positions);
    this.normals = signed(data.normals);
    this.tangents = signed(data.tangents);
    /** Shares of the way from the first thickness of a film to the last; `null` for one thickness. */
    this.shares = data.shares ? indices(data.shares) : null;
    this.triangles = indices(data.triangles);
  }

  /** The nearest hit of a ray: its point and its frame, turned to the viewer; `null` if the ray misses. */
  intersect(origin, direction) {
    const vertex = (list, i) => [list[3 * i] / 32767, list[3 * i + 1] / 32767, list[3 * i + 2] / 32767];
    let [nearest, found] = [Infinity, null];
    for (let k = 0; k < this.triangles.length; k += 3) {
      const [i, j, l] = [this.triangles[k], this.triangles[k + 1], this.triangles[k + 2]];
      const a = vertex(this.positions, i);
      const [ab, ac] = [plus(vertex(this.positions, j), a, -1), plus(vertex(this.positions, l), a, -1)];
      const p = cross(direction, ac);
      const determinant = dot(ab, p);
      if (determinant === 0) continue;
      const from = plus(origin, a, -1);
      const u = dot(from, p) / determinant;
      if (u < -EDGE || u > 1 + EDGE) continue;
      const q = cross(from, ab);
      const v = dot(direction, q) / determinant;
      const t = dot(ac, q) / determinant;
      if (v < -EDGE || u + v > 1 + EDGE || t <= 0 || t >= nearest) continue;
      [nearest, found] = [t, { corners: [i, j, l], shares: [1 - u - v, u, v], front: determinant > 0 }];
    }
    if (!found) return null;
    const mean = (list) => found.corners.reduce((sum, c, n) => plus(sum, vertex(list, c), found.shares[n]), [0, 0, 0]);
    const side = found.front ? 1 : -1;
    const normal = times(unit(mean(this.normals)), side);
    const along = mean(this.tangents);
    const across = plus(along, normal, -dot(along, normal));
    const tangent = Math.hypot(...across) > 1e-9 ? unit(across) : [1, 0, 0];
    const share = this.shares ? found.corners.reduce((sum, c, n) => sum + (found.shares[n] * this.shares[c]) / 65535, 0) : 0;
    return { point: plus(origin, direction, nearest), share, normal, tangent, binormal: cross(normal, tangent) };
  }
}

/** θ and φ of the viewer in the frame of a hit, in degrees. */
function anglesOf(hit, towardsViewer) {
  const [x, y, z] = [hit.tangent, hit.binormal, hit.normal].map((axis) => dot(axis, towardsViewer));
  return { theta: degrees(Math.atan2(Math.hypot(x, y), Math.max(z, 0))), phi: (degrees(Math.atan2(y, x)) + 360) % 360 };
}
