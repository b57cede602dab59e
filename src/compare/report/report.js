"use strict";
// Draws the page from the figures in #data: the viewer, the tables, the maps. Loads nothing.
const { circumstances, inputs } = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);
const make = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};
let input = inputs[0];

// ------------------------------------------------------------------------------------------ numbers

function short(v) {
  if (v === null || v === undefined || Number.isNaN(v)) return "–";
  const a = Math.abs(v);
  if (a < 1e-6) return "0";
  if (a >= 99.5) return v.toFixed(0);
  if (a >= 9.95) return v.toFixed(1);
  if (a >= 0.0995) return v.toFixed(2);
  if (a >= 0.00005) return v.toFixed(4);
  return v.toExponential(0);
}
const percent = (v) => (v === null || v === undefined ? "–" : v === 0 ? "0" : short(100 * v));
const plural = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;

// ------------------------------------------------------------------------------------------- errors

// Inferno, in nine steps (van der Walt & Smith): dark is right, bright is wrong.
const STOPS = [[0, 0, 4], [27, 12, 65], [74, 12, 107], [120, 28, 109], [165, 44, 96], [207, 68, 70], [237, 105, 37], [251, 155, 6], [252, 255, 164]];
const RAMP = Array.from({ length: 256 }, (_, i) => {
  const at = (i / 255) * (STOPS.length - 1), k = Math.min(Math.floor(at), STOPS.length - 2);
  return STOPS[k].map((c, j) => Math.round(c + (STOPS[k + 1][j] - c) * (at - k)));
});
const levelsOf = (grey) => 2 ** (grey / (255 / 8)) - 1;
const placeOf = (levels) => Math.log2(1 + levels) / 8;

for (const legend of document.querySelectorAll(".legend")) {
  const ramp = make("div", { className: "ramp" });
  ramp.style.background = `linear-gradient(90deg, ${STOPS.map((c) => `rgb(${c})`).join(",")})`;
  const scale = make("div", { className: "scale" });
  for (const [levels, text] of [[0, "0"], [0.5, ".5"], [1, "1"], [4, "4"], [16, "16"], [64, "64"], [255, "255 levels"]]) {
    const tick = make("span", { textContent: text });
    tick.style.left = `${100 * placeOf(levels)}%`;
    scale.append(tick);
  }
  legend.append(ramp, scale);
}

// ------------------------------------------------------------------------------------------- images

const canvases = new Map();
async function canvasOf(uri, colour) {
  const key = (colour ? "e" : "p") + uri;
  if (!canvases.has(key)) canvases.set(key, load(uri, colour));
  return canvases.get(key);
}
async function load(uri, colour) {
  const image = new Image();
  image.src = uri;
  await image.decode();
  const canvas = make("canvas", { width: image.naturalWidth, height: image.naturalHeight });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  const pixels = context.getImageData(0, 0, canvas.width, canvas.height);
  canvas.raw = new Uint8ClampedArray(pixels.data);
  if (colour) {
    for (let i = 0; i < pixels.data.length; i += 4) pixels.data.set(RAMP[pixels.data[i]], i);
    context.putImageData(pixels, 0, 0);
  }
  return canvas;
}

// ------------------------------------------------------------------------------------------- viewer

const view = { mode: "slider", left: -1, right: -1, split: 0.5, zoom: 1, x: 0, y: 0, fit: true, spot: null, pictures: [null, null], errors: [null, null] };
const stage = $("stage"), canvas = $("canvas"), divider = $("divider");
const nameOf = (i) => (i < 0 ? "reference" : input.records[i].method);
const shown = () => input.records.map((_, i) => i).filter((i) => input.pictures[i]);

