// The finish of a mirror-like table: microfacets, as `goniochrome::microfacet` has them, and how `finish.frag` looks at
// them.

/** Smallest roughness of a facet. */
const MIN_ROUGHNESS = 0.001;
/** Looks of a picture at facets; few, for processors that draw without a graphics card. */
const LOOKS = 5;
/** Looks of a picture at tabulated facets, in whose list six normals are two rings. */
const NORMALS = 6;
/** Looks for an albedo, of equally and of unequally rough facets. */
const ALBEDO_LOOKS = [233, 89];
/** Steps of cos θ, of cos² φ and, for tabulated facets, of φ in tables of the albedo. */
const ALBEDO_STEPS = [64, 6, 16];
/** Steps of cos θ in tables of ρ. */
const RHO_STEPS = 1024;
/** Steps of √cos θ in tables of what facets lose, and azimuths of unequally rough ones. */
const LOSS_STEPS = 64;
const LOSS_AZIMUTHS = 12;
/** Standard deviation of the light's blur in units of the side of its solid angle. */
const SOFTNESS = 0.4;
const GOLDEN = 0.6180339887498949;
/** Roughness of a table's own tabulated facets, which have no number for it. */
const TABULATED = Object.freeze([]);

class Finish {
  constructor({ beckmann, separable, compensated, facets }, table) {
    [this.beckmann, this.separable, this.compensated] = [beckmann, separable, compensated];
    const steps = (of) => Float32Array.from(Array.from({ length: RHO_STEPS + 1 }, (_, i) => of(degrees(Math.acos(i / RHO_STEPS)))).flat());
    /** Linear RGB of ρ in equal steps of cos θ, and of the light that goes through a sheet. */
    this.rho = steps((theta) => table.mirrored(theta));
    this.tau = table.sheet ? steps((theta) => table.passed(theta)) : null;
    this.facets = facets && {
      /** Normals with D there and at those turned by half a turn. */
      normals: floats(facets.normals),
      views: facets.views,
      /** Squared roughness of the GGX facets of which a direction sees as much, `[step of √cos θ][sector]`. */
      seen: floats(facets.seen),
    };
  }

