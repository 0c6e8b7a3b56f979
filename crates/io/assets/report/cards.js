// What each card shows. A card has picks (a joint, a signal, an agent) and turns them into series.

const agents = index.agents;
// Everybody who has curves: the agents, and last a leader that is none.
const everybody = [...agents.map((agent) => agent.name), ...(index.leader ? [leading(index.leader.name, true)] : [])];
const shownAgents = new Set(everybody.keys());
const signals = index.signals;
const mostAxes = Math.max(0, ...agents.map((a) => a.axes.length));
const SAME = (items) => (new Set(items).size === 1 ? items[0] : null);

// Joints by number; a name when all agents that have the joint call it the same.
const joints = Array.from({ length: mostAxes }, (_, axis) => {
  const owners = agents.filter((a) => axis < a.axes.length);
  return { axis, name: SAME(owners.map((a) => a.axes[axis].name)) ?? String(axis + 1), units: owners.map((a) => a.axes[axis].units) };
});
const unitOf = (axis, read) => unitsOf((joints[axis]?.units ?? []).map(read));

// Of more agents than this quantiles are drawn, and curves of those that are chosen.
const MOST_CURVES = 24;
const shownCurves = () => agents.filter((_, i) => shownAgents.has(i)).length;
const isBanded = () => shownCurves() > MOST_CURVES;
const QUANTILES = [[1, "greatest", 1, [4, 3]], [0.9, "nine tenths are below", 1.2, []], [0.5, "median", 2.2, []], [0.1, "a tenth is below", 1.2, []], [0, "least", 1, [4, 3]]];
const quantiles = (columns, log) => {
  const all = columns.map((k) => data.values("main", k));
  const beyond = all.map(({ beyond_s }) => beyond_s).filter((t) => t !== null);
  const curves = QUANTILES.map(() => []);
  const row = new Float64Array(all.length);
  for (let i = 0; i < all[0].length; i++) {
    // Of what is not known of all there is no quantile.
    const isWhole = all.every((values) => values[i] !== null);
    all.forEach((values, k) => (row[k] = values[i]));
    if (isWhole) row.sort();
    QUANTILES.forEach(([share], q) => {
      const v = isWhole ? row[Math.round(share * (row.length - 1))] : null;
      curves[q].push(v !== null && (!log || v > 0) ? v : null);
    });
  }
  return curves.map((values, q) => {
    const [, label, width, dash] = QUANTILES[q];
    return { label, keyed: true, colour: colour(label === "median" ? "--ink" : "--muted"), width, dash, values: Object.assign(values, { beyond_s: beyond.length ? Math.min(...beyond) : null }) };
  });
};
const ofAgents = (columns, axis, style = {}, log = false) => {
  const columnOf = (i) => (axis === null ? columns[i] : columns[i]?.[axis]);
  if (!isBanded()) return curvesOf(agents.keys(), columnOf, style, log);
  const own = [...agents.keys()].filter((i) => shownAgents.has(i) && columnOf(i) != null);
  const chosen = curvesOf(own.filter((i) => String(i) === document.getElementById("chosen").value), columnOf, { width: 2, ...style, keyed: true }, log);
  return own.length === 0 || style.suffix ? chosen : [...quantiles(own.map(columnOf), log), ...chosen];
};
const curvesOf = (some, columnOf, style, log) =>
  [...some].flatMap((i) => {
    const [agent, k] = [agents[i], columnOf(i)];
    if (k == null) return [];
    return [{ label: agent.name + (style.suffix ?? ""), colour: colour(`--a${i}`), agent: i, show: shownAgents.has(i), values: data.values("main", k, log), ...style }];
  });

// The distinct limits of a joint, both signs.
const limitLines = (axis, read, label) => {
  const values = new Set(agents.flatMap((a) => (a.axes[axis] ? read(a.axes[axis]) : [])).filter((v) => v != null));
  return values.size > 6 ? [] : [...values].map((value) => ({ value, label }));
};
const both = (v) => (v == null ? [] : [v, -v]);

// Ships and masses have no joints.
const jointWord = index.scene.arms.length === 0 ? "axis" : "joint";

