// Paths of the whole run in space, projected: of tips and of the end of a spacecraft's first axis from their own bases, of all others from one origin.

const spatial = bodies.filter((b) => b.kind === "arm" || b.kind === "vehicle" || b.kind === "spacecraft" || (b.kind === "point" && b.q.length === 3));
const PATH_ROWS = 600;
const PATH_POINTS = 24_000;
const fromBase = (of) => (body, place) => {
  const p = of(body, place);
  return p && finite(p) ? minusVector(p, layout.bases.get(body) ?? ORIGIN) : [NaN, NaN, NaN];
};
const ownPoint = fromBase(trailPoint);
const ownTarget = fromBase(targetPoint);

// Rows, and along them a curve of each body and of what it is to follow.
const spacePaths = (() => {
  let made = null;
  return () => {
    if (made) return made;
    const most = Math.max(24, Math.min(PATH_ROWS, Math.floor(PATH_POINTS / Math.max(1, spatial.length))));
    const count = Math.min(sceneTimes.length, most);
    const rows = Array.from({ length: count }, (_, k) => (count < 2 ? 0 : Math.round((k * (sceneTimes.length - 1)) / (count - 1))));
    const along = (of, body) => rows.map((row) => of(body, { row, part: 0 }));
    const curves = spatial.flatMap((body) => {
      const agent = body.vertex;
      const label = leading(body.name, body.leads);
      const wanted = body.target.length > 0 && body.kind !== "spacecraft" ? [{ body, agent, label: `${label}, desired`, dash: [4, 3], wanted: true, points: along(ownTarget, body) }] : [];
      return [...wanted, { body, agent, label, dash: body.motion ? [8, 3] : [], points: along(ownPoint, body) }];
    });
    return (made = { times: rows.map((row) => sceneTimes[row]), curves: curves.filter(({ points }) => points.some(finite)) });
  };
})();
const pathUnit = (() => {
  const kinds = new Set(spatial.map((b) => b.kind));
  if (kinds.has("arm") || kinds.has("vehicle")) return "m";
  const of = spatial.filter((b) => b.kind === "point" && b.vertex < agents.length).flatMap((b) => agents[b.vertex].axes.map((axis) => axis.units.q));
  return unitsOf(of);
})();

// Its card stands beside what is drawn over another.
if (spatial.length > 0 && sceneTimes.length > 0) {
  const based = spatial.some((b) => layout.bases.has(b));
  const every = (kind) => spatial.every((b) => b.kind === kind);
  // Where neither an end-effector nor a flange is stated, a link ends as far beyond its centre of mass as its joint is before it.
  const stated = spatial.every((b) => b.tip.length > 0 || !scene.arms[b.arm]?.guessed);
  const tips = `${stated ? "of the end-effector" : "of the end-effector, estimated from the last link’s centre of mass"}${spatial.length > 1 ? ", each from its own base" : ", from its base"}`;
  const what = every("spacecraft") ? "where the first axis points" : every("arm") ? tips : based ? "each from its own base" : "";
  const card = element("article", { className: "card plot" });
  card.dataset.plot = "path";
  card.dataset.empty = "nothing was recorded";
  const title = element("h3", {}, "Paths in space", element("span", { className: "by", textContent: what }), element("span", { className: "unit", textContent: pathUnit ? ` ${pathUnit}` : "" }));
  card.append(element("div", { className: "head" }, title, element("div", { className: "pick" })), element("div", { className: "canvas" }));
  document.querySelector('[data-plot="plane"]').after(card);
}

// Paths in a plane are looked at from the side from which they are seen best, and turned with the picture from there.
const pathView = (() => {
  let made = null;
  return () => {
    if (!made) {
      const { low, high } = boxOf(spacePaths().curves.flatMap(({ points }) => points.filter(finite)));
      const sizes = [0, 1, 2].map((k) => high[k] - low[k]);
      const thin = sizes.indexOf(Math.min(...sizes));
      made = sizes[thin] < 0.15 * Math.max(...sizes) ? [{ az: -14, el: 14 }, { az: -76, el: 14 }, { az: -90, el: 72 }][thin] : FIRST_VIEW;
    }
    return { az: made.az + camera.az - FIRST_VIEW.az, el: Math.min(90, Math.max(-20, made.el + camera.el - FIRST_VIEW.el)) };
  };
})();

