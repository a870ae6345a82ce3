// Decoder of OpenEXR images: scan lines of R, G, B or Y, in halves, floats or whole numbers, uncompressed or ZIP.

const EXR_COMPRESSIONS = ["none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"];
const MAX_TEXELS = 50e6;

/** Decodes the bytes of a file: width, height, linear RGB and primaries. */
async function decodeExr(buffer) {
  const header = exrHeader(new DataView(buffer));
  const { channels, compression, width, height } = header;
  const lines = { none: 1, ZIPS: 1, ZIP: 16 }[compression];
  if (!lines) throw new Error(`EXR compression ${compression} is not supported here; save the image uncompressed or as ZIP`);
  const sources = exrSources(channels);
  const rgb = new Float32Array(3 * width * height);
  const blocks = Math.ceil(height / lines);
  const view = header.view;
  const lineBytes = channels.reduce((sum, channel) => sum + channel.bytes * width, 0);
  for (let block = 0; block < blocks; block += 1) {
    const at = Number(view.getBigUint64(header.end + 8 * block, true));
    const [first, size] = [view.getInt32(at, true) - header.top, view.getInt32(at + 4, true)];
    const count = Math.min(lines, height - first);
    if (first < 0 || count <= 0) throw new Error("this EXR file is damaged: a block lies outside the image");
    let data = new Uint8Array(buffer, at + 8, size);
    if (compression !== "none" && size < lineBytes * count) data = unpredicted(await inflated(data));
    if (data.length < lineBytes * count) throw new Error("this EXR file is damaged: a block is too short");
    const samples = new DataView(data.buffer, data.byteOffset, data.length);
    for (let line = 0; line < count; line += 1) {
      let from = line * lineBytes;
      for (const channel of channels) {
        const target = sources.get(channel.name);
        if (target) {
          for (let x = 0; x < width; x += 1) {
            const value = channel.read(samples, from + channel.bytes * x);
            for (const c of target) rgb[3 * ((first + line) * width + x) + c] = value;
          }
        }
        from += channel.bytes * width;
      }
    }
  }
  return { width, height, rgb, primaries: header.primaries };
}

/**
 * The components among R, G, B that each channel fills. As in `render`, a channel is named by its layer, a point, and
 * its own name. Channels without a layer are preferred, then the layer that Blender calls Combined, then the only one.
 */
function exrSources(channels) {
  const names = channels.map((channel) => channel.name);
  const layers = (needed) => {
    const all = [...new Set(names.map((name) => name.slice(0, name.lastIndexOf(".") + 1)))];
    return all.filter((layer) => needed.every((own) => names.includes(layer + own)));
  };
  const colours = layers(["R", "G", "B"]);
  const greys = layers(["Y"]).filter((layer) => !["X", "RY", "BY"].some((own) => names.includes(layer + own)));
  const found = colours.length ? colours : greys;
  const combined = found.filter((layer) => /(^|\.)Combined\.$/.test(layer));
  const [layer] = found.includes("") ? [""] : combined.length === 1 ? combined : found;
  if (layer === undefined) throw new Error(`an EXR environment needs the channels R, G and B, or Y; this one has ${names.join(", ")}`);
  if (found.length > 1 && layer !== "" && combined.length !== 1) {
    throw new Error(`this EXR file holds ${found.length} pictures: ${found.map((name) => name.slice(0, -1)).join(", ")}; save the one to open`);
  }
  if (colours.length) return new Map(["R", "G", "B"].map((own, c) => [layer + own, [c]]));
  return new Map([[`${layer}Y`, [0, 1, 2]]]);
}

function exrHeader(view) {
  const version = view.getUint32(4, true);
  if (version & 0x1a00) throw new Error("tiled, deep and multi-part EXR files are not supported here; save scan lines");
  let at = 8;
  const text = () => {
    let word = "";
    while (view.getUint8(at) !== 0) word += String.fromCharCode(view.getUint8(at++));
    at += 1;
    return word;
  };
  const found = { view };
  while (view.getUint8(at) !== 0) {
    const [name] = [text(), text()];
    const size = view.getInt32(at, true);
    at += 4;
    const end = at + size;
    if (name === "channels") {
      found.channels = [];
      while (view.getUint8(at) !== 0) {
        const channel = { name: text(), ...exrType(view.getInt32(at, true)) };
        if (view.getInt32(at + 8, true) !== 1 || view.getInt32(at + 12, true) !== 1) {
          throw new Error("EXR files with subsampled channels are not supported here");
        }
        found.channels.push(channel);
        at += 16;
      }
    } else if (name === "compression") {
      found.compression = EXR_COMPRESSIONS[view.getUint8(at)] ?? "of an unknown kind";
    } else if (name === "chromaticities") {
      found.primaries = [0, 4, 8, 12, 16, 20, 24, 28].map((offset) => view.getFloat32(at + offset, true));
    } else if (name === "dataWindow" || name === "displayWindow") {
      const [left, top, right, bottom] = [0, 4, 8, 12].map((offset) => view.getInt32(at + offset, true));
      const window = { top, width: right - left + 1, height: bottom - top + 1 };
      if (name === "dataWindow") Object.assign(found, window);
      else found.whole = window;
    }
    at = end;
  }
  found.end = at + 1;
  if (!(found.channels && found.width > 0 && found.height > 0 && found.width * found.height <= MAX_TEXELS)) {
    throw new Error("this EXR file is damaged, or larger than 50 million pixels");
  }
  if (found.whole && (found.whole.width !== found.width || found.whole.height !== found.height)) {
    throw new Error("this EXR file holds a part of a picture; save the whole");
  }
  return found;
}

function exrType(type) {
  if (type === 0) return { bytes: 4, read: (view, at) => view.getUint32(at, true) };
  if (type === 1) return { bytes: 2, read: (view, at) => float(view.getUint16(at, true)) };
  return { bytes: 4, read: (view, at) => view.getFloat32(at, true) };
}

async function inflated(data) {
  const stream = new Blob([data]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Undoes the predictor of ZIP compression: bytes are differences, and even ones are stored first. */
function unpredicted(data) {
  for (let i = 1; i < data.length; i += 1) data[i] = (data[i - 1] + data[i] - 128) & 255;
  const whole = new Uint8Array(data.length);
  const half = (data.length + 1) >> 1;
  for (let i = 0; i < data.length; i += 1) whole[i] = data[i & 1 ? half + (i >> 1) : i >> 1];
  return whole;
}
