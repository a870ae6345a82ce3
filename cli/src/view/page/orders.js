// Look-ups in a table of diffraction orders.

class OrderTable {
  constructor(data) {
    this.diffracts = true;
    this.turns = true;
    this.wavelength = data.wavelength;
    this.index = data.index;
    [this.nodes, this.lines, this.period, this.orders] = [data.nodes, data.lines, data.period, data.orders];
    this.strengths = halves(data.strengths);
    this.weights = floats(data.rgbWeights);
    /** Wavelengths of all pictures, even in the medium above: RGB per nanometre, and layer. */
    this.response = floats(data.response);
    this.range = data.range;
    [this.groups, this.pictures] = [data.groups, data.pictures];
    /** Colours in even light, and of order (0, 0), over α and β. */
    [this.albedoNodes, this.albedo, this.mirrored] = [data.albedoNodes, halves(data.albedo), halves(data.mirrored)];
    this.max = 1;
    this.label = "Albedo";
    const grid = `${this.nodes.join(" × ")} directions × ${this.wavelength.length} wavelengths`;
    this.about = { grid: `diffracts into ${this.orders.length} orders; ${grid}`, ...SCATTERED };
    // The shader takes the other orders, by fours. Steps of this size lead nowhere.
    this.blocks = Math.ceil((this.orders.length - 1) / 4);
    this.stepsX = new Float32Array(4 * Math.max(this.blocks, 1)).fill(1);
    this.stepsY = this.stepsX.slice();
    this.orders.slice(1).forEach(([m, n], i) => {
      [this.stepsX[i], this.stepsY[i]] = [m / this.period[0], n / this.period[1]];
    });
  }

  /** Neighbours among nodes and their weights, for a direction of the surface's frame, as in the core. */
  between([x, y, z]) {
    const [along, across] = this.lines === 2 ? [y, x] : [x, y];
    const last = radians(89);
    const alpha = 0.5 * (Math.atan2(along, Math.hypot(across, z)) / last + 1);
    const beta = Math.atan2(across, z) / last;
    const places = [alpha, this.lines ? Math.abs(beta) : 0.5 * (beta + 1)];
    const [[a, wa], [b, wb]] = places.map((place, axis) => {
      const at = clamp(place, 0, 1) * (this.nodes[axis] - 1);
      const below = Math.min(Math.floor(at), this.nodes[axis] - 2);
      return [below, at - below];
    });
    const width = this.nodes[0];
    return [
      [b * width + a, (1 - wb) * (1 - wa)], [b * width + a + 1, (1 - wb) * wa],
      [(b + 1) * width + a, wb * (1 - wa)], [(b + 1) * width + a + 1, wb * wa],
    ];
  }

  /** Calls `visit` with the wavelength, order, direction and efficiency of all light that leaves from a direction. */
  follow(theta, phi, visit) {
    const [sin, cos] = [Math.sin(radians(theta)), Math.cos(radians(theta))];
    const wo = [sin * Math.cos(radians(phi)), sin * Math.sin(radians(phi)), Math.max(cos, 1e-6)];
    const near = this.between(wo);
    const count = this.nodes[0] * this.nodes[1];
    this.wavelength.forEach((nm, w) => {
      this.orders.forEach(([m, n], order) => {
        const inMedium = nm / this.index[w];
        const [x, y] = [(m * inMedium) / this.period[0] - wo[0], (n * inMedium) / this.period[1] - wo[1]];
        const up = 1 - x * x - y * y;
        if (up <= 0) return;
        const from = (w * this.orders.length + order) * count;
        const strength = near.reduce((sum, [node, share]) => sum + share * this.strengths[from + node], 0);
        const sum = Math.sqrt(up) + wo[2];
        const factor = (4 * Math.sqrt(up) * wo[2]) / (sum * sum);
        visit(w, order, [x, y, Math.sqrt(up)], strength * factor);
      });
    });
  }

  curves(theta, phi) {
    const values = this.wavelength.map(() => 0);
    this.follow(theta, phi, (w, _order, _direction, efficiency) => { values[w] += efficiency; });
    return [{ name: "albedo", values }];
  }

