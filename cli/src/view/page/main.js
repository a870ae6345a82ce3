// The page: its controls, and the response to the visitor.

const $ = (id) => document.getElementById(id);
const data = JSON.parse($("data").textContent);
const table = new { mirror: MirrorTable, scatter: ScatterTable, orders: OrderTable }[data.table.kind](data.table);
data.shapes = Object.fromEntries(Object.entries(data.shapes).map(([name, shape]) => [name, new Shape(shape)]));
const camera = new Camera(data.view);
const stage = $("stage");
/** Roughness of the surface along its tangent and across; 0 is a mirror. */
const ownRoughness = data.table.facets
  ? TABULATED
  : (data.table.finish?.roughness ?? [0, 0]).map((alpha) => Number(alpha.toPrecision(4)));
const state = { shape: "teapot", light: "studio", exposure: 0, turn: 0, surroundings: false, roughness: ownRoughness };
/** First and last thickness of the layer that varies; `null` for one surface. */
const range = table.thickness && [table.thickness.nm[0], table.thickness.nm[table.thickness.nm.length - 1]];
/** Whether the thickness varies over the bodies; the slider then makes it more or less everywhere. */
const isMapped = Boolean(data.shapes.sphere.shares);
const ownThickness = range && (isMapped ? 0 : (range[0] + range[1]) / 2);
Object.assign(state, { thickness: ownThickness, layer: 0 });
if (range) {
  const [first, last] = range;
  Object.assign($("thickness"), isMapped ? { min: first - last, max: last - first } : { min: first, max: last });
  $("thickness-row").hidden = false;
}
// Discs are known from small lamps.
if (table.diffracts) Object.assign(state, { shape: "disc", light: "lamp" });
/** Lights that need no file. */
const LIGHTS_BUILT_IN = ["white", "studio", "lamp"];
/** The pointer that reads the surface: a place of the stage, from −1 to 1, or a direction of the disc. */
let pointed = { x: 0, y: 0 };
let reading = { theta: 0, phi: 0 };
let renderer = null;
let waiting = false;

const chart = new SpectrumChart($("spectrum"), table);
const disc = new Disc($("disc"), $("disc-marks"), table);

// ---- drawing

/** Milliseconds at rest after which pictures have all pixels; before, they are small enough to follow the hand. */
const AT_REST = 600;
const hand = { moved: -Infinity, scale: 1, timer: 0, frame: 0 };

function size(scale = 1) {
  const dense = Math.min(window.devicePixelRatio || 1, 2) * scale;
  return [Math.max(1, Math.round(stage.clientWidth * dense)), Math.max(1, Math.round(stage.clientHeight * dense))];
}

/** Adapts the size of pictures to the milliseconds from one to the next. */
function adapt(took) {
  if (took > 90) hand.scale = Math.max(0.2, 0.75 * hand.scale);
  else if (took < 30) hand.scale = Math.min(1, 1.1 * hand.scale);
}

function redraw(anew = true) {
  if (!renderer) return;
  if (anew) renderer.restart();
  if (!waiting) {
    waiting = true;
    requestAnimationFrame(frame);
  }
}

function frame(now) {
  waiting = false;
  if (!renderer || renderer.gl.isContextLost()) return;
  const moving = now - hand.moved < AT_REST;
  if (moving && now - hand.frame < 2000) adapt(now - hand.frame);
  hand.frame = now;
  renderer.resize(...size(moving ? hand.scale : 1));
  const more = renderer.advance(state, camera);
  stage.dataset.drawn = renderer.drawn;
  if (more) redraw(false);
}

function changed() {
  hand.moved = performance.now();
  clearTimeout(hand.timer);
  hand.timer = setTimeout(() => redraw(false), AT_REST + 50);
  redraw();
  read();
  keepAddress();
}

function start() {
  try {
    renderer = new Renderer(stage, data, table);
    if (image) renderer.setImage(image);
    $("missing").hidden = true;
    stage.hidden = false;
  } catch (error) {
    renderer = null;
    stage.hidden = true;
    $("missing").hidden = false;
    $("reason").textContent = `${error.message}.`;
    for (const control of document.querySelectorAll(".needs-stage")) control.disabled = true;
  }
}

