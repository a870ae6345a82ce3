// Tests of the page of scattering bodies: the first picture, and light from everywhere.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { difference, grain, launch, picture, visit } from "./browser.mjs";

const TABLES = ["beetle-pits", "silicon-pyramids"];
/** Largest mean difference of 8-bit values of the first picture, whose light is blurred most, from the sum of many. */
const FIRST = 3;
/** Largest grain in steps of 8 bits: rounding to whole steps alone makes 0.3. */
const GRAIN = 0.5;
/** Largest difference of light from everywhere from the albedo: a step of rounding, and one of halves. */
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

  test(`in light from everywhere, samples of ${table} add up to the albedo`, async () => {
    const { page } = await visit(browser, `${table}.html`);
    const body = await picture(page, { shape: "sphere", light: "white", surroundings: false }, 128, 1);
    const albedo = await picture(page, {}, 128, 4);
    // An image of 1 everywhere is white light too, but samples look into it.
    await page.evaluate(() => {
      window.goniochrome.renderer.setImage({ width: 8, height: 4, rgb: new Float32Array(3 * 32).fill(1) });
    });
    const sampled = await picture(page, { light: "image" }, 128, 4);
    const { mean, largest } = await difference(browser, albedo, sampled, body);
    console.log(`${table}: mean ${mean.toFixed(3)}, largest ${largest}`);
    assert.ok(largest <= EVEN, `${largest}`);
    await page.context().close();
  });
}
