"use strict";
// What all parts of the page share: the data, what is chosen, elements, numbers, colours, packed grids.
const data = JSON.parse(document.getElementById("data").textContent);
const chosen = {
  date: data.focus,
  panel: data.first_panel,
  layer: "density",
  palette: "canopy",
  a: 0,
  b: 0
};

const byId = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";

// A number and its unit stay on one line.
const glued = (text) => text.replace(/ (%|m²)/g, "\u00a0$1");
const say = (id, text) => (byId(id).textContent = glued(text));

// Attributes and text only: nothing is ever parsed as HTML.
function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {})) node.setAttribute(name, value);
  node.append(...children.flat().filter((child) => child !== null).map((c) => (typeof c === "string" ? glued(c) : c)));
  return node;
}
const element = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
const drawn = (tag, attributes, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);

const known = (value) => value !== null && value !== undefined;
const fixed = (value, digits) => value.toFixed(digits).replace("-", "−");
const signed = (value, digits) => (value > 0 ? "+" : "") + fixed(value, digits);
const percent = (value) => `${Math.round(100 * value)} %`;
const interval = (low, high, digits) => `${fixed(low, digits)} to ${fixed(high, digits)}`;

const panels = data.panels.map((p, index) => ({
                                 index,
                                 row: data.rows[p[0]],
                                 rowIndex: p[0],
                                 number: p[1],
                                 start: p[2],
                                 end: p[3],
                                 length: p[4],
                                 ring: p[5],
                               }));
const panelName = (panel) => `${rowName(panel.row)}, panel ${panel.number}`;
const rowName = (row) => `Row ${row.number}` + (row.name ? ` (${row.name})` : "");

// A panel on a date: null where it was not observed.
function valueOf(panel, date) {
  const v = data.scans[date].values;
  if (v.leaf[panel.index] === null) return null;
  const at = (name) => v[name][panel.index];
  return {
    leaf: at("leaf"),
    low: at("low"),
    high: at("high"),
    perM: at("leaf") / panel.length,
    lowPerM: at("low") / panel.length,
    highPerM: at("high") / panel.length,
    height: at("height"),
    width: at("width"),
    open: at("open"),
    seen: at("seen"),
    porosity: at("porosity"),
    layers: at("layers"),
    exposed: at("exposed"),
    fruit: at("fruit"),
  };
}

// The store's own comparison of two dates, from the first to the second whichever way round they are given.
function pairOf(a, b) {
  const forward = a < b;
  const pair = data.pairs.find((p) => p.a === Math.min(a, b) && p.b === Math.max(a, b));
  return pair ? {pair, sign: forward ? 1 : -1} : null;
}
const words = {
  g: "gain",
  l: "loss",
  n: "none",
  "-": "unseen"
};
function changeOf(panel, a, b) {
  const found = pairOf(a, b), from = valueOf(panel, a), to = valueOf(panel, b);
  if (!found || !from || !to) return null;
  const verdict = words[found.pair.verdicts[panel.index]];
  const turned = found.sign > 0 ? verdict : {gain: "loss", loss: "gain"}[verdict] || verdict;
  return {verdict: turned, leaf: to.leaf - from.leaf, half: found.pair.half[panel.index], perM: to.perM - from.perM};
}
const verdictText = {
  gain: "clear gain",
  loss: "clear loss",
  none: "within its error"
};

function mixed(stops, t) {
  const position = Math.min(1, Math.max(0, t)) * (stops.length - 1);
  const i = Math.min(Math.floor(position), stops.length - 2), f = position - i;
  const channel = (hex, k) => parseInt(hex.slice(1 + 2 * k, 3 + 2 * k), 16);
  return [0, 1, 2].map((k) => Math.round(channel(stops[i], k) * (1 - f) + channel(stops[i + 1], k) * f));
}
const colour = (stops, t) => `rgb(${mixed(stops, t).join(" ")})`;
const stopsNow = () => data.ramps[chosen.palette];

