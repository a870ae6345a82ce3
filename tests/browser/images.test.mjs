// Tests of the page's own readers of pictures against the formats' specifications, without a browser.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import vm from "node:vm";

const scripts = ["basics.js", "exr.js", "images.js"].map((name) => readFileSync(`${process.env.PAGE}/${name}`, "utf8"));
const program = `${scripts.join("\n")};({ decodeHdr, exrSources, toRec709 })`;
const { decodeHdr, exrSources, toRec709 } = vm.runInNewContext(program, { Uint8Array, Float32Array });

/** An HDR file of a header and stored pixels, whose default mantissas are 128, 64 and the pixel's number. */
function hdr(header, resolution, stored = Buffer.from([...Array(8).keys()].flatMap((i) => [128, 64, i, 136]))) {
  return new Uint8Array(Buffer.concat([Buffer.from(`${header}\n${resolution}\n`), stored]));
}
const RGBE = "#?RGBE\nFORMAT=32-bit_rle_rgbe\n";
const blues = (image) => [...image.rgb].filter((_, i) => i % 3 === 2);

test("HDR files of every orientation are upright", () => {
  const orders = {
    "-Y 2 +X 4": "01234567",
    "+Y 2 +X 4": "45670123",
    "-Y 2 -X 4": "32107654",
    "+Y 2 -X 4": "76543210",
    "+X 4 -Y 2": "02461357",
    "-X 4 -Y 2": "64207531",
    "+X 4 +Y 2": "13570246",
    "-X 4 +Y 2": "75316420",
  };
  for (const [resolution, order] of Object.entries(orders)) {
    const image = decodeHdr(hdr(RGBE, resolution));
    assert.equal(blues(image).join(""), order, resolution);
    assert.deepEqual([image.width, image.height], [4, 2]);
  }
});

test("HDR exposures and colour corrections are divided out", () => {
  const header = `${RGBE}EXPOSURE=2\npcomb a.hdr\n\tEXPOSURE=99\nEXPOSURE= 4.0 \nCOLORCORR=1 2 0.5\r\n`;
  assert.deepEqual([...decodeHdr(hdr(header, "-Y 2 +X 4")).rgb.slice(18, 21)], [16, 4, 1.5]);
  const photoshop = `${RGBE}GAMMA=1\nPRIMARIES=0 0 0 0 0 0 0 0\n`;
  assert.equal(decodeHdr(hdr(photoshop, "-Y 2 +X 4")).primaries, undefined);
  for (const line of ["EXPOSURE=0", "EXPOSURE=x", "COLORCORR=1 1", "GAMMA=2.2", "FORMAT=32-bit_rle_xyze"]) {
    assert.throws(() => decodeHdr(hdr(`${RGBE}${line}\n`, "-Y 2 +X 4")), { message: new RegExp(line) });
  }
});

test("HDR runs of both codings", () => {
  const old = Buffer.from([9, 8, 7, 136, 1, 1, 1, 87, 1, 1, 1, 2]);
  assert.ok(blues(decodeHdr(hdr(RGBE, "-Y 1 +X 600", old))).every((x) => x === 7));
  const coded = Buffer.from([2, 2, 0, 8, 136, 9, 136, 8, 3, 1, 2, 3, 133, 7, 136, 136]);
  assert.deepEqual(blues(decodeHdr(hdr(RGBE, "-Y 1 +X 8", coded))), [1, 2, 3, 7, 7, 7, 7, 7]);
  for (const stored of [old.subarray(0, 11), coded.subarray(0, 15), Buffer.from([1, 1, 1, 2]), Buffer.from([2, 2, 0, 9])]) {
    const width = stored[0] === 2 || stored.length === 15 ? 8 : 600;
    assert.throws(() => decodeHdr(hdr(RGBE, `-Y 1 +X ${width}`, stored)), /ends too early|wrong length/);
  }
});

test("EXR channels are found in layers", () => {
  const sources = (...names) => Object.fromEntries(exrSources(names.map((name) => ({ name }))));
  assert.deepEqual(JSON.stringify(sources("A", "B", "G", "R")), '{"R":[0],"G":[1],"B":[2]}');
  const passes = ["V.Combined.R", "V.Combined.G", "V.Combined.B", "V.Emit.R", "V.Emit.G", "V.Emit.B"];
  assert.deepEqual(Object.keys(sources(...passes))[0], "V.Combined.R");
  assert.deepEqual(JSON.stringify(sources("grey.Y")), '{"grey.Y":[0,1,2]}');
  assert.throws(() => sources("a.R", "a.G", "a.B", "b.R", "b.G", "b.B"), /holds 2 pictures: a, b/);
  assert.throws(() => sources("N.X", "N.Y", "N.Z"), /this one has N.X, N.Y, N.Z/);
});

test("primaries of Rec. 2020 are converted as BT.2087 says", () => {
  const rows = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
  const found = toRec709([0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329]);
  found.flat().forEach((x, i) => assert.ok(Math.abs(x - rows.flat()[i]) < 2e-4, `${found}`));
});
