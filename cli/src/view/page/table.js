// Look-ups in a table: colours, spectra and the disc at an angle, and words about it.

class MirrorTable {
  constructor(data) {
    this.turns = false;
    this.theta = data.theta;
    this.wavelength = data.wavelength;
    /** Whether light goes through the surface. */
    this.sheet = Boolean(data.through);
    /** Thicknesses of a layer, for each of which there are values; `null` for one surface. */
    this.thickness = data.thickness;
    this.facets = { ...data.finish, facets: data.facets };
    const names = ["s", "p", "lookup", ...(this.sheet ? ["through"] : [])];
    this.every = Object.fromEntries(names.map((name) => [name, floats(data[name])]));
    /** Roughness of the facets; `null` for a mirror. */
    this.alpha = null;
    this.max = ["s", "p"].reduce((max, name) => this.every[name].reduce((a, b) => Math.max(a, b), max), 1);
    this.setThickness(this.thickness?.nm[0] ?? 0);
    this.label = "Reflectance";
    this.about = {
      grid: `mirror-like; ${this.thickness ? `${this.thickness.nm.length} thicknesses × ` : ""}${this.theta.length} angles × ${this.wavelength.length} wavelengths`,
      spectrum: "Spectrum there",
      disc: "Every direction",
    };
  }

  /** The place of a thickness in the range of the table's rows. */
  layerOf(nm) {
    if (!this.thickness) return 0;
    const [low, , share] = place(nm, this.thickness.nm);
    return (low + share) / (this.thickness.nm.length - 1);
  }

  /** Takes the values of a thickness, linear between those of the table. */
  setThickness(nm) {
    if (this.thickness) {
      const [low, high, share] = place(nm, this.thickness.nm);
      for (const [name, values] of Object.entries(this.every)) {
        const length = values.length / this.thickness.nm.length;
        const [thin, thick] = [low, high].map((row) => values.subarray(row * length, (row + 1) * length));
        this[name] = thin.map((value, i) => value + share * (thick[i] - value));
      }
    } else Object.assign(this, this.every);
    this.finish = new Finish(this.facets, this);
  }

  /** Linear RGB of unpolarised light that a mirror reflects. */
  mirrored(theta) {
    return MirrorTable.between(this.lookup, theta);
  }

  /** Linear RGB of unpolarised light that goes through a sheet. */
  passed(theta) {
    return MirrorTable.between(this.through, theta);
  }

  /** Colour at an angle, between those of a list in equal steps from 0 to 90°. */
  static between(list, theta) {
    const last = list.length / 3 - 1;
    const row = clamp((theta / 90) * last, 0, last);
    const below = Math.min(Math.floor(row), last - 1);
    const at = (i, c) => list[3 * i + c];
    return [0, 1, 2].map((c) => at(below, c) + (row - below) * (at(below + 1, c) - at(below, c)));
  }

  /** Linear RGB of unpolarised light: by facets, all that they reflect. */
  rgb(theta, phi) {
    return this.alpha ? this.finish.rgb(this.alpha, sphere(theta, phi)) : this.mirrored(theta);
  }

  /** Curves over the wavelength. Facets mix s and p. */
  curves(theta, phi) {
    const { alpha, finish } = this;
    /** Shares of the table's angles. */
    const shares = new Float64Array(this.theta.length);
    const add = (theta, share) => {
      const [low, high, weight] = place(theta, this.theta);
      shares[low] += share * (1 - weight);
      shares[high] += share * weight;
    };
    if (alpha) finish.each(alpha, sphere(theta, phi), ALBEDO_LOOKS[0], (cosine, share) => add(degrees(Math.acos(cosine)), share));
    else add(theta, 1);
    const width = this.wavelength.length;
    const loss = alpha && finish.compensated ? finish.lossAt(alpha, Math.cos(radians(theta))) : 0;
    const weights = loss > 0 ? this.hemisphere() : [];
    const mixed = (of, i, parts) => parts.reduce((sum, share, row) => sum + share * of[row * width + i], 0);
    const mean = (i) => 0.5 * (mixed(this.s, i, weights) + mixed(this.p, i, weights));
    const curve = (of) => this.wavelength.map((_, i) => mixed(of, i, shares) + (loss > 0 ? loss * finish.severalOf(alpha, mean(i)) : 0));
    const [s, p] = [curve(this.s), curve(this.p)];
    const both = { name: "mean", values: s.map((value, i) => 0.5 * (value + p[i])) };
    return alpha ? [both] : [both, { name: "s", values: s }, { name: "p", values: p }];
  }