async function choose(left, right) {
  [view.left, view.right] = [left, right];
  [$("left").value, $("right").value] = [left, right];
  const wanted = input;
  const picture = (i) => canvasOf(i < 0 ? input.truth : input.pictures[i], false);
  const error = (i) => (i < 0 ? null : canvasOf(input.errors[i], true));
  const loaded = await Promise.all([picture(left), picture(right), error(left), error(right)]);
  if (wanted !== input || view.left !== left || view.right !== right) return;
  view.pictures = loaded.slice(0, 2);
  view.errors = loaded.slice(2);
  view.spot = null;
  listSpots();
  draw();
}

// How large a pane is, in CSS pixels.
function pane() {
  const { clientWidth: width, clientHeight: height } = stage;
  return { width: view.mode === "side" ? width / 2 : width, height };
}
function fit() {
  const { width, height } = pane();
  view.zoom = Math.min(width / input.part.width, height / input.part.height);
  if (view.zoom > 1) view.zoom = Math.floor(view.zoom);
  [view.x, view.y, view.fit] = [input.part.width / 2, input.part.height / 2, true];
}
// The picture's pixel under a place on the stage, and which of the two pictures.
function under(px, py) {
  const { width, height } = pane();
  const second = view.mode === "side" ? px >= width : px >= view.split * width;
  const x = view.mode === "side" && second ? px - width : px;
  return { x: (x - width / 2) / view.zoom + view.x, y: (py - height / 2) / view.zoom + view.y, second };
}
function draw() {
  const ratio = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = stage;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.imageSmoothingEnabled = view.zoom < 1;
  const layers = view.mode === "error" ? view.errors : view.pictures;
  const panes = view.mode === "side"
    ? [[0, 0, width / 2, width / 4], [1, width / 2, width / 2, (3 * width) / 4]]
    : [[0, 0, view.split * width, width / 2], [1, view.split * width, (1 - view.split) * width, width / 2]];
  for (const [k, left, across, middle] of panes) {
    context.save();
    context.beginPath();
    context.rect(left, 0, across, height);
    context.clip();
    const x = middle - view.x * view.zoom, y = height / 2 - view.y * view.zoom;
    const { width: w, height: h } = input.part;
    if (layers[k]) context.drawImage(layers[k], x, y, w * view.zoom, h * view.zoom);
    else if (view.mode === "error") { context.fillStyle = `rgb(${STOPS[0]})`; context.fillRect(x, y, w * view.zoom, h * view.zoom); }
    if (view.spot) ring(context, x + (view.spot.x + 0.5) * view.zoom, y + (view.spot.y + 0.5) * view.zoom);
    context.restore();
  }
  if (view.mode === "side") { context.fillStyle = "#8889"; context.fillRect(width / 2 - 1, 0, 2, height); }
  place(width);
}
function ring(context, x, y) {
  const radius = Math.max(12, view.zoom * 0.5 * Math.SQRT2 + 6);
  for (const [colour, line] of [["#000a", 5], ["#fff", 2.5]]) {
    context.strokeStyle = colour;
    context.lineWidth = line;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.stroke();
  }
}
function place(width) {
  divider.hidden = view.mode === "side";
  divider.style.left = `${view.split * width}px`;
  divider.setAttribute("aria-valuenow", Math.round(100 * view.split));
  const error = view.mode === "error" ? "error of " : "";
  $("tag-left").textContent = error + nameOf(view.left);
  $("tag-right").textContent = error + nameOf(view.right);
  document.querySelector("#look .legend").hidden = view.mode !== "error";
  for (const button of $("zoom").children) {
    const pressed = button.dataset.zoom === "fit" ? view.fit : !view.fit && Number(button.dataset.zoom) === view.zoom;
    button.setAttribute("aria-pressed", pressed);
  }
  for (const button of $("mode").children) button.setAttribute("aria-pressed", button.dataset.mode === view.mode);
}
function zoomTo(zoom, px, py) {
  const { width, height } = pane();
  [px, py] = [px ?? width / 2, py ?? height / 2];
  const at = under(px, py), next = Math.min(64, Math.max(0.05, zoom));
  if (view.mode === "side" && px >= width) px -= width;
  view.x = at.x - (px - width / 2) / next;
  view.y = at.y - (py - height / 2) / next;
  [view.zoom, view.fit] = [next, false];
  draw();
}
function listSpots() {
  const list = $("spots");
  list.replaceChildren();
  // The worse of the two is the one to look at.
  const rms = (i) => (i < 0 ? -1 : input.records[i].error.rms);
  const worse = rms(view.left) > rms(view.right) ? view.left : view.right;
  const inside = (s) => s.x >= input.part.x && s.y >= input.part.y && s.x < input.part.x + input.part.width && s.y < input.part.y + input.part.height;
  const spots = worse < 0 ? [] : input.records[worse].worst.filter(inside);
  if (!spots.length) return;
  list.append(`Worst of ${nameOf(worse)} (column, row · levels):`);
  for (const spot of spots) {
    const button = make("button", { type: "button", textContent: `${spot.x}, ${spot.y} · ${short(spot.error)}`, title: `column ${spot.x}, row ${spot.y}: off by ${short(spot.error)} levels` });
    button.onclick = () => {
      view.spot = { x: spot.x - input.part.x, y: spot.y - input.part.y };
      // Beside the line, on the side of the picture that errs.
      const aside = view.mode === "side" ? 0 : worse === view.left ? 4 : -4;
      [view.x, view.y, view.zoom, view.fit, view.split] = [view.spot.x + 0.5 + aside, view.spot.y + 0.5, 16, false, 0.5];
      for (const other of list.querySelectorAll("button")) other.setAttribute("aria-pressed", other === button);
      draw();
    };
    list.append(button);
  }
}
function read(px, py) {
  const at = under(px, py), x = Math.floor(at.x), y = Math.floor(at.y);
  const { width, height } = input.part;
  const readout = $("readout");
  if (x < 0 || y < 0 || x >= width || y >= height || !view.pictures[0]) { readout.textContent = "Point at a pixel to read it."; return; }
  const at4 = 4 * (y * width + x);
  readout.replaceChildren(`column ${x + input.part.x}, row ${y + input.part.y}`);
  [view.left, view.right].forEach((which, k) => {
    const [r, g, b, a] = view.pictures[k].raw.slice(at4, at4 + 4);
    const swatch = make("i");
    swatch.style.background = `rgb(${r} ${g} ${b} / ${a / 255})`;
    const off = which < 0 ? "" : `, off by ${short(levelsOf(view.errors[k].raw[at4]))}`;
    readout.append(swatch, `${nameOf(which)} ${r} ${g} ${b}${a < 255 ? ` / ${a}` : ""}${off}`);
  });
}

