// One plot: uPlot with our axes, a cursor shared by all plots, one zoom for all, and a box that says what is under the cursor.

const plots = new Set();
const view = { zoom: null, breakPoints: true };
const whole = [0, Math.max(0, index.until_s)];
// A run that ended where it began has one instant; an axis needs room around it.
const axisOf = ([min, max]) => (max > min ? [min, max] : [min - 1, max + 1]);

const zoomTo = (range) => {
  view.zoom = range;
  document.getElementById("reset").disabled = range === null;
  const [min, max] = axisOf(range ?? whole);
  for (const plot of plots) plot.setScale("x", { min, max });
};
// Closer to a time, or less close: it stays where it is in all plots, and comes to their middle if it was out of sight.
const zoomAbout = (t, by) => {
  const [from, to] = view.zoom ?? whole;
  const length = Math.max((to - from) / by, 1e-5 * whole[1]);
  if (length >= whole[1]) return zoomTo(null);
  const share = t >= from && t <= to ? (t - from) / (to - from) : 0.5;
  const begin = Math.min(whole[1] - length, Math.max(whole[0], t - share * length));
  zoomTo([begin, begin + length]);
};
// Buttons for whoever has no mouse.
const zoomButtons = (what, zoom) =>
  [["−", "Zoom out", 1 / 1.5], ["+", "Zoom in", 1.5]].map(([textContent, how, by]) => {
    const title = `${how}: ${what}`;
    const button = element("button", { type: "button", className: "zoom", textContent, title, onclick: () => zoom(by) });
    button.setAttribute("aria-label", title);
    return button;
  });

// Times on an axis; of one instant nothing but that.
const timeTick = (t, step) => (whole[1] > 0 || t === 0 ? `${tick(t, step)} s` : "");

const axisFont = '11px ui-sans-serif, system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif';

// Room for the labels beside the vertical axis: the usual, or as much as the widest needs, such as −2.5 × 10³³.
const labelRoom = (u, labels) => {
  u.ctx.save();
  u.ctx.font = axisFont;
  const widest = Math.max(0, ...(labels ?? []).map((label) => u.ctx.measureText(label).width));
  u.ctx.restore();
  return Math.max(62, Math.ceil(widest) + 14);
};

const widthOf = (() => {
  const ctx = document.createElement("canvas").getContext("2d");
  return (text) => ((ctx.font = axisFont), ctx.measureText(text).width);
})();

const decades = (min, max) => {
  const low = Math.ceil(Math.log10(min) - 1e-9);
  const high = Math.floor(Math.log10(max) + 1e-9);
  const step = Math.max(1, Math.ceil((high - low) / 6));
  const ticks = [];
  for (let e = high; e >= low; e -= step) ticks.unshift(10 ** e);
  return ticks;
};

// Distances of ticks for all sizes a single-precision number can have; the library's own end at 1e16.
const increments = Array.from({ length: 80 }, (_, k) => [1, 2, 2.5, 5].map((m) => +`${m}e${k - 40}`)).flat();

// Multiples of such a distance within a range. The library's own count by rounded decimals, and never end below 1e-16.
const MOST_TICKS = 200;
const multiples = (min, max, step) => {
  const [first, last] = [Math.ceil(min / step - 1e-6), Math.floor(max / step + 1e-6)];
  return Array.from({ length: Math.max(0, Math.min(MOST_TICKS, last - first + 1)) }, (_, k) => (first + k) * step);
};

// The smallest usual distance of ticks that leaves room for their labels.
const stepOf = (perPixel, room) => increments.find((step) => step / perPixel >= room) ?? 1;

// Whole decades, but none below what double precision can tell from one, or from the greatest value.
const logRange = (u, min, max) => {
  if (!(min > 0) || !(max > 0)) return [1e-3, 1];
  const high = Math.ceil(Math.log10(max) + 1e-9);
  const low = Math.max(Math.floor(Math.log10(min) - 1e-9), Math.min(high, 0) - 18);
  return [10 ** Math.min(low, high - 1), 10 ** high];
};

