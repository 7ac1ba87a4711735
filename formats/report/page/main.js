// Brings the parts together: what is chosen, and the words that follow from it.
function showPanel() {
  const panel = panels[chosen.panel], value = valueOf(panel, chosen.date), scan = data.scans[chosen.date];
  say("panel-h", panelName(panel));
  const change = chosen.date > 0 ? changeOf(panel, chosen.date - 1, chosen.date) : null;
  const where = `${fixed(panel.start, 1)} to ${fixed(panel.end, 1)} m from the row's start.`;
  say("panel-text",
      !value ? `Not observed on ${scan.label}. ${where}` :
               `On ${scan.label}: ${fixed(value.leaf, 1)} m² of leaf area (95 %: ${
                   interval(value.low, value.high, 1)}), that is ` +
              `${fixed(value.perM, 2)} m² per metre of row` +
              (change ? `; since the date before ${signed(change.leaf, 1)} m², ${verdictText[change.verdict]}. ` :
                        ". ") +
              where);
  showPickers(panel);
}

function showPickers(panel) {
  const rows = byId("pick-row"), numbers = byId("pick-panel");
  rows.value = String(panel.rowIndex);
  numbers.replaceChildren();
  for (const p of panels)
    if (p.rowIndex === panel.rowIndex) option(numbers, p.index, String(p.number));
  numbers.value = String(panel.index);
}

function changeCell(panel, date) {
  const change = date > 0 ? changeOf(panel, date - 1, date) : null;
  if (!change) return element("td", {}, date > 0 ? "cannot be told" : "first date");
  return element(
      "td", {}, `${signed(change.leaf, 1)} m² ± ${fixed(change.half, 1)} `,
      element("span", {class: `tag ${change.verdict}`}, verdictText[change.verdict]));
}

function showPanelTable() {
  const panel = panels[chosen.panel];
  const rows = data.scans.map((scan, date) => {
    const v = valueOf(panel, date), attributes = date === chosen.date ? {class: "here"} : {};
    if (!v)
      return element(
          "tr", attributes, element("td", {}, scan.label), unseenCell(), unseenCell(), unseenCell(), unseenCell(),
          changeCell(panel, date));
    return element(
        "tr", attributes, element("td", {}, scan.label),
        numberCell(`${fixed(v.leaf, 1)} (${interval(v.low, v.high, 1)})`), numberCell(fixed(v.perM, 2)),
        numberCell(known(v.open) ? percent(v.open) : "–"), numberCell(percent(v.seen)), changeCell(panel, date));
  });
  byId("panel-table")
      .replaceChildren(table(
          [
            ["Date"], ["Leaf area, m² (95 %)", "number"], ["m² per metre", "number"], ["Open from the side", "number"],
            ["Observed", "number"], ["Change since the date before (95 %)"]
          ],
          rows, `${panelName(panel)} on all dates`));
}

// What its canopy is like: height, width, porosity, leaf layers, exposed leaves, leaf area beside the fruit.
function showCanopyTable() {
  const panel = panels[chosen.panel];
  const number = (value, digits) => numberCell(known(value) ? fixed(value, digits) : "–");
  const share = (value) => numberCell(known(value) ? percent(value) : "–");
  const rows = data.scans.map((scan, date) => {
    const v = valueOf(panel, date);
    const cells = v ?
        [
          number(v.height, 2), number(v.width, 2), share(v.porosity), number(v.layers, 1), share(v.exposed),
          number(v.fruit, 2)
        ] :
        Array.from({length: 6}, unseenCell);
    return element("tr", date === chosen.date ? {class: "here"} : {}, element("td", {}, scan.label), cells);
  });
  const [low, high] = data.scans[chosen.date].fruit_zone;
  const zone = known(low) ? `, ${fixed(low, 1)} to ${fixed(high, 1)} m high` : "";
  byId("canopy-table")
      .replaceChildren(table(
          [
            ["Date"], ["Height, m", "number"], ["Width, m", "number"], ["Porosity", "number"],
            ["Leaf layers", "number"], ["Exposed leaves", "number"], [`Fruit zone${zone}, m² per metre`, "number"]
          ],
          rows, `Canopy of ${panelName(panel)}`));
}

