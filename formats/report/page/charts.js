// Charts as SVG, drawn as wide as their place is, so that their text keeps its size on a phone.
function axes(parent, height, xRange, yRange, xTicks, yTicks, xTitle, yTitle) {
  const width = Math.max(260, parent.clientWidth || 560), left = 40, right = 12, top = 20, bottom = xTitle ? 40 : 26;
  const root = drawn("svg", {viewBox: `0 0 ${width} ${height}`, role: "img"});
  const x = (v) => left + ((v - xRange[0]) / (xRange[1] - xRange[0])) * (width - left - right);
  const y = (v) => height - bottom - ((v - yRange[0]) / (yRange[1] - yRange[0])) * (height - top - bottom);
  for (const [value, text] of yTicks)
    root.append(
        drawn("line", {class: "gridline", x1: left, x2: width - right, y1: y(value), y2: y(value)}),
        drawn("text", {x: left - 6, y: y(value) + 4, "text-anchor": "end"}, text));
  let end = -Infinity;
  for (const [value, text] of xTicks) {
    const at = Math.min(width - right - 3.2 * text.length, Math.max(3.2 * text.length, x(value)));
    if (at - 3.4 * text.length < end) continue;
    end = at + 3.4 * text.length;
    root.append(drawn("text", {x: at, y: height - bottom + 17, "text-anchor": "middle"}, text));
  }
  root.append(
      drawn("path", {class: "axis", d: `M${left} ${top - 6}V${height - bottom}H${width - right}`}),
      drawn("text", {x: 0, y: 11}, yTitle));
  if (xTitle) root.append(drawn("text", {x: width - right, y: height - 5, "text-anchor": "end"}, xTitle));
  parent.replaceChildren(root);
  return {root, x, y, width};
}

function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((f) => f * power >= rough * 0.999) * power,
        digits = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const values = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9; ++k)
    values.push([k * step, fixed(k * step, digits)]);
  return values;
}
const days = (date) => Date.parse(date) / 86400000;

function keyEntry(parent, shape, text) {
  parent.append(
      element("span", {}, drawn("svg", {viewBox: "0 0 28 16", class: "chart", "aria-hidden": "true"}, shape), text));
}

// The panel's leaf area through the season with its 95 % intervals, its row and the block beside.
function showCurve() {
  const panel = panels[chosen.panel], parent = byId("panel-curve"), times = data.scans.map((s) => days(s.date));
  const points = data.scans.map((_, d) => valueOf(panel, d)), pad = Math.max(5, (times.at(-1) - times[0]) * 0.06);
  const others = data.scans.flatMap((s) => [s.rows[panel.rowIndex], s.block]).filter(known).map((v) => v[2]);
  const most = Math.max(0.5, ...points.filter(known).map((p) => p.highPerM), ...others);
  const chart = axes(
      parent, 210, [times[0] - pad, times.at(-1) + pad], [0, 1.05 * most], data.scans.map((s, d) => [times[d], s.tick]),
      ticks(0, 1.05 * most, 4), "", "leaf area, m² per metre of row");
  const line = (values) => {
    let pen = "M";
    return values
        .map((v, d) => (known(v) ? [`${pen}${chart.x(times[d])} ${chart.y(v)}`, (pen = "L")][0] : ((pen = "M"), "")))
        .join("");
  };
  chart.root.setAttribute(
      "aria-label", `Leaf area of ${panelName(panel)} through the season; the values stand in the table below`);
  chart.root.append(
      drawn(
          "line",
          {class: "now", x1: chart.x(times[chosen.date]), x2: chart.x(times[chosen.date]), y1: chart.y(0), y2: 16}),
      drawn("path", {class: "block-line", d: line(data.scans.map((s) => s.block && s.block[0]))}),
      drawn(
          "path",
          {class: "row-line", d: line(data.scans.map((s) => s.rows[panel.rowIndex] && s.rows[panel.rowIndex][0]))}),
      drawn("path", {class: "main", d: line(points.map((p) => p && p.perM))}));
  points.forEach((p, d) => {
    if (!p) return;
    const x = chart.x(times[d]), low = chart.y(p.lowPerM), high = chart.y(p.highPerM);
    chart.root.append(
        drawn("path", {class: "error", d: `M${x - 4} ${low}h8M${x} ${low}V${high}M${x - 4} ${high}h8`}),
        drawn("circle", {class: "dot", cx: x, cy: chart.y(p.perM), r: 4}));
  });
  const key = byId("curve-key");
  key.replaceChildren();
  keyEntry(key, drawn("path", {class: "main", d: "M2 8H26"}), "this panel, with 95 % interval");
  keyEntry(key, drawn("path", {class: "row-line", d: "M2 8H26"}), "its row");
  keyEntry(key, drawn("path", {class: "block-line", d: "M2 8H26"}), "block");
}

