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
  const empty = (why) => canvas.replaceChildren(element("p", { className: "none", textContent: why || "nothing was recorded" }));

  if (kind === "gantt") {
    if (index.gantt.rows.length === 0) return empty("no agent hears another");
    if (index.gantt.by_receiver) document.getElementById("gantt-by").textContent = "per receiver; the stronger, the more agents it hears";
    mine.plot = drawPlot(canvas, ganttCard());
    return;
  }
  if (kind === "plane") {
    if (quantities.length < 2 || data.t("main").length === 0) return empty();
    mine.picks = drawPicks(card, planeSpec, mine.picks);
    mine.plot = drawPlane(canvas, mine.picks, height ?? (innerWidth < 640 ? 220 : 240));
    offer(card, mine.plot);
    return;
  }
  if (kind === "path") {
    mine.plot = drawPaths(canvas, height ?? 290);
    offer(card, mine.plot);
    return;
  }
  const spec = cards[kind];
  mine.picks = drawPicks(card, spec, mine.picks);
  const built = spec.build(mine.picks);
  const unit = card.querySelector(".unit") ?? card.querySelector("h3").appendChild(element("span", { className: "unit" }));
  unit.textContent = built.unit ? ` ${built.unit}` : "";
  const times = data.t(built.grid ?? "main");
  if (built.series.length === 0 || times.length === 0) return empty(card.dataset.empty);
  if (built.series.every((s) => s.values.every((v) => v === null))) return empty("no value can be drawn: all are zero or not finite");
  mine.series = built.series;
  const far = built.log ? null : outliers(built.series);
  mine.plot = drawPlot(canvas, { ...built, times, height: height ?? (card.closest("#stage") && innerWidth > 1000 ? 176 : undefined), within: far?.usual });
  if (far) canvas.append(element("p", { className: "note", textContent: `Some values leave this axis; the largest is ${number(far.largest)}.` }));
  if (built.key) card.append(key(built.series, mine.plot));
  offer(card, mine.plot);
};

// Names of series that are not agents.
const key = (series, plot) => {
  const named = series.filter((s) => !s.dash);
  const list = element("div", { className: "key" });
  for (const s of named.slice(0, 24)) {
    const line = element("i");
    line.style.background = s.colour;
    list.append(element("span", {}, line, s.label));
  }
  if (named.length > 24) list.append(element("span", { textContent: `and ${named.length - 24} more` }));
  return list;
};

// Buttons for a few options, a list for many. Returns what is chosen, keeping earlier choices that still exist.
const drawPicks = (card, spec, chosen) => {
  const place = card.querySelector(".pick");
  if (!place) return [];
  place.replaceChildren();
  const picks = [];
  spec.picks.forEach((pick, k) => {
    const options = typeof pick.options === "function" ? pick.options(picks) : pick.options;
    const values = options.map(([value]) => value);
    picks.push(values.includes(chosen[k]) ? chosen[k] : (pick.first?.(picks, options) ?? values[0]));
    if (options.length < 2) return;
    const choose = (value) => {
      const mine = state.get(card);
      mine.picks[k] = value;
      fill(card);
    };
    const letters = options.reduce((sum, [, name]) => sum + name.length + 3, 0);
    if (letters <= 34) {
      const group = element("div", { className: "buttons" });
      for (const [value, name] of options) {
        const button = element("button", { type: "button", textContent: name, onclick: () => choose(value) });
        button.setAttribute("aria-pressed", String(value === picks[k]));
        group.append(button);
      }
      place.append(group);
    } else {
      const select = element("select", { onchange: () => choose(select.value) });
      for (const [value, name] of options) select.append(element("option", { value, textContent: name, selected: value === picks[k] }));
      place.append(select);
    }
  });
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
const chips = agents.map((agent, i) => {
  const dot = element("span", { className: `dot a${i}` });
  const chip = element("button", { type: "button", title: "Click to hide or show, double-click to see this one alone" }, dot, agent.name);
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
const everyone = element("button", { type: "button", className: "all", textContent: "all", onclick: () => (agents.forEach((_, i) => shownAgents.add(i)), showAgents()) });
legend.append(...chips, ...(agents.length > 1 ? [everyone] : []));
const showAgents = () => {
  stageAsk();
  chips.forEach((chip, i) => chip.setAttribute("aria-pressed", String(shownAgents.has(i))));
  everyone.hidden = shownAgents.size === agents.length;
  for (const { plot, series } of state.values()) {
    if (plot?.curves) plot.redraw();
    if (!plot || !series) continue;
    series.forEach((s, k) => {
      if (s.agent == null || plot.series[k + 1].show === shownAgents.has(s.agent)) return;
      plot.setSeries(k + 1, { show: shownAgents.has(s.agent) });
    });
  }
};

// One joint for all cards that have the choice.
const joint = document.getElementById("joint");
for (const j of joints) joint.append(element("option", { value: String(j.axis), textContent: j.name }));
document.getElementById("joint-label").hidden = joints.length < 2;
joint.onchange = () => {
  for (const card of all) {
    const spec = cards[card.dataset.plot];
    const k = spec?.picks.indexOf(jointPick) ?? -1;
    if (k < 0) continue;
    state.get(card).picks[k] = joint.value;
    fill(card);
  }
};

const lines = document.getElementById("break-points");
lines.parentElement.hidden = index.break_points.length === 0;
lines.onchange = () => {
  view.breakPoints = lines.checked;
  for (const plot of plots) plot.redraw(false);
};
document.getElementById("reset").onclick = () => zoomTo(null);

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", fillAll);
const printing = (on) => {
  document.documentElement.classList.toggle("printing", on);
  fillAll();
};
addEventListener("beforeprint", () => printing(true));
addEventListener("afterprint", () => printing(false));

let width = innerWidth;
addEventListener("resize", () => {
  if (innerWidth === width) return; // a phone's address bar
  width = innerWidth;
  for (const card of all) {
    const plot = state.get(card)?.plot;
    if (plot) plot.setSize({ width: card.querySelector(".canvas").clientWidth, height: plot.height });
  }
});

fillAll();
showAgents();
document.documentElement.dataset.ready = String(plots.size);