const linearRange = (u, min, max) => {
  if (min == null || max == null) return [-1, 1];
  if (min === max) {
    const pad = Math.abs(min) * 0.1 || 1;
    return [min - pad, max + pad];
  }
  const pad = 0.06 * (max - min);
  return [min - pad, max + pad];
};

// What is drawn of values beyond an axis, in parts of it.
const FAR = 1000;

// A run that blew up at its end would flatten everything before: the axis then shows what the signals kept to until then.
const outliers = (series) => {
  // A run that blows up does so at its end, which beside another may come early.
  const sizeUpTo = (share) => series.reduce((most, { values }) => {
    const end = values.findLastIndex((v) => v !== null) + 1;
    for (let k = 0; k < Math.ceil(share * end); k++) if (Math.abs(values[k]) > most) most = Math.abs(values[k]);
    return most;
  }, 0);
  const [usual, largest] = [sizeUpTo(0.95), sizeUpTo(1)];
  return usual > 0 && largest > 100 * usual ? { usual, largest } : null;
};
const kept = (size, value) => (value == null ? value : Math.max(-size, Math.min(size, value)));
const rangeWithin = (size) => (u, min, max) => linearRange(u, kept(size, min), kept(size, max));

const clipped = (u, draw) => {
  const { left, top, width, height } = u.bbox;
  u.ctx.save();
  u.ctx.beginPath();
  u.ctx.rect(left, top, width, height);
  u.ctx.clip();
  draw(u.ctx, u.density ?? devicePixelRatio);
  u.ctx.restore();
};

const drawBreakPoints = (u) => {
  if (!view.breakPoints) return;
  const { min, max } = u.scales.x;
  const times = index.break_points.filter((t) => t >= min && t <= max);
  if (times.length > Math.max(24, u.width / 8)) return;
  clipped(u, (ctx, scale) => {
    ctx.strokeStyle = colour("--break");
    ctx.lineWidth = scale;
    ctx.beginPath();
    for (const t of times) {
      const x = Math.round(u.valToPos(t, "x", true)) + 0.5;
      ctx.moveTo(x, u.bbox.top);
      ctx.lineTo(x, u.bbox.top + u.bbox.height);
    }
    ctx.stroke();
  });
};

// Horizontal lines with a word above: limits, goals, predictions. They do not widen the axis.
const drawLines = (u, lines) =>
  clipped(u, (ctx, scale) => {
    ctx.font = `${10.5 * scale}px ui-sans-serif, system-ui, sans-serif`;
    for (const { value, label } of lines) {
      const y = u.valToPos(value, "y", true);
      if (!Number.isFinite(y) || y < u.bbox.top || y > u.bbox.top + u.bbox.height) continue;
      ctx.strokeStyle = colour("--muted");
      ctx.lineWidth = scale;
      ctx.setLineDash([6 * scale, 4 * scale]);
      ctx.beginPath();
      ctx.moveTo(u.bbox.left, y);
      ctx.lineTo(u.bbox.left + u.bbox.width, y);
      ctx.stroke();
      const right = u.bbox.left + u.bbox.width - 5 * scale;
      const baseline = y + (y - u.bbox.top < 18 * scale ? 14 : -5) * scale;
      ctx.setLineDash([]);
      // A rim around the letters: a box would hide the curves behind it.
      Object.assign(ctx, { textAlign: "right", textBaseline: "alphabetic", lineJoin: "round", lineWidth: 3 * scale, strokeStyle: colour("--surface"), fillStyle: colour("--soft") });
      ctx.strokeText(label, right, baseline);
      ctx.fillText(label, right, baseline);
    }
  });

