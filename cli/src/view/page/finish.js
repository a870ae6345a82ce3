// The finish of a mirror-like table: microfacets, as `goniochrome::microfacet` has them, and how `finish.frag` looks at
// them.

/** Smallest roughness of a facet. */
const MIN_ROUGHNESS = 0.001;
/** Looks of a picture at facets; few, for processors that draw without a graphics card. */
const LOOKS = 6;
/** Looks for an albedo, of equally and of unequally rough facets. */
const ALBEDO_LOOKS = [233, 89];
/** Steps of cos θ and of cos² φ in tables of the albedo. */
const ALBEDO_STEPS = [64, 6];
/** Steps of cos θ in tables of ρ. */
const RHO_STEPS = 1024;
/** Standard deviation of the light's blur in units of the side of its solid angle. */
const SOFTNESS = 0.4;
const GOLDEN = 0.6180339887498949;

class Finish {
  constructor({ beckmann, separable }, table) {
    [this.beckmann, this.separable] = [beckmann, separable];
    /** Linear RGB of ρ in equal steps of cos θ. */
    this.rho = Float32Array.from({ length: 3 * (RHO_STEPS + 1) });
    for (let i = 0; i <= RHO_STEPS; i += 1) this.rho.set(table.mirrored(degrees(Math.acos(i / RHO_STEPS))), 3 * i);
  }

  /** Roughness of the facets; `null` for a mirror. */
  static alpha(roughness) {
    return Math.max(...roughness) > 0 ? roughness.map((alpha) => Math.max(alpha, MIN_ROUGHNESS)) : null;
  }

  /**
   * A look at GGX facets from a place of the unit square: cosine and sine of its azimuth on their cap, height over it,
   * and how many looks it stands for. For Beckmann's facets, looks straight ahead are spread as their slopes are.
   */
  look(x, y) {
    const square = -Math.log1p(-(y % 1));
    const [depth, more] = this.beckmann ? [square / (1 + square), Math.exp(square) / (1 + square) ** 2] : [y % 1, 1];
    return [Math.cos(2 * Math.PI * x), Math.sin(2 * Math.PI * x), 1 - depth, more];
  }

  /** Looks of a picture, by its number: two rings, each around the middle of the lobe. */
  looks(picture) {
    const [x, y] = SHIFT.map((step) => (picture * step) % 1);
    return Array.from({ length: LOOKS }, (_, i) => this.look(i / LOOKS + x, (i % 2) / 2 + 0.25 + y)).flat();
  }

  /**
   * The level of light that a look of a picture sees, straight ahead. Solid angles shrink more slowly than the number
   * of looks grows, else single looks at a lamp would be seen.
   */
  static sharpness([x, y], picture, side) {
    const looks = LOOKS * (picture + 1) ** (2 / 3);
    return Math.log2(((SOFTNESS * side) / BLUR) * Math.sqrt((4 * Math.PI * x * y) / looks));
  }

  /** Area of the facets that a direction sees, projected along it: cos θ/G₁. */
  visibleArea([ax, ay], [x, y, z]) {
    const root = Math.hypot(ax * x, ay * y);
    if (!this.beckmann) return 0.5 * (z + Math.hypot(z, root));
    const a = z / Math.max(root, 1e-20);
    const [tail, t] = [Math.exp(-a * a), 1 / (1 + 0.3275911 * a)];
    // erf by Abramowitz and Stegun, 7.1.26.
    const poly = [1.0614054, -1.453152, 1.4214138, -0.2844967, 0.2548296].reduce((sum, c) => (sum + c) * t, 0);
    return 0.5 * (z * (2 - tail * poly) + root * 0.5641896 * tail);
  }

  /** Calls `see` with cos θ_d and the share of the light, for looks of a viewer at facets. */
  each(alpha, wo, count, see) {
    const [ax, ay] = alpha;
    const viewer = unit([ax * wo[0], ay * wo[1], wo[2]]);
    const area = this.visibleArea(alpha, wo);
    const drawn = 0.5 * (wo[2] + Math.hypot(ax * wo[0], ay * wo[1], wo[2]));
    for (let i = 0; i < count; i += 1) {
      const [cos, sin, height, more] = this.look(i * GOLDEN, (i + 0.5) / count);
      const z = height * (1 + viewer[2]) - viewer[2];
      const across = Math.sqrt(Math.max(1 - z * z, 0));
      const h = plus([across * cos, across * sin, z], viewer);
      const m = unit([ax * h[0], ay * h[1], h[2]]);
      const cosine = Math.min(dot(wo, m), 1);
      const wi = plus(times(m, 2 * cosine), wo, -1);
      if (!(wi[2] > 0)) continue;
      const light = this.visibleArea(alpha, wi);
      const divisor = this.separable ? light * area : light * wo[2] + area * wi[2] - wi[2] * wo[2];
      const slope = (h[0] * h[0] + h[1] * h[1]) / (h[2] * h[2]);
      const ratio = this.beckmann ? more * Math.exp(-slope) * (1 + slope) ** 2 : 1;
      see(cosine, (ratio * drawn * wi[2]) / (divisor * count));
    }
  }

  /** Linear RGB of the albedo for a viewer's direction. */
  rgb(alpha, wo, count = ALBEDO_LOOKS[0]) {
    const sum = [0, 0, 0];
    this.each(alpha, wo, count, (cosine, share) => {
      const at = cosine * RHO_STEPS;
      const i = Math.min(Math.floor(at), RHO_STEPS - 1);
      for (let c = 0; c < 3; c += 1) {
        const [low, high] = [this.rho[3 * i + c], this.rho[3 * i + 3 + c]];
        sum[c] += share * (low + (at - i) * (high - low));
      }
    });
    return sum;
  }

  /** A table of the albedo in linear RGB, `[cos² φ][cos θ]`; over cos θ alone for equally rough facets. */
  albedo(alpha) {
    if (this.kept?.alpha !== alpha.join()) this.kept = { alpha: alpha.join(), ...this.integrated(alpha) };
    return this.kept;
  }

  integrated(alpha) {
    const equal = alpha[0] === alpha[1];
    const [columns, rows] = [ALBEDO_STEPS[0] + 1, equal ? 1 : ALBEDO_STEPS[1] + 1];
    const values = new Float32Array(3 * columns * rows);
    for (let row = 0; row < rows; row += 1) {
      const x = Math.sqrt(row / ALBEDO_STEPS[1]);
      for (let column = 0; column < columns; column += 1) {
        const z = Math.max(column / ALBEDO_STEPS[0], 1e-6);
        const sin = Math.sqrt(1 - z * z);
        const wo = [sin * x, sin * Math.sqrt(1 - x * x), z];
        values.set(this.rgb(alpha, wo, ALBEDO_LOOKS[equal ? 0 : 1]), 3 * (row * columns + column));
      }
    }
    return { columns, rows, values };
  }
}