  /** Weights of the table's angles in a mean over the hemisphere by the cosine. */
  hemisphere() {
    const weights = new Float64Array(this.theta.length);
    const count = 256;
    for (let i = 0; i < count; i += 1) {
      const cosine = (i + 0.5) / count;
      const [low, high, weight] = place(degrees(Math.acos(cosine)), this.theta);
      weights[low] += (2 * cosine * (1 - weight)) / count;
      weights[high] += (2 * cosine * weight) / count;
    }
    return weights;
  }

  /** Linear RGB over the directions of the disc, whatever the direction of the reading. */
  disc() {
    if (!this.alpha) return (theta) => this.mirrored(theta);
    const { columns, rows, values } = this.finish.albedo(this.alpha);
    return (theta, phi) => {
      const [x, y] = [Math.cos(radians(theta)) * (columns - 1), Finish.rowOf(this.alpha, phi) * (rows - 1)];
      const [left, below] = [Math.min(Math.floor(x), columns - 2), Math.max(Math.min(Math.floor(y), rows - 2), 0)];
      const at = (column, row, c) => values[3 * (Math.min(row, rows - 1) * columns + column) + c];
      const along = (row, c) => at(left, row, c) + (x - left) * (at(left + 1, row, c) - at(left, row, c));
      const rgb = [0, 1, 2].map((c) => along(below, c) + (y - below) * (along(below + 1, c) - along(below, c)));
      return this.finish.withSeveral(this.alpha, Math.cos(radians(theta)), rgb);
    };
  }
}

/** Titles of the charts of a table whose light leaves in many directions. */
const SCATTERED = { spectrum: "All light from there together", disc: "Where light from the viewer’s direction goes" };

/** Largest angle of the directions of a table, in radians. */
const THETA_MAX = radians(89);
/** Radius and soft edge of a lobe's dot on the disc, in degrees. */
const DOT = [2, 1];

class ScatterTable {
  constructor(data) {
    /** Whether the disc depends on the direction of the reading. */
    this.turns = true;
    this.scatters = true;
    this.wavelength = data.wavelength;
    [this.incident, this.nodes, this.views] = [data.incident, data.halfVectors, data.views];
    /** Pairs of density and integral of the warp over u and over v. */
    this.warp = data.warp.map(floats);
    const lobes = floats(data.lobes);
    this.lobes = Array.from({ length: lobes.length / 10 }, (_, i) => lobes.subarray(10 * i, 10 * i + 10));
    /** Values of each incident direction: s at the nodes of the square, then ρ of the lobes. */
    this.places = this.nodes[0] * this.nodes[1] + this.lobes.length;
    this.atlas = halves(data.atlas).map((x) => x * data.scale);
    this.cumulative = floats(data.cumulative);
    [this.albedo, this.scattered] = [floats(data.albedo), floats(data.scattered)];
    this.weights = floats(data.rgbWeights);
    this.max = Math.max(1, this.albedo.reduce((a, b) => Math.max(a, b), 0));
    this.label = "Albedo";
    const flat = this.lobes.length ? `, ${this.lobes.length} lobes of flat facets` : "";
    const grid = `${this.incident.join(" × ")} directions × ${this.nodes.join(" × ")} half vectors × ${this.wavelength.length} wavelengths`;
    this.about = { grid: `scatters; ${grid}${flat}`, ...SCATTERED };
  }

