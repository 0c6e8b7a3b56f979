// One quantity over another: paths in a plane, and phase planes. Time runs along the curves; a dot is where the clock stands.

// Whatever all agents have on the grid of the plots, by name: coordinates, their rates, and what only some systems have.
// The coordinates of an attitude are no angles, and no angular velocity is the rate of one of them.
const attitudes = joints.length > 0 && joints.every((j) => unitOf(j.axis, (u) => u.q) === "" && unitOf(j.axis, (u) => u.dq) === "rad/s");
const velocityOf = (name) => (attitudes ? `angular velocity, ${name}` : `velocity, ${name}`);
const quantities = (() => {
  const perAxis = (columns, leader, name, unit) =>
    joints.map((j) => ({ name: name(/^\d+$/.test(j.name) ? `axis ${j.name}` : j.name), unit: unitOf(j.axis, unit), of: agents.map((_, i) => columns[i]?.[j.axis]), wanted: [], leader: leader?.[j.axis] }));
  const headings = index.families.map(({ id }) => document.querySelector(`[data-plot="${id}"] h3`));
  const titles = headings.map((heading, k) => headingOf(heading) || index.families[k].id);
  const families = index.families.flatMap(({ id, entries }, k) => {
    // Cards of one title tell themselves apart by their letters.
    const letters = titles.filter((title) => title === titles[k]).length > 1 ? ` ${headings[k]?.querySelector(".by")?.textContent ?? ""}` : "";
    return entries.map((e) => ({ name: `${titles[k]}${letters}${e.name && `: ${e.name}`}`, unit: e.unit, of: e.series, wanted: e.wanted, family: id }));
  });
  return [...perAxis(signals.q, index.leader?.q, (name) => name, (u) => u.q), ...perAxis(signals.dq, index.leader?.dq, velocityOf, (u) => u.dq), ...families]
    .filter(({ of }) => of.some((k) => k != null));
})();

// A path where lengths are, of agents, or of tips with where they are wanted; else the first coordinate and its rate.
const usualPlane = (() => {
  const length = quantities.filter((q) => q.unit === "m" && !q.name.startsWith("velocity, "));
  const rank = (q) => (q.family === undefined ? 0 : q.wanted.some((k) => k != null) ? 1 : 2);
  for (const one of [0, 1, 2].flatMap((r) => length.filter((q) => rank(q) === r))) {
    const other = length.find((q) => q !== one && q.family === one.family);
    if (other) return [one, other];
  }
  return [quantities[0], quantities.find((q) => !attitudes && q.name === velocityOf(quantities[0]?.name)) ?? quantities[1]];
})();

const planeOptions = quantities.map((q, k) => [String(k), q.unit ? `${q.name} in ${q.unit}` : q.name]);
const planeSpec = {
  picks: [0, 1].map((k) => ({ id: `plane-${k}`, name: ["across", "upwards"][k], options: planeOptions, first: () => String(Math.max(0, quantities.indexOf(usualPlane[k]))) })),
};

const spread = (ranges) => [Math.min(...ranges.map(([low]) => low)), Math.max(...ranges.map(([, high]) => high))];
const rangeOf = (values, from, to) => {
  let [low, high] = [Infinity, -Infinity];
  for (let i = from; i <= to; i++) if (values[i] != null) [low, high] = [Math.min(low, values[i]), Math.max(high, values[i])];
  return [low, high];
};

const MOST_POINTS = 200_000;
const POINTS_EACH = 20;
const MARGIN = { left: 62, right: 20, top: 16, bottom: 30 };

// An empty canvas of a size, as sharp as the screen.
const preparedCanvas = (canvas, ctx, size) => {
  const scale = Math.min(2, devicePixelRatio || 1);
  const [width, high] = [Math.round(size.width * scale), Math.round(size.height * scale)];
  if (canvas.width !== width || canvas.height !== high) {
    Object.assign(canvas, { width, height: high });
    Object.assign(canvas.style, { width: `${size.width}px`, height: `${size.height}px` });
  }
  ctx.setTransform(scale, 0, 0, scale, 0, 0);
  ctx.clearRect(0, 0, size.width, size.height);
  return ctx;
};

// Printed as lines, since of two canvases over each other a print may have the upper one alone.
const printedOn = (frame, { width, height }, paint, dotsAt) => {
  const pen = svgPen(width, height, measuring());
  paint(pen);
  dotsAt(pen, document.getElementById("stage").time());
  const picture = new DOMParser().parseFromString(pen.document(""), "image/svg+xml").documentElement;
  picture.style.display = "block";
  frame.replaceChildren(document.adoptNode(picture));
};

