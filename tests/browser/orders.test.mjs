// Tests of the page of diffraction orders: a large picture, the first picture, and readings.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { SMALL, difference, fileUrl, launch, picture, run, visit } from "./browser.mjs";

/** Largest mean difference of 8-bit values of the first picture, which has few wavelengths, from `render`. */
const FIRST = 2;

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

test("a disc is drawn at 1080p, in the time that is printed", async () => {
  const { page } = await visit(browser, "disc.html", SMALL);
  for (const light of ["lamp", "studio", "white"]) {
    const { took, lit } = await page.evaluate((light) => {
      const { state, camera, renderer } = window.goniochrome;
      const { gl } = renderer;
      // The page's own pictures stop.
      renderer.enough = 0;
      Object.assign(state, { shape: "disc", light });
      renderer.resize(1920, 1080);
      const row = new Uint8Array(4 * 1920);
      const drawn = () => {
        renderer.add(state, camera);
        renderer.show(state);
        gl.readPixels(0, 540, 1920, 1, gl.RGBA, gl.UNSIGNED_BYTE, row);
      };
      drawn();
      const from = performance.now();
      drawn();
      return { took: performance.now() - from, lit: row.filter((value, i) => i % 4 < 3 && value > 0).length };
    }, light);
    console.log(`${light}: ${took.toFixed(0)} ms a picture`);
    assert.ok(lit > 0, `${light}: the middle row is black`);
  }
  await page.context().close();
});

test("the first picture is near the last", async () => {
  const { page } = await visit(browser, "disc.html");
  for (const light of ["lamp", "studio"]) {
    const body = await picture(page, { shape: "disc", light, surroundings: false }, 256, 1);
    const shown = await picture(page, { surroundings: true }, 256, 1);
    run("render", "disc.exr", "-o", "offline.png", "--mesh", "disc", "--env", light, "--size", "256", "--samples", "1", "--quiet");
    const { mean } = await difference(browser, shown, fileUrl("offline.png"), body);
    console.log(`${light}: mean ${mean.toFixed(2)}`);
    assert.ok(mean <= FIRST, `${light}: ${mean}`);
  }
  await page.context().close();
});

test("the disc of directions and the spectrum follow the pointer", async () => {
  const { page, complaints } = await visit(browser, "disc.html");
  const reading = () => page.evaluate(() => [
    document.getElementById("disc").toDataURL(),
    document.querySelector("#spectrum .albedo").getAttribute("points"),
  ]);
  await page.locator("#disc-field").scrollIntoViewIfNeeded();
  const box = await page.locator("#disc-field").boundingBox();
  const at = async (x, y) => {
    await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
    return reading();
  };
  const [one, two] = [await at(0.5, 0.5), await at(0.8, 0.5)];
  assert.ok(one[0] !== two[0] && one[1] !== two[1]);
  assert.deepEqual(complaints, []);
  await page.context().close();
});
