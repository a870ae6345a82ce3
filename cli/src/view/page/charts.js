// The charts of the page: the spectrum and the disc.

const SVG = document.querySelector("svg").namespaceURI;

function element(parent, tag, attributes, text) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  parent.append(made);
  return made;
}

/** Colours that suggest wavelengths; monochromatic light lies outside every screen's gamut. */
const WAVELENGTH_COLOURS = [
  [380, "#3b1466"], [400, "#5c1a99"], [436, "#422ecc"], [475, "#0d66d9"], [505, "#008c80"],
  [546, "#1a9433"], [585, "#cc9900"], [620, "#de4d0f"], [700, "#b8121a"], [780, "#5e0a0e"],
];

class SpectrumChart {
  constructor(svg, table) {
    [this.svg, this.table] = [svg, table];
    this.area = { left: 52, right: 352, top: 12, bottom: 168 };
    const nm = table.wavelength;
    this.range = nm.length > 1 ? [nm[0], nm[nm.length - 1]] : [nm[0] - 10, nm[0] + 10];
    this.drawAxes();
    this.lines = element(svg, "g", {});
  }

  x(nm) {
    const { left, right } = this.area;
    return left + ((nm - this.range[0]) / (this.range[1] - this.range[0])) * (right - left);
  }

  y(value) {
    const { top, bottom } = this.area;
    return bottom - (value / this.table.max) * (bottom - top);
  }

  drawAxes() {
    const { left, right, top, bottom } = this.area;
    for (let tick = 0; tick <= 4; tick += 1) {
      const value = (this.table.max * tick) / 4;
      const y = this.y(value);
      element(this.svg, "line", { x1: left, x2: right, y1: y, y2: y, class: "grid" });
      element(this.svg, "text", { x: left - 7, y: y + 4, "text-anchor": "end" }, value.toFixed(2));
    }
    const gradient = element(element(this.svg, "defs", {}), "linearGradient", {
      id: "wavelengths", gradientUnits: "userSpaceOnUse", x1: this.x(380), x2: this.x(780), y1: 0, y2: 0,
    });
    for (const [nm, colour] of WAVELENGTH_COLOURS) {
      element(gradient, "stop", { offset: (nm - 380) / 400, "stop-color": colour });
    }
    element(this.svg, "rect", { x: left, y: bottom + 3, width: right - left, height: 5, fill: "url(#wavelengths)", rx: 2 });
    const step = this.range[1] - this.range[0] > 250 ? 100 : 50;
    for (let nm = Math.ceil(this.range[0] / step) * step; nm <= this.range[1]; nm += step) {
      element(this.svg, "text", { x: this.x(nm), y: bottom + 23, "text-anchor": "middle" }, nm);
    }
    element(this.svg, "text", { x: (left + right) / 2, y: bottom + 41, "text-anchor": "middle", class: "name" }, "Wavelength (nm)");
    const [x, y] = [12, (top + bottom) / 2];
    const turned = { x, y, "text-anchor": "middle", class: "name", transform: `rotate(-90 ${x} ${y})` };
    element(this.svg, "text", turned, this.table.label);
  }

  draw(curves, theta) {
    this.lines.replaceChildren();
    // The mean is drawn last, on top.
    for (const { name, values } of [...curves].reverse()) {
      const points = values.map((value, i) => `${this.x(this.table.wavelength[i]).toFixed(1)},${this.y(value).toFixed(1)}`);
      element(this.lines, "polyline", { points: points.join(" "), class: `curve ${name}` });
      if (values.length === 1) {
        element(this.lines, "circle", { cx: this.x(this.table.wavelength[0]), cy: this.y(values[0]), r: 3, class: "dot" });
      }
    }
    const main = curves[0].values;
    const peak = main.reduce((best, value, i) => (value > main[best] ? i : best), 0);
    const says = `largest ${main[peak].toFixed(2)} at ${Math.round(this.table.wavelength[peak])} nm`;
    this.svg.setAttribute("aria-label", `${this.table.label} over the wavelength at ${theta.toFixed(1)}°: ${says}`);
  }
}

class Disc {
  constructor(canvas, svg, table) {
    [this.canvas, this.table] = [canvas, table];
    this.marks = element(svg, "g", {});
    for (const radius of [30, 60, 90]) {
      element(svg, "circle", { cx: 0, cy: 0, r: radius, class: radius === 90 ? "rim" : "ring" });
    }
    for (const radius of [30, 60, 90]) {
      const at = { x: radius * Math.SQRT1_2 + (radius === 90 ? 3 : 1), y: radius * Math.SQRT1_2 + (radius === 90 ? 9 : 7) };
      element(svg, "text", { ...at, class: radius === 90 ? "outside" : "inside" }, `${radius}°`);
    }
    this.mark = element(svg, "circle", { r: 5, class: "mark" });
    svg.append(this.mark);
  }

  draw(theta, phi) {
    const { canvas } = this;
    if (this.table.turns || !this.drawn) this.fill(this.table.disc(theta, phi));
    const [sin, cos] = [Math.sin(radians(phi)), Math.cos(radians(phi))];
    this.mark.setAttribute("cx", (theta * cos).toFixed(2));
    this.mark.setAttribute("cy", (-theta * sin).toFixed(2));
    this.drawn = true;
    return canvas;
  }

  fill(rgb) {
    const { width } = this.canvas;
    const context = this.canvas.getContext("2d");
    const image = context.createImageData(width, width);
    for (let j = 0; j < width; j += 1) {
      for (let i = 0; i < width; i += 1) {
        const [x, y] = [(2 * i + 1) / width - 1, 1 - (2 * j + 1) / width];
        const theta = 90 * Math.hypot(x, y);
        if (theta > 91.5) continue;
        const [r, g, b] = srgb(rgb(Math.min(theta, 90), degrees(Math.atan2(y, x))));
        image.data.set([r, g, b, 255], 4 * (j * width + i));
      }
    }
    context.putImageData(image, 0, 0);
  }

  /** θ and φ under the pointer, or `null` outside the disc. */
  at(event) {
    const box = this.canvas.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left)) / box.width - 1;
    const y = 1 - (2 * (event.clientY - box.top)) / box.height;
    const theta = 90 * Math.hypot(x, y);
    return theta > 90 ? null : { theta, phi: (degrees(Math.atan2(y, x)) + 360) % 360 };
  }
}