// The joints of which something is drawn.
const jointPick = (columnsOf) => ({
  id: "joint",
  name: jointWord,
  options: (picks) => {
    const columns = columnsOf(picks) ?? [];
    return joints.filter((j) => columns.some((axes) => axes?.[j.axis] != null)).map((j) => [String(j.axis), j.name]);
  },
});

// A leader that is no agent, beside those that follow it.
const ofLeader = (columns, axis) => {
  const k = columns?.[axis];
  if (k == null) return [];
  const agent = agents.length;
  return [{ label: everybody[agent], agent, show: shownAgents.has(agent), colour: colour("--ink"), width: 2.2, dash: [8, 3], values: data.values("main", k) }];
};

const perJoint = (columns, unit, lines = () => [], leader = null) => ({
  picks: [jointPick(() => columns)],
  build: ([joint]) => joint == null ? { series: [] } : ({ unit: unitOf(+joint, unit), series: [...ofAgents(columns, +joint), ...ofLeader(leader, +joint)], lines: lines(+joint) }),
});

const dots = ["z", "ż", "z̈", "z⃛"];
const referenceName = (k) => dots[k] ?? `z${raise(`${k}`)}`;
const velocity = perJoint(signals.dq, (u) => u.dq, (axis) => limitLines(axis, (a) => both(a.velocity_limit), "limit"), index.leader?.dq);

const groupOf = (name) => (name.includes(".") ? name.slice(0, name.lastIndexOf(".")) : null);
const withEstimates = [...agents.keys()].filter((i) => agents[i].parameters.some((p) => p.series != null));
const parameterOptions = (who) => {
  if (who === "all") {
    const names = new Set(withEstimates.flatMap((i) => agents[i].parameters.map((p) => p.name)));
    return [...names].map((name) => [`one:${name}`, name]);
  }
  const { parameters } = agents[+who];
  const groups = [...new Set(parameters.map((p) => groupOf(p.name)))].filter((g) => g !== null);
  const options = (groups.length > 1 ? groups : []).map((g) => [`group:${g}`, g]);
  const every = ["every", `all ${parameters.length}`];
  return parameters.length <= 12 ? [every, ...options] : [...options, every];
};

// The group of parameters that moves most, where not all of them can be shown at once.
const liveliest = (who, options) => {
  if (who == null || who === "all" || options[0]?.[0] === "every") return options[0]?.[0];
  const move = (p) => {
    let [low, high] = [Infinity, -Infinity];
    for (const v of p.series == null ? [] : data.values("estimates", p.series)) if (v != null) [low, high] = [Math.min(low, v), Math.max(high, v)];
    return Math.max(0, high - low);
  };
  const moves = new Map();
  for (const p of agents[+who].parameters) moves.set(groupOf(p.name), Math.max(moves.get(groupOf(p.name)) ?? 0, move(p)));
  const groups = options.map(([value]) => value).filter((value) => value.startsWith("group:"));
  return groups.sort((a, b) => moves.get(b.slice(6)) - moves.get(a.slice(6)))[0] ?? options[0]?.[0];
};

const estimateSeries = (who, what) => {
  const truthOf = (p, c) => (p.truth == null ? [] : [{ label: `${p.name}, truth`, colour: c, dash: [5, 4], width: 1, values: data.t("estimates").map(() => p.truth) }]);
  if (who === "all") {
    const name = what.slice(4);
    return withEstimates.flatMap((i) => {
      const p = agents[i].parameters.find((p) => p.name === name);
      if (p?.series == null) return [];
      const c = colour(`--a${i}`);
      const mine = [{ label: agents[i].name, colour: c, values: data.values("estimates", p.series) }, ...truthOf({ ...p, name: agents[i].name }, c)];
      return mine.map((s) => ({ ...s, agent: i, show: shownAgents.has(i) }));
    });
  }
  const chosen = agents[+who].parameters.filter((p) => p.series != null && (what === "every" || groupOf(p.name) === what.slice(6)));
  return chosen.flatMap((p, k) => {
    const c = ramp(k, chosen.length);
    const name = what === "every" ? p.name : p.name.slice(what.length - 5);
    return [{ label: name, colour: c, values: data.values("estimates", p.series) }, ...(chosen.length <= 12 ? truthOf(p, c) : [])];
  });
};