  /** Roughness of the facets; `null` for a mirror. */
  static alpha(roughness) {
    if (roughness === TABULATED) return roughness;
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

  /**
   * Looks of a picture, by its number: two rings around the middle of the lobe, of two and three looks by turns. Rings
   * of later pictures lie between those of earlier ones.
   */
  looks(alpha, picture) {
    if (alpha === TABULATED) return Array.from({ length: NORMALS }, (_, i) => this.normal(picture * NORMALS + i)).flat();
    const [x, y] = [GOLDEN, SHIFT[1]].map((step) => (picture * step) % 1);
    return Array.from({ length: LOOKS }, (_, i) => this.look(i / LOOKS + x, (((i + picture) % 2) + 0.5 + y) / 2)).flat();
  }

  /**
   * A look at tabulated facets: x and y of a normal, the share of its D in the sum of both turns, and the level of its
   * light from the density of normals.
   */
  normal(i) {
    const { normals } = this.facets;
    const [x, y, density, turned] = normals.subarray((4 * i) % normals.length);
    return [x, y, density / (density + turned), -0.5 * Math.log2(Math.PI * (density + turned) * Math.sqrt(1 - x * x - y * y))];
  }

  /**
   * The level of light that a look of a picture sees, straight ahead. Solid angles shrink more slowly than the number
   * of looks grows, else single looks at a lamp would be seen. Tabulated facets add a level of their own.
   */
  static sharpness(alpha, picture, side) {
    const [x = 1, y = 1] = alpha;
    const looks = (alpha === TABULATED ? NORMALS : LOOKS) * (picture + 1) ** (2 / 3);
    return Math.log2(((SOFTNESS * side) / BLUR) * Math.sqrt((4 * Math.PI * x * y) / looks));
  }

  /** Area of the facets that a direction sees, projected along it: cos θ/G₁. */
  visibleArea(alpha, [x, y, z]) {
    if (alpha === TABULATED) return 0.5 * (z + Math.sqrt(z * z + this.seenAt(x, y, z) * (x * x + y * y)));
    const root = Math.hypot(alpha[0] * x, alpha[1] * y);
    if (!this.beckmann) return 0.5 * (z + Math.hypot(z, root));
    const a = z / Math.max(root, 1e-20);
    const [tail, t] = [Math.exp(-a * a), 1 / (1 + 0.3275911 * a)];
    // erf by Abramowitz and Stegun, 7.1.26.
    const poly = [1.0614054, -1.453152, 1.4214138, -0.2844967, 0.2548296].reduce((sum, c) => (sum + c) * t, 0);
    return 0.5 * (z * (2 - tail * poly) + root * 0.5641896 * tail);
  }

  /** The squared roughness that tabulated facets have for a direction. */
  seenAt(x, y, z) {
    const { views: [rows, sectors], seen } = this.facets;
    const [row, column] = [Math.sqrt(Math.max(z, 0)) * (rows - 1), (Math.atan2(y, x) / (2 * Math.PI) + 1) * sectors];
    const [low, left] = [Math.min(Math.floor(row), rows - 2), Math.floor(column)];
    const between = (line) => {
      const [from, to] = [left, left + 1].map((j) => seen[line * sectors + (j % sectors)]);
      return from + (column - left) * (to - from);
    };
    return between(low) + (row - low) * (between(low + 1) - between(low));
  }

  /** Part of the light of a direction that is neither masked nor shadowed, over cos θ of the viewer. */
  unmasked(alpha, wi, wo, area) {
    const light = this.visibleArea(alpha, wi);
    return wi[2] / (this.separable ? light * area : light * wo[2] + area * wi[2] - wi[2] * wo[2]);
  }

  /** As `each`, at tabulated facets. */
  eachNormal(wo, see) {
    const { normals } = this.facets;
    const count = normals.length / 4;
    const area = this.visibleArea(TABULATED, wo);
    for (let i = 0; i < count; i += 1) {
      let [x, y, share] = this.normal(i);
      const z = Math.sqrt(1 - x * x - y * y);
      if (dot(wo, [x, y, z]) < 0) [x, y, share] = [-x, -y, 1 - share];
      const [cosine, turned] = [Math.min(dot(wo, [x, y, z]), 1), dot(wo, [-x, -y, z])];
      const seen = ((turned < 0 ? share : 1) * cosine) / (z * count);
      const wi = plus(times([x, y, z], 2 * cosine), wo, -1);
      see(cosine, wi[2] > 0 ? seen * this.unmasked(TABULATED, wi, wo, area) : 0, seen / area);
    }
  }

  /**
   * Calls `see` with cos θ_d, the share of the light and the share of the facets that the viewer sees, for looks of a
   * viewer at facets.
   */
  each(alpha, wo, count, see) {
    if (alpha === TABULATED) return this.eachNormal(wo, see);
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
      const slope = (h[0] * h[0] + h[1] * h[1]) / (h[2] * h[2]);
      const seen = ((this.beckmann ? more * Math.exp(-slope) * (1 + slope) ** 2 : 1) * drawn) / count;
      see(cosine, wi[2] > 0 ? seen * this.unmasked(alpha, wi, wo, area) : 0, seen / area);
    }
  }

  /** Whether facets are equally rough in all directions. */
  isEqual(alpha) {
    return alpha === TABULATED ? this.facets.views[1] === 1 : alpha[0] === alpha[1];
  }

  /** What facets lose to others in equal steps of √cos θ, and the mean of it. */
  losses(alpha) {
    if (this.lost?.alpha === alpha.join()) return this.lost;
    const [azimuths, turn] =
      this.isEqual(alpha) ? [1, 0] : [LOSS_AZIMUTHS, (alpha === TABULATED ? 2 : 0.5) * Math.PI];
    const values = Float32Array.from({ length: LOSS_STEPS + 1 }, (_, i) => {
      const z = Math.max((i / LOSS_STEPS) ** 2, 1e-5);
      const sin = Math.sqrt(1 - z * z);
      let kept = 0;
      for (let k = 0; k < azimuths; k += 1) {
        const phi = (turn * (k + 0.5)) / azimuths;
        this.each(alpha, [sin * Math.cos(phi), sin * Math.sin(phi), z], ALBEDO_LOOKS[0], (_, share) => { kept += share / azimuths; });
      }
      return clamp(1 - kept, 0, 1);
    });
    // Over x = √cos θ, 2 cos θ d(cos θ) = 4 x³ dx: by parts of the interpolation.
    const mean = values.subarray(1).reduce((sum, high, i) => {
      const [a, b, slope] = [i / LOSS_STEPS, (i + 1) / LOSS_STEPS, (high - values[i]) * LOSS_STEPS];
      return sum + (values[i] - slope * a) * (b ** 4 - a ** 4) + 0.8 * slope * (b ** 5 - a ** 5);
    }, 0);
    this.lost = { alpha: alpha.join(), values, mean };
    return this.lost;
  }

