// The plan of the block: one date's map, panels to click, thumbnails of all dates.
const extent = (() => {
  const xs = panels.flatMap((p) => p.ring.filter((_, i) => i % 2 === 0));
  const ys = panels.flatMap((p) => p.ring.filter((_, i) => i % 2 === 1));
  const low = (values) => values.reduce((a, b) => Math.min(a, b)),
        high = (values) => values.reduce((a, b) => Math.max(a, b));
  const margin = 2.5;
  return {x0: low(xs) - margin, x1: high(xs) + margin, y0: low(ys) - 2 * margin, y1: high(ys) + margin};
})();
const extentPart = [extent.x0, extent.x1, extent.y0, extent.y1];
const flipped = (y) => extent.y1 - y;  // SVG's y runs down

const layers = {
  density: {text: "Canopy density, finest detail"},
  leaf: {text: "Leaf area, panel by panel"},
  change: {text: "Change since the date before"},
  classes: {text: "Five classes, weakest to strongest"},
  gaps: {text: "Gaps over canopy density"},
};
const showsGrid = () => chosen.layer === "density" || chosen.layer === "gaps";

// The colour of a panel in the layers that colour panels; null where there is nothing to show.
function panelColour(panel) {
  const value = valueOf(panel, chosen.date);
  if (!value) return null;
  if (chosen.layer === "leaf") return colour(stopsNow(), value.perM / data.scale.leaf);
  if (chosen.layer === "classes") {
    const c = data.scans[chosen.date].classes[panel.index];
    return c === "-" ? null : colour(stopsNow(), Number(c) / (data.classes - 1));
  }
  const change = chosen.date > 0 ? changeOf(panel, chosen.date - 1, chosen.date) : null;
  return change ? colour(data.ramps.change, 0.5 + change.perM / data.scale.change / 2) : null;
}

const map = {};
function buildMap() {
  map.root = byId("map");
  map.canvas = element("canvas", {"aria-hidden": "true"});
  map.svg = drawn("svg", {viewBox: `0 0 ${extent.x1 - extent.x0} ${extent.y1 - extent.y0}`, "aria-hidden": "true"});
  map.root.style.setProperty("--aspect", (extent.x1 - extent.x0) / (extent.y1 - extent.y0));
  const outline = (p) => p.ring.map((v, i) => (i % 2 ? flipped(v) : v - extent.x0).toFixed(2)).join(" ");
  map.polygons = panels.map((p) => drawn("polygon", {points: outline(p)}));
  map.halo = drawn("polygon", {class: "halo"});
  map.ring = drawn("polygon", {class: "chosen"});
  map.gaps = drawn("g");
  map.texts = drawn("g");
  const hatch = drawn(
      "pattern",
      {id: "unseen", width: 0.4, height: 0.4, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)"},
      drawn("rect", {class: "hatch-a", width: 0.4, height: 0.4}),
      drawn("rect", {class: "hatch-b", width: 0.13, height: 0.4}));
  map.svg.append(drawn("defs", {}, hatch), drawn("g", {}, map.polygons), map.gaps, map.halo, map.ring, map.texts);
  map.root.append(map.canvas, map.svg);
  map.root.addEventListener("click", (event) => choose({panel: nearestPanel(event)}));
  map.root.addEventListener("keydown", walk);
  new ResizeObserver(drawMap).observe(map.root);
  redraws.push(drawMap);
}

// A ring runs along one side of a panel and back along the other: pairs of points across from each other.
function acrossPairs(panel) {
  const closed = panel.ring[0] === panel.ring.at(-2) && panel.ring[1] === panel.ring.at(-1);
  const count = panel.ring.length / 2 - (closed ? 1 : 0), at = (k) => [panel.ring[2 * k], panel.ring[2 * k + 1]];
  return Array.from({length: Math.floor(count / 2)}, (_, i) => [at(i), at(count - 1 - i)]);
}
const between = ([p, q]) => [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];

// A panel's outline, wider by so many metres to both sides, so that a thick line around it hides no canopy.
function widened(panel, metres) {
  const pairs = acrossPairs(panel).map(([p, q]) => {
    const share = metres / Math.hypot(q[0] - p[0], q[1] - p[1]), dx = share * (q[0] - p[0]), dy = share * (q[1] - p[1]);
    return [[p[0] - dx, p[1] - dy], [q[0] + dx, q[1] + dy]];
  });
  const ring = [...pairs.map(([p]) => p), ...pairs.map(([, q]) => q).reverse()];
  return ring.map(([x, y]) => `${(x - extent.x0).toFixed(2)} ${flipped(y).toFixed(2)}`).join(" ");
}

// The panel nearest to a click: panels of a large block are too slim for a finger.
function nearestPanel(event) {
  const box = map.root.getBoundingClientRect();
  const x = extent.x0 + ((event.clientX - box.left) / box.width) * (extent.x1 - extent.x0);
  const y = extent.y1 - ((event.clientY - box.top) / box.height) * (extent.y1 - extent.y0);
  let best = chosen.panel, least = Infinity;
  for (const panel of panels) {
    const middles = acrossPairs(panel).map(between);
    for (let i = 0; i + 1 < middles.length; ++i) {
      const [ax, ay] = middles[i], [bx, by] = middles[i + 1], dx = bx - ax, dy = by - ay;
      const t = Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)));
      const distance = Math.hypot(x - ax - t * dx, y - ay - t * dy);
      if (distance < least) [least, best] = [distance, panel.index];
    }
  }
  return best;
}

