// Tests of the page of scattering bodies: the first picture, and light from everywhere.

import { after, before, test } from "node:test";
import { checkSamples, launch } from "./browser.mjs";

/** Largest mean difference of 8-bit values of the first picture, whose light is blurred most, from the sum of many. */
const FIRST = 3;

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

for (const table of ["beetle-pits", "silicon-pyramids"]) {
  test(`samples of ${table}`, () => checkSamples(browser, table, FIRST));
}
