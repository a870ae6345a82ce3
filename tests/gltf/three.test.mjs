// Tests of the exported files in three.js: bubbles are transparent, and rows of textures are in their places.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname } from "node:path";
import { after, before, test } from "node:test";
import { at, launch } from "./browser.mjs";

const TYPES = { ".html": "text/html", ".js": "text/javascript" };
let browser, server, page;
const complaints = [];

before(async () => {
  server = createServer((request, response) => {
    try {
      const body = readFileSync(at(decodeURIComponent(request.url.slice(1))));
      response.writeHead(200, { "content-type": TYPES[extname(request.url)] ?? "application/octet-stream" }).end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  browser = await launch();
  page = await browser.newPage();
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) complaints.push(message.text()); });
  page.on("pageerror", (error) => complaints.push(error.message));
  await page.goto(`http://127.0.0.1:${server.address().port}/three.html`);
  await page.waitForFunction(() => window.ready);
});
after(async () => {
  await browser.close();
  server.close();
});

const picture = (file) => page.evaluate((file) => window.before(file), file);

/** RGB along the middle line, a quarter of the picture to each side of the centre: well within the sphere. */
const middle = (pixels) =>
  Array.from({ length: 128 }, (_, i) => pixels.slice(4 * (128 * 256 + 64 + i), 4 * (128 * 256 + 64 + i) + 3));
const mean = (line) => line.flat().reduce((sum, x) => sum + x, 0) / (3 * line.length);

test("a bubble is seen through, and what is behind it stays in place", async () => {
  const [bare, bubble] = [await picture(null), await picture("soap-bubble.gltf")].map(middle);
  // Two walls, each reflecting at most 0.13 of any colour facing, and more towards the sides.
  assert.ok(mean(bubble) > 0.6 * mean(bare), `${mean(bubble)} of ${mean(bare)}`);
  // Away from the edges of stripes, which three.js blurs.
  const inside = bare.map((_, i) => i).filter((i) => [-4, 4].every((by) => String(bare[i + by]) === String(bare[i])));
  assert.ok(inside.length > 60, `${inside.length}`);
  for (const i of inside) {
    const [[r, , b], seen] = [bare[i], bubble[i]];
    assert.equal(seen[0] > seen[2], r > b, `stripe at ${i}`);
    assert.ok(seen.every((x, c) => x <= bare[i][c] + 2), `light of its own at ${i}: ${seen}`);
  }
});

test("a film on glass is a solid body: light passes, and is refracted", async () => {
  const [bare, glass] = [await picture(null), await picture("glass.gltf")].map(middle);
  assert.ok(mean(glass) > 0.5 * mean(bare), `${mean(glass)} of ${mean(bare)}`);
  assert.ok(bare.some(([r, , b], i) => r > b !== glass[i][0] > glass[i][2]), "stripes are where they were");
});

test("metals and mirrors are opaque", async () => {
  for (const name of ["gold", "mirror"]) {
    assert.equal(mean(middle(await picture(`${name}.gltf`))), 0, name);
  }
});

for (const kind of ["exr", "png"]) {
  test(`v = 0 is the bottom of a picture: --origin bottom puts parameter 0 there (${kind})`, async () => {
    const glsl = readFileSync(at("lut.glsl"), "utf8");
    const lookUp = (file, parameter) => page.evaluate((words) => window.lookUp(...words), [`${file}.${kind}`, glsl, parameter]);
    const [thin, thick] = [await lookUp("thin", 0), await lookUp("thick", 0)];
    const [first, last] = [await lookUp("bottom", 0), await lookUp("bottom", 1)];
    // PNG comes as 8 bits.
    const near = (a, b) => a.every((x, c) => Math.abs(x - b[c]) <= (kind === "exr" ? 1e-6 : 1 / 255));
    assert.ok(!near(thin, thick), `${thin} ${thick}`);
    assert.ok(near(first, thin) && near(last, thick), `${first} for ${thin}, ${last} for ${thick}`);
    assert.ok(near(await lookUp("top", 0), thick), "the file's first row is v = 1 there");
  });
}

test("three.js has no complaints", () => assert.deepEqual(complaints, []));