const pointers = new Map();
let grip = null;
const local = (event) => { const box = stage.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
stage.addEventListener("pointerdown", (event) => {
  const [px, py] = local(event);
  stage.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, [px, py]);
  grip = event.target === divider ? "divider" : "picture";
  stage.classList.toggle("moving", grip === "picture");
});
stage.addEventListener("pointermove", (event) => {
  const [px, py] = local(event), before = pointers.get(event.pointerId);
  if (!before) return read(px, py);
  if (grip === "divider") {
    setSplit(px / stage.clientWidth);
  } else if (pointers.size === 2) {
    const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
    const spread = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]);
    zoomTo((view.zoom * spread([px, py])) / Math.max(1, spread(before)), (px + other[0]) / 2, (py + other[1]) / 2);
  } else {
    view.x -= (px - before[0]) / view.zoom;
    view.y -= (py - before[1]) / view.zoom;
    view.fit = false;
    draw();
  }
  pointers.set(event.pointerId, [px, py]);
});
for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, (event) => { pointers.delete(event.pointerId); stage.classList.remove("moving"); });
stage.addEventListener("wheel", (event) => {
  // Until it is clicked, the wheel turns the page.
  if (!stage.contains(document.activeElement) && !event.ctrlKey) return;
  event.preventDefault();
  zoomTo(view.zoom * 2 ** (-event.deltaY / 300), ...local(event));
}, { passive: false });
function setSplit(split) { view.split = Math.min(1, Math.max(0, split)); draw(); }
divider.addEventListener("keydown", (event) => {
  const step = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 }[event.key];
  if (step) { event.preventDefault(); setSplit(view.split + step); }
});
$("mode").onclick = (event) => {
  if (!event.target.dataset.mode) return;
  view.mode = event.target.dataset.mode;
  if (view.fit) fit();
  draw();
};
$("zoom").onclick = (event) => {
  const zoom = event.target.dataset.zoom;
  if (zoom === "fit") { fit(); draw(); } else if (zoom) zoomTo(Number(zoom));
};
$("left").onchange = $("right").onchange = () => choose(Number($("left").value), Number($("right").value));
$("swap").onclick = () => choose(view.right, view.left);
new ResizeObserver(() => { if (view.fit) fit(); draw(); }).observe(stage);
function lookAt(index, mode) {
  if (mode) view.mode = mode;
  choose(index, view.right === index ? -1 : view.right);
  $("look").scrollIntoView({ behavior: "smooth", block: "start" });
}

