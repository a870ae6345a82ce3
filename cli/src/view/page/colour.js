// Encoding of linear RGB for the screen, under the gamut policy of all pictures: colours out of gamut are mixed with
// the grey of their luminance, then scaled.

const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

function srgb(rgb) {
  const light = luminance(rgb);
  if (!(light > 0 && Number.isFinite(light))) return [0, 0, 0];
  const min = Math.min(...rgb);
  const saturation = min < 0 ? light / (light - min) : 1;
  const inside = rgb.map((c) => Math.max(light + saturation * (c - light), 0));
  const max = Math.max(1, ...inside);
  return inside.map((c) => Math.round(255 * encoded(c / max)));
}

const encoded = (c) => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
const decoded = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const hex = (rgb) => `#${srgb(rgb).map((c) => c.toString(16).padStart(2, "0")).join("")}`;
