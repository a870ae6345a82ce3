// Environments from files: Radiance HDR, OpenEXR, or an ordinary picture. All are lat-long images.

/** Width, height, linear RGB, and what had to be mended. */
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
  image.mended = mend(image.rgb);
  return image;
}

/** No radiance is negative, no number or infinite. */
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

/** Radiance RGBE, with or without run lengths. */
function decodeHdr(data) {
  let at = 0;
  const line = () => {
    const end = data.indexOf(10, at);
    if (end < 0) throw new Error("this HDR file is damaged: its header does not end");
    const text = String.fromCharCode(...data.subarray(at, end));
    at = end + 1;
    return text;
  };
  let text = line();
  while (text !== "") {
    if (text.startsWith("FORMAT=") && text !== "FORMAT=32-bit_rle_rgbe") throw new Error(`${text} is not supported here; save R, G, B`);
    text = line();
  }
  const size = /^-Y (\d+) \+X (\d+)$/.exec(line());
  if (!size) throw new Error("HDR files must run from the upper left, row by row (-Y … +X …)");
  const [height, width] = [Number(size[1]), Number(size[2])];
  if (!(width > 0 && height > 0 && width * height <= MOST_TEXELS)) throw new Error("this HDR file has no pixels, or more than 50 million");
  const rgb = new Float32Array(3 * width * height);
  const row = new Uint8Array(4 * width);
  for (let y = 0; y < height; y += 1) {
    at = hdrRow(data, at, row, width);
    for (let x = 0; x < width; x += 1) {
      const exponent = row[4 * x + 3];
      const scale = exponent ? 2 ** (exponent - 136) : 0;
      for (let c = 0; c < 3; c += 1) rgb[3 * (y * width + x) + c] = row[4 * x + c] * scale;
    }
  }
  return { width, height, rgb };
}

function hdrRow(data, start, row, width) {
  let at = start;
  const early = () => new Error("this HDR file ends too early");
  const coded = width >= 8 && width < 32768 && data[at] === 2 && data[at + 1] === 2 && data[at + 2] < 128;
  if (!coded) {
    if (at + 4 * width > data.length) throw early();
    row.set(data.subarray(at, at + 4 * width));
    return at + 4 * width;
  }
  at += 4;
  for (let c = 0; c < 4; c += 1) {
    for (let x = 0; x < width; ) {
      if (at + 1 >= data.length) throw early();
      const count = data[at++];
      const run = count > 128 ? count - 128 : count;
      if (run === 0 || x + run > width) throw new Error("this HDR file is damaged: a run is too long");
      for (let i = 0; i < run; i += 1) row[4 * (x + i) + c] = data[count > 128 ? at : at + i];
      at += count > 128 ? 1 : run;
      x += run;
    }
  }
  return at;
}

/** JPEG, PNG and what else the browser reads: sRGB, at most 1. */
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