  /** Four neighbours and their weights: periodic among columns, held at the ends of rows; rows are `stride` apart. */
  static between(turns, columns, row, rows, columnStride, rowStride) {
    const [x, y] = [(turns - Math.floor(turns)) * columns, clamp(row, 0, rows - 1)];
    const [left, below] = [Math.floor(x) % columns, Math.min(Math.floor(y), rows - 2)];
    const [wx, wy] = [x - Math.floor(x), y - below];
    const at = (column, line) => column * columnStride + line * rowStride;
    const right = (left + 1) % columns;
    return [
      [at(left, below), (1 - wx) * (1 - wy)], [at(right, below), wx * (1 - wy)],
      [at(left, below + 1), (1 - wx) * wy], [at(right, below + 1), wx * wy],
    ];
  }

  /** Neighbours among incident directions, by angles in radians. */
  incidentNodes(theta, phi) {
    const [rows, columns] = this.incident;
    return ScatterTable.between(phi / (2 * Math.PI) + 0.5, columns, (theta / THETA_MAX) * (rows - 1), rows, 1, columns);
  }

  /** Neighbours among the nodes of the square, for a half vector whose azimuth counts from `origin`. */
  squareNodes([x, y, z], origin) {
    const [across, around] = this.nodes;
    const u = Math.sqrt(Math.atan2(Math.hypot(x, y), z) / (Math.PI / 2));
    const v = (Math.atan2(y, x) - origin) / (2 * Math.PI) + 0.5;
    return ScatterTable.between(this.warped(1, v - Math.floor(v)), around, this.warped(0, u) * (across - 1), across, across, 1);
  }

  /** Place x of u (`axis` 0) or y of v (1). */
  warped(axis, plain) {
    const pairs = this.warp[axis];
    const intervals = pairs.length / 2 - 1;
    const at = clamp(plain, 0, 1) * intervals;
    const i = Math.min(Math.floor(at), intervals - 1);
    const density = pairs[2 * i] + (at - i) * (pairs[2 * i + 2] - pairs[2 * i]);
    return pairs[2 * i + 1] + ((at - i) * 0.5 * (pairs[2 * i] + density)) / intervals;
  }

  /** Albedo at each wavelength: the colour under white light from all around, by reciprocity. */
  curves(theta, phi) {
    const nodes = this.incidentNodes(radians(theta), radians(phi));
    const width = this.wavelength.length;
    // s is linear between incident directions: the albedo times the cosine.
    const cosine = (theta) => Math.cos(Math.min(theta, THETA_MAX));
    const shares = nodes.map(([i, share]) => {
      const row = Math.floor(i / this.incident[1]);
      return [i, (share * cosine((row / (this.incident[0] - 1)) * THETA_MAX)) / cosine(radians(theta))];
    });
    const value = (w) => shares.reduce((sum, [i, share]) => sum + share * this.albedo[i * width + w], 0);
    return [{ name: "albedo", values: this.wavelength.map((_, w) => value(w)) }];
  }

  rgb(theta, phi) {
    const [{ values }] = this.curves(theta, phi);
    return [0, 1, 2].map((c) => values.reduce((sum, value, w) => sum + value * this.weights[3 * w + c], 0));
  }

  /**
   * Linear RGB of f cos θ over the outgoing directions for light from (θ, φ), scaled to its brightest component. Lobes
   * are dots, as bright as their share of the brightest.
   */
  disc(theta, phi) {
    const wi = sphere(theta, phi);
    const origin = this.incident[1] === 1 ? Math.atan2(wi[1], wi[0]) : 0;
    const mixed = new Float32Array(3 * this.places);
    for (const [i, share] of this.incidentNodes(radians(theta), radians(phi))) {
      const from = 3 * i * this.places;
      for (let k = 0; k < mixed.length; k += 1) mixed[k] += share * this.atlas[from + k];
    }
    const first = mixed.length - 3 * this.lobes.length;
    const brightest = (values) => values.reduce((a, b) => Math.max(a, b), 0) || 1;
    const [max, maxLobe] = [brightest(mixed.subarray(0, first)), brightest(mixed.subarray(first))];
    const dots = this.lobes.map((lobe, i) => {
      const d = ScatterTable.lobeDirection(lobe, wi);
      const polar = d && degrees(Math.atan2(Math.hypot(d[0], d[1]), d[2])) / (Math.hypot(d[0], d[1]) || 1);
      return d && { at: [d[0] * polar, d[1] * polar], rgb: mixed.subarray(first + 3 * i, first + 3 * i + 3).map((x) => x / maxLobe) };
    }).filter((dot) => dot && dot.rgb.some((x) => x > 0));
    return (thetaOut, phiOut) => {
      const wo = sphere(Math.min(thetaOut, 89.99), phiOut);
      const rgb = [0, 0, 0];
      for (const [node, share] of this.squareNodes(plus(wi, wo), origin)) {
        for (let c = 0; c < 3; c += 1) rgb[c] += (share / max) * mixed[3 * node + c];
      }
      const [x, y] = [thetaOut * Math.cos(radians(phiOut)), thetaOut * Math.sin(radians(phiOut))];
      for (const dot of dots) {
        const inside = clamp((DOT[0] + DOT[1] - Math.hypot(x - dot.at[0], y - dot.at[1])) / DOT[1], 0, 1);
        for (let c = 0; c < 3; c += 1) rgb[c] += inside * dot.rgb[c];
      }
      return rgb;
    };
  }

