// Environments from files of lat-long images: Radiance HDR, OpenEXR, or any picture that the browser reads.

/** Decodes a file: width, height, linear RGB, and the number of components that were repaired. */
async function decodeImage(file) {
  const buffer = await file.arrayBuffer();
  const start = new Uint8Array(buffer, 0, Math.min(4, buffer.byteLength));
  let image;
  try {
    if (start[0] === 0x76 && start[1] === 0x2f) image = await decodeExr(buffer);
    else if (start[0] === 0x23 && start[1] === 0x3f) image = decodeHdr(new Uint8Array(buffer));
    else image = await decodePicture(file);
  } catch (error) {
    if (error instanceof RangeError || error instanceof TypeError) throw new Error("the file ends too early, or is damaged");
    throw error;
  }
  if (image.primaries) convert(image.rgb, image.primaries);
  image.mended = mend(image.rgb);
  return image;
}

/** Chromaticities x and y of red, green, blue and white in Rec. 709. */
const REC_709 = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
/** Largest difference of a primary that is still Rec. 709: files round to two digits; Radiance has green at 0.29. */
const MAX_PRIMARY_DIFFERENCE = 0.015;
/** Bradford's cone responses, row by row. */
const BRADFORD = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

/** Converts R, G, B of other primaries to Rec. 709, as `render` does; white stays white. */
function convert(rgb, primaries) {
  if (REC_709.slice(0, 6).every((x, i) => Math.abs(x - primaries[i]) <= MAX_PRIMARY_DIFFERENCE)) return;
  const matrix = toRec709(primaries);
  if (!matrix.flat().every(Number.isFinite)) throw new Error("the primaries of this file span no colours");
  for (let i = 0; i < rgb.length; i += 3) rgb.set(matrix.map((row) => dot(row, rgb.subarray(i, i + 3))), i);
}

/** The matrix, row by row, that converts R, G, B of primaries to Rec. 709. */
function toRec709(primaries) {
  const transposed = (m) => [0, 1, 2].map((i) => m.map((row) => row[i]));
  const product = (a, b) => a.map((row) => transposed(b).map((column) => dot(row, column)));
  const applied = (m, v) => m.map((row) => dot(row, v));
  const inverse = ([a, b, c]) => transposed([cross(b, c), cross(c, a), cross(a, b)].map((row) => times(row, 1 / dot(a, cross(b, c)))));
  const white = (named) => [named[6] / named[7], 1, (1 - named[6] - named[7]) / named[7]];
  const toXyz = (named) => {
    const columns = transposed([0, 2, 4].map((i) => [named[i], named[i + 1], 1 - named[i] - named[i + 1]]));
    const strengths = applied(inverse(columns), white(named));
    return columns.map((row) => row.map((x, i) => x * strengths[i]));
  };
  const [from, to] = [primaries, REC_709].map((named) => applied(BRADFORD, white(named)));
  const adapted = product(inverse(BRADFORD), BRADFORD.map((row, i) => times(row, to[i] / from[i])));
  return product(inverse(toXyz(REC_709)), product(adapted, toXyz(primaries)));
}

/** Replaces components that are no radiance: negative, infinite or not a number; returns their count. */
function mend(rgb) {
  let mended = 0;
  for (let i = 0; i < rgb.length; i += 1) {
    const good = rgb[i] >= 0 && rgb[i] <= 65504;
    if (!good) {
      rgb[i] = rgb[i] > 0 ? 65504 : 0;
      mended += 1;
    }
  }
  return mended;
}

/**
 * Decodes Radiance RGBE in any orientation, with or without run lengths, as `render` does. Factors by which programs
 * multiplied the pixels, as the header tells, are divided out.
 */
function decodeHdr(data) {
  let at = 0;
  const line = () => {
    const end = data.indexOf(10, at);
    if (end < 0) throw new Error("this HDR file is damaged: its header does not end");
    const text = String.fromCharCode(...data.subarray(at, end));
    at = end + 1;
    return text.replace(/\r+$/, "");
  };
  const { multiplied, primaries } = hdrHeader(line);
  const size = /^([-+])([XY]) +(\d+) +([-+])([XY]) +(\d+)$/.exec(line().trim());
  if (!size || size[2] === size[5]) throw new Error("this HDR file is damaged: it has no resolution such as -Y 512 +X 1024");
  const byColumns = size[2] === "X";
  const [count, length] = [Number(size[3]), Number(size[6])];
  const [width, height] = byColumns ? [count, length] : [length, count];
  // Y grows upwards, rows are counted from the top.
  const [signX, signY] = byColumns ? [size[1], size[4]] : [size[4], size[1]];
  if (!(width > 0 && height > 0 && width * height <= MAX_TEXELS)) throw new Error("this HDR file has no pixels, or more than 50 million");
  const rgb = new Float32Array(3 * width * height);
  const stored = new Uint8Array(4 * length);
  for (let number = 0; number < count; number += 1) {
    at = hdrLine(data, at, stored, length);
    for (let along = 0; along < length; along += 1) {
      const [column, row] = byColumns ? [number, along] : [along, number];
      const [x, y] = [signX === "-" ? width - 1 - column : column, signY === "+" ? height - 1 - row : row];
      const exponent = stored[4 * along + 3];
      const scale = exponent ? 2 ** (exponent - 136) : 0;
      for (let c = 0; c < 3; c += 1) rgb[3 * (y * width + x) + c] = (stored[4 * along + c] * scale) / multiplied[c];
    }
  }
  return { width, height, rgb, primaries };
}