stage.addEventListener("webglcontextlost", (event) => event.preventDefault());
stage.addEventListener("webglcontextrestored", () => { start(); redraw(); });
new ResizeObserver(() => { redraw(); read(); }).observe(stage);

// ---- reading the surface

function read() {
  if (pointed.theta !== undefined) {
    $("crosshair").hidden = true;
    reading = { theta: pointed.theta, phi: pointed.phi };
  } else {
    const [width, height] = [stage.clientWidth || 1, stage.clientHeight || 1];
    const { origin, direction } = camera.ray(pointed.x, pointed.y, width, height);
    const hit = data.shapes[state.shape].intersect(origin, direction);
    $("crosshair").style.left = `${50 + 50 * pointed.x}%`;
    $("crosshair").style.top = `${50 - 50 * pointed.y}%`;
    $("crosshair").hidden = !renderer;
    // Beside the body the last reading stays.
    if (hit) reading = anglesOf(hit, unit(plus(origin, hit.point, -1)));
    if (hit && isMapped) {
      table.setThickness(clamp(range[0] + hit.share * (range[1] - range[0]) + state.thickness, ...range));
      disc.drawn = false;
    }
  }
  showReading();
}

function showReading() {
  const { theta, phi } = reading;
  const rgb = table.rgb(theta, phi);
  const curves = table.curves(theta, phi);
  chart.draw(curves, theta);
  disc.draw(theta, phi);
  const colour = hex(rgb);
  $("swatch").style.background = colour;
  $("angle").textContent = `${theta.toFixed(1)}°`;
  $("azimuth").textContent = `${phi.toFixed(0)}°`;
  $("code").textContent = colour;
  $("share").textContent = `${(100 * luminance(rgb)).toFixed(1)} %`;
}

let announcing;
/** Announces the reading to screen readers once the pointer rests. */
function announce() {
  clearTimeout(announcing);
  announcing = setTimeout(() => {
    $("announcement").textContent =
      `${reading.theta.toFixed(0)} degrees from the normal: colour ${$("code").textContent}, reflects ${$("share").textContent}`;
  }, 600);
}

// ---- mouse, touch, keyboard on the stage

const pointers = new Map();
let pinch = 0;

function placeOf(event) {
  const box = stage.getBoundingClientRect();
  return { x: (2 * (event.clientX - box.left)) / box.width - 1, y: 1 - (2 * (event.clientY - box.top)) / box.height };
}

function spread() {
  const [a, b] = [...pointers.values()];
  return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
}

stage.addEventListener("pointerdown", (event) => {
  stage.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, event);
  if (pointers.size === 2) pinch = spread();
  pointed = placeOf(event);
  read();
  announce();
});

stage.addEventListener("pointermove", (event) => {
  const before = pointers.get(event.pointerId);
  if (!before) {
    pointed = placeOf(event);
    read();
    announce();
    return;
  }
  pointers.set(event.pointerId, event);
  if (pointers.size === 1) {
    const perPixel = 240 / Math.max(200, Math.min(stage.clientWidth, stage.clientHeight));
    camera.orbit((event.clientX - before.clientX) * perPixel, (before.clientY - event.clientY) * perPixel);
  } else if (pointers.size === 2) {
    const now = spread();
    camera.zoomBy(now / Math.max(1, pinch));
    pinch = now;
  }
  changed();
});

for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, (event) => pointers.delete(event.pointerId));

stage.addEventListener("wheel", (event) => {
  event.preventDefault();
  camera.zoomBy(Math.exp(-0.0015 * event.deltaY));
  changed();
}, { passive: false });

stage.addEventListener("dblclick", () => { camera.reset(); changed(); });

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

stage.addEventListener("keydown", (event) => {
  const arrow = ARROWS[event.key];
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (arrow && event.shiftKey) {
    const from = pointed.theta === undefined ? pointed : { x: 0, y: 0 };
    pointed = { x: clamp(from.x + 0.04 * arrow[0], -1, 1), y: clamp(from.y + 0.04 * arrow[1], -1, 1) };
  } else if (arrow) camera.orbit(6 * arrow[0], 6 * arrow[1]);
  else if (event.key === "+" || event.key === "=") camera.zoomBy(1.1);
  else if (event.key === "-") camera.zoomBy(1 / 1.1);
  else if (event.key === "Home" || event.key === "0") camera.reset();
  else return;
  event.preventDefault();
  changed();
  announce();
});

