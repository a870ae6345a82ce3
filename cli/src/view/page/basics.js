// Vectors, and arrays of numbers from base64 text.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, b, scale = 1) => [a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]];
const times = (a, scale) => [a[0] * scale, a[1] * scale, a[2] * scale];
const unit = (a) => times(a, 1 / Math.hypot(...a));
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const radians = (degrees) => (degrees * Math.PI) / 180;
const degrees = (radians) => (radians * 180) / Math.PI;

/** The unit vector at angles in degrees. */
function sphere(theta, phi) {
  const sin = Math.sin(radians(theta));
  return [sin * Math.cos(radians(phi)), sin * Math.sin(radians(phi)), Math.cos(radians(theta))];
}

/** The bytes of a base64 text. */
function bytes(text) {
  const string = atob(text);
  const all = new Uint8Array(string.length);
  for (let i = 0; i < string.length; i += 1) all[i] = string.charCodeAt(i);
  return all.buffer;
}

const floats = (text) => new Float32Array(bytes(text));
const halves = (text) => Float32Array.from(new Uint16Array(bytes(text)), float);
const signed = (text) => new Int16Array(bytes(text));
const indices = (text) => new Uint16Array(bytes(text));

/** The value of a half-precision number of these 16 bits. */
function float(half) {
  const [sign, exponent, fraction] = [half & 0x8000 ? -1 : 1, (half >> 10) & 31, half & 1023];
  if (exponent === 0) return sign * fraction * 2 ** -24;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
}

/** The neighbours of `x` among increasing numbers, and the weight of the second; held at the ends. */
function place(x, numbers) {
  let [low, high] = [0, numbers.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= x) low = middle;
    else high = middle;
  }
  const span = numbers[high] - numbers[low];
  return [low, high, span > 0 ? clamp((x - numbers[low]) / span, 0, 1) : 0];
}
