// Fills the cards and keeps them in step with the legend, the joint and the theme.

const state = new Map(); // card → { picks, plot, series }

const fill = (card, height) => {
  const kind = card.dataset.plot;
  const canvas = card.querySelector(".canvas");
  const mine = state.get(card) ?? { picks: [] };
  state.set(card, mine);
  if (mine.plot) removePlot(mine.plot);
  mine.plot = null;
  canvas.replaceChildren();
  card.querySelector(".key")?.remove();
  card.querySelector(".exports")?.remove();
  // A card that has nothing to show stands where something is missing, and nowhere else.
  const empty = (why) => {
    canvas.replaceChildren(element("p", { className: "none", textContent: why || "nothing was recorded" }));
    card.hidden = !card.closest("#stage") && !why;
  };
  card.hidden = false;

  if (kind === "gantt") {
    if (index.gantt.rows.length === 0) return empty();
    if (index.gantt.by_receiver) document.getElementById("gantt-by").textContent = "per receiver; the stronger, the more agents it hears";
    mine.plot = Object.assign(drawPlot(canvas, ganttCard()), { rows: ganttRows(), named: () => [] });
    offer(card, mine.plot);
    return;
  }
  if (kind === "plane") {
    if (quantities.length < 2 || data.t("main").length === 0) return empty();
    mine.picks = drawPicks(card, planeSpec, mine.picks);
    mine.plot = drawPlane(canvas, mine.picks, height ?? (isPrinting() ? 184 : innerWidth < 640 ? 220 : 240));
    offer(card, mine.plot);
    return;
  }
  if (kind === "path") {
    mine.plot = drawPaths(canvas, height ?? (isPrinting() ? 220 : 290));
    offer(card, mine.plot);
    return;
  }
  const spec = cards[kind];
  mine.picks = drawPicks(card, spec, mine.picks);
  const built = spec.build(mine.picks);
  const unit = card.querySelector(".unit") ?? card.querySelector("h3").appendChild(element("span", { className: "unit" }));
  unit.textContent = (built.said ?? built.unit) ? ` ${built.said ?? built.unit}` : "";
  const times = data.t(built.grid ?? "main");
  if (built.series.length === 0 || times.length === 0) return empty(card.dataset.empty || (card.dataset.plot === "disagreement" && "nothing was recorded"));
  if (built.series.every((s) => s.values.every((v) => v === null))) return empty("no value can be drawn: all are zero or not finite");
  if (kind === "delay" && built.series.every((s) => s.values.every((v) => v === 0))) return empty();
  mine.series = built.series;
  const far = built.log ? null : outliers(built.series);
  mine.plot = drawPlot(canvas, { ...built, times, height: height ?? (isPrinting() ? SHEET_PLOT : card.closest("#stage") && innerWidth > 1000 ? stagePlotHeight() : undefined), within: far?.usual });
  const grid = built.grid ?? "main";
  mine.plot.recorded = () => mine.plot.data.map((column, k) => data.picked(grid, built.series[k - 1]?.values.linear?.() ?? column));
  const lost = built.series.map(({ values }) => values.beyond_s ?? null).filter((t) => t !== null);
  if (lost.length) canvas.append(element("p", { className: "note beyond", textContent: `${lost.length < built.series.length ? "Some curves are b" : "B"}eyond what the page can draw from t = ${number(Math.min(...lost))} s on.` }));
  if (far) canvas.append(element("p", { className: "note", textContent: `Some values leave this axis${lost.length ? "" : `; the largest is ${number(far.largest)}`}.` }));
  const banded = isBanded() && built.series.some((s) => QUANTILES.some(([, label]) => label === s.label));
  if (banded) canvas.append(element("p", { className: "note" }, `${shownCurves()} agents, by quantiles ${index.grids.rows.main ? "of gathered rows" : "at each time"}. `, element("span", { className: "screen", textContent: `Curves are drawn of up to ${MOST_CURVES}: hide others in the legend, or choose one beside the clock.` })));
  if (built.key || banded) card.append(key(built.series, mine.plot));
  offer(card, mine.plot);
};

// Four of them fit on a sheet.
const SHEET_PLOT = 164;
const isPrinting = () => document.documentElement.classList.contains("printing");
// Beside the picture there is less room in a low window.
const stagePlotHeight = () => {
  const room = innerHeight - document.getElementById("stage").getBoundingClientRect().top - scrollY;
  return Math.round(Math.max(132, Math.min(176, room - 604)));
};

