// Side views: of one panel in true proportion, of one row fitted to the width.
const highest = Math.max(1, ...data.scans.flatMap((s) => s.sides.filter((g) => g).map((g) => g.y + g.ny * g.cell)));

// One date's side view of the stretch [start, end] of a row; `stretch` times higher than it is.
function sideView(row, rowIndex, date, start, end, stretch, marks) {
  const grid = data.scans[date].sides[rowIndex];
  const view = element("div", {
    class: "view",
    role: "img",
    "aria-label": `${rowName(row)} from the side on ${data.scans[date].label}, ${fixed(start, 1)} to ${fixed(end, 1)} m`
  });
  const canvas = element("canvas", {"aria-hidden": "true"});
  canvas.stretch = stretch;
  view.style.aspectRatio = `${end - start} / ${highest * stretch}`;
  const lines = drawn("svg", {viewBox: `0 0 ${end - start} 1`, preserveAspectRatio: "none", "aria-hidden": "true"});
  for (const post of row.posts)
    if (post >= start && post <= end)
      lines.append(drawn("line", {class: "post", x1: post - start, x2: post - start, y1: 0, y2: 1}));
  for (const [from, to] of marks)
    lines.append(drawn("rect", {class: "mark", x: from - start, y: 0.01, width: to - from, height: 0.98}));
  view.append(canvas, lines);
  return {
    view,
    draw: () => drawGrid(canvas, grid, [start, end, 0, highest], devicePixels(view.clientWidth || 320), stopsNow())
  };
}

function sideLabel(date, right) {
  return element("div", {class: "label"}, element("b", {}, data.scans[date].label), element("span", {}, right));
}

// A stack of dates; what has been built is kept while only its colours change.
function showStack(parent, row, rowIndex, start, end, stretch, marks, text) {
  const views = data.scans.map((_, date) => sideView(row, rowIndex, date, start, end, stretch, marks));
  const scale = element(
      "div", {class: "chainage"}, element("span", {}, `${fixed(start, 1)} m`), element("span", {}, "along the row"),
      element("span", {}, `${fixed(end, 1)} m`));
  parent.replaceChildren(
      ...views.map(({view}, date) => element("div", {class: "side"}, sideLabel(date, text(date)), view)), scale);
  for (const {draw} of views) draw();
}

function showPanelSides() {
  const panel = panels[chosen.panel];
  showStack(byId("panel-sides"), panel.row, panel.rowIndex, panel.start, panel.end, 1, [], (date) => {
    const value = valueOf(panel, date);
    return value ? `${fixed(value.perM, 2)} m² per metre` : "not observed";
  });
  rampLegend(byId("side-legend"), stopsNow(), 0, data.scale.side, "m²/m² seen from the side, wood included", true);
}

function showRowStack() {
  const panel = panels[chosen.panel], row = panel.row, width = byId("row-stack").clientWidth || 700;
  // At least 56 px high, whole factors, so that the exaggeration can be said plainly.
  const stretch = Math.max(1, Math.ceil((56 / width) * (row.length / highest)));
  say("row-text",
      `${rowName(row)}, ${fixed(row.length, 1)} m` + (stretch > 1 ? `, heights drawn ${stretch} times too large` : "") +
          ". Dashed lines are posts; the frame is the panel chosen on the map. All dates have one scale.");
  showStack(byId("row-stack"), row, panel.rowIndex, 0, row.length, stretch, [[panel.start, panel.end]], (date) => {
    const total = data.scans[date].rows[panel.rowIndex];
    return total ? `${fixed(total[0], 2)} m² per metre (95 %: ${interval(total[1], total[2], 2)})` : "not observed";
  });
  rampLegend(byId("row-legend"), stopsNow(), 0, data.scale.side, "m²/m² seen from the side, wood included", true);
}