  rgb(theta, phi) {
    const [{ values }] = this.curves(theta, phi);
    return [0, 1, 2].map((c) => values.reduce((sum, value, w) => sum + value * this.weights[3 * w + c], 0));
  }

  /** Linear RGB over the disc: each wavelength of each order is a dot, as bright as its share of the brightest. */
  disc(theta, phi) {
    const side = 121;
    const sums = new Float32Array(3 * side * side);
    this.follow(theta, phi, (w, order, [x, y, z], efficiency) => {
      const polar = degrees(Math.atan2(Math.hypot(x, y), z)) / 90;
      const scale = polar / (Math.hypot(x, y) || 1);
      const at = [x, y].map((d) => (0.5 + 0.5 * d * scale) * (side - 1));
      const corner = at.map((place) => Math.min(Math.floor(place), side - 2));
      for (const [i, j] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
        const share = Math.abs(1 - i - (at[0] - corner[0])) * Math.abs(1 - j - (at[1] - corner[1]));
        const to = 3 * ((corner[1] + j) * side + corner[0] + i);
        // Order (0, 0) is a dot of all wavelengths; dimmed, it does not hide the others.
        const light = order === 0 ? efficiency / this.wavelength.length : efficiency;
        for (let c = 0; c < 3; c += 1) sums[to + c] += share * light * this.weights[3 * w + c];
      }
    });
    const max = sums.reduce((a, b) => Math.max(a, b), 0);
    return (thetaOut, phiOut) => {
      const at = [Math.cos(radians(phiOut)), Math.sin(radians(phiOut))].map((d) => (0.5 + (0.5 * d * thetaOut) / 90) * (side - 1));
      const corner = at.map((place) => clamp(Math.floor(place), 0, side - 2));
      const value = (c) => [[0, 0], [1, 0], [0, 1], [1, 1]].reduce((sum, [i, j]) => {
        const share = Math.abs(1 - i - (at[0] - corner[0])) * Math.abs(1 - j - (at[1] - corner[1]));
        return sum + share * sums[3 * ((corner[1] + j) * side + corner[0] + i) + c];
      }, 0);
      return [0, 1, 2].map((c) => (max > 0 ? value(c) / max : 0));
    };
  }

  /** Strengths of all orders but (0, 0) as the shader takes them: see `orders.frag`. */
  packed() {
    const [along, across] = this.nodes;
    const blocks = Math.max(this.blocks, 1);
    const values = new Float32Array(4 * along * across * blocks * this.wavelength.length);
    this.wavelength.forEach((_, w) => this.orders.slice(1).forEach((_, order) => {
      const from = (w * this.orders.length + order + 1) * along * across;
      const to = 4 * (w * blocks + (order >> 2)) * along * across + (order & 3);
      for (let node = 0; node < along * across; node += 1) values[to + 4 * node] = this.strengths[from + node];
    }));
    return { width: along, height: across * blocks, depth: this.wavelength.length, values };
  }

  /**
   * The wavelengths of a picture: one in each group, at a place that goes on from picture to picture. The first
   * picture is as soft as its wavelengths are apart; later ones fill the gaps, and are sharper.
   */
  looksOf(picture) {
    const number = picture % this.pictures;
    let place = 0;
    for (let bit = 1; bit < this.pictures; bit *= 2) if (number & bit) place += this.pictures / (2 * bit);
    place = (place + this.pictures / 2) % this.pictures;
    const [looks, layers] = [new Float32Array(4 * this.groups), new Float32Array(this.groups)];
    const count = this.groups * this.pictures;
    const [first, last] = this.range;
    const interval = (last - first) / this.groups;
    for (let group = 0; group < this.groups; group += 1) {
      const at = group * this.pictures + place;
      for (let c = 0; c < 3; c += 1) looks[4 * group + c] = interval * this.response[4 * at + c];
      looks[4 * group + 3] = first + ((at + 0.5) / count) * (last - first);
      layers[group] = this.response[4 * at + 3];
    }
    return { looks, layers, interval: interval / (number + 1) };
  }
}