// ---- the disc

$("disc-field").addEventListener("pointerdown", (event) => pointAtDisc(event));
$("disc-field").addEventListener("pointermove", (event) => pointAtDisc(event));
$("disc-field").addEventListener("keydown", (event) => {
  const arrow = ARROWS[event.key];
  if (!arrow) return;
  event.preventDefault();
  const theta = clamp(reading.theta + 2 * arrow[1], 0, 89.9);
  pointed = { theta, phi: (reading.phi - 5 * arrow[0] + 360) % 360 };
  read();
  announce();
});

function pointAtDisc(event) {
  const direction = disc.at(event);
  if (!direction) return;
  pointed = direction;
  read();
  announce();
}

// ---- controls

/** Roughness at a place of its slider, whose steps are small where the roughness is. */
const roughnessAt = (place) => (place ** 2 < MIN_ROUGHNESS ? 0 : Number((place ** 2).toPrecision(2)));

/** Makes the layer so thick, or so much thicker than it is somewhere. */
function setThickness(nm) {
  if (!range) return;
  const [first, last] = range;
  state.thickness = nm;
  state.layer = isMapped ? nm / (last - first) : table.layerOf(nm);
  table.setThickness(isMapped ? (first + last) / 2 + nm : nm);
  renderer?.finished.setFinish(table.finish);
  disc.drawn = false;
  setLabels();
}

function setLabels() {
  const nm = Math.round(state.thickness ?? 0);
  const sign = isMapped ? (nm > 0 ? "+" : nm === 0 ? "±" : "") : "";
  if (range) $("thickness-value").textContent = `${sign}${nm} nm`;
  $("roughness-value").textContent = state.roughness[0] ?? "the table’s";
  $("across-value").textContent = state.roughness[1];
  $("exposure-value").textContent = `${state.exposure > 0 ? "+" : ""}${state.exposure.toFixed(1)} EV`;
  $("turn-value").textContent = `${state.turn.toFixed(0)}°`;
}

function showState() {
  for (const name of ["shape", "light"]) {
    for (const radio of document.querySelectorAll(`input[name=${name}]`)) radio.checked = radio.value === state[name];
  }
  [$("exposure").value, $("turn").value, $("surroundings").checked] = [state.exposure, state.turn, state.surroundings];
  if (range) {
    setThickness(state.thickness);
    $("thickness").value = state.thickness;
  }
  const { roughness: [along = 0, across = 0] } = state;
  [$("roughness").value, $("across").value] = [along, across].map(Math.sqrt);
  $("brushed").checked = state.roughness[0] !== state.roughness[1];
  setFinish(state.roughness);
}

/** Makes the surface as rough as that. */
function setFinish(roughness) {
  state.roughness = roughness;
  setLabels();
  if (!table.finish) return;
  table.alpha = Finish.alpha(roughness);
  $("across-row").hidden = !$("brushed").checked;
  // Facets mix s and p.
  $("legend").hidden = table.alpha !== null;
  disc.drawn = false;
}

for (const name of ["shape", "light"]) {
  for (const radio of document.querySelectorAll(`input[name=${name}]`)) {
    radio.addEventListener("change", () => {
      state[name] = radio.value;
      changed();
    });
  }
}
for (const name of ["exposure", "turn"]) {
  $(name).addEventListener("input", () => {
    state[name] = Number($(name).value);
    setLabels();
    if (name === "turn") changed();
    else { redraw(false); keepAddress(); }
  });
}
$("thickness").addEventListener("input", () => {
  setThickness(Number($("thickness").value));
  changed();
});
for (const id of ["roughness", "across", "brushed"]) {
  $(id).addEventListener("input", () => {
    const along = id === "roughness" ? roughnessAt($(id).value) : state.roughness[0];
    const across = id === "across" ? roughnessAt($(id).value) : state.roughness[1];
    setFinish([along, $("brushed").checked ? across : along]);
    $("across").value = Math.sqrt(state.roughness[1]);
    changed();
  });
}
$("surroundings").addEventListener("change", () => { state.surroundings = $("surroundings").checked; changed(); });
$("reset").addEventListener("click", () => {
  camera.reset();
  Object.assign(state, { exposure: 0, turn: 0, roughness: ownRoughness, thickness: ownThickness });
  pointed = { x: 0, y: 0 };
  showState();
  changed();
});
$("save").addEventListener("click", () => {
  const link = document.createElement("a");
  link.download = "view.png";
  link.href = renderer.picture(state, camera, ...size());
  link.click();
  redraw();
});

