// Several runs: pictures side by side with one clock, and plots in which each run has a colour.

const runs = index.runs.map((run, k) => {
  const data = dataOf(run, document.getElementById(`block-${k}`).textContent);
  const within = (name) => colour(name, document.querySelector(`.scene.run${k}`));
  const drawn = (frame) => pictureIn({ ...run, frame }, data, run.agents, within);
  return { ...run, k, data, drawn, picture: drawn(), shown: true };
});
// What is alike is seen from as far away, unless one of them would be lost in the picture of another.
const MOST_TIMES_LARGER = 3;
const alike = new Map();
for (const run of runs) {
  const kinds = [...new Set(run.picture.bodies.map((b) => b.kind))].sort().join();
  if (!run.picture.charted) alike.set(kinds, [...(alike.get(kinds) ?? []), run]);
}
for (const same of [...alike.values()].filter((some) => some.length > 1)) {
  const worlds = same.map(({ picture }) => picture.world);
  const corners = [[Math.min, "low"], [Math.max, "high"]].map(([pick, end]) => [0, 1, 2].map((k) => pick(...worlds.map((own) => own[end][k]))));
  const wide = Math.max(...[0, 1, 2].map((k) => corners[1][k] - corners[0][k]));
  if (!(wide <= MOST_TIMES_LARGER * Math.min(...worlds.map(({ extent }) => extent)))) continue;
  const spread = Math.max(...worlds.map((own) => own.spread));
  for (const run of same) run.picture = run.drawn({ corners, spread });
}
const runColour = (run) => colour(`--run${run.k}`);

// Plots: all times of all runs, and each run on straight lines between its own.
const cardsPlace = document.getElementById("cards");
// Disagreement of one run and errors of another are both what is to vanish.
const vanishing = ["gap", "gap-to-targets"];
const isMixed = vanishing.every((id) => runs.some((run) => run.quantities.some((q) => q.id === id)));
if (isMixed) {
  for (const { quantities } of runs) {
    const place = quantities.findIndex((q) => vanishing.includes(q.id));
    if (place < 0) continue;
    const { title, entries } = quantities[place];
    const [largest] = entries;
    quantities.splice(place, 0, { id: "vanishes", title: "What is to vanish: disagreement or error", log: true, entries: [{ ...largest, word: title.toLowerCase() }] });
  }
}
// Positions of one name may be of different units: they are not one quantity.
const placed = runs.flatMap((run) => run.quantities.filter(({ id }) => id === "position").flatMap(({ entries }) => entries));
for (const name of new Set(placed.map((entry) => entry.name))) {
  const alike = placed.filter((entry) => entry.name === name);
  if (new Set(alike.map(({ unit }) => unit)).size > 1) for (const entry of alike) entry.name = `${name}, ${entry.unit || "no unit"}`;
}
const quantityIds = [...new Set(runs.flatMap((run) => run.quantities.map((q) => q.id)))];
const having = (id) => runs.flatMap((run) => run.quantities.filter((q) => q.id === id).map((quantity) => ({ run, quantity })));
const timesOf = (list) => Float64Array.from(new Set(list.flatMap((run) => run.data.t("main")))).sort();
const allTimes = timesOf(runs);
const sampled = new Map();
const valuesOf = (run, k, log) => {
  const key = `${run.k} ${k} ${log}`;
  if (!sampled.has(key)) {
    const end = run.until_s;
    sampled.set(key, Array.from(allTimes, (t) => {
      if (t > end) return null;
      const v = run.data.at("main", k, run.data.place("main", t));
      return Number.isFinite(v) && (!log || v > 0) ? v : null;
    }));
  }
  return sampled.get(key);
};
// The same at rows that were recorded, of whichever run, and between those of each.
const recordedOf = (run, k, times) => {
  const own = run.data.picked("main", run.data.t("main"));
  const values = run.data.picked("main", run.data.values("main", k));
  return times.map((t) => {
    if (t > run.until_s) return null;
    const { row, part } = placeIn(own, t);
    const [a, b] = [values[row], values[row + (part > 0 ? 1 : 0)]];
    return a === null || b === null ? null : a + part * (b - a);
  });
};
const LINES = { run: { width: 1.8 }, predicted: { width: 1.2, dash: [6, 4] }, band: { width: 0.9, dash: [2, 3] } };
const SUFFIX = { run: "", predicted: ", predicted" };
// The least and the greatest of all agents come in this order.
const ENDS = [", least", ", greatest"];

