// Tests of the page of mirror-like tables with a finish: the first picture, light from everywhere, speed, and roughness
// that visitors choose.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SMALL, checkSamples, launch, picture, visit } from "./browser.mjs";

const TABLES = ["satin", "brushed", "gold", "facets"];
/** Largest mean difference of 8-bit values of the first picture, whose light is blurred most, from the sum of many. */
const FIRST = 4;

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

for (const table of TABLES) {
  test(`looks at facets of ${table}`, () => checkSamples(browser, table, FIRST));
}

test("rough facets are drawn at 720p, in the time that is printed", async () => {
  const { page, complaints } = await visit(browser, "gold.html", SMALL);
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
      const took = Math.min(...Array.from({ length: 5 }, drawn));
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