const drawPlane = (target, [acrossId, upId], height) => {
  const [across, up] = [quantities[+acrossId], quantities[+upId]];
  // Both coordinates of a point are of one row.
  const times = data.picked("main", data.t("main"));
  const along = (k) => data.picked("main", data.values("main", k));
  const curve = (label, own, x, y, more = {}) => ({ label, colour: own, x: along(x), y: along(y), ...more });
  const curves = agents.flatMap((agent, i) => {
    const own = colour(`--a${i}`);
    const made = across.of[i] == null || up.of[i] == null ? [] : [curve(agent.name, own, across.of[i], up.of[i], { agent: i })];
    const wanted = across.wanted[i] == null || up.wanted[i] == null ? [] : [curve(`${agent.name}, wanted`, own, across.wanted[i], up.wanted[i], { agent: i, dash: [4, 3] })];
    return [...wanted, ...made];
  });
  if (across.leader != null && up.leader != null) curves.push(curve(everybody[agents.length], colour("--ink"), across.leader, up.leader, { agent: agents.length, dash: [8, 3] }));
  const isShown = ({ agent }) => agent == null || shownAgents.has(agent);
  const canvases = [element("canvas", {}), element("canvas", { className: "over" })];
  const frame = element("div", { className: "plane" }, ...canvases);
  target.append(frame);
  const size = { width: Math.max(120, target.clientWidth), height };
  let seen = null; // from values to pixels, as drawn last

  const rows = () => {
    const [min, max] = view.zoom ?? whole;
    let [from, to] = [0, times.length - 1];
    while (from < to && times[from] < min) from += 1;
    while (to > from && times[to] > max) to -= 1;
    return [from, to];
  };
  // `pen` draws all but the dots in a picture `width` wide and `height` high, `head` lower.
  const paint = (pen, { width, height: high }, head = 0) => {
    const shown = curves.filter(isShown);
    const [from, to] = rows();
    const inner = { left: MARGIN.left, top: MARGIN.top + head, width: width - MARGIN.left - MARGIN.right, height: high - MARGIN.top - MARGIN.bottom };
    const ends = (values) => {
      const [low, top] = spread([...shown.map((c) => rangeOf(values(c), from, to)), [Infinity, -Infinity]]);
      const far = outliers(shown.map((c) => ({ values: values(c) })));
      if (far) return rangeWithin(far.usual)(null, low, top);
      return low <= top ? linearRange(null, low, top) : [-1, 1];
    };
    const [xs, ys] = [ends((c) => c.x), ends((c) => c.y)];
    let [perX, perY] = [(xs[1] - xs[0]) / inner.width, (ys[1] - ys[0]) / inner.height];
    // A metre is as long in either direction.
    if (across.unit === up.unit) perX = perY = Math.max(perX, perY);
    const [midX, midY] = [(xs[0] + xs[1]) / 2, (ys[0] + ys[1]) / 2];
    const to2 = (x, y) => [inner.left + inner.width / 2 + kept(FAR * width, (x - midX) / perX), inner.top + inner.height / 2 - kept(FAR * width, (y - midY) / perY)];
    const [right, bottom] = [inner.left + inner.width, inner.top + inner.height];
    const ticks = (mid, per, length, room, draw) => {
      const step = stepOf(per, room);
      for (let k = Math.ceil((mid - (per * length) / 2) / step); k * step <= mid + (per * length) / 2; k++) draw(k * step, step);
    };
    Object.assign(pen, { font: axisFont, lineWidth: 1 });
    const grid = (points, text, x, y, align, baseline) => {
      pen.strokeStyle = colour("--grid");
      stroked(pen, points);
      Object.assign(pen, { fillStyle: colour("--muted"), textAlign: align, textBaseline: baseline });
      pen.fillText(text, x, y);
    };
    ticks(midX, perX, inner.width, 70, (value, step) => {
      const [x] = to2(value, midY);
      grid([[x, inner.top], [x, bottom]], tick(value, step), x, bottom + 6, "center", "top");
    });
    ticks(midY, perY, inner.height, 34, (value, step) => {
      const [, y] = to2(midX, value);
      grid([[inner.left, y], [right, y]], tick(value, step), inner.left - 6, y, "right", "middle");
    });
    pen.save();
    pen.beginPath();
    pen.rect(inner.left, inner.top, inner.width, inner.height);
    pen.clip();
    const many = shown.length > 100;
    // Of very many each is drawn through fewer points.
    const stride = Math.max(1, Math.min(Math.floor((to - from + 1) / POINTS_EACH), Math.ceil(((to - from + 1) * shown.length) / MOST_POINTS)));
    for (const c of shown) {
      const points = [];
      for (let i = from; i <= to; i = i === to ? to + 1 : Math.min(to, i + stride)) points.push(c.x[i] == null || c.y[i] == null ? [NaN, NaN] : to2(c.x[i], c.y[i]));
      Object.assign(pen, { strokeStyle: c.colour, lineWidth: many ? 0.5 : 1.5, lineJoin: "round", mark: CURVE });
      pen.setLineDash(c.dash ?? []);
      stroked(pen, points);
      pen.setLineDash([]);
      pen.mark = "";
      if (many || points.length === 0) continue;
      // A ring where it begins, a disc where it ends.
      const ring = ([x, y], inside) => {
        if (!Number.isFinite(x) || !Number.isFinite(y)) return;
        pen.beginPath();
        pen.arc(x, y, 3.5, 0, 2 * Math.PI);
        pen.fillStyle = inside;
        pen.fill();
        pen.stroke();
      };
      ring(points[0], colour("--surface"));
      ring(points.at(-1), c.colour);
    }
    pen.restore();
    Object.assign(pen, { fillStyle: colour("--soft"), strokeStyle: colour("--surface"), lineWidth: 4, lineJoin: "round", textBaseline: "alphabetic" });
    // Curves may run through it.
    const named = (text, textAlign, x, y) => {
      pen.textAlign = textAlign;
      for (const how of ["strokeText", "fillText"]) pen[how](text, x, y);
    };
    named(planeOptions[+acrossId][1], "right", right, bottom - 6);
    named(planeOptions[+upId][1], "left", inner.left + 4, inner.top - 4);
    return to2;
  };

  const contexts = canvases.map((canvas) => canvas.getContext("2d"));
  const prepared = (k) => preparedCanvas(canvases[k], contexts[k], size);
  const dotsAt = (ctx, t) => {
    const place = placeIn(times, t);
    const between = (values) => {
      const [a, b] = [values[place.row], values[place.row + (place.part > 0 ? 1 : 0)]];
      return a == null || b == null ? null : a + place.part * (b - a);
    };
    const shown = curves.filter(isShown);
    for (const c of shown) {
      const [x, y] = [between(c.x), between(c.y)];
      if (x == null || y == null) continue;
      const [px, py] = seen(x, y);
      ctx.beginPath();
      ctx.arc(px, py, shown.length > 100 ? 2 : 5, 0, 2 * Math.PI);
      // An edge tells it from the disc where a curve ends.
      Object.assign(ctx, { fillStyle: c.colour, strokeStyle: colour("--ink"), lineWidth: shown.length > 100 ? 0.5 : 1.2 });
      ctx.fill();
      ctx.stroke();
    }
  };
  const redraw = () => {
    seen = paint(prepared(0), size);
    stageAsk();
  };
  // Whoever points at a curve sets the clock to when it was there.
  canvases[1].addEventListener("mousemove", (event) => {
    let best = { far: 15 ** 2, row: null };
    const [from, to] = rows();
    for (const c of curves.filter(isShown)) {
      for (let i = from; i <= to; i++) {
        if (c.x[i] == null || c.y[i] == null) continue;
        const [x, y] = seen(c.x[i], c.y[i]);
        const far = (x - event.offsetX) ** 2 + (y - event.offsetY) ** 2;
        if (far < best.far) best = { far, row: i };
      }
    }
    if (best.row !== null) stageGo(times[best.row]);
  });

  // To whoever saves, tells or zooms plots it is one of them.
  const plot = {
    ctx: contexts[0],
    height,
    data: [times, ...curves.flatMap((c) => [c.x, c.y])],
    get series() {
      return [{}, ...curves.flatMap((c) => [across, up].map((q) => ({ label: `${c.label}, ${q.name}`, unit: q.unit, show: isShown(c), agent: c.agent })))];
    },
    curves: () => curves.filter(isShown).length,
    // Each column says which quantity it is.
    columnsSayAll: true,
    get width() {
      return size.width;
    },
    named: () => curves.filter(isShown),
    again: (pen, head) => void paint(pen, size, head),
    dotsAt,
    clock: (t) => dotsAt(prepared(1), t),
    redraw,
    setScale: redraw,
    setSeries: () => {},
    setSize: ({ width }) => ((size.width = Math.max(120, width)), redraw(), prepared(1)),
    destroy: () => frame.remove(),
  };
  redraw();
  if (isPrinting()) printedOn(frame, size, (pen) => paint(pen, size), dotsAt);
  plot.clock(whole[0]);
  plots.add(plot);
  return plot;
};