// ------------------------------------------------------------------------------------------- tables

const METHOD = ["method", "How edges are smoothed", (r) => r.method, (v) => v];
const COLUMNS = [
  METHOD,
  ["ms", "Scene to pixels, median", (r) => r.raster_ms?.median, short],
  ["±", "Distance between the quartiles", (r) => r.raster_ms?.spread, short, "plain"],
  ["× exact", "Time in that of exact, the median over interleaved runs", (r) => r.times.exact, short, "plain"],
  ["× tiny-skia", "Time in that of tiny-skia, the median over interleaved runs", (r) => r.times["tiny-skia"], short, "plain"],
  ["mean", "Mean error, levels", (r) => r.error?.mean, short],
  ["rms", "Root mean square error, levels", (r) => r.error?.rms, short],
  ["worst", "Largest error, levels", (r) => r.error?.max, short],
  ["> .5 %", "Pixels off by more than half a level", (r) => r.error?.over_half, percent],
  ["> 1 %", "Pixels off by more than 1 level", (r) => r.error?.over_1, percent],
  ["> 4 %", "Pixels off by more than 4 levels", (r) => r.error?.over_4, percent],
  ["> 16 %", "Pixels off by more than 16 levels", (r) => r.error?.over_16, percent],
  ["PSNR", "Peak signal to noise ratio, dB; more is better", (r) => r.error?.psnr, short, "plain"],
  ["SSIM", "Structural similarity; 1 is alike", (r) => r.error?.ssim, (v) => (v ?? null) === null ? "–" : v.toFixed(5), "plain"],
  ["FLIP", "LDR-FLIP; 0 is alike", (r) => r.error?.flip, short],
  ["seam", "Mean error where the reference is flat all around, levels", (r) => r.seams?.mean, short],
  ["seam worst", "Largest error where the reference is flat all around, levels", (r) => r.seams?.max, short],
];
const MOTION = [
  METHOD,
  ["light / step", "Light gained or lost from one step to the next, mean, in fully lit pixels", (r) => r.pan?.light_step, short],
  ["at most", "The largest of these", (r) => r.pan?.light_step_max, short],
  ["light beyond the reference's", "Total light at each step", (r) => r.pan?.light, null],
  ["flicker", "Standard deviation over time of a pixel's error, mean over pixels that move, levels", (r) => r.pan?.flicker, short],
  ["most", "The most that a pixel flickers, levels", (r) => r.pan?.flicker_max, short],
  ["> 4 %", "Pixels that flicker by more than 4 levels, of those that move", (r) => r.pan?.flicker_over_4, percent],
];