// The values under the cursor, nearest first.
const readout = (log) => {
  const box = element("div", { className: "readout", hidden: true });
  const update = (u) => {
    const { left, top, idx } = u.cursor;
    if (left == null || left < 0 || idx == null || !u.over.matches(":hover")) {
      box.hidden = true;
      return;
    }
    const near = [];
    for (let k = 1; k < u.series.length; k++) {
      const v = u.whole[k - 1][idx];
      if (u.series[k].show && v != null) near.push({ k, v, distance: Math.abs(u.valToPos(v, "y") - top) });
    }
    near.sort((a, b) => a.distance - b.distance);
    const shown = near.slice(0, 8);
    shown.sort((a, b) => b.v - a.v);
    box.replaceChildren(
      element("div", { className: "time", textContent: `t = ${number(u.data[0][idx], 6)} s` }),
      ...shown.map(({ k, v }) => {
        const dot = element("span", { className: "dot" });
        dot.style.background = u.series[k]._colour;
        return element("div", {}, dot, element("span", { textContent: u.series[k].label }), element("b", { textContent: number(v) }));
      }),
    );
    if (near.length > shown.length) box.append(element("div", { className: "more", textContent: `and ${near.length - shown.length} more` }));
    box.hidden = false;
    // On the side that has room for it, and never beyond the plot.
    const [wide, room] = [box.offsetWidth, u.over.clientWidth];
    const beside = left + 14 + wide <= room ? left + 14 : left - 14 - wide;
    box.style.left = `${Math.min(room - wide, Math.max(0, beside))}px`;
    box.style.top = "6px";
  };
  return { hooks: { init: [(u) => u.over.append(box)], setCursor: [update] } };
};

// How fast time may pass: as the page offers it, and where none of that suits the length of a run, also what does. A long run plays in about half a
// minute, whoever does not choose.
const fitRates = (rate, end) => {
  const suits = end > 0 ? 10 ** Math.round(Math.log10(end / 20)) : 1;
  if (suits < 0.1 || suits > 20) {
    for (const k of [0.2, 1, 5]) rate.append(element("option", { value: String(+(k * suits).toPrecision(3)), textContent: `${number(k * suits, 3)} ×` }));
    [...rate.options].sort((a, b) => a.value - b.value).forEach((option) => rate.append(option));
  }
  const all = [...rate.options].map(({ value }) => value);
  const least = suits < 0.1 ? 0 : 1;
  rate.value = all.find((r) => Number(r) >= least && end / Number(r) <= 30) ?? all.at(-1);
};

// A browser may keep fewer digits of a slider than its end has.
const slidTo = (slider, end) => {
  const t = Number(slider.value);
  return t > (1 - 1e-9) * end ? end : t;
};
// Space and the arrows move the clock, wherever what has the focus has no use for them of its own; Home and End, which move the page, only at the clock
// and the picture.
const USED_BY = { " ": "button, summary, select, textarea, input:not(#slider)", ArrowLeft: "select, textarea, input:not(#slider, [type=checkbox])" };
USED_BY.ArrowRight = USED_BY.ArrowLeft;
const scrolls = (part, along, size) => /auto|scroll/.test(getComputedStyle(part)[`overflow${along}`]) && part[`scroll${size}`] > part[`client${size}`];
const usesKey = (part, key) => part.matches(USED_BY[key] ?? ":not(*)") || (key === " " ? scrolls(part, "Y", "Height") : scrolls(part, "X", "Width"));
const clockKeys = ({ end, now, go, toggle }, picture) =>
  addEventListener("keydown", (event) => {
    const { key, target } = event;
    const step = ((event.shiftKey ? 10 : 1) * end) / 200;
    const by = (steps) => () => go(now.t + steps * step);
    const anywhere = { " ": toggle, ArrowRight: by(1), ArrowLeft: by(-1) };
    const ends = { Home: () => go(0), End: () => go(end) };
    const slides = { ArrowUp: by(1), ArrowDown: by(-1), PageUp: by(10), PageDown: by(-10) };
    const atSlider = target.closest?.("#slider");
    const does = { ...anywhere, ...(atSlider || target.closest?.(picture) ? ends : {}), ...(atSlider ? slides : {}) }[key];
    if (!does || end === 0 || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || (key === " " && event.shiftKey)) return;
    if (target instanceof Element && usesKey(target, key)) return;
    event.preventDefault();
    does();
  });