// Levels of a packed grid, unpacked once.
const unpacked = new Map();
async function levelsOf(grid) {
  if (!unpacked.has(grid)) {
    const bytes = Uint8Array.from(atob(grid.data), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    unpacked.set(grid, new Response(stream).arrayBuffer().then((buffer) => new Uint8Array(buffer)));
  }
  return unpacked.get(grid);
}

// A grid's pixels, one per cell; what was not observed stays transparent, so that the hatching behind shows.
async function pixelsOf(grid, stops) {
  const levels = await levelsOf(grid);
  const table = Uint32Array.from({length: data.levels + 1}, (_, level) => {
    if (level === 0) return 0;
    const [r, g, b] = mixed(stops, (level - 1) / (data.levels - 1));
    return new Uint32Array(Uint8Array.of(r, g, b, 255).buffer)[0];
  });
  const canvas = document.createElement("canvas");
  canvas.width = grid.nx;
  canvas.height = grid.ny;
  const context = canvas.getContext("2d"), image = context.createImageData(grid.nx, grid.ny);
  const pixels = new Uint32Array(image.data.buffer);
  for (let i = 0; i < levels.length; ++i) pixels[i] = table[levels[i]];
  context.putImageData(image, 0, 0);
  return canvas;
}

// Draws the part [x0, x1] × [y0, y1] (metres) of a grid over a whole canvas of `width` pixels. A later call for the
// same canvas wins over an earlier one that is still unpacking.
async function drawGrid(canvas, grid, part, width, stops) {
  const ticket = (canvas.ticket = {});
  const pixels = grid ? await pixelsOf(grid, stops) : null;
  if (canvas.ticket !== ticket) return;
  const [x0, x1, y0, y1] = part;
  canvas.width = Math.max(1, Math.round(width));
  canvas.height = Math.max(1, Math.round((width * (y1 - y0)) / (x1 - x0) * (canvas.stretch || 1)));
  if (!pixels) return;
  const context = canvas.getContext("2d"), sx = canvas.width / (x1 - x0), sy = canvas.height / (y1 - y0);
  const top = grid.y + grid.ny * grid.cell;
  context.imageSmoothingEnabled = sx * grid.cell < 1;
  context.imageSmoothingQuality = "high";
  context.drawImage(pixels, (grid.x - x0) * sx, (y1 - top) * sy, grid.nx * grid.cell * sx, grid.ny * grid.cell * sy);
}
const devicePixels = (width) => width * Math.min(3, window.devicePixelRatio || 1);

function rampLegend(parent, stops, low, high, unit, beyond, unseen = true) {
  const bar = element("div", {class: "colours"});
  bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  const digits = high - low < 4 ? 1 : 0;
  const tick = (t) => fixed(low + t * (high - low), (low + t * (high - low)) % 1 ? Math.max(1, digits) : digits);
  parent.replaceChildren(
      element(
          "div", {class: "ramp"}, bar,
          element(
              "div", {class: "ticks"}, element("span", {}, (low < 0 ? "≤ " : "") + tick(0)),
              element("span", {}, tick(0.5)), element("span", {}, (beyond ? "≥ " : "") + tick(1)))),
      element("span", {}, unit));
  if (unseen) parent.append(element("span", {}, element("i", {class: "swatch unseen"}), "not observed"));
}

function table(headings, rows, caption) {
  const head =
      element("tr", {}, headings.map(([text, kind]) => element("th", {scope: "col", class: kind || ""}, text)));
  return element(
      "div", {class: "scroll"},
      element(
          "table", {}, caption ? element("caption", {}, caption) : null, element("thead", {}, head),
          element("tbody", {}, rows)));
}
const numberCell = (text) => element("td", {class: "number"}, text);
const unseenCell = () => element("td", {class: "unseen"}, "not observed");

function option(select, value, text) { select.append(element("option", {value}, text)); }
// What has to be drawn again when something else is chosen.
const redraws = [];
function redraw() {
  for (const draw of redraws) draw();
}
function choose(change) {
  Object.assign(chosen, change);
  redraw();
}