// What is not drawn here, and whose it is.
const alone = [];
const sideCards = quantityIds.flatMap((id) => {
  const all = having(id);
  // What one run alone has cannot be compared.
  const names = [...new Set(all.flatMap(({ quantity }) => quantity.entries.map((e) => e.name)))];
  const common = names.filter((name) => all.filter(({ quantity }) => quantity.entries.some((e) => e.name === name)).length > 1);
  if (common.length === 0) {
    if (!isMixed || !vanishing.includes(id)) alone.push(`${all[0].quantity.title} (${all.map(({ run }) => run.name).join(", ")})`);
    return [];
  }
  const without = all.filter(({ quantity }) => !quantity.entries.some((e) => common.includes(e.name)));
  if (without.length) alone.push(`${all[0].quantity.title} (${without.map(({ run }) => run.name).join(", ")})`);
  const card = element("article", { className: "card plot" });
  card.dataset.plot = id;
  const unit = element("span", { className: "unit" });
  const pick = element("div", { className: "pick" });
  const [canvas, picked] = [element("div", { className: "canvas" }), element("span", { className: "picked" })];
  card.append(element("div", { className: "head" }, element("h3", {}, all[0].quantity.title, unit), picked, pick), canvas);
  cardsPlace.append(card);
  return [{ id, all, common, card, unit, pick, picked, canvas, chosen: common[0], log: all[0].quantity.log, plot: null }];
});

if (alone.length) cardsPlace.after(element("p", { className: "note", id: "alone", textContent: `On the pages of the runs alone, since no other has it under the same name and in the same unit: ${alone.join("; ")}.` }));

const fillCard = (mine) => {
  if (mine.plot) removePlot(mine.plot);
  mine.plot = null;
  mine.canvas.replaceChildren();
  const button = (text, pressed, onclick) => {
    const made = element("button", { type: "button", textContent: text, onclick });
    made.setAttribute("aria-pressed", String(pressed));
    return made;
  };
  const scale = element("div", { className: "buttons" });
  for (const [log, text] of [[false, "linear"], [true, "log"]]) scale.append(button(text, mine.log === log, () => ((mine.log = log), fillCard(mine))));
  const entry = element("select", { onchange: () => ((mine.chosen = entry.value), fillCard(mine)) });
  entry.setAttribute("aria-label", "what is drawn");
  for (const name of mine.common) entry.append(element("option", { value: name, textContent: name, selected: name === mine.chosen }));
  // A print has nothing to press.
  mine.picked.textContent = mine.common.length > 1 ? mine.chosen : "";
  // What has both signs has no logarithm.
  mine.pick.replaceChildren(...(mine.common.length > 1 ? [entry] : []), ...(mine.id === "position" ? [] : [scale]));
  const found = mine.all.flatMap(({ run, quantity }) => quantity.entries.filter((e) => e.name === mine.chosen).map((e) => ({ run, entry: e })));
  const units = [...new Set(found.map(({ entry: { unit } }) => unit))];
  // What has no unit stands beside what has one.
  mine.unit.textContent = units.join("") ? ` ${units.map((unit) => unit || "no unit").join(" beside ")}` : "";
  mine.series = found.flatMap(({ run, entry: e }) => {
    const bands = e.lines.filter(({ style }) => style === "band");
    const suffix = (line) => SUFFIX[line.style] ?? ENDS[bands.indexOf(line)] ?? "";
    const name = e.word ? `${run.name}, ${e.word}` : run.name;
    return e.lines.map((line) => ({ ...LINES[line.style], run, k: line.series, label: name + suffix(line), unit: e.unit, colour: runColour(run), show: run.shown, values: valuesOf(run, line.series, mine.log) }));
  });
  if (mine.series.every((s) => s.values.every((v) => v === null))) {
    mine.canvas.append(element("p", { className: "none", textContent: "no value can be drawn: all are zero or not finite" }));
    return;
  }
  const far = mine.log ? null : outliers(mine.series);
  mine.plot = drawPlot(mine.canvas, { times: allTimes, series: mine.series, log: mine.log, within: far?.usual, unit: units.length === 1 ? units[0] : "" });
  mine.plot.recorded = () => {
    const times = Array.from(new Set(mine.series.flatMap(({ run }) => run.data.picked("main", run.data.t("main"))))).sort((a, b) => a - b);
    return [times, ...mine.series.map(({ run, k }) => recordedOf(run, k, times))];
  };
  const note = (textContent) => mine.canvas.append(element("p", { className: "note", textContent }));
  if (far) note(`Some values leave this axis; the largest is ${number(far.largest)}.`);
  const lost = found.flatMap(({ run, entry: e }) => e.lines.map(({ series }) => ({ run, t: run.data.beyond("main", series) }))).filter(({ t }) => t !== null);
  for (const { run } of lost.filter(({ run }, k) => lost.findIndex((other) => other.run === run) === k)) {
    note(`${run.name}: beyond what the page can draw from t = ${number(Math.min(...lost.filter((other) => other.run === run).map(({ t }) => t)))} s on.`);
  }
  offer(mine.card, mine.plot);
};
const fillCards = () => {
  sampled.clear();
  for (const mine of sideCards) {
    try {
      fillCard(mine);
    } catch (error) {
      reportError(error);
    }
  }
};