  /** Part of the light that facets lose which several bounces return, for a mean reflectance of the facets. */
  severalOf(alpha, reflectance) {
    const { mean } = this.losses(alpha);
    const reflected = clamp(reflectance, 0, 1);
    return mean > 0 ? (reflected ** 2 * (1 - mean)) / (1 - reflected * mean) : 0;
  }

  /** That part in linear RGB. */
  several(alpha) {
    const mean = [0, 0, 0];
    for (let i = 0; i < 3 * RHO_STEPS; i += 1) {
      const cosine = (Math.floor(i / 3) + 0.5) / RHO_STEPS;
      mean[i % 3] += (cosine * (this.rho[i] + this.rho[i + 3])) / RHO_STEPS;
    }
    return mean.map((reflectance) => this.severalOf(alpha, reflectance));
  }

  /** What facets lose of the light of a direction. */
  lossAt(alpha, z) {
    const { values } = this.losses(alpha);
    const at = Math.sqrt(clamp(z, 0, 1)) * LOSS_STEPS;
    const i = Math.min(Math.floor(at), LOSS_STEPS - 1);
    return values[i] + (at - i) * (values[i + 1] - values[i]);
  }

  /** Linear RGB of the albedo for a viewer's direction. */
  rgb(alpha, wo) {
    return this.withSeveral(alpha, wo[2], this.ofFacets(alpha, wo));
  }

  /** Adds what several bounces return to linear RGB of the facets' albedo for a viewer's height. */
  withSeveral(alpha, z, rgb) {
    if (!this.compensated) return rgb;
    const loss = this.lossAt(alpha, z);
    return this.several(alpha).map((returned, c) => rgb[c] + loss * returned);
  }

  /**
   * Linear RGB of the albedo of the facets alone for a viewer's direction; with `through`, of the light that goes
   * straight on.
   */
  ofFacets(alpha, wo, count = ALBEDO_LOOKS[0], through = false) {
    const sum = [0, 0, 0];
    const list = through ? this.tau : this.rho;
    this.each(alpha, wo, count, (cosine, share, seen) => {
      const at = cosine * RHO_STEPS;
      const i = Math.min(Math.floor(at), RHO_STEPS - 1);
      for (let c = 0; c < 3; c += 1) {
        const [low, high] = [list[3 * i + c], list[3 * i + 3 + c]];
        sum[c] += (through ? seen : share) * (low + (at - i) * (high - low));
      }
    });
    return sum;
  }

  /**
   * A table of the facets' albedo in linear RGB, `[cos² φ][cos θ]`, and of what a sheet lets through; over φ in place
   * of cos² φ for tabulated facets, and over cos θ alone for equally rough ones.
   */
  albedo(alpha) {
    if (this.kept?.alpha !== alpha.join()) this.kept = { alpha: alpha.join(), ...this.integrated(alpha) };
    return this.kept;
  }

  /** The place of an azimuth in degrees among the rows of that table, from 0 to 1. */
  static rowOf(alpha, phi) {
    return alpha === TABULATED ? (((phi / 360) % 1) + 1) % 1 : Math.cos(radians(phi)) ** 2;
  }

  integrated(alpha) {
    const equal = this.isEqual(alpha);
    const steps = ALBEDO_STEPS[alpha === TABULATED ? 2 : 1];
    const [columns, rows] = [ALBEDO_STEPS[0] + 1, equal ? 1 : steps + 1];
    const [values, through] = [0, 1].map(() => new Float32Array(3 * columns * rows));
    for (let row = 0; row < rows; row += 1) {
      const phi = alpha === TABULATED ? (2 * Math.PI * row) / steps : Math.acos(Math.sqrt(row / steps));
      for (let column = 0; column < columns; column += 1) {
        const z = Math.max(column / ALBEDO_STEPS[0], 1e-6);
        const sin = Math.sqrt(1 - z * z);
        const wo = [sin * Math.cos(phi), sin * Math.sin(phi), z];
        const at = 3 * (row * columns + column);
        const count = ALBEDO_LOOKS[equal ? 0 : 1];
        values.set(this.ofFacets(alpha, wo, count), at);
        if (this.tau) through.set(this.ofFacets(alpha, wo, count, true), at);
      }
    }
    return { columns, rows, values, through };
  }
}