// A line at the time of the clock; whoever points at a plot sets the clock.
let stageGo = () => {};
let stageAsk = () => {};
const clockLine = () => {
  const line = element("div", { className: "clock-line", hidden: true });
  return {
    hooks: {
      init: [
        (u) => {
          u.over.append(line);
          u.clock = (t) => {
            const { min, max } = u.scales.x;
            line.hidden = !(t >= min && t <= max);
            if (!line.hidden) line.style.transform = `translateX(${u.valToPos(t, "x").toFixed(1)}px)`;
          };
          u.over.addEventListener("mousemove", () => u.cursor.left >= 0 && stageGo(u.posToVal(u.cursor.left, "x")));
        },
      ],
      ready: [() => stageAsk()],
      setScale: [() => stageAsk()],
    },
  };
};

// Draws `series` = [{label, colour, dash, width, values}] over `times` into `target`.
const drawPlot = (target, { times, series, log = false, lines = [], height, y = {}, draw = [], cursor = true, within = null, unit = "" }) => {
  const besides = [(u) => drawLines(u, lines), ...draw];
  const axis = { stroke: colour("--muted"), font: axisFont, ticks: { show: false }, grid: { stroke: colour("--grid"), width: 1 } };
  const options = {
    width: Math.max(120, target.clientWidth),
    height: height ?? (innerWidth < 640 ? 220 : 270),
    padding: [10, Math.max(20, 3 + 0.5 * widthOf(timeTick(whole[1], 0.2 * whole[1]))), 0, 0],
    legend: { show: false },
    focus: { alpha: 0.25 },
    cursor: {
      y: false,
      focus: { prox: 14 },
      points: { size: 6 },
      drag: { x: true, y: false, setScale: false },
      bind: { dblclick: () => () => (zoomTo(null), null) },
      sync: { key: "run", scales: ["x", null], filters: { pub: (type) => type === "mousemove" || type === "mouseleave" } },
    },
    scales: { x: { time: false, range: () => axisOf(view.zoom ?? whole) }, y: { distr: log ? 3 : 1, range: log ? logRange : within ? rangeWithin(within) : linearRange, ...y.scale } },
    axes: [
      { ...axis, size: 30, gap: 6, space: 70, values: (u, splits, a, s, step) => splits.map((v) => timeTick(v, step)) },
      {
        ...axis,
        size: labelRoom,
        gap: 6,
        space: 34,
        incrs: increments,
        values: (u, splits, a, s, step) => splits.map((v) => (log ? power(Math.round(Math.log10(v))) : tick(v, step))),
        splits: (u, a, min, max, step) => (log ? decades(min, max) : multiples(min, max, step)),
        ...(log ? { filter: (u, splits) => splits } : {}),
        ...y.axis,
      },
    ],
    series: [
      {},
      ...series.map((s) => ({
        label: s.label,
        stroke: s.colour,
        width: s.width ?? 1.5,
        dash: s.dash,
        pxAlign: s.exact ? 0 : 1,
        show: s.show ?? true,
        points: { show: times.length < 2 },
        _colour: s.colour,
        _first: s.first,
        unit: s.unit,
      })),
    ],
    hooks: {
      drawAxes: [drawBreakPoints],
      draw: besides,
      setSelect: [
        (u) => {
          if (u.select.width < 4) return;
          const from = u.posToVal(u.select.left, "x");
          const to = u.posToVal(u.select.left + u.select.width, "x");
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          zoomTo([Math.max(from, whole[0]), Math.min(to, whole[1])]);
        },
      ],
    },
    plugins: [...(cursor ? [readout(log)] : []), clockLine()],
  };
  // What is far beyond the axis leaves it as steeply from nearer by: who prints a page may drop a path with ends at 10^35.
  const drawn = ({ values }) => (within ? values.map((v) => kept(FAR * within, v)) : values);
  const plot = new uPlot(options, [times, ...series.map(drawn)], target);
  Object.assign(plot, { besides, unit, whole: series.map((s) => s.values) });
  plots.add(plot);
  return plot;
};

// What stands for the whole is named before its parts, where names may have no room.
const foremost = (series) => [...series.filter((s) => s.first), ...series.filter((s) => !s.first)];

const removePlot = (plot) => {
  plots.delete(plot);
  plot.destroy();
};
