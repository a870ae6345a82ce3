// Tests of the page by what visitors do: they turn the body, point, switch, open files, and use a phone or a browser
// without WebGL2.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { at, bytesOf, launch, run, skyHdr, visit } from "./browser.mjs";

/** Largest size of the page of a 2D table, which fits into an e-mail. */
const MAX_BYTES = 2_000_000;
/** Error of the chart: tables are linear between whole degrees, and points are rounded to a tenth of a unit of 156. */
const BETWEEN_DEGREES = 0.01;

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

const view = (page) => page.evaluate(() => {
  const { camera, state } = window.goniochrome;
  return { azimuth: camera.azimuth, elevation: camera.elevation, zoom: camera.zoom, ...state };
});
/** The stage's picture as a data URL, after at least two pictures. */
async function pixels(page) {
  await page.waitForFunction(() => Number(document.getElementById("stage").dataset.drawn) >= 2);
  return page.evaluate(() => document.getElementById("stage").toDataURL());
}
async function changes(page, what, act) {
  const before = await pixels(page);
  await act();
  await page.waitForTimeout(400);
  assert.ok((await pixels(page)) !== before, `${what} changes the picture`);
}
async function middle(page, selector) {
  await page.locator(selector).scrollIntoViewIfNeeded();
  const box = await page.locator(selector).boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
}

test("the page of a 2D table is small", () => {
  console.log(`${bytesOf("beetle.html")} bytes; of a 4D table ${bytesOf("beetle-pits.html")}`);
  assert.ok(bytesOf("beetle.html") <= MAX_BYTES);
});

test("mouse, wheel and keyboard turn the body", async () => {
  const { page, complaints } = await visit(browser, "beetle.html");
  const [x, y] = await middle(page, "#stage");
  const start = await view(page);
  await changes(page, "dragging", async () => {
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 80, y + 30, { steps: 4 });
    await page.mouse.up();
  });
  const dragged = await view(page);
  assert.ok(dragged.azimuth < start.azimuth && dragged.elevation > start.elevation, JSON.stringify(dragged));
  await changes(page, "the wheel", () => page.mouse.wheel(0, -200));
  assert.ok((await view(page)).zoom > 1);
  await page.focus("#stage");
  await changes(page, "an arrow key", () => page.keyboard.press("ArrowLeft"));
  await changes(page, "minus", () => page.keyboard.press("-"));
  await page.keyboard.press("Home");
  const home = await view(page);
  assert.deepEqual([home.azimuth, home.elevation, home.zoom], [start.azimuth, start.elevation, 1]);
  assert.deepEqual(complaints, []);
  await page.context().close();
});

test("fingers turn and pinch, and a phone has no sideways scrolling", async () => {
  const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
  const { page, complaints } = await visit(browser, "beetle.html", phone);
  const widths = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(widths[0] <= widths[1], `${widths}`);
  const [x, y] = await middle(page, "#stage");
  const input = await page.context().newCDPSession(page);
  const touch = (type, ...points) =>
    input.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const start = await view(page);
  await changes(page, "a finger", async () => {
    await touch("touchStart", [x, y]);
    for (const step of [20, 40, 60]) await touch("touchMove", [x - step, y]);
    await touch("touchEnd");
  });
  assert.ok((await view(page)).azimuth > start.azimuth);
  await changes(page, "two fingers", async () => {
    await touch("touchStart", [x - 20, y], [x + 20, y]);
    for (const step of [30, 40, 50]) await touch("touchMove", [x - step, y], [x + step, y]);
    await touch("touchEnd");
  });
  assert.ok((await view(page)).zoom > 1.5);
  assert.deepEqual(complaints, []);
  await page.context().close();
});