// One panel's mark: discs are within their errors, triangles point where a clear change went.
function mark(verdict, x, y, size) {
  if (verdict === "none") return drawn("circle", {class: "none", cx: x, cy: y, r: 0.7 * size});
  const s = verdict === "gain" ? -size : size;
  return drawn("path", {class: verdict, d: `M${x} ${y + s}L${x - size} ${y - 0.7 * s}H${x + size}Z`});
}

function showScatter() {
  const {a, b} = chosen, found = pairOf(a, b), parent = byId("scatter");
  if (!found) {
    parent.replaceChildren();
    byId("scatter-key").replaceChildren();
    say("pair-text", a === b ? "Choose two different dates." : "No panel was observed on both dates.");
    return;
  }
  const points = panels.map((p) => ({p, from: valueOf(p, a), to: valueOf(p, b), change: changeOf(p, a, b)}))
                     .filter((q) => q.change);
  const most = 1.04 * Math.max(0.5, ...points.flatMap((q) => [q.from.highPerM, q.to.highPerM]));
  const size = Math.min(420, Math.max(260, parent.clientWidth || 420)), tick = ticks(0, most, 4);
  const chart =
      axes(parent, size, [0, most], [0, most], tick, tick, data.scans[a].label, `m² per metre, ${data.scans[b].label}`);
  chart.root.setAttribute(
      "aria-label",
      `Panels on ${data.scans[a].label} against ${data.scans[b].label}; the text above says what changed`);
  chart.root.append(
      drawn("line", {class: "equal", x1: chart.x(0), y1: chart.y(0), x2: chart.x(most), y2: chart.y(most)}));
  if (points.length <= 400)
    for (const {from, to} of points)
      chart.root.append(drawn("path", {
        class: "whisker",
        d: `M${chart.x(from.lowPerM)} ${chart.y(to.perM)}H${chart.x(from.highPerM)}` +
            `M${chart.x(from.perM)} ${chart.y(to.lowPerM)}V${chart.y(to.highPerM)}`
      }));
  for (const {p, from, to, change} of points) {
    const shape = mark(change.verdict, chart.x(from.perM), chart.y(to.perM), points.length > 400 ? 3 : 4.5);
    shape.classList.add("pick");
    shape.append(drawn("title", {}, `${panelName(p)}: ${fixed(from.perM, 2)} → ${fixed(to.perM, 2)} m² per metre`));
    shape.addEventListener("click", () => choose({panel: p.index}));
    chart.root.append(shape);
    if (p.index === chosen.panel)
      chart.root.append(drawn("circle", {class: "ring", cx: chart.x(from.perM), cy: chart.y(to.perM), r: 8}));
  }
  drawTrend(chart, found, most);
  const key = byId("scatter-key");
  key.replaceChildren();
  for (const [verdict, text] of [["gain", "clear gain"], ["loss", "clear loss"], ["none", "within its error"]])
    keyEntry(key, mark(verdict, 14, 8, 6), text);
  keyEntry(key, drawn("path", {class: "equal", d: "M2 8H26"}), "no change");
  if (found.sign > 0 && known(found.pair.slope))
    keyEntry(key, drawn("path", {class: "trend", d: "M2 8H26"}), "trend (least squares)");
  say("pair-text", pairText(found, points, a, b));
}