const legend = document.getElementById("legend");
const chips = runs.map((run) => {
  const chip = element("button", { type: "button", title: `${run.name}: click to hide or show` }, element("span", { className: `dot run${run.k}` }), run.name);
  chip.setAttribute("aria-pressed", "true");
  chip.onclick = () => {
    run.shown = !run.shown;
    chip.setAttribute("aria-pressed", String(run.shown));
    for (const mine of sideCards) mine.plot && mine.series.forEach((s, k) => s.run === run && mine.plot.setSeries(k + 1, { show: run.shown }));
  };
  return chip;
});
legend.append(...chips);
document.getElementById("reset").onclick = () => zoomTo(null);

// Names of keys break between their words.
const breakable = (text) => text.replace(/([a-z0-9][._])(?=[a-z])/gi, "$1\n").split("\n").flatMap((part, k) => (k ? [element("wbr"), part] : [part]));
const textsIn = (part) => [...part.childNodes].flatMap((node) => (node.nodeType === Node.TEXT_NODE ? [node] : textsIn(node)));
for (const text of textsIn(document.querySelector(".compared"))) text.replaceWith(element("span", {}, ...breakable(text.data)));

// Pictures, projected, and the clock of all.
const side = (() => {
  const part = (id) => document.getElementById(id);
  const [slider, play, timeWords, rate] = ["slider", "play", "time", "rate"].map(part);
  const scenes = document.querySelector(".scenes");
  const end = whole[1];
  const now = { t: 0, playing: false, since: 0 };
  let asked = 0;
  slider.max = String(end);
  slider.disabled = play.disabled = end === 0;
  // What is measured where bodies stand, as the page of one run says it.
  const lengthOf = ({ picture, agents }) => (picture.bodies.some((b) => b.kind !== "point") ? " m" : ` ${unitsOf(agents.flatMap((a) => a.axes.map((x) => x.units.q)))}`.trimEnd());
  const views = [...document.querySelectorAll(".scene")].map((card, k) => {
    const canvas = element("canvas");
    canvas.setAttribute("role", "img");
    card.querySelector(".view").append(canvas);
    return { run: runs[k], canvas, ctx: canvas.getContext("2d"), words: card.querySelector(".words"), unit: lengthOf(runs[k]), colours: runs[k].picture.sceneColours() };
  });
  const nothing = () => false;

  const drawOne = ({ run, canvas, ctx, words, colours, unit }) => {
    const picture = run.picture;
    const [width, height, scale] = [canvas.clientWidth, canvas.clientHeight, Math.min(2, devicePixelRatio || 1)];
    if (width === 0 || height === 0) return;
    if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
    if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
    ctx.setTransform(scale, 0, 0, scale, 0, 0);
    ctx.clearRect(0, 0, width, height);
    const t = Math.min(now.t, run.until_s);
    const frame = picture.frameAt(t, nothing);
    const see = picture.looking(width, height, frame.nodes);
    const heard = picture.heardAt(t);
    picture.drawUnder(ctx, see, colours);
    picture.drawSolids(ctx, see, frame, colours);
    picture.drawTrails(ctx, see, frame, colours, nothing, null);
    picture.drawMarks(ctx, see, frame, colours, null);
    picture.drawEdges(ctx, see, frame, colours, heard);
    const unnamed = picture.drawWords(ctx, see, frame, colours, { hovered: null, alone: null });
    // A run that broke down may have ended after its last row.
    const over = now.t > run.until_s ? `Recorded until ${number(run.until_s, 4)} s. ` : "";
    const size = picture.charted ? "Positions over time. " : picture.floorGrid.step ? `Squares of ${number(picture.floorGrid.step, 2)}${unit}. ` : "";
    const more = [unnamed > 0 && unnamedWords(unnamed, frame.nodes.length), marksOf(picture.bodies).join("; "), picture.lostWords(frame)].filter(Boolean).map((words) => `${words[0].toUpperCase()}${words.slice(1)}. `);
    const text = `${over}${size}${more.join("")}${picture.graphWords(heard)}`;
    if (words.textContent !== text) words.textContent = text;
    canvas.setAttribute("aria-label", `${run.name} at ${number(t, 4)} s: ${picture.bodies.length} in space`);
  };
  const draw = () => {
    asked = 0;
    views.forEach(drawOne);
    timeWords.textContent = timeOf(now.t, end);
    slider.value = String(now.t);
    slider.setAttribute("aria-valuetext", `${number(now.t, 4)} seconds`);
    for (const plot of plots) plot.clock?.(now.t);
  };
  const ask = () => {
    if (!asked) asked = requestAnimationFrame(draw);
  };
  const go = (t) => ((now.t = Math.min(end, Math.max(0, t))), ask());

  // Whoever asked for less motion sees a picture every half second.
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const later = () => (calm.matches ? setTimeout(() => requestAnimationFrame(step), 480) : requestAnimationFrame(step));
  const step = (stamp) => {
    if (!now.playing) return;
    const passed = Math.min(calm.matches ? 1 : 0.5, Math.max(0, (stamp - now.since) / 1000));
    now.since = stamp;
    now.t = Math.min(end, now.t + passed * Number(rate.value));
    if (asked) cancelAnimationFrame(asked);
    draw();
    if (now.t >= end) setPlaying(false);
    else later();
  };
  const setPlaying = (on) => {
    if (on === now.playing) return;
    now.playing = on;
    play.textContent = on ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(on));
    if (!on) return;
    if (now.t >= end) now.t = 0;
    now.since = performance.now();
    later();
  };
  play.onclick = () => setPlaying(!now.playing);
  slider.oninput = () => (setPlaying(false), go(slidTo(slider, end)));
  fitRates(rate, end);

  const zoom = (by) => (runs.forEach(({ picture: { camera } }) => (camera.zoom = Math.min(30, Math.max(0.3, camera.zoom * by)))), ask());
  const turn = (az, el) => {
    for (const { picture: { camera } } of runs) {
      camera.az += az;
      camera.el = Math.min(90, Math.max(-20, camera.el + el));
    }
    ask();
  };
  scenes.addEventListener("keydown", (event) => {
    const does = {
      a: () => turn(-6, 0), d: () => turn(6, 0), w: () => turn(0, 6), s: () => turn(0, -6),
      "+": () => zoom(1.2), "=": () => zoom(1.2), "-": () => zoom(1 / 1.2),
    }[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    does();
  });
  clockKeys({ end, now, go, toggle: () => setPlaying(!now.playing) }, ".scenes");
  part("view-help").before(element("span", { className: "zooms" }, "pictures", ...zoomButtons("all pictures", zoom)));
  part("reset").before(element("span", { className: "zooms" }, "plots", ...zoomButtons("all plots, at the clock", (by) => zoomAbout(now.t, by))));
  part("view-help").textContent = "Space plays and pauses, and ← and → move in time, with Shift faster, wherever nothing has the focus that uses these keys. With the pictures or the slider in focus, Home and End go to the start and the end. Drag or W, A, S, D turn all pictures, + and − zoom. Plots follow the same clock.";
  for (const { canvas } of views) {
    let held = null;
    canvas.addEventListener("pointerdown", (event) => {
      held = { x: event.clientX, y: event.clientY };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!held) return;
      turn(-0.4 * (event.clientX - held.x), 0.4 * (event.clientY - held.y));
      held = { x: event.clientX, y: event.clientY };
    });
    for (const over of ["pointerup", "pointercancel"]) canvas.addEventListener(over, () => (held = null));
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      zoom(Math.exp(-0.004 * event.deltaY));
    }, { passive: false });
    new ResizeObserver(ask).observe(canvas);
  }
  const themed = () => (views.forEach((view) => (view.colours = view.run.picture.sceneColours())), ask());
  return { go, ask, now, themed, draw, playing: () => now.playing };
})();
stageGo = (t) => !side.playing() && side.go(t);
stageAsk = side.ask;

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => (fillCards(), side.themed()));
const printing = (on) => {
  document.documentElement.classList.toggle("printing", on);
  fillCards();
  fitSheet(on);
  side.themed();
  side.draw();
};
addEventListener("beforeprint", () => printing(true));
addEventListener("afterprint", () => printing(false));
let width = innerWidth;
addEventListener("resize", () => {
  if (innerWidth === width) return; // a phone's address bar
  width = innerWidth;
  for (const mine of sideCards) mine.plot?.setSize({ width: mine.canvas.clientWidth, height: mine.plot.height });
});

fillCards();
side.draw();
// For tests: where bodies are, as they are drawn.
Object.assign(document.getElementById("side"), {
  go: side.go,
  time: () => side.now.t,
  tips: (t) => runs.map((run) => run.picture.bodies.map((body) => run.picture.trailPoint(body, run.data.place("scene", Math.min(t, run.until_s))))),
  series: (id) => sideCards.find((card) => card.id === id)?.series.map((s) => ({ label: s.label, peak: s.values.reduce((most, v) => Math.max(most, Math.abs(v ?? 0)), 0) })),
});
document.documentElement.dataset.ready = String(plots.size);
