// Look-ups in a table: colours, spectra and the disc at an angle, and words about it.

class MirrorTable {
  constructor(data) {
    this.turns = false;
    this.theta = data.theta;
    this.wavelength = data.wavelength;
    this.s = floats(data.s);
    this.p = floats(data.p);
    this.lookup = floats(data.lookup);
    this.max = Math.max(1, this.s.reduce((a, b) => Math.max(a, b), 0), this.p.reduce((a, b) => Math.max(a, b), 0));
    this.label = "Reflectance";
    this.about = {
      grid: `mirror-like; ${this.theta.length} angles × ${this.wavelength.length} wavelengths`,
      spectrum: "Spectrum there",
      disc: "Every direction",
    };
  }

  /** Linear RGB of unpolarised light. */
  rgb(theta) {
    const last = this.lookup.length / 3 - 1;
    const row = clamp((theta / 90) * last, 0, last);
    const below = Math.min(Math.floor(row), last - 1);
    const at = (i, c) => this.lookup[3 * i + c];
    return [0, 1, 2].map((c) => at(below, c) + (row - below) * (at(below + 1, c) - at(below, c)));
  }

  /** Curves over the wavelength. */
  curves(theta) {
    const [low, high, share] = place(theta, this.theta);
    const width = this.wavelength.length;
    const curve = (of) => this.wavelength.map((_, i) => {
      const [a, b] = [of[low * width + i], of[high * width + i]];
      return a + share * (b - a);
    });
    const [s, p] = [curve(this.s), curve(this.p)];
    return [
      { name: "mean", values: s.map((value, i) => 0.5 * (value + p[i])) },
      { name: "s", values: s },
      { name: "p", values: p },
    ];
  }

  /** Linear RGB over the directions of the disc, whatever the direction of the reading. */
  disc() {
    return (theta) => this.rgb(theta);
  }
}

/** Titles of the charts of a table whose light leaves in many directions. */
const SCATTERED = { spectrum: "All light from there together", disc: "Where light from the viewer’s direction goes" };

class ScatterTable {
  constructor(data) {
    /** Whether the disc depends on the direction of the reading. */
    this.turns = true;
    this.scatters = true;
    this.wavelength = data.wavelength;
    [this.incident, this.bins] = [data.incident, data.bins];
    this.atlas = halves(data.atlas).map((x) => x * data.scale);
    this.cumulative = floats(data.cumulative);
    this.albedo = floats(data.albedo);
    this.weights = floats(data.rgbWeights);
    this.max = Math.max(1, this.albedo.reduce((a, b) => Math.max(a, b), 0));
    this.label = "Albedo";
    const grid = `${this.incident.join(" × ")} directions × ${this.bins.join(" × ")} bins × ${this.wavelength.length} wavelengths`;
    this.about = { grid: `scatters; ${grid}`, ...SCATTERED };
  }

  get binCount() {
    return this.bins[0] * this.bins[1];
  }

  /** The four neighbours and their weights on a grid, constant beyond the ends of rows and periodic in columns. */
  static nodes(row, rows, turns, columns) {
    const y = clamp(row, 0, rows - 1);
    const below = Math.min(Math.floor(y), Math.max(rows - 2, 0));
    const above = Math.min(below + 1, rows - 1);
    const x = (turns - Math.floor(turns)) * columns;
    const left = Math.floor(x) % columns;
    const right = (left + 1) % columns;
    const [wy, wx] = [y - below, x - Math.floor(x)];
    return [
      [below * columns + left, (1 - wy) * (1 - wx)],
      [below * columns + right, (1 - wy) * wx],
      [above * columns + left, wy * (1 - wx)],
      [above * columns + right, wy * wx],
    ];
  }

  /** Neighbours among incident directions, by angles in radians, as in the core. */
  incidentNodes(theta, phi) {
    const [rows, columns] = this.incident;
    const row = (theta / (Math.PI / 2)) * rows - 0.5;
    return ScatterTable.nodes(row, rows, (phi - Math.PI / this.bins[1]) / (2 * Math.PI), columns);
  }

  outgoingNodes(cos, phi) {
    const [rows, columns] = this.bins;
    return ScatterTable.nodes(cos * rows - 0.5, rows, phi / (2 * Math.PI), columns);
  }

  /** Albedo at each wavelength: the colour under white light from all around, by reciprocity. */
  curves(theta, phi) {
    const nodes = this.incidentNodes(radians(theta), radians(phi));
    const width = this.wavelength.length;
    const value = (w) => nodes.reduce((sum, [i, share]) => sum + share * this.albedo[i * width + w], 0);
    return [{ name: "albedo", values: this.wavelength.map((_, w) => value(w)) }];
  }

  rgb(theta, phi) {
    const [{ values }] = this.curves(theta, phi);
    return [0, 1, 2].map((c) => values.reduce((sum, value, w) => sum + value * this.weights[3 * w + c], 0));
  }

  /** Linear RGB of f over the outgoing directions for light from (θ, φ), scaled to its brightest component. */
  disc(theta, phi) {
    const mixed = new Float32Array(3 * this.binCount);
    for (const [i, share] of this.incidentNodes(radians(theta), radians(phi))) {
      const from = 3 * i * this.binCount;
      for (let k = 0; k < mixed.length; k += 1) mixed[k] += share * this.atlas[from + k];
    }
    const max = mixed.reduce((a, b) => Math.max(a, b), 0);
    const scale = max > 0 ? 1 / max : 0;
    return (thetaOut, phiOut) => {
      const rgb = [0, 0, 0];
      for (const [bin, share] of this.outgoingNodes(Math.cos(radians(thetaOut)), radians(phiOut - phi))) {
        for (let c = 0; c < 3; c += 1) rgb[c] += share * scale * mixed[3 * bin + c];
      }
      return rgb;
    };
  }

  /** f and the probability of each bin, four floats a bin, as the shader takes them. */
  packed() {
    const [rows, columns] = this.bins;
    const stride = 1 + rows + this.binCount;
    const packed = new Float32Array((this.atlas.length / 3) * 4);
    for (let pair = 0; pair < this.atlas.length / 3; pair += 1) {
      const [i, bin] = [Math.floor(pair / this.binCount), pair % this.binCount];
      const [row, column] = [Math.floor(bin / columns), bin % columns];
      const step = (from, at) => this.cumulative[from + at] - (at > 0 ? this.cumulative[from + at - 1] : 0);
      packed.set(this.atlas.subarray(3 * pair, 3 * pair + 3), 4 * pair);
      packed[4 * pair + 3] = step(i * stride + 1, row) * step(i * stride + 1 + rows + row * columns, column);
    }
    return packed;
  }
}