test("the pointer draws the spectrum and the colour of the table", async () => {
  const { page, complaints } = await visit(browser, "beetle.html");
  const [x, y] = await middle(page, "#stage");
  for (const [dx, dy] of [[0, 0], [-90, 60], [40, -70]]) {
    await page.mouse.move(x + dx, y + dy);
    const read = await page.evaluate(() => {
      const points = document.querySelector("#spectrum .mean").getAttribute("points").split(" ");
      const { top, bottom } = { top: 12, bottom: 168 };
      return {
        theta: window.goniochrome.reading.theta,
        mean: points.map((point) => (bottom - Number(point.split(",")[1])) / (bottom - top)),
        swatch: getComputedStyle(document.getElementById("swatch")).backgroundColor.match(/\d+/g).map(Number),
      };
    });
    const theta = String(read.theta);
    const rows = run("spectrum", "jewel-beetle", "--theta", theta, "--quiet").trim().split("\n").slice(1);
    assert.equal(rows.length, read.mean.length);
    rows.forEach((row, i) => {
      const [, nm, s, p] = row.split(",").map(Number);
      const apart = Math.abs(0.5 * (s + p) - read.mean[i]);
      assert.ok(apart < BETWEEN_DEGREES, `${theta}°, ${nm} nm: ${apart}`);
    });
    const code = run("colour", "jewel-beetle", "--theta", theta, "--csv", "-", "--quiet").trim().split("\n")[1].split(",").pop();
    const wanted = [1, 3, 5].map((from) => Number.parseInt(code.slice(from, from + 2), 16));
    // The tolerance allows for linear interpolation between whole degrees.
    wanted.forEach((value, c) => assert.ok(Math.abs(value - read.swatch[c]) <= 3, `${theta}°: ${wanted} ${read.swatch}`));
  }
  await page.focus("#disc-field");
  const before = await page.textContent("#angle");
  await page.keyboard.press("ArrowUp");
  assert.notEqual(await page.textContent("#angle"), before);
  assert.deepEqual(complaints, []);
  await page.context().close();
});

test("bodies and lights are switched, and exposure and turn do something", async () => {
  const { page, complaints } = await visit(browser, "beetle.html");
  for (const value of ["sphere", "plane", "teapot", "white", "studio"]) {
    await changes(page, value, () => page.check(`input[value=${value}]`, { force: true }));
  }
  const slide = (id, value) => page.locator(id).fill(value);
  await changes(page, "exposure", () => slide("#exposure", "1.5"));
  await changes(page, "turning the light", () => slide("#turn", "90"));
  await changes(page, "the surroundings", () => page.check("#surroundings"));
  await page.click("#reset");
  assert.equal((await view(page)).exposure, 0);
  assert.deepEqual(complaints, []);
  await page.context().close();
});

test("environments are opened from files, and bad ones are refused in words", async () => {
  const { page, complaints } = await visit(browser, "beetle.html");
  const sky = skyHdr();
  const open = async (name, bytes) => {
    writeFileSync(at(name), bytes);
    await page.setInputFiles("#file", at(name));
    await page.waitForFunction((name) => new RegExp(`^${name}: `).test(document.getElementById("status").textContent), name);
    return page.textContent("#status");
  };
  assert.ok(await page.isDisabled("#light-image"));
  for (const [name, bytes, says] of [
    ["cut.hdr", sky.subarray(0, 500), "ends too early"],
    ["text.png", Buffer.from("no picture"), "not an image"],
    ["cut.exr", Buffer.from([0x76, 0x2f, 0x31, 1, 2, 0, 0, 0, 65]), "ends too early"],
  ]) {
    assert.match(await open(name, bytes), new RegExp(says));
    assert.ok(await page.isDisabled("#light-image"), name);
  }
  await changes(page, "an HDR file", async () => assert.match(await open("good.hdr", sky), /64 × 32/));
  assert.equal((await view(page)).light, "image");
  run("render", "beetle.exr", "-o", "picture.exr", "--mesh", "sphere", "--size", "64x32", "--samples", "4", "--quiet");
  await changes(page, "an EXR file", async () => {
    await page.setInputFiles("#file", at("picture.exr"));
    await page.waitForFunction(() => document.getElementById("status").textContent.startsWith("picture.exr: 64 × 32"));
  });
  assert.deepEqual(complaints, []);
  await page.context().close();
});

test("without WebGL2 the page says so, and spectra still work", async () => {
  const plain = await launch(["--disable-3d-apis"]);
  const { page } = await visit(plain, "beetle.html");
  assert.ok(await page.isVisible("#missing"));
  assert.match(await page.textContent("#missing"), /WebGL2 is missing/);
  assert.ok(await page.isDisabled("#save"));
  const [x, y] = await middle(page, "#disc-field");
  const before = await page.getAttribute("#spectrum .mean", "points");
  await page.mouse.move(x + 60, y);
  assert.ok((await page.getAttribute("#spectrum .mean", "points")) !== before, "the disc moves the reading");
  await plain.close();
});

test("a scattering table is read and shown too", async () => {
  const { page, complaints } = await visit(browser, "beetle-pits.html");
  await pixels(page);
  const [x, y] = await middle(page, "#disc-field");
  const disc = () => page.evaluate(() => document.getElementById("disc").toDataURL());
  const before = await disc();
  await page.mouse.move(x + 50, y + 20);
  assert.ok((await disc()) !== before, "the disc follows the direction");
  assert.deepEqual(complaints, []);
  await page.context().close();
});