const spansDecades = (series) => {
  let [low, high] = [Infinity, 0];
  for (const { values } of series) for (const v of values) if (v > 0) [low, high] = [Math.min(low, v), Math.max(high, v)];
  return high > 30 * low;
};

const balances = {
  v: { columns: signals.lyapunov, log: true, unit: index.energy },
  sum: { columns: signals.balance_sum, log: false, unit: index.energy, said: `${index.energy && `${index.energy}, `}flat when the proof’s identity holds` },
  error: { columns: signals.balance_residual, log: true, unit: "V(0)", said: "of V(0)" },
};

const cards = {
  disagreement: {
    picks: [],
    build: () => {
      const d = index.disagreement;
      if (!d) return { series: [] };
      const axes = d.per_axis.length > 1 ? d.per_axis : [];
      return {
        unit: d.unit,
        log: true,
        lines: index.goal == null ? [] : [{ value: index.goal, label: "goal" }],
        key: true,
        series: [
          ...axes.map((k, axis) => ({ label: d.names[axis], colour: ramp(axis, axes.length), width: 1.1, values: data.values("main", k, true) })),
          ...(d.predicted == null ? [] : [{ label: "predicted", keyed: true, first: true, colour: colour("--ink"), dash: [6, 4], width: 1.4, values: data.values("main", d.predicted, true) }]),
          { label: axes.length ? "largest" : d.word, first: true, colour: colour("--ink"), width: 2.2, values: data.values("main", d.overall, true) },
        ],
      };
    },
  },
  position: perJoint(signals.q, (u) => u.q, (axis) => [
    ...limitLines(axis, (a) => a.position_limits ?? [], "limit"),
    ...(index.predicted?.[axis] == null ? [] : [{ value: index.predicted[axis], label: "predicted agreement" }]),
  ], index.leader?.q),
  velocity: {
    ...velocity,
    build: (picks) => {
      const built = velocity.build(picks);
      const z = signals.reference[0] && picks[0] != null ? ofAgents(signals.reference[0], +picks[0], { suffix: ", z", dash: [4, 3], width: 1.1 }) : [];
      const unit = z.length ? unitOf(+picks[0], (u) => u.reference[0]) : built.unit;
      return { ...built, unit: unit === built.unit ? unit : `${built.unit || "1"}, z in ${unit || "1"}`, series: [...built.series, ...z] };
    },
  },
  error: perJoint(signals.s, (u) => u.s),
  torque: perJoint(signals.tau, (u) => u.tau, (axis) => limitLines(axis, (a) => both(a.effort_limit), "limit")),
  external: perJoint(signals.tau_ext, (u) => u.tau_ext),
  reference: {
    picks: [{ id: "order", name: "derivative", options: signals.reference.slice(1).map((_, k) => [String(k + 1), referenceName(k + 1)]) }, jointPick(([order]) => signals.reference[+order])],
    build: ([order, joint]) => ({ unit: order == null ? "" : unitOf(+joint, (u) => u.reference[+order]), series: order == null ? [] : ofAgents(signals.reference[+order], +joint) }),
  },
  estimate: {
    picks: [
      { id: "who", name: "agent", options: withEstimates.length === 0 ? [] : [...withEstimates.map((i) => [String(i), agents[i].name]), ...(withEstimates.length > 1 ? [["all", "compare agents"]] : [])] },
      { id: "what", name: "parameters", options: (picks) => (picks[0] == null ? [] : parameterOptions(picks[0])), first: (picks, options) => liveliest(picks[0], options) },
    ],
    build: ([who, what]) => ({ grid: "estimates", unit: index.energy && "SI units", series: who == null || what == null ? [] : estimateSeries(who, what), key: who !== "all" }),
  },
  balance: {
    picks: [{ id: "balance", name: "what is drawn", options: [["v", "V"], ["sum", "V + ∫ dissipation"], ["error", "error"]].filter(([id]) => balances[id].columns.some((k) => k != null)) }],
    build: ([which]) => {
      const { columns, unit, said } = balances[which];
      // V often falls by little, since it need not vanish: a logarithmic axis is for what spans decades.
      const log = balances[which].log && spansDecades(ofAgents(columns, null, {}, true));
      return { unit, said, log, series: ofAgents(columns, null, {}, log) };
    },
  },
  injected: {
    picks: [{ id: "cause", name: "cause", options: [["", "all causes"], ...(index.injected?.by ?? []).map(([name]) => [name, name])] }],
    build: ([cause]) => {
      const own = index.injected;
      if (!own) return { series: [] };
      const causes = own.by.map(([label, k], i) => ({ label, colour: ramp(i, own.by.length), width: 1.4, values: data.values("main", k) }));
      if (cause) return { unit: index.energy, series: causes.filter(({ label }) => label === cause) };
      // They add up to how V has changed.
      const v = data.values("main", own.v);
      const start = v.find((value) => value !== null) ?? 0;
      const change = Object.assign(v.map((value) => (value === null ? null : value - start)), { beyond_s: v.beyond_s });
      return { unit: index.energy, key: true, series: [...causes, { label: "V − V(0)", first: true, colour: colour("--ink"), width: 2.2, values: change }] };
    },
  },
  cascade: {
    picks: [{ id: "interval", name: "what is drawn", options: [["", "length"], ...joints.filter((j) => index.cascade?.low[j.axis] != null).map((j) => [String(j.axis), j.name])] }],
    build: ([axis]) => {
      const c = index.cascade;
      if (!c) return { series: [] };
      const line = (label, k, more) => (k == null ? [] : [{ label, colour: colour("--ink"), width: 2.2, values: data.values("main", k, axis === ""), ...more }]);
      if (axis === "") return { unit: c.unit, log: true, key: true, series: [...line("guaranteed for s ≡ 0", c.guaranteed, { dash: [6, 4], width: 1.4, keyed: true }), ...line("length", c.width)] };
      const ends = { dash: [6, 4], width: 1.4, keyed: true };
      return { unit: unitOf(+axis, (u) => u.q), series: [...ofAgents(signals.q, +axis), ...line("lowest of all", c.low[+axis], ends), ...line("highest of all", c.high[+axis], ends)] };
    },
  },
  delay: {
    picks: [],
    build: () => ({
      grid: "delays",
      unit: "s",
      key: index.delays.length > 1 || index.delays.some((d) => d.band),
      series: index.delays.flatMap((d, k) => {
        const line = { colour: ramp(k, index.delays.length), exact: true };
        const values = data.values("delays", d.series);
        if (!d.band) return [{ ...line, label: d.label, values }];
        // The greatest and the least stand in turn; beside one of them stands the other.
        const end = (pick) => values.map((v, row) => pick(v, values[row > 0 ? row - 1 : Math.min(1, values.length - 1)]));
        return [{ ...line, label: `${d.label}, greatest`, values: end(Math.max) }, { ...line, label: `${d.label}, least`, width: 1, values: end(Math.min) }];
      }),
    }),
  },
};