function table(element, columns, rows, order) {
  const usable = columns.filter((c) => c === METHOD || rows.some(({ r }) => (c[2](r) ?? null) !== null));
  const state = { column: usable.find((c) => c[0] === order) ?? METHOD, up: true };
  const heads = usable.map((column) => {
    const button = make("button", { type: "button", textContent: column[0], title: column[1] });
    const head = make("th", { scope: "col" }, button);
    button.onclick = () => {
      state.up = state.column === column ? !state.up : true;
      state.column = column;
      fill();
    };
    return head;
  });
  element.tHead.replaceChildren(make("tr", {}, ...heads));
  function fill() {
    heads.forEach((head, i) => {
      if (usable[i] === state.column) head.setAttribute("aria-sort", state.up ? "ascending" : "descending");
      else head.removeAttribute("aria-sort");
    });
    const value = ({ r }) => state.column[2](r);
    const sorted = [...rows].sort((p, q) => {
      const [a, b] = [value(p), value(q)];
      // What was not measured stays at the end.
      if ((a ?? null) === null || (b ?? null) === null) return ((a ?? null) === null) - ((b ?? null) === null);
      const by = typeof a === "string" ? a.localeCompare(b, "en", { numeric: true }) : Array.isArray(a) ? 0 : a - b;
      return state.up ? by : -by;
    });
    element.tBodies[0].replaceChildren(...sorted.map((row) => line(row, usable, rows)));
  }
  fill();
}
function line({ r, i, best }, columns, rows) {
  const name = make("td", {}, make("span", { className: best ? "mark" : "mark off", title: best ? "No other method betters it in both time and error" : "" }));
  if (input.pictures[i]) name.append(make("button", { type: "button", className: "name", textContent: r.method, onclick: () => lookAt(i) }));
  else name.append(r.method);
  if (r.failed !== null) return make("tr", {}, name, make("td", { className: "why", colSpan: columns.length - 1, textContent: r.failed }));
  const cells = columns.slice(1).map(([, , get, format, plain]) => {
    const value = get(r);
    if (!format) return make("td", { innerHTML: value ? spark(value, rows) : "–" });
    const cell = make("td", { textContent: format(value) });
    const all = rows.map(({ r }) => get(r)).filter((v) => v > 1e-6);
    if (!plain && value > 1e-6 && all.length > 1) {
      const [low, high] = [Math.log(Math.min(...all)), Math.log(Math.max(...all))];
      const share = high > low ? 0.06 + (0.94 * (Math.log(value) - low)) / (high - low) : 0;
      cell.className = "meter";
      cell.style.backgroundSize = `${100 * share}% 100%`;
    }
    return cell;
  });
  return make("tr", {}, name, ...cells);
}
// Light over time, all methods on one scale.
function spark(light, rows) {
  const most = Math.max(1e-6, ...rows.flatMap(({ r }) => r.pan ? r.pan.light.map((v) => Math.abs(v - r.pan.light[0])) : []));
  const points = light.map((v, i) => `${(2 + (146 * i) / (light.length - 1)).toFixed(1)},${(15 - (13 * (v - light[0])) / most).toFixed(1)}`);
  return `<svg viewBox="0 0 150 30" preserveAspectRatio="none"><path class="zero" d="M0 15H150"/><polyline points="${points.join(" ")}"/></svg>`;
}

// --------------------------------------------------------------------------------------------- page