// A box around points, with walls behind them, as the camera of the picture looks at it.
const pathBox = (points) => {
  const { low, high } = boxOf(points);
  const extent = Math.max(...[0, 1, 2].map((k) => high[k] - low[k])) || 1;
  const middle = [0, 1, 2].map((k) => 0.5 * (low[k] + high[k]));
  const half = [0, 1, 2].map((k) => Math.max(0.53 * (high[k] - low[k]), 0.08 * extent));
  const [from, to] = [minusVector(middle, half), add(middle, half)];
  const corners = [0, 1].flatMap((x) => [0, 1].flatMap((y) => [0, 1].map((z) => [[from, to][x][0], [from, to][y][1], [from, to][z][2]])));
  return { from, to, middle, corners, extent, step: easy((2 * Math.max(...half)) / 4) };
};
// What is projected is as large as there is room for it and its labels.
const pathLooking = ({ middle, corners, extent }, width, height, head) => {
  const see = lookingFrom(width, height, { middle, points: corners, extent }, { ...pathView(), zoom: 1 });
  const seen = corners.map(see.project);
  const [[left, right], [top, bottom]] = ["x", "y"].map((side) => [Math.min(...seen.map((p) => p[side])), Math.max(...seen.map((p) => p[side]))]);
  const k = Math.min(Math.max(60, width - 124) / (right - left), Math.max(60, height - 64) / (bottom - top));
  const project = (p) => {
    const { x, y } = see.project(p) ?? { x: NaN, y: NaN };
    return { x: 0.5 * width + k * (x - 0.5 * (left + right)), y: head + 0.5 * height - 6 + k * (y - 0.5 * (top + bottom)) };
  };
  return { ...see, project };
};
const drawPathBox = (pen, see, { from, to, step, middle }) => {
  const far = [0, 1, 2].map((k) => (see.back[k] > 0 ? from[k] : to[k]));
  const near = [0, 1, 2].map((k) => (see.back[k] > 0 ? to[k] : from[k]));
  const ticksOf = (k) => {
    const ticks = [];
    for (let n = Math.ceil(from[k] / step - 1e-9); n * step <= to[k] + 1e-9 * step; n++) ticks.push(n * step);
    return ticks;
  };
  const at = (k, value, rest) => rest.map((v, i) => (i === k ? value : v));
  const line = (a, b) => strokeLine(pen, see, { points: [a, b], width: 1 }, colour("--grid"));
  // Each wall has the lines of the two directions in it.
  for (const wall of [0, 1, 2]) {
    for (const k of [0, 1, 2].filter((i) => i !== wall)) {
      const other = 3 - wall - k;
      for (const value of [from[k], ...ticksOf(k), to[k]]) {
        const rest = at(wall, far[wall], at(k, value, ORIGIN));
        line(at(other, from[other], rest), at(other, to[other], rest));
      }
    }
  }
  // Labels stand where the box ends: below for two directions, at the side for the third.
  const centre = see.project(middle);
  const side = [at(2, middle[2], [far[0], near[1], 0]), at(2, middle[2], [near[0], far[1], 0])];
  const upright = side.reduce((a, b) => (see.project(a).x <= see.project(b).x ? a : b));
  const edges = [at(0, 0, [0, near[1], far[2]]), at(1, 0, [near[0], 0, far[2]]), upright];
  Object.assign(pen, { font: axisFont, textBaseline: "middle", textAlign: "center" });
  // Names first, then numbers where there is room left.
  const taken = [];
  const word = (text, x, y, ink) => {
    const half = 0.5 * pen.measureText(text).width + 2;
    const box = [x - half, y - 7, x + half, y + 7];
    if (taken.some((b) => b[0] < box[2] && box[0] < b[2] && b[1] < box[3] && box[1] < b[3])) return;
    taken.push(box);
    pen.fillStyle = colour(ink);
    pen.fillText(text, x, y);
  };
  const numbered = edges.map((edge, k) => {
    const mid = see.project(at(k, middle[k], edge));
    const ends = [from[k], to[k]].map((v) => see.project(at(k, v, edge)));
    // Outwards, across the edge.
    const length = Math.hypot(ends[1].x - ends[0].x, ends[1].y - ends[0].y) || 1;
    let [ox, oy] = [-(ends[1].y - ends[0].y) / length, (ends[1].x - ends[0].x) / length];
    if (ox * (mid.x - centre.x) + oy * (mid.y - centre.y) < 0) [ox, oy] = [-ox, -oy];
    // A picture of what points down counts downwards.
    const sign = scene.down && k > 0 ? -1 : 1;
    const beside = (text, p, far, ink) => word(text, p.x + far * 1.25 * ox, p.y + far * oy, ink);
    if (length < 24) return () => {};
    const ticks = ticksOf(k);
    const apart = (length * step) / (to[k] - from[k]);
    const room = Math.abs(ox) > 0.7 ? 15 : 32;
    const every = Math.ceil(room / apart);
    beside("xyz"[k], mid, 27 + 15 * Math.abs(ox), "--soft");
    return () => ticks.forEach((value, n) => n % every === 0 && beside(tick(sign * value, step), see.project(at(k, value, edge)), 14, "--muted"));
  });
  numbered.forEach((write) => write());
  Object.assign(pen, { textAlign: "left", textBaseline: "alphabetic" });
  return far[2];
};