// Signals that only some systems have: an entry is picked, all agents are drawn.
for (const { id, entries } of index.families) {
  cards[id] = {
    picks: [{ id: "entry", name: "entry", options: entries.map((e, k) => [String(k), e.name]).filter((_, k) => entries[k].series.some((s) => s != null)) }],
    build: ([k]) => {
      const entry = entries[+k];
      if (!entry) return { series: [] };
      const wanted = entry.wanted.length ? ofAgents(entry.wanted, null, { suffix: ", commanded", dash: [4, 3], width: 1.1 }) : [];
      const lines = entry.lines.length > 6 ? [] : entry.lines;
      return { unit: entry.unit, lines, series: [...ofAgents(entry.series, null), ...wanted] };
    },
  };
}

const notDrawn = index.gantt.drawn_until_s === null ? "" : `not drawn after ${number(index.gantt.drawn_until_s)} s`;

// The same as rows: who hears whom, from when to when.
const ganttRows = () => {
  const { rows, bars, by_receiver } = index.gantt;
  const all = bars.map(([start, end, row, edges]) => [rows[row][0], start, end, ...(by_receiver ? [edges] : [])]);
  const head = [by_receiver ? "receiver" : "edge", "from, in s", "to, in s", ...(by_receiver ? ["agents heard"] : [])];
  return { head, all, said: `${rows.length === 1 ? "1 row" : `${rows.length} rows`}${notDrawn && `, ${notDrawn}`}` };
};