  /** Direction of a lobe, n and M by columns, for light from `wi`; `null` if there is none above the horizon. */
  static lobeDirection([n, ...m], wi) {
    const excess = (n - 1) * (n + 1);
    const k = [-wi[0] / n, -wi[1] / n, -Math.sqrt((wi[2] * wi[2] + excess) / (n * n))];
    const [x, y, z] = [0, 1, 2].map((row) => m[row] * k[0] + m[3 + row] * k[1] + m[6 + row] * k[2]);
    const up = Math.sqrt(z * z * n * n - excess);
    // Neither holds for NaN.
    return z > 0 && up >= 1e-6 ? [n * x, n * y, up] : null;
  }

  /**
   * The table as `prepare.frag` takes it: s with the density of samples at each place; integrals of the density; and
   * the warp. The density of an incident direction integrates to what it reflects.
   */
  packed() {
    const [width, rows] = this.nodes;
    const stride = 1 + rows + rows * width;
    const atlas = new Float32Array((this.atlas.length / 3) * 4);
    for (let i = 0; i < this.atlas.length / 3; i += 1) atlas.set(this.atlas.subarray(3 * i, 3 * i + 3), 4 * i);
    const sums = new Float32Array((this.cumulative.length / stride) * stride);
    for (let incident = 0; incident < this.cumulative.length / stride; incident += 1) {
      const memory = this.cumulative.subarray(incident * stride, (incident + 1) * stride);
      const step = (from, at) => memory[from + at] - (at > 0 ? memory[from + at - 1] : 0);
      const density = (row, column) => {
        // The first and the last column have half a tent.
        const tent = column === 0 || column + 1 === width ? 2 : 1;
        const node = step(1, row) * step(1 + rows + row * width, column);
        return memory[0] * node * tent * (width - 1) * rows;
      };
      const along = sums.subarray(incident * stride, (incident + 1) * stride);
      for (let row = 0; row < rows; row += 1) {
        let sum = 0;
        for (let column = 0; column < width; column += 1) {
          const here = density(row, column);
          if (column > 0) sum += (0.5 * (density(row, column - 1) + here)) / (width - 1);
          along[1 + rows + row * width + column] = sum;
          atlas[4 * (incident * this.places + row * width + column) + 3] = here;
        }
      }
      const ofRow = (row) => along[1 + rows + (row % rows) * width + width - 1];
      for (let row = 0; row < rows; row += 1) along[row + 1] = along[row] + (0.5 * (ofRow(row) + ofRow(row + 1))) / rows;
    }
    const length = Math.max(...this.warp.map((pairs) => pairs.length / 2));
    const knots = new Float32Array(2 * 4 * length);
    this.warp.forEach((pairs, axis) => pairs.forEach((x, i) => { knots[4 * (axis * length + (i >> 1)) + (i & 1)] = x; }));
    return { atlas, sums, knots };
  }

  /** n and M of the lobes in rows of three texels. */
  packedLobes() {
    const packed = new Float32Array(12 * Math.max(this.lobes.length, 1));
    this.lobes.forEach((lobe, i) => packed.set(lobe, 12 * i));
    return packed;
  }
}