// Names of series that are not agents; what is dashed is named where its card does not say what dashes are.
const key = (series, plot) => {
  const named = foremost(series.filter((s) => !s.dash || s.keyed));
  const list = element("div", { className: "key" });
  for (const s of named.slice(0, 24)) {
    const line = element("i");
    line.style.background = s.dash?.length ? `repeating-linear-gradient(90deg, ${s.colour} 0 5px, transparent 5px 8px)` : s.colour;
    // A thinner curve of the same colour is told apart by that.
    if (s.width != null) line.style.height = `${s.width}px`;
    list.append(element("span", {}, line, s.label));
  }
  if (named.length > 24) list.append(element("span", { textContent: `and ${named.length - 24} more` }));
  return list;
};

const UNNAMED = "what is drawn";
// A print has nothing to press, and says what was chosen instead.
const sayPicked = (place, said) => {
  const words = place.parentElement.querySelector(".picked") ?? element("span", { className: "picked" });
  words.textContent = said.join(", ");
  place.before(words);
};

// Buttons for a few options, a list for many. Returns what is chosen, keeping earlier choices that still exist.
const drawPicks = (card, spec, chosen) => {
  const place = card.querySelector(".pick");
  if (!place) return [];
  place.replaceChildren();
  const [picks, said] = [[], []];
  spec.picks.forEach((pick, k) => {
    const options = typeof pick.options === "function" ? pick.options(picks) : pick.options;
    const values = options.map(([value]) => value);
    picks.push(values.includes(chosen[k]) ? chosen[k] : (pick.first?.(picks, options) ?? values[0]));
    if (options.length < 2) return;
    const picked = options.find(([value]) => value === picks[k])[1];
    said.push((pick.name ?? UNNAMED) === UNNAMED ? picked : `${pick.name}: ${picked}`);
    const choose = (value) => {
      const mine = state.get(card);
      mine.picks[k] = value;
      fill(card);
      // What was pressed is made anew; whoever goes by keys stays there.
      place.querySelector(`select[data-pick="${k}"], [data-pick="${k}"][aria-pressed="true"]`)?.focus({ preventScroll: true });
    };
    const name = `${titleOf(card)}: ${pick.name ?? UNNAMED}`;
    const letters = options.reduce((sum, [, name]) => sum + name.length + 3, 0);
    if (letters <= 34) {
      const group = element("div", { className: "buttons" });
      group.setAttribute("role", "group");
      group.setAttribute("aria-label", name);
      for (const [value, name] of options) {
        const button = element("button", { type: "button", textContent: name, onclick: () => choose(value) });
        button.setAttribute("aria-pressed", String(value === picks[k]));
        button.dataset.pick = String(k);
        group.append(button);
      }
      place.append(group);
    } else {
      const select = element("select", { onchange: () => choose(select.value) });
      select.dataset.pick = String(k);
      select.setAttribute("aria-label", name);
      for (const [value, name] of options) select.append(element("option", { value, textContent: name, selected: value === picks[k] }));
      place.append(select);
    }
  });
  sayPicked(place, said);
  return picks;
};

// Where there is no graph, its place is for what the controllers ask for.
const inputs = document.querySelector('[data-plot="torque"]');
if (inputs && !scene.graphs.some((graph) => graph.length > 0)) document.querySelector(".beside-space").append(inputs);

const all = [...document.querySelectorAll("[data-plot]")];
// A card that fails says so in the banner and leaves the others alone.
const fillAll = () =>
  all.forEach((card) => {
    try {
      fill(card);
    } catch (error) {
      reportError(error);
    }
  });