// The Gantt strip is drawn by hand on an empty plot, so that it zooms with the others.
const ganttCard = () => {
  const { rows, bars, spans, by_receiver, drawn_until_s: until } = index.gantt;
  const strip = new Set(spans.map((s) => s[2])).size > 1 ? 1 : 0;
  const most = Math.max(1, ...bars.map((b) => b[3]));
  const rowHeight = rows.length > 40 ? 11 : 19;
  const names = [...(strip ? ["graph"] : []), ...rows.map((r) => r[0])];
  const mostWide = innerWidth < 640 ? 128 : 190;
  // Of an edge both names and the arrow stay: the letters that there are room for are shared.
  const short = (name) => {
    const parts = name.split(" → ");
    const fits = (letters) => parts.map((part) => shortName(part, letters)).join(" → ");
    let letters = Math.max(...parts.map((part) => [...part].length));
    while (letters > 3 && widthOf(fits(letters)) > mostWide - 16) letters -= 1;
    return fits(letters);
  };
  const labels = names.map(short);
  const width = Math.min(mostWide, 16 + Math.max(24, ...labels.map(widthOf)));
  const draw = (u) =>
    clipped(u, (ctx, scale) => {
      const x = (t) => u.valToPos(t, "x", true);
      const y = (row) => u.valToPos(row, "y", true);
      const box = (start, end, row, inset) => [x(start), y(row) + inset * scale, Math.max(scale, x(end) - x(start)), y(row + 1) - y(row) - 2 * inset * scale];
      const { min, max } = u.scales.x;
      if (strip) {
        ctx.font = `600 ${10.5 * scale}px ui-sans-serif, system-ui, sans-serif`;
        ctx.textAlign = "center";
        ctx.textBaseline = "middle";
        for (const [start, end, graph] of spans) {
          if (end < min || start > max) continue;
          const [left, top, w, h] = box(start, end, 0, 2);
          ctx.fillStyle = colour(graph % 2 ? "--strip-b" : "--strip-a");
          ctx.fillRect(left, top, w, h);
          ctx.fillStyle = colour("--muted");
          if (w > 16 * scale) ctx.fillText(String(graph + 1), left + w / 2, top + h / 2 + 0.5 * scale);
        }
      }
      for (const [start, end, row, edges] of bars) {
        if (end < min || start > max) continue;
        ctx.globalAlpha = by_receiver ? 0.25 + (0.7 * edges) / most : 0.85;
        ctx.fillStyle = colour(`--a${rows[row][1]}`);
        ctx.fillRect(...box(start, end, row + strip, rowHeight > 12 ? 3 : 1));
      }
      ctx.globalAlpha = 1;
      // What is not on the page is not "nobody hears anybody".
      if (until === null || until >= max) return;
      const left = Math.max(x(until), u.bbox.left);
      const [top, wide, high] = [u.bbox.top, u.bbox.left + u.bbox.width - left, u.bbox.height];
      ctx.fillStyle = colour("--strip-a");
      ctx.fillRect(left, top, wide, high);
      Object.assign(ctx, { font: `${11 * scale}px ui-sans-serif, system-ui, sans-serif`, fillStyle: colour("--soft"), textAlign: "center", textBaseline: "middle" });
      ctx.fillText(notDrawn, left + 0.5 * wide, top + 0.5 * high);
    });
  return {
    times: axisOf(whole),
    series: [{ label: "", colour: "transparent", values: [null, null] }],
    height: names.length * rowHeight + 42,
    cursor: false,
    y: {
      scale: { range: () => [0, names.length], dir: -1 },
      axis: {
        size: width,
        splits: () => names.map((_, k) => k + 0.5),
        values: () => labels,
        filter: (u, splits) => splits,
        space: 1,
        grid: { show: false },
      },
    },
    draw: [draw],
  };
};