let image = null;

async function open(file) {
  if (!file) return;
  const status = $("status");
  status.textContent = `Reading ${file.name} …`;
  try {
    const opened = await decodeImage(file);
    image = opened;
    renderer?.setImage(opened);
    $("light-image").disabled = false;
    state.light = "image";
    showState();
    changed();
    const mended = opened.mended ? `; ${opened.mended} components that were no radiance are mended` : "";
    const stretched = opened.width === 2 * opened.height ? "" : "; it is not twice as wide as high, and is stretched around the sphere";
    status.textContent = `${file.name}: ${opened.width} × ${opened.height}${stretched}${mended}`;
  } catch (error) {
    status.textContent = `${file.name}: ${error.message}.`;
  }
}

$("file").addEventListener("change", () => { open($("file").files[0]); $("file").value = ""; });
document.addEventListener("dragover", (event) => event.preventDefault());
document.addEventListener("drop", (event) => { event.preventDefault(); open(event.dataTransfer.files[0]); });

// ---- the address keeps the view

const KEPT = ["azimuth", "elevation", "zoom"];
let keeping;

function keepAddress() {
  clearTimeout(keeping);
  keeping = setTimeout(() => {
    const kept = new URLSearchParams({ shape: state.shape, light: LIGHTS_BUILT_IN.includes(state.light) ? state.light : "studio" });
    for (const name of KEPT) kept.set(name, Number(camera[name].toFixed(3)));
    for (const name of ["exposure", "turn"]) if (state[name]) kept.set(name, state[name]);
    if (range && state.thickness !== ownThickness) kept.set("thickness", Number(state.thickness.toFixed(1)));
    if (state.roughness.join() !== ownRoughness.join()) kept.set("roughness", state.roughness.join());
    if (state.surroundings) kept.set("surroundings", "1");
    history.replaceState(null, "", `#${kept}`);
  }, 300);
}

function followAddress() {
  const kept = new URLSearchParams(location.hash.slice(1));
  const number = (name, low, high) => {
    const value = Number(kept.get(name));
    return kept.has(name) && Number.isFinite(value) ? clamp(value, low, high) : undefined;
  };
  if (kept.get("shape") in data.shapes) state.shape = kept.get("shape");
  if (LIGHTS_BUILT_IN.includes(kept.get("light"))) state.light = kept.get("light");
  camera.azimuth = number("azimuth", -360, 360) ?? camera.azimuth;
  camera.elevation = number("elevation", -89.9, 89.9) ?? camera.elevation;
  camera.zoom = number("zoom", 0.4, 4) ?? camera.zoom;
  state.exposure = number("exposure", -6, 6) ?? state.exposure;
  state.turn = number("turn", -180, 180) ?? state.turn;
  if (range) state.thickness = number("thickness", Number($("thickness").min), Number($("thickness").max)) ?? state.thickness;
  const roughness = (kept.get("roughness") ?? "").split(",").map(Number);
  if (table.finish && roughness.length === 2 && roughness.every((alpha) => alpha >= 0 && alpha <= 1)) state.roughness = roughness;
  if (kept.has("surroundings")) state.surroundings = kept.get("surroundings") === "1";
}

window.addEventListener("hashchange", () => { followAddress(); showState(); redraw(); read(); });

// ---- begin

const { facts } = data.table;
$("grid").textContent = `${table.about.grid}; ${facts.model || "physical"} model, light ${facts.illuminant || "D65"}`;
$("spectrum-title").textContent = table.about.spectrum;
$("legend").hidden = table.turns;
for (const control of document.querySelectorAll(".of-finish")) control.hidden = !table.finish;
$("disc-title").textContent = table.about.disc;
followAddress();
showState();
start();
redraw();
read();
/** For tests, and for the curious. */
window.goniochrome = {
  state, camera, table, setThickness, get renderer() { return renderer; }, get reading() { return reading; },
};