// Arrow keys: along the row, and to the panel beside in the next row.
function walk(event) {
  const step = {ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0]}[event.key];
  if (!step) return;
  event.preventDefault();
  const here = panels[chosen.panel], row = here.rowIndex + step[0];
  const beside = panels.filter((p) => p.rowIndex === row && (step[0] !== 0 || p.number === here.number + step[1]));
  const middle = (p) => (p.start + p.end) / 2;
  beside.sort((p, q) => Math.abs(middle(p) - middle(here)) - Math.abs(middle(q) - middle(here)));
  if (beside.length > 0) choose({panel: beside[0].index});
}

function drawMap() {
  const width = map.root.clientWidth;
  if (width === 0) return;
  drawGrid(map.canvas, showsGrid() ? data.scans[chosen.date].map : null, extentPart, devicePixels(width), stopsNow());
  map.root.classList.toggle("plain", !showsGrid());
  for (const panel of panels)
    map.polygons[panel.index].style.fill = showsGrid() ? "none" : panelColour(panel) || "url(#unseen)";
  const around = widened(panels[chosen.panel], (5 * (extent.x1 - extent.x0)) / width);
  for (const ring of [map.halo, map.ring]) ring.setAttribute("points", around);
  map.gaps.replaceChildren(
      ...(chosen.layer === "gaps" ? data.scans[chosen.date].gaps : [])
          .map(
              (g) => drawn(
                  "line",
                  {class: "gap", x1: g[1] - extent.x0, y1: flipped(g[2]), x2: g[3] - extent.x0, y2: flipped(g[4])})));
  drawTexts(width);
  drawLegend();
}

// Row numbers at the rows' starts, as many as there is room for, and a scale bar.
function drawTexts(width) {
  const metre = (extent.x1 - extent.x0) / width, size = 11 * metre;
  const texts = [];
  let last = null;
  for (const row of data.rows) {
    const x = row.line[0] - extent.x0, y = flipped(row.line[1]);
    if (last && Math.hypot(x - last[0], y - last[1]) < 1.5 * size) continue;
    last = [x, y];
    const dx = row.line[2] - row.line[0], dy = row.line[3] - row.line[1], length = Math.hypot(dx, dy);
    texts.push(drawn(
        "text", {
          x: x - (dx / length) * size,
          y: y + (dy / length) * size + 0.35 * size,
          "font-size": size,
          "stroke-width": 0.25 * size,
          "text-anchor": "middle"
        },
        String(row.number)));
  }
  const bar = [1, 2, 5, 10, 20, 50, 100].filter((m) => m / metre <= width / 3).at(-1) || 1;
  const x = size, y = extent.y1 - extent.y0 - size;
  texts.push(
      drawn(
          "path",
          {class: "bar", "stroke-width": 2 * metre, d: `M${x} ${y - size / 3}V${y}H${x + bar}V${y - size / 3}`}),
      drawn("text", {x: x + bar + size / 2, y, "font-size": size, "stroke-width": 0.25 * size}, `${bar} m`));
  map.texts.replaceChildren(...texts);
}

function drawLegend() {
  const legend = byId("map-legend"), scan = data.scans[chosen.date];
  const captions = {
    density: "One-sided area of leaves and wood above each square metre of ground.",
    leaf: "Leaf area per metre of row of each panel.",
    change: chosen.date === 0 ? "This is the first date: there is nothing to compare it with." :
                                `Leaf area on ${scan.label} less that on ${
                                    data.scans[chosen.date - 1].label}. Small changes may be errors of ` +
            "measurement; the panel's own text says whether a change is clear.",
    classes:
        "Five classes with equally many panels, by leaf area per metre on this date. They rank panels against each " +
        "other and are no agronomic zones.",
    gaps: `${scan.gaps.length} gaps on this date, drawn in magenta.`,
  };
  if (chosen.layer === "change")
    rampLegend(legend, data.ramps.change, -data.scale.change, data.scale.change, "m² per metre of row", true);
  else if (chosen.layer === "leaf")
    rampLegend(legend, stopsNow(), 0, data.scale.leaf, "m² per metre of row", true);
  else if (showsGrid())
    rampLegend(legend, stopsNow(), 0, data.scale.map, "m²/m²", true);
  else
    legend.replaceChildren(...Array.from({length: data.classes}, (_, i) => {
      const swatch = element("i", {class: "swatch"});
      swatch.style.background = colour(stopsNow(), i / (data.classes - 1));
      return element(
          "span", {}, swatch,
          i === 0                    ? "weakest fifth" :
              i + 1 === data.classes ? "strongest fifth" :
                                       String(i + 1));
    }), element("span", {}, element("i", {class: "swatch unseen"}), "not observed"));
  say("map-caption",
      captions[chosen.layer] +
          (chosen.layer === "change" || chosen.layer === "classes" ? "" : " The scale is the same on all dates.") +
          " North is up; row numbers stand where rows start.");
}

function buildThumbs() {
  const canvases = [];
  data.scans.forEach((scan, date) => {
    const canvas = element("canvas", {"aria-hidden": "true"}), total = scan.block;
    canvases.push(canvas);
    const button = element(
        "button", {type: "button", "data-date": date}, canvas, element("span", {}, scan.label),
        element(
            "span", {class: "sub"},
            scan.dormant ? "no leaves" :
                total    ? `${fixed(total[0], 2)} m² per metre` :
                           "not observed"));
    button.addEventListener("click", () => choose({date}));
    byId("thumbs").append(button);
  });
  let shown = null;
  redraws.push(() => {
    for (const button of byId("thumbs").children)
      button.setAttribute("aria-pressed", Number(button.dataset.date) === chosen.date);
    if (shown === chosen.palette) return;
    shown = chosen.palette;
    canvases.forEach((canvas, date) => drawGrid(canvas, data.scans[date].map, extentPart, 320, stopsNow()));
  });
}
