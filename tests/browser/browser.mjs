// Helpers: a browser with software GL, its pages, the comparison of pictures, and tests that several tables share.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { chromium } from "playwright-core";

export const work = process.env.WORK;
const ARGUMENTS = [
  "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-sync",
];
const SOFTWARE_GL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

export const at = (name) => join(work, name);
export const bytesOf = (name) => statSync(at(name)).size;

/** Runs the program and returns what it writes to standard output. */
export const run = (...words) => execFileSync(process.env.GONIOCHROME, words, { cwd: work, encoding: "utf8" });

export const launch = (gl = SOFTWARE_GL) =>
  chromium.launch({ executablePath: "/usr/bin/chromium", args: [...ARGUMENTS, ...gl] });

/** A window that leaves the processor to what a test draws itself. */
export const SMALL = { viewport: { width: 400, height: 300 } };

/** Opens a page. Returns it with a list of complaints: messages of the console, and requests to the network. */
export async function visit(browser, name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 900, height: 640 }, ...options });
  const page = await context.newPage();
  const complaints = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) complaints.push(`asks for ${request.url()}`);
  });
  await page.goto(`file://${at(name)}`);
  return { page, complaints };
}

/**
 * Sets the state and the camera, and returns the picture as a PNG in a data URL. From then on the page draws no more
 * than one picture of its own after each change, which leaves the processor to the tests.
 */
export const picture = (page, wanted, side, count) =>
  page.evaluate(({ wanted, side, count }) => {
    const { state, camera, renderer } = window.goniochrome;
    const { azimuth, elevation, ...rest } = wanted;
    renderer.enough = 1;
    Object.assign(camera, { azimuth: azimuth ?? camera.azimuth, elevation: elevation ?? camera.elevation });
    Object.assign(state, rest);
    return renderer.picture(state, camera, side, side, count);
  }, { wanted, side, count });

export const fileUrl = (name) => `data:image/png;base64,${readFileSync(at(name)).toString("base64")}`;

/** An empty page of each browser, in which pictures are measured. */
const empty = new WeakMap();

/** Runs `measure` in the browser on the pixels of pictures of one size, and returns its result. */
async function measured(browser, measure, urls) {
  if (!empty.has(browser)) empty.set(browser, await browser.newPage());
  return empty.get(browser).evaluate(async ({ measure, urls }) => {
    const pictures = await Promise.all(urls.map(async (url) => {
      const image = new Image();
      image.src = url;
      await image.decode();
      const canvas = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height });
      const context = canvas.getContext("2d");
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height);
    }));
    if (pictures.some(({ width, height }) => width !== pictures[0].width || height !== pictures[0].height)) {
      throw new Error("pictures of two sizes");
    }
    return new Function(`return ${measure}`)()(...pictures);
  }, { measure: measure.toString(), urls });
}

/** The mean and largest difference of 8-bit values of two pictures, where the picture `mask` is opaque. */
export const difference = (browser, a, b, mask) => measured(browser, (one, two, opaque) => {
  let [sum, largest, lit, count] = [0, 0, 0, 0];
  for (let i = 0; i < one.data.length; i += 1) {
    if (i % 4 === 3 || opaque.data[i | 3] < 128) continue;
    const apart = Math.abs(one.data[i] - two.data[i]);
    sum += apart;
    largest = Math.max(largest, apart);
    lit += two.data[i] > 16 ? 1 : 0;
    count += 1;
  }
  return { mean: sum / count, largest, lit: lit / count, covered: (4 * count) / (3 * one.data.length) };
}, [a, b, mask]);

/**
 * The mean difference of an 8-bit value from the mean of its four neighbours, where the picture `mask` is opaque three
 * pixels around.
 */
export const grain = (browser, a, mask) => measured(browser, ({ data, width }, opaque) => {
  const [right, down] = [4, 4 * width];
  let [sum, count] = [0, 0];
  for (let i = 3 * down; i < data.length - 3 * down; i += 1) {
    if (i % 4 === 3 || [0, 3 * right, -3 * right, 3 * down, -3 * down].some((by) => opaque.data[(i + by) | 3] < 128)) continue;
    sum += Math.abs(data[i] - 0.25 * (data[i - right] + data[i + right] + data[i - down] + data[i + down]));
    count += 1;
  }
  return sum / count;
}, [a, mask]);

/** Largest grain in steps of 8 bits: rounding to whole steps alone makes 0.3. */
const GRAIN = 0.5;
/** Largest difference of light from everywhere from the albedo: a step of rounding, and one of the texture's floats. */
const EVEN = 2;

/**
 * Checks that the first picture of a rough body has no grain and is near the sum of many, by a largest mean difference
 * of 8-bit values; and that in light from everywhere, what its samples see adds up to the albedo.
 */
export async function checkSamples(browser, table, largestMean) {
  const { page, complaints } = await visit(browser, `${table}.html`, SMALL);
  const side = 96;
  const body = await picture(page, { shape: "sphere", light: "studio", surroundings: false }, side, 1);
  const first = await picture(page, { surroundings: true }, side, 1);
  const last = await picture(page, {}, side, 16);
  const { mean } = await difference(browser, first, last, body);
  const [before, after] = [await grain(browser, first, body), await grain(browser, last, body)];
  console.log(`${table}: mean ${mean.toFixed(2)}; grain ${before.toFixed(2)}, then ${after.toFixed(2)}`);
  assert.ok(mean <= largestMean, `${mean}`);
  assert.ok(before <= after + GRAIN, `${before} ${after}`);

  const albedo = await picture(page, { light: "white", surroundings: false }, side, 4);
  // An image of 1 everywhere is white light too, but samples look into it.
  await page.evaluate(() => {
    window.goniochrome.renderer.setImage({ width: 8, height: 4, rgb: new Float32Array(3 * 32).fill(1) });
  });
  const seen = await picture(page, { light: "image" }, side, 4);
  const even = await difference(browser, albedo, seen, body);
  console.log(`${table} in even light: mean ${even.mean.toFixed(3)}, largest ${even.largest}`);
  assert.ok(even.largest <= EVEN, `${even.largest}`);
  assert.deepEqual(complaints, []);
  await page.context().close();
}

/** A Radiance HDR file of a coloured sky with a lamp, 64 × 32 pixels, without run-length coding. */
export function skyHdr() {
  const [width, height] = [64, 32];
  const pixels = Buffer.alloc(4 * width * height);
  for (let y = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1) {
      const lamp = Math.hypot(x - 20, y - 10) < 3 ? 3 : 0;
      const rgb = [0.2 + lamp + x / 80, 0.3 + lamp, 0.7 - y / 64 + lamp];
      const exponent = Math.ceil(Math.log2(Math.max(...rgb) * 1.01));
      rgb.forEach((value, c) => { pixels[4 * (y * width + x) + c] = Math.floor((value * 256) / 2 ** exponent); });
      pixels[4 * (y * width + x) + 3] = exponent + 128;
    }
  }
  return Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`), pixels]);
}