const drawPaths = (target, height) => {
  const { times, curves } = spacePaths();
  const canvases = [element("canvas", {}), element("canvas", { className: "over" })];
  const frame = element("div", { className: "plane turns", tabIndex: 0 }, ...canvases);
  frame.setAttribute("role", "application");
  frame.setAttribute("aria-label", "Paths in space: W, A, S and D turn them, with the picture");
  target.append(frame);
  const size = { width: Math.max(120, target.clientWidth), height };
  const isShown = ({ agent }) => agent == null || shownAgents.has(agent);
  const rows = () => {
    const [min, max] = view.zoom ?? whole;
    const inside = times.map((t, k) => (t >= min && t <= max ? k : -1)).filter((k) => k >= 0);
    return inside.length > 1 ? [inside[0], inside.at(-1)] : [0, times.length - 1];
  };
  let seen = null; // what was drawn last, and how it was looked at
  const viewed = () => `${camera.az} ${camera.el}`;

  const paint = (pen, head = 0) => {
    const shown = curves.filter(isShown);
    const [from, to] = rows();
    const parts = shown.map((c) => c.points.slice(from, to + 1));
    const box = pathBox(parts.flat());
    const see = pathLooking(box, size.width, size.height, head);
    const floor = drawPathBox(pen, see, box);
    const many = shown.length > 100;
    const draw = (points, own, dash) => {
      Object.assign(pen, { strokeStyle: own, lineJoin: "round" });
      pen.setLineDash(dash);
      stroked(pen, points.map((p) => (finite(p) ? (({ x, y }) => [x, y])(see.project(p)) : [NaN, NaN])));
      pen.setLineDash([]);
      pen.mark = "";
    };
    pen.lineWidth = 1;
    // Shadows say how high a path is.
    if (shown.length <= 24) shown.forEach((c, k) => c.wanted || draw(parts[k].map(([x, y, z]) => [x, y, z + (floor - z)]), colour("--line"), []));
    shown.forEach((c, k) => {
      const own = c.wanted ? colour("--muted") : colour(`--a${c.body.vertex}`);
      Object.assign(pen, { lineWidth: many ? 0.5 : c.wanted ? 1.1 : 1.6, mark: CURVE });
      draw(parts[k], own, c.dash);
      if (many || c.wanted) return;
      // A ring where it begins, a disc where it ends.
      [[parts[k][0], colour("--surface")], [parts[k].at(-1), own]].forEach(([p, inside]) => {
        if (!p || !finite(p)) return;
        const { x, y } = see.project(p);
        pen.beginPath();
        pen.arc(x, y, 3.5, 0, 2 * Math.PI);
        pen.fillStyle = inside;
        pen.fill();
        pen.stroke();
      });
    });
    return { see, floor, shown, from, to };
  };
  const contexts = canvases.map((canvas) => canvas.getContext("2d"));
  const prepared = (k) => preparedCanvas(canvases[k], contexts[k], size);
  const dotsAt = (pen, t) => {
    const { see, floor, shown } = seen;
    const place = data.place("scene", t);
    for (const c of shown) {
      const p = (c.wanted ? ownTarget : ownPoint)(c.body, place);
      if (!finite(p) || (c.wanted && shown.length > 100)) continue;
      const own = c.wanted ? colour("--muted") : colour(`--a${c.body.vertex}`);
      const { x, y } = see.project(p);
      if (!c.wanted && shown.length <= 24) strokeLine(pen, see, { points: [p, [p[0], p[1], floor]], width: 1, alpha: 0.6 }, own);
      pen.beginPath();
      pen.arc(x, y, c.wanted ? 3 : shown.length > 100 ? 2 : 5, 0, 2 * Math.PI);
      // An edge tells it from the disc where a path ends.
      Object.assign(pen, { fillStyle: own, strokeStyle: colour("--ink"), lineWidth: 1.2 });
      pen.fill();
      pen.stroke();
    }
  };
  const drawn = () => (seen = { ...paint(prepared(0)), as: viewed() });
  const redraw = () => (drawn(), stageAsk());
  // While it is out of sight it does not follow the camera and the clock.
  let visible = true;
  const watcher = new IntersectionObserver((entries) => {
    visible = entries.at(-1).isIntersecting;
    if (visible) stageAsk();
  });
  watcher.observe(frame);
  const clock = (t) => {
    if (!visible) return;
    if (seen.as !== viewed()) drawn();
    dotsAt(prepared(1), t);
  };

  let held = null;
  const turn = (az, el) => (turnCamera(az, el), stageAsk());
  const over = canvases[1];
  over.addEventListener("pointerdown", (event) => {
    held = { x: event.clientX, y: event.clientY };
    over.setPointerCapture(event.pointerId);
  });
  for (const end of ["pointerup", "pointercancel"]) over.addEventListener(end, () => (held = null));
  over.addEventListener("pointermove", (event) => {
    if (held) {
      turn(-0.4 * (event.clientX - held.x), 0.4 * (event.clientY - held.y));
      held = { x: event.clientX, y: event.clientY };
      return;
    }
    // Whoever points at a curve sets the clock to when it was there.
    let best = { far: 15 ** 2, row: null };
    for (const c of seen.shown) {
      for (let i = seen.from; i <= seen.to; i++) {
        if (!finite(c.points[i])) continue;
        const { x, y } = seen.see.project(c.points[i]);
        const far = (x - event.offsetX) ** 2 + (y - event.offsetY) ** 2;
        if (far < best.far) best = { far, row: i };
      }
    }
    if (best.row !== null) stageGo(times[best.row]);
  });
  frame.addEventListener("keydown", (event) => {
    const way = { a: [-6, 0], d: [6, 0], w: [0, 6], s: [0, -6] }[event.key.toLowerCase()];
    if (!way || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    turn(...way);
  });

  // As recorded, whichever way the third axis points.
  const column = (c, k) => c.points.map((p) => (finite(p) ? (scene.down && k > 0 ? -p[k] : p[k]) : null));
  const plot = {
    ctx: contexts[0],
    height,
    data: [times, ...curves.flatMap((c) => [0, 1, 2].map((k) => column(c, k)))],
    get series() {
      return [{}, ...curves.flatMap((c) => ["x", "y", "z"].map((axis) => ({ label: `${c.label}, ${axis}`, unit: pathUnit, show: isShown(c), agent: c.agent })))];
    },
    curves: () => curves.filter(isShown).length,
    get width() {
      return size.width;
    },
    named: () => curves.filter(isShown).map((c) => ({ label: c.label, colour: c.wanted ? colour("--muted") : colour(`--a${c.body.vertex}`), dash: c.dash })),
    again: (pen, head) => void paint(pen, head),
    dotsAt,
    clock,
    redraw,
    setScale: redraw,
    setSeries: () => {},
    // Out of sight too: a canvas that keeps the width of a larger window keeps the page as wide.
    setSize: ({ width }) => ((size.width = Math.max(120, width)), redraw(), prepared(1)),
    destroy: () => (watcher.disconnect(), frame.remove()),
  };
  redraw();
  if (isPrinting()) printedOn(frame, size, (pen) => paint(pen), dotsAt);
  clock(whole[0]);
  plots.add(plot);
  return plot;
};