/** Reads a header to its empty line: the factors that multiplied R, G and B, and their primaries. */
function hdrHeader(line) {
  const multiplied = [1, 1, 1];
  let primaries;
  for (let text = line(); text !== ""; text = line()) {
    // Lines that start with a blank repeat the headers of a program's inputs.
    const [, key, value] = /^([A-Z]+)=(.*)$/.exec(text) ?? [];
    const numbers = (count, min = Number.MIN_VALUE) => {
      const found = value.trim().split(/\s+/).map(Number);
      if (found.length !== count || !found.every((x) => x >= min && x < Infinity)) {
        throw new Error(`this HDR file is damaged: ${text} is not the ${count} numbers that belong there`);
      }
      return found;
    };
    if (key === "PRIMARIES") {
      const named = numbers(8, -Infinity);
      // Photoshop writes zeros for what it does not know.
      primaries = named.some((x) => x !== 0) ? named : undefined;
    }
    if (key === "FORMAT" && value.trim() !== "32-bit_rle_rgbe") throw new Error(`${text} is not supported here; save R, G, B`);
    if (key === "GAMMA" && numbers(1)[0] !== 1) throw new Error(`${text}: the pixels are not linear; save the image with a gamma of 1`);
    const by = key === "EXPOSURE" ? numbers(1) : key === "COLORCORR" ? numbers(3) : [1];
    for (let c = 0; c < 3; c += 1) multiplied[c] *= by[c % by.length];
  }
  if (!multiplied.every((m) => m > 0 && m < Infinity)) throw new Error("this HDR file's exposures multiply to no number above 0");
  return { multiplied, primaries };
}

/** Reads the pixels of a scan line; returns the place at which the next begins. */
function hdrLine(data, start, stored, length) {
  let at = start;
  const early = () => new Error("this HDR file ends too early");
  const wrong = () => new Error("this HDR file is damaged: a run has a wrong length");
  const coded = length >= 8 && length < 32768 && data[at] === 2 && data[at + 1] === 2 && data[at + 2] < 128;
  if (!coded) return hdrOldLine(data, at, stored, length, early, wrong);
  if (256 * data[at + 2] + data[at + 3] !== length) throw wrong();
  at += 4;
  for (let c = 0; c < 4; c += 1) {
    for (let x = 0; x < length; ) {
      if (at + 1 >= data.length) throw early();
      const count = data[at++];
      const run = count > 128 ? count - 128 : count;
      if (run === 0 || x + run > length) throw wrong();
      if (count <= 128 && at + run > data.length) throw early();
      for (let i = 0; i < run; i += 1) stored[4 * (x + i) + c] = data[count > 128 ? at : at + i];
      at += count > 128 ? 1 : run;
      x += run;
    }
  }
  return at;
}

/**
 * Reads a scan line of plain pixels and runs of them: the pixel 1, 1, 1, n repeats the last one n times. The count of a
 * run that directly follows another stands for 256 times as many pixels.
 */
function hdrOldLine(data, start, stored, length, early, wrong) {
  let at = start;
  let shift = 0;
  for (let x = 0; x < length; at += 4) {
    if (at + 4 > data.length) throw early();
    if (data[at] === 1 && data[at + 1] === 1 && data[at + 2] === 1) {
      const run = data[at + 3] * 2 ** shift;
      if (x === 0 || shift >= 32 || x + run > length) throw wrong();
      for (let i = 0; i < run; i += 1) stored.copyWithin(4 * (x + i), 4 * (x - 1), 4 * x);
      x += run;
      shift += 8;
    } else {
      stored.set(data.subarray(at, at + 4), 4 * x);
      x += 1;
      shift = 0;
    }
  }
  return at;
}

/** Decodes JPEG, PNG and other pictures that the browser reads: sRGB, at most 1. */
async function decodePicture(file) {
  let bitmap;
  try {
    bitmap = await createImageBitmap(file);
  } catch {
    throw new Error("not an image that this browser reads; choose Radiance HDR, OpenEXR, JPEG or PNG");
  }
  const { width, height } = bitmap;
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  const context = canvas.getContext("2d");
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  const linear = Float32Array.from({ length: 256 }, (_, i) => decoded(i / 255));
  const rgb = new Float32Array(3 * width * height);
  for (let i = 0; i < width * height; i += 1) for (let c = 0; c < 3; c += 1) rgb[3 * i + c] = linear[data[4 * i + c]];
  return { width, height, rgb };
}