// The legend switches agents on and off in every plot; a double click leaves one alone.
const legend = document.getElementById("legend");
const chips = everybody.map((name, i) => {
  const dot = element("span", { className: `dot a${i}` });
  const chip = element("button", { type: "button", title: `${name}: click to hide or show, double-click to see this one alone` }, dot, name);
  chip.onclick = () => {
    shownAgents.has(i) ? shownAgents.delete(i) : shownAgents.add(i);
    showAgents();
  };
  chip.ondblclick = () => {
    shownAgents.clear();
    shownAgents.add(i);
    showAgents();
  };
  return chip;
});
const everyone = element("button", { type: "button", className: "all", textContent: "all", onclick: () => (everybody.forEach((_, i) => shownAgents.add(i)), showAgents()) });
// Of many those whose names hold some letters.
const filter = element("input", { type: "search", placeholder: "filter agents" });
filter.setAttribute("aria-label", "Agents whose names hold these letters");
const matching = () => [...everybody.keys()].filter((i) => everybody[i].toLowerCase().includes(filter.value.trim().toLowerCase()));
const only = element("button", { type: "button", className: "all", textContent: "only these", hidden: true });
only.onclick = () => {
  shownAgents.clear();
  matching().forEach((i) => shownAgents.add(i));
  showAgents();
};
filter.oninput = () => {
  const found = new Set(matching());
  chips.forEach((chip, i) => (chip.hidden = !found.has(i)));
  only.hidden = found.size === 0 || found.size === everybody.length;
};
if (agents.length > MOST_CURVES) legend.append(filter, only, everyone, ...chips);
else legend.append(...chips, ...(everybody.length > 1 ? [everyone] : []));
// Quantiles are those of the agents that are shown.
const regroup = () => agents.length > MOST_CURVES && fillAll();
const showAgents = () => {
  stageAsk();
  chips.forEach((chip, i) => chip.setAttribute("aria-pressed", String(shownAgents.has(i))));
  everyone.hidden = shownAgents.size === everybody.length;
  regroup();
  for (const { plot, series } of state.values()) {
    if (plot?.curves) plot.redraw();
    if (!plot || !series) continue;
    series.forEach((s, k) => {
      if (s.agent == null || plot.series[k + 1].show === shownAgents.has(s.agent)) return;
      plot.setSeries(k + 1, { show: shownAgents.has(s.agent) });
    });
  }
  for (const [card, { plot }] of state) if (plot && card.querySelector(".exports")) labelled(card, plot);
  refreshTables();
};

// One joint for all cards that have the choice.
const joint = document.getElementById("joint");
for (const j of joints) joint.append(element("option", { value: String(j.axis), textContent: j.name }));
document.getElementById("joint-label").hidden = joints.length < 2;
if (jointWord === "axis") document.getElementById("joint-label").firstChild.textContent = "Axis ";
joint.onchange = () => {
  for (const card of all) {
    const picks = cards[card.dataset.plot]?.picks ?? [];
    const k = picks.findIndex(({ id }) => id === "joint");
    const mine = state.get(card);
    // A card that has nothing of this joint keeps its own.
    if (k < 0 || !picks[k].options(mine.picks).some(([value]) => value === joint.value)) continue;
    mine.picks[k] = joint.value;
    fill(card);
  }
};

const lines = document.getElementById("break-points");
lines.parentElement.hidden = index.break_points.length === 0;
lines.parentElement.title = "When the graph switches, a delay jumps, or a push begins or ends. Where they are many, they are drawn when plots are zoomed in.";
lines.onchange = () => {
  view.breakPoints = lines.checked;
  for (const plot of plots) plot.redraw(false);
};
document.getElementById("reset").onclick = () => zoomTo(null);

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", fillAll);
// The layout of the print is there before anything is measured, and all is drawn before the page is printed.
const advice = document.querySelector("details.advice:not([open])");
let unfolded = false;
const printing = (on) => {
  // A print says all that is advised.
  if (advice && (on ? !advice.open : unfolded)) advice.open = unfolded = on;
  document.documentElement.classList.toggle("printing", on);
  fillAll();
  fitSheet(on);
};
addEventListener("beforeprint", () => printing(true));
addEventListener("afterprint", () => printing(false));

let width = innerWidth;
addEventListener("resize", () => {
  if (innerWidth === width || isPrinting()) return; // a phone's address bar
  width = innerWidth;
  for (const card of all) {
    const plot = state.get(card)?.plot;
    if (plot) plot.setSize({ width: card.querySelector(".canvas").clientWidth, height: plot.height });
  }
});

if (agents.length <= MOST_CURVES) fillAll();
showAgents();
if (data.t("main").length === 0) document.querySelector("#signals .grid").append(element("p", { className: "note", textContent: "Nothing was recorded." }));
document.documentElement.dataset.ready = String(plots.size);
