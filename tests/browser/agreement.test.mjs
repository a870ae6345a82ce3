// Tests that the page shows what `render` draws with equal camera, light and table.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { SMALL, at, difference, fileUrl, launch, picture, run, skyHdr, visit } from "./browser.mjs";

/**
 * Largest mean difference of 8-bit values on the body. Scattering bodies and facets see light that is blurred a little.
 */
const MEAN = { "beetle-pits": 3, "silicon-pyramids": 3, satin: 3, brushed: 3, gold: 3, facets: 3, frosted: 3, matt: 3 };
const MEAN_OTHERS = 2;
/**
 * Pixels of a side, number of pictures that the page sums, rays of `render`. Mirrors and orders need many only to
 * smooth edges. A ray of `render` on a body that scatters, or on facets, samples 20 directions: the noise of so few
 * is well below the tolerance.
 */
const SCATTERING = [96, 16, 64];
const FACETS = [128, 32, 32];
const SIZE = {
  "beetle-pits": SCATTERING, "silicon-pyramids": SCATTERING,
  satin: FACETS, brushed: FACETS, gold: FACETS, facets: FACETS, matt: FACETS, frosted: [64, 32, 32],
  disc: [128, 32, 32], soft: [128, 32, 32],
};
const SIZE_OTHERS = [192, 32, 32];
/** Options of `render` for a page. */
const OPTIONS = { soft: ["--spread=5"], satin: ["--roughness=0.1"], brushed: ["--roughness=0.1,0.4"], frosted: ["--roughness=0.2"], matt: ["--roughness=0.8", "--energy-compensation"] };
/** The thickness of a film in nm. */
const THICKNESS = { soap: 333, frosted: 333 };
/** How a page's film varies over the body. */
const MAPS = { draining: "drain", swirls: "noise" };
/** The table of a page. */
const TABLE = { draining: "soap", swirls: "soap", soft: "disc", satin: "beetle", brushed: "beetle", frosted: "soap", matt: "gold" };

/** One page for each table. */
const pages = {};
let browser;
before(async () => {
  browser = await launch();
  writeFileSync(at("sky.hdr"), skyHdr());
});
after(() => browser.close());

async function compare(table, shape, light, view = {}) {
  const { page, complaints } = pages[table] ??= await visit(browser, `${table}.html`, SMALL);
  await page.evaluate(() => window.goniochrome.camera.reset());
  let environment = light;
  if (light === "image") {
    environment = "sky.hdr";
    await page.setInputFiles("#file", at(environment));
    await page.waitForFunction(() => window.goniochrome.state.light === "image");
  }
  const nm = THICKNESS[table];
  if (nm) await page.evaluate((nm) => window.goniochrome.setThickness(nm), nm);
  const [side, count, rays] = SIZE[table] ?? SIZE_OTHERS;
  const body = await picture(page, { shape, light, surroundings: false, ...view }, side, 1);
  const shown = await picture(page, { surroundings: true }, side, count);
  const words = Object.entries(view).map(([name, value]) => `--${name}=${value}`);
  run("render", `${TABLE[table] ?? table}.exr`, "-o", "offline.png", "--mesh", shape, "--env", environment, "--size", `${side}x${side}`,
    "--samples", String(rays), "--quiet", ...OPTIONS[table] ?? [], ...nm || MAPS[table] ? [`--thickness=${nm ?? MAPS[table]}`] : [], ...words);
  const { mean, largest, lit, covered } = await difference(browser, shown, fileUrl("offline.png"), body);
  const parts = `covered ${covered.toFixed(2)}, of it lit ${lit.toFixed(2)}`;
  console.log(`${table} ${shape} ${light}: mean ${mean.toFixed(3)}, largest ${largest}; ${parts}`);
  assert.deepEqual(complaints, []);
  assert.ok(covered > 0.1 && lit > 0.3, "the picture shows something");
  assert.ok(mean <= (MEAN[table] ?? MEAN_OTHERS), `${table} ${shape} ${light}: ${mean}`);
}

for (const light of ["white", "studio", "image"]) {
  test(`mirror-like, teapot, ${light}`, () => compare("beetle", "teapot", light));
}
test("mirror-like, sphere, studio", () => compare("beetle", "sphere", "studio", { azimuth: 20, elevation: 50 }));
test("mirror-like, plane, studio, from below", () =>
  compare("beetle", "plane", "studio", { azimuth: 100, elevation: -40 }));
for (const [shape, light] of [["sphere", "white"], ["sphere", "studio"], ["sphere", "image"], ["teapot", "studio"], ["plane", "lamp"]]) {
  test(`sheet, ${shape}, ${light}`, () => compare("soap", shape, light));
}
test("sheet, draining, sphere, studio", () => compare("draining", "sphere", "studio"));
test("sheet, swirls, teapot, studio", () => compare("swirls", "teapot", "studio"));
for (const [table, lights] of [["satin", ["white", "studio", "image", "lamp"]], ["brushed", ["lamp"]], ["gold", ["studio"]], ["facets", ["studio", "lamp"]], ["matt", ["studio", "lamp"]]]) {
  for (const light of lights) {
    test(`rough facets, ${table}, teapot, ${light}`, () => compare(table, "teapot", light));
  }
}
test("rough facets, brushed, sphere, image", () => compare("brushed", "sphere", "image", { azimuth: 20, elevation: 50 }));
test("rough facets, brushed, disc, lamp", () => compare("brushed", "disc", "lamp"));
test("rough facets, gold, plane from below, studio", () => compare("gold", "plane", "studio", { elevation: -40 }));
test("rough facets of a sheet, sphere, studio", () => compare("frosted", "sphere", "studio"));
for (const light of ["white", "studio", "lamp"]) {
  test(`scattering, teapot, ${light}`, () => compare("beetle-pits", "teapot", light));
}
test("scattering, sphere, image", () => compare("beetle-pits", "sphere", "image", { azimuth: 20, elevation: 50 }));
for (const light of ["white", "studio", "image"]) {
  test(`scattering with lobes of flat facets, teapot, ${light}`, () => compare("silicon-pyramids", "teapot", light));
}
for (const light of ["white", "studio", "image", "lamp"]) {
  test(`diffraction orders, disc, ${light}`, () => compare("disc", "disc", light));
}
test("diffraction orders, disc from above, lamp", () => compare("disc", "disc", "lamp", { azimuth: 20, elevation: 60 }));
test("diffraction orders, sphere, image", () => compare("disc", "sphere", "image", { azimuth: 20, elevation: 50 }));
test("diffraction orders, plane from below, studio", () => compare("disc", "plane", "studio", { elevation: -40 }));
for (const light of ["studio", "image", "lamp"]) {
  test(`diffraction orders of a width, disc, ${light}`, () => compare("soft", "disc", light));
}
