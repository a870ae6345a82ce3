// Tests of the page of mirror-like tables with a finish: the first picture, light from everywhere, speed, and roughness
// that visitors choose.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { difference, grain, launch, picture, visit } from "./browser.mjs";

const TABLES = ["satin", "brushed", "gold"];
/** Largest mean difference of 8-bit values of the first picture, whose light is blurred most, from the sum of many. */
const FIRST = 4;
/** Largest grain in steps of 8 bits: rounding to whole steps alone makes 0.3. */
const GRAIN = 0.5;
/** Largest difference of light from everywhere from the albedo: a step of rounding, and one of single precision. */
const EVEN = 2;

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

for (const table of TABLES) {
  test(`the first picture of ${table} is near the last, and has no grain`, async () => {
    const { page } = await visit(browser, `${table}.html`);
    const body = await picture(page, { shape: "sphere", light: "studio", surroundings: false }, 192, 1);
    const first = await picture(page, { surroundings: true }, 192, 1);
    const last = await picture(page, {}, 192, 32);
    const { mean } = await difference(browser, first, last, body);
    const [before, after] = [await grain(browser, first, body), await grain(browser, last, body)];
    console.log(`${table}: mean ${mean.toFixed(2)}; grain ${before.toFixed(2)}, then ${after.toFixed(2)}`);
    assert.ok(mean <= FIRST, `${mean}`);
    assert.ok(before <= after + GRAIN, `${before} ${after}`);
    await page.context().close();
  });

  test(`in light from everywhere, looks at facets of ${table} add up to the albedo`, async () => {
    const { page } = await visit(browser, `${table}.html`);
    const body = await picture(page, { shape: "sphere", light: "white", surroundings: false }, 128, 1);
    const albedo = await picture(page, {}, 128, 4);
    // An image of 1 everywhere is white light too, but facets look into it.
    await page.evaluate(() => {
      window.goniochrome.renderer.setImage({ width: 8, height: 4, rgb: new Float32Array(3 * 32).fill(1) });
    });
    const seen = await picture(page, { light: "image" }, 128, 4);
    const { mean, largest } = await difference(browser, albedo, seen, body);
    console.log(`${table}: mean ${mean.toFixed(3)}, largest ${largest}`);
    assert.ok(largest <= EVEN, `${largest}`);
    await page.context().close();
  });
}

test("rough facets are drawn at 720p, in the time that is printed", async () => {
  const { page, complaints } = await visit(browser, "gold.html", { viewport: { width: 400, height: 300 } });
  for (const light of ["studio", "lamp"]) {
    const { took, lit } = await page.evaluate((light) => {
      const { state, camera, renderer } = window.goniochrome;
      const { gl } = renderer;
      // The page's own pictures stop.
      renderer.enough = 1;
      Object.assign(state, { light, roughness: [0.3, 0.3] });
      renderer.resize(1280, 720);
      const row = new Uint8Array(4 * 1280);
      const drawn = () => {
        const from = performance.now();
        renderer.restart();
        renderer.advance(state, camera);
        gl.readPixels(0, 360, 1280, 1, gl.RGBA, gl.UNSIGNED_BYTE, row);
        return performance.now() - from;
      };
      drawn();
      const took = Math.min(...Array.from({ length: 10 }, drawn));
      return { took, lit: row.filter((value, i) => i % 4 < 3 && value > 0).length };
    }, light);
    console.log(`${light}: ${took.toFixed(0)} ms a picture`);
    assert.ok(lit > 0, `${light}: the middle row is black`);
  }
  assert.deepEqual(complaints, []);
  await page.context().close();
});

test("visitors choose the roughness, and mirrors are rough or smooth", async () => {
  const { page, complaints } = await visit(browser, "beetle.html");
  const shown = (roughness) => picture(page, { shape: "sphere", light: "studio", ...roughness }, 96, 2);
  const mirror = await shown({});
  assert.deepEqual(await page.evaluate(() => window.goniochrome.state.roughness), [0, 0]);
  await page.locator("#roughness").fill("0.55");
  assert.equal(await page.textContent("#roughness-value"), "0.3");
  assert.ok(await page.isHidden("#legend"));
  const rough = await shown({});
  assert.ok(rough !== mirror);
  await page.check("#brushed");
  await page.locator("#across").fill("0.3");
  assert.deepEqual(await page.evaluate(() => window.goniochrome.state.roughness), [0.3, 0.09]);
  assert.ok(![rough, mirror].includes(await shown({})));
  await page.waitForFunction(() => location.hash.includes("roughness=0.3%2C0.09"));
  await page.uncheck("#brushed");
  await page.locator("#roughness").fill("0");
  assert.ok(await page.isVisible("#legend"));
  assert.equal(await shown({}), mirror);
  assert.deepEqual(complaints, []);
  await page.context().close();
});