// The map's values in words: built when it is opened, and again when the date changes.
function showAllPanels() {
  if (!byId("all-panels").open) return;
  const rows = panels.map((panel) => {
    const v = valueOf(panel, chosen.date), button = element("button", {type: "button"}, String(panel.number));
    button.setAttribute("aria-label", `Show ${panelName(panel)}`);
    button.addEventListener("click", () => choose({panel: panel.index}));
    const cells = v ?
        [
          numberCell(`${fixed(v.leaf, 1)} (${interval(v.low, v.high, 1)})`), numberCell(fixed(v.perM, 2)),
          numberCell(percent(v.seen))
        ] :
        [unseenCell(), unseenCell(), unseenCell()];
    return element(
        "tr", panel.index === chosen.panel ? {class: "here"} : {}, element("td", {}, rowName(panel.row)),
        element("td", {}, button), cells, changeCell(panel, chosen.date));
  });
  const shown = table(
      [
        ["Row"], ["Panel"], ["Leaf area, m² (95 %)", "number"], ["m² per metre", "number"], ["Observed", "number"],
        ["Change since the date before (95 %)"]
      ],
      rows, `All panels on ${data.scans[chosen.date].label}`);
  shown.classList.add("tall");
  byId("panels-table").replaceChildren(shown);
}

function buildControls() {
  const slider = byId("date"), last = data.scans.length - 1;
  slider.max = String(last);
  slider.addEventListener("input", () => choose({date: Number(slider.value)}));
  byId("date-back").addEventListener("click", () => choose({date: Math.max(0, chosen.date - 1)}));
  byId("date-on").addEventListener("click", () => choose({date: Math.min(last, chosen.date + 1)}));
  for (const [value, {text}] of Object.entries(layers)) option(byId("layer"), value, text);
  option(byId("palette"), "canopy", "cream – green – blue (colour-blind safe)");
  option(byId("palette"), "paper", "red – green – blue (as in the paper)");
  for (const id of ["layer", "palette"])
    byId(id).addEventListener("change", (event) => choose({[id]: event.target.value}));
  data.rows.forEach(
      (row, i) => panels.some((p) => p.rowIndex === i) && option(byId("pick-row"), i, rowName(row).slice(4)));
  byId("pick-row").addEventListener("change", (event) => {
    const here = panels[chosen.panel], row = Number(event.target.value);
    const beside = panels.filter((p) => p.rowIndex === row)
                       .sort((p, q) => Math.abs(p.start - here.start) - Math.abs(q.start - here.start));
    choose({panel: beside[0].index});
  });
  byId("pick-panel").addEventListener("change", (event) => choose({panel: Number(event.target.value)}));
  chosen.b = data.focus;
  chosen.a = data.focus > 0 ? data.focus - 1 : Math.min(1, last);
  for (const [id, name] of [["from", "a"], ["to", "b"]]) {
    data.scans.forEach((scan, i) => option(byId(id), i, scan.label));
    byId(id).addEventListener("change", (event) => choose({[name]: Number(event.target.value)}));
  }
  redraws.push(() => {
    slider.value = String(chosen.date);
    slider.setAttribute("aria-valuetext", data.scans[chosen.date].label);
    say("date-text", data.scans[chosen.date].label);
    byId("date-back").disabled = chosen.date === 0;
    byId("date-on").disabled = chosen.date === last;
    byId("from").value = String(chosen.a);
    byId("to").value = String(chosen.b);
  });
}

// Draws a part only when what it shows has changed.
function when(key, draw) {
  let shown = null;
  redraws.push(() => {
    const now = key();
    if (now === shown) return;
    shown = now;
    draw();
  });
  return () => {
    shown = null;
  };
}

function start() {
  if (typeof DecompressionStream === "undefined") {
    byId("old-browser").hidden = false;
    return;
  }
  for (const section of document.querySelectorAll(".needs-script")) section.hidden = false;
  byId("dates-h").parentElement.hidden = data.scans.length < 2;
  buildControls();
  buildMap();
  buildThumbs();
  const {date, panel, palette, a, b} = {
    date: () => chosen.date,
    panel: () => chosen.panel,
    palette: () => chosen.palette,
    a: () => chosen.a,
    b: () => chosen.b
  };
  const key = (...parts) => () => parts.map((part) => part()).join();
  const again = [
    when(key(panel, date), showPanel), when(key(panel, date), showPanelTable), when(key(panel, date), showCanopyTable),
    when(key(panel, date), showCurve), when(key(panel, palette), showPanelSides),
    when(key(panel, palette), showRowStack), when(key(panel, a, b), showScatter),
    when(key(panel, date, palette), showHistogram),
    when(key(panel, date), showAllPanels)
  ];
  byId("all-panels").addEventListener("toggle", showAllPanels);
  let width = document.documentElement.clientWidth;
  const resized = () => {
    if (document.documentElement.clientWidth === width) return;
    width = document.documentElement.clientWidth;
    again.forEach((forget) => forget());
    redraw();
  };
  window.addEventListener("resize", resized);
  redraw();
}
start();