// The trend is that of the later date on the earlier one: turned round it would be another line.
function drawTrend(chart, found, most) {
  const {slope, intercept} = found.pair;
  if (found.sign < 0 || !known(slope)) return;
  const ends = [0, most].map((x) => [x, intercept + slope * x]).map(([x, y]) => {
    const inside = Math.min(most, Math.max(0, y));
    return [slope ? (inside - intercept) / slope : x, inside];
  });
  chart.root.append(drawn("path", {
    class: "trend",
    d: `M${chart.x(ends[0][0])} ${chart.y(ends[0][1])}L${chart.x(ends[1][0])} ${chart.y(ends[1][1])}`
  }));
}

function pairText({pair, sign}, points, a, b) {
  const count = (verdict) => points.filter((q) => q.change.verdict === verdict).length;
  const low = sign > 0 ? pair.low : -pair.high, high = sign > 0 ? pair.high : -pair.low;
  const clear = low > 0 || high < 0;
  return `From ${data.scans[a].label} to ${data.scans[b].label} the leaf area of the ${
             points.length} panels observed on both dates ` +
      `changed by ${signed(sign * pair.change, 1)} m² (95 %: ${interval(low, high, 1)}), which is ${
             clear ? "a clear change" : "within its error"}. ` +
      `${count("gain")} panels gained clearly, ${count("loss")} lost clearly, ${
             count("none")} stayed within their errors` +
      (pair.unseen ? `; ${pair.unseen} were not observed on both dates.` : ".") +
      (known(pair.rrmse) ? ` Difference between the dates (RRMSE) ${fixed(100 * pair.rrmse, 1)} %` : "") +
      (known(pair.r2) ? `, r² ${fixed(pair.r2, 2)}.` : ".");
}

function showHistogram() {
  const parent = byId("histogram"), scan = data.scans[chosen.date];
  const values = panels.map((p) => valueOf(p, chosen.date)).filter(known).map((v) => v.perM);
  const most = Math.max(data.scale.leaf, ...values), bins = 20, width = most / bins, counts = new Array(bins).fill(0);
  for (const v of values) counts[Math.min(bins - 1, Math.max(0, Math.floor(v / width)))] += 1;
  const top = Math.max(4, ...counts), height = Math.min(420, Math.max(260, parent.clientWidth || 420));
  const chart = axes(
      parent, height, [0, most], [0, 1.08 * top], ticks(0, most, 5), ticks(0, top, 4).filter(([v]) => v % 1 === 0),
      "m² per metre of row", "panels");
  chart.root.setAttribute("aria-label", `How many panels have how much leaf area on ${scan.label}`);
  counts.forEach((count, i) => {
    if (count === 0) return;
    const bar = drawn("rect", {
      class: "column",
      x: chart.x(i * width),
      y: chart.y(count),
      width: chart.x(width) - chart.x(0),
      height: chart.y(0) - chart.y(count)
    });
    bar.style.fill = colour(stopsNow(), ((i + 0.5) * width) / data.scale.leaf);
    chart.root.append(bar);
  });
  const own = valueOf(panels[chosen.panel], chosen.date), key = byId("histogram-key");
  key.replaceChildren();
  if (own) {
    chart.root.append(
        drawn("line", {class: "main", x1: chart.x(own.perM), x2: chart.x(own.perM), y1: chart.y(0), y2: 20}));
    keyEntry(key, drawn("path", {class: "main", d: "M14 0V16"}), panelName(panels[chosen.panel]));
  }
  const below = values.filter((v) => v < 0).length;
  say("histogram-text",
      `Leaf area of the ${values.length} panels observed on ${scan.label}.` +
          (below ?
               ` ${below} read slightly below zero, by measurement error; they are counted in the first column.` :
               ""));
}