function onFront(measure) {
  const rows = input.records.map((r, i) => ({ i, x: r.raster_ms?.median, y: measure(r) })).filter((p) => p.x !== undefined && p.y !== undefined);
  return new Set(rows.filter((p) => !rows.some((q) => (q.x <= p.x && q.y < p.y) || (q.x < p.x && q.y <= p.y))).map((p) => p.i));
}
function cards() {
  const measured = input.records.filter((r) => r.error);
  const least = (get) => measured.filter((r) => get(r) !== undefined).sort((a, b) => get(a) - get(b))[0];
  const best = least((r) => r.error.rms), fast = least((r) => r.raster_ms?.median);
  const seams = [...measured].sort((a, b) => b.seams.over_1 * b.seams.flat - a.seams.over_1 * a.seams.flat)[0];
  const list = [
    ["Most exact", best.method, `rms ${short(best.error.rms)}, worst ${short(best.error.max)} levels`],
    fast && ["Fastest", fast.method, `${short(fast.raster_ms.median)} ms, rms ${short(fast.error.rms)}`],
    ["Most seams", seams.seams.over_1 ? seams.method : "nowhere", seams.seams.over_1 ? `${percent(seams.seams.over_1 * seams.seams.flat)} % of all pixels wrong where nothing is to be seen` : "flat areas are flat in every picture"],
    ["Pixels with edges", `${percent(input.records[0].reference.edge_pixels / (input.width * input.height))} %`, `of ${input.width} × ${input.height}`],
  ];
  $("cards").replaceChildren(...list.filter(Boolean).map(([head, value, more]) =>
    make("div", { className: "card" }, make("small", { textContent: head }), make("b", { textContent: value }), make("small", { textContent: more }))));
}
function plots() {
  const choose = (button, svg) => {
    for (const other of $("measure").children) other.setAttribute("aria-pressed", other === button);
    $("plot").innerHTML = svg;
  };
  $("measure").replaceChildren(...input.plots.map(([name, title, svg]) => {
    const button = make("button", { type: "button", textContent: name, title });
    button.onclick = () => choose(button, svg);
    return button;
  }));
  $("cost").hidden = !input.plots.length;
  if (input.plots.length) choose($("measure").firstChild, input.plots[0][2]);
  $("curves").hidden = !input.curves.length;
  $("curve-plots").replaceChildren(...input.curves.map(([caption, svg]) =>
    make("figure", { className: "plot", innerHTML: svg })).map((figure, i) => {
      figure.prepend(make("figcaption", { textContent: input.curves[i][0] }));
      return figure;
    }));
}
function gallery() {
  const cards = shown().map((i) => {
    const r = input.records[i];
    const picture = make("canvas", { width: 1, height: 1 });
    const card = make("button", { type: "button", onclick: () => lookAt(i, "error"), title: `Errors of ${r.method}` }, picture,
      make("span", {}, make("b", { textContent: r.method }), make("em", { textContent: `worst ${short(r.error.max)}` })));
    canvasOf(input.errors[i], true).then((map) => {
      [picture.width, picture.height] = [map.width, map.height];
      picture.getContext("2d").drawImage(map, 0, 0);
    });
    return card;
  });
  $("gallery").replaceChildren(...cards);
}
function bars() {
  const rows = input.records.filter((r) => r.stages.length);
  const total = (r) => r.stages.reduce((sum, s) => sum + s.median, 0);
  const most = Math.max(...rows.map(total));
  const names = [...new Set(rows.flatMap((r) => r.stages.map((s) => s.name)))].sort((a, b) => (a === "other") - (b === "other"));
  const colour = (name) => (name === "other" ? "var(--soft)" : `var(--c${(names.indexOf(name) % 8) + 1})`);
  const bar = (r) => {
    const parts = r.stages.map((s) => {
      const part = make("i", { title: `${s.name}: ${short(s.median)} ms (${short(s.min)} to ${short(s.max)}, ${plural(s.runs, "run")})` });
      part.style.cssText = `flex:${Math.max(s.median, 1e-6)} 0 0;background:${colour(s.name)}`;
      return part;
    });
    const whole = make("div", { className: "bar" }, ...parts);
    whole.style.width = `${(100 * total(r)) / most}%`;
    return make("div", { className: "bar-row" }, make("b", { textContent: r.method }), whole, make("span", { textContent: `${short(total(r))} ms` }));
  };
  const keys = names.map((name) => { const key = make("i"); key.style.background = colour(name); return make("span", {}, key, name); });
  $("stages").hidden = !rows.length;
  $("bars").replaceChildren(...rows.sort((a, b) => total(a) - total(b)).map(bar), make("div", { className: "keys" }, ...keys));
}
function facts() {
  const { reference: about, threads, parse_ms: parse } = input.records[0];
  const own = about.own_error.map((o) => `${short(o.mean)} levels mean, ${short(o.max)} at most, from one with ${o.against}`).join("; ");
  const list = [
    ["Reference", `${about.how}; curves cut at ${about.tolerance} px.`],
    ["Its own error", [`cutting curves shifts one edge by at most ${short(about.tolerance_levels)} levels`, own || "not held against another, which would take long", `areas of a pixel sum to 1 within ${about.area_defect.toExponential(0)}`, about.approximate_pixels ? `areas approximate in ${plural(about.approximate_pixels, "pixel")}` : "no pixel approximate"].filter(Boolean).join("; ") + "."],
    ["Rounding", `the reference itself, rounded to 8 bits, is off by ${short(about.rounding_mean)} levels in the mean, rms ${short(about.rounding_rms)}: no picture can better that by much.`],
    about.leaves_out.length && ["It leaves out", `${about.leaves_out.join(", ")}: a method that draws these differs there without being wrong.`],
    ["Its time", `${short(about.ms)} ms${about.cached ? ", kept from an earlier run" : ""}.`],
    ["Size", `${input.width} × ${input.height} pixels${input.part.width < input.width || input.part.height < input.height ? `; pictures show ${input.part.width} × ${input.part.height} of them, from column ${input.part.x}, row ${input.part.y}: where the errors are largest` : ""}.`],
    ["Threads", `${threads} for each method that can use them; parsing took ${short(parse)} ms.`],
    ["Machine", `${circumstances.processor}, ${plural(circumstances.cores, "core")}, ${circumstances.system}.`],
    ["Versions", circumstances.versions.map(([name, version]) => `${name} ${version}`).join(", ") + "."],
    ["Date", circumstances.date + "."],
  ];
  const pairs = list.filter(Boolean).flatMap(([term, text]) => [make("dt", { textContent: term }), make("dd", { textContent: text })]);
  $("facts").replaceChildren(...pairs, make("dt", { textContent: "Command" }), make("dd", {}, make("code", { textContent: circumstances.command })));
}
function show(index) {
  input = inputs[index];
  const { threads } = input.records[0];
  $("subject").textContent = `${input.name} · ${input.width} × ${input.height} px · ${plural(threads, "thread")} · ${circumstances.processor}`;
  cards();
  const front = onFront((r) => r.error?.rms);
  const rows = input.records.map((r, i) => ({ r, i, best: front.has(i) }));
  table($("table"), COLUMNS, rows, "rms");
  $("notes").replaceChildren(...input.records.flatMap((r) => r.notes.map((note) => make("li", { textContent: `${r.method}: ${note}` }))));
  const panned = rows.filter(({ r }) => r.pan);
  $("motion").hidden = !panned.length;
  if (panned.length) {
    $("motion-text").textContent = `The drawing moves by one pixel across and down in ${panned[0].r.pan.steps} steps. Its light should stay, and no error should change.`;
    table($("motion-table"), MOTION, panned, "flicker");
  }
  plots();
  gallery();
  bars();
  facts();
  for (const select of [$("left"), $("right")]) {
    select.replaceChildren(make("option", { value: -1, textContent: "reference" }), ...shown().map((i) => make("option", { value: i, textContent: nameOf(i) })));
  }
  fit();
  const by = (name) => shown().find((i) => nameOf(i) === name);
  const rms = (i) => input.records[i].error.rms;
  const ranked = [...shown()].sort((a, b) => rms(a) - rms(b));
  const other = shown().find((i) => input.records[i].against) ?? by("tiny-skia") ?? by("area") ?? ranked[ranked.length - 1];
  const right = by("exact") ?? ranked[0];
  choose(other, right === other ? -1 : right);
}

$("theme").onclick = () => {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = dark ? "light" : "dark";
};
$("input").replaceChildren(...inputs.map((one, i) => make("option", { value: i, textContent: one.name.split(/[\\/]/).pop(), title: one.name })));
$("input").onchange = (event) => show(Number(event.target.value));
$("input-picker").hidden = inputs.length < 2;
show(0);
