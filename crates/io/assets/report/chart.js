// Positions over time in place of a picture in space: for what has one coordinate, or more than space has.

const charted = bodies.length > 0 && bodies.every((b) => b.kind === "point") && (bodies.every((b) => b.q.length === 1) || bodies.some((b) => b.q.length > 3));

// One curve of each coordinate, at so many rows that all can be drawn again and again.
// Of very many curves what shares of them are below, at the same rows; none where they are few or not known at all rows.
const BANDS = [0.1, 0.5, 0.9];
const bandsOf = (curves) => {
  if (curves.length <= 40 || curves.some(({ points }) => points.some(([, v]) => !Number.isFinite(v)))) return [];
  const row = new Float64Array(curves.length);
  const bands = BANDS.map((share) => ({ share, points: [] }));
  curves[0].points.forEach(([t], k) => {
    curves.forEach(({ points }, c) => (row[c] = points[k][1]));
    row.sort();
    for (const { share, points } of bands) points.push([t, row[Math.round(share * (row.length - 1))], 0]);
  });
  return bands;
};
const chart = (() => {
  if (!charted) return null;
  const curves = bodies.flatMap((body) => body.q.map((series, axis) => ({ body, axis, series, target: body.target[axis] ?? null, dash: [[], [7, 3], [2, 2], [7, 2, 2, 2]][axis % 4] })));
  const rows = Math.min(sceneTimes.length, Math.max(24, Math.floor(40_000 / Math.max(1, curves.length))));
  const picks = [...new Set(Array.from({ length: rows }, (_, k) => (rows < 2 ? 0 : Math.round((k * (sceneTimes.length - 1)) / (rows - 1)))))];
  const pointsOf = (series) => {
    const values = data.values("scene", series);
    return picks.map((row) => [sceneTimes[row], values[row] ?? NaN]);
  };
  for (const curve of curves) Object.assign(curve, { points: pointsOf(curve.series), wanted: curve.target === null ? [] : pointsOf(curve.target) });
  const all = curves.flatMap(({ points, wanted }) => [points, wanted]).map((points) => points.map(([, v]) => (Number.isFinite(v) ? v : null)));
  const size = outliers(all.map((values) => ({ values })))?.usual ?? Infinity;
  let [low, high] = [null, null];
  for (const v of all.flat()) if (v !== null && Math.abs(v) <= size) [low, high] = [low === null ? v : Math.min(low, v), high === null ? v : Math.max(high, v)];
  const unit = unitsOf(bodies.filter((b) => b.vertex < agents.length).flatMap((b) => agents[b.vertex].axes.map((axis) => axis.units.q)));
  return { curves, range: linearRange(null, low, high), unit, bands: bandsOf(curves), several: curves.length > bodies.length };
})();
const CHART_EDGES = { left: 66, right: 24, top: 46, bottom: 48 };

// Where times and values are in the picture; zooming in keeps where the clock stands.
const chartLooking = (width, height, nodes) => {
  const [from, to] = axisOf(view.zoom ?? whole);
  const length = (to - from) / Math.max(1, camera.zoom);
  const middle = nodes[0]?.at[0] ?? 0.5 * (from + to);
  const share = Math.min(1, Math.max(0, (middle - from) / (to - from)));
  const begin = from + share * (to - from - length);
  const [low, high] = chart.range;
  const { left, top } = CHART_EDGES;
  const [wide, tall] = [Math.max(40, width - left - CHART_EDGES.right), Math.max(40, height - top - CHART_EDGES.bottom)];
  const project = ([t, v]) => ({ x: left + (wide * (t - begin)) / length, y: top + (tall * (high - v)) / (high - low), k: 1, depth: 1 });
  return { project, width, height, box: { left, top, wide, tall }, span: [begin, begin + length], timeAt: (x) => begin + (length * (x - left)) / wide };
};

// Dots where the clock stands, and where each is to be.
const drawChartBody = (body, place, time, into) => {
  const own = chart.curves.filter((curve) => curve.body === body).reverse();
  const last = lastPlace(body, place);
  for (const curve of own) {
    const value = data.at("scene", curve.series, last.place);
    if (!Number.isFinite(value)) continue;
    const at = [last.gone ? sceneTimes[last.place.row] : time, value, 0];
    into.dots.push({ at, colour: last.gone ? GREY : body.vertex, leads: body.leads });
    if (curve.target !== null) into.crosses.push({ at: [time, data.at("scene", curve.target, place), 0], colour: body.vertex });
    into.nodes.push({ body, at, label: at, axis: curve.axis });
  }
};
// Where a body was when it said what is heard now.
const chartSaid = (body, time) => [time, data.at("scene", body.q[0], data.place("scene", time)), 0];

const chartClip = (pen, { box }, draw) => {
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top - 8, box.wide + CHART_EDGES.right, box.tall + 16);
  pen.clip();
  draw();
  pen.restore();
};
const drawChartGrid = (pen, see, colours) => {
  const { left, top, wide, tall } = see.box;
  const [right, bottom] = [left + wide, top + tall];
  const [begin, end] = see.span;
  const [low, high] = chart.range;
  const line = (x0, y0, x1, y1) => {
    Object.assign(pen, { strokeStyle: colours.grid, lineWidth: 1 });
    pen.beginPath();
    pen.moveTo(x0, y0);
    pen.lineTo(x1, y1);
    pen.stroke();
  };
  const word = (text, x, y, textAlign, textBaseline) => {
    Object.assign(pen, { fillStyle: colours.muted, textAlign, textBaseline });
    pen.fillText(text, x, y);
  };
  const ticks = (from, to, pixels, room, draw) => {
    const step = stepOf((to - from) / pixels, room);
    for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; k++) draw(k * step, step);
  };
  pen.font = axisFont;
  ticks(begin, end, wide, 70, (t, step) => {
    const { x } = see.project([t, low]);
    line(x, top, x, bottom);
    const text = timeTick(t, step);
    word(text, Math.min(x, see.width - 3 - 0.5 * pen.measureText(text).width), bottom + 8, "center", "top");
  });
  ticks(low, high, tall, 40, (v, step) => {
    const { y } = see.project([begin, v]);
    line(left, y, right, y);
    word(tick(v, step), left - 8, y, "right", "middle");
  });
  word(chart.unit ? `position in ${chart.unit}` : "position", 10, top - 11, "left", "alphabetic");
  Object.assign(pen, { textAlign: "left", textBaseline: "alphabetic" });
};

// What was so far, and fainter what is to come.
const drawChartCurves = (pen, see, frame, colours, hidden, alone) => {
  const many = chart.curves.length > 40;
  const now = frame.time;
  chartClip(pen, see, () => {
    strokeLine(pen, see, { points: [[now, 2 * chart.range[0] - chart.range[1], 0], [now, 2 * chart.range[1] - chart.range[0], 0]], width: 1, alpha: 0.5 }, colours.accent);
    for (const { body, points, wanted, dash, series } of chart.curves) {
      if (hidden(body)) continue;
      const picked = alone === body.vertex;
      const stroke = colours.agents[body.vertex];
      if (wanted.length && (!many || picked)) strokeLine(pen, see, { points: wanted, dash: [5, 4], width: 1.1, alpha: 0.7 }, colours.muted);
      const faint = alone !== null && !picked;
      if (many && !picked) {
        strokeLine(pen, see, { points, dash, width: 0.7, alpha: (faint ? 0.12 : 0.35) * Math.min(1, Math.sqrt(60 / chart.curves.length)) }, stroke);
        continue;
      }
      const value = data.at("scene", series, frame.place);
      const next = points.findIndex(([t]) => t > now);
      const past = next < 0 ? points : points.slice(0, next);
      const here = [[now, value]];
      strokeLine(pen, see, { points: [...past, ...here], dash, width: picked ? 2.6 : 1.8, alpha: faint ? 0.3 : 1 }, stroke);
      if (next >= 0) strokeLine(pen, see, { points: [...here, ...points.slice(next)], dash, width: 1.2, alpha: faint ? 0.12 : 0.3 }, stroke);
    }
    for (const { share, points } of chart.bands) strokeLine(pen, see, { points, width: share === 0.5 ? 2.2 : 1.2 }, share === 0.5 ? colours.ink : colours.soft);
  });
};

// Names beside the dots, in the order of their values and none over another.
const drawChartWords = (pen, see, frame, colours, { hovered, alone }) => {
  const few = chart.curves.length <= 24;
  const named = frame.nodes.filter(({ body }) => few || body.vertex === hovered || body.vertex === alone || body.leads);
  const axisName = ({ body, axis }) => (chart.several ? `, ${agents[body.vertex]?.axes[axis]?.name ?? axis + 1}` : "");
  const short = (name) => shortName(name, 24);
  const words = named.map((node) => ({ ...see.project(node.at), text: short(leading(node.body.name, node.body.leads)) + axisName(node), dot: colours.agents[node.body.vertex] }));
  words.sort((a, b) => a.y - b.y);
  const apart = 15;
  const { top, tall } = see.box;
  // Pushed down one after the other, and all of them up again if the last has left the picture.
  words.forEach((word, k) => (word.y = Math.max(word.y, k ? words[k - 1].y + apart : top)));
  for (let k = words.length - 1, most = top + tall; k >= 0; k--, most -= apart) words[k].y = Math.min(words[k].y, most);
  pen.font = WORDS;
  const widest = Math.max(0, ...words.map(({ text }) => pen.measureText(text).width));
  let unnamed = few ? 0 : frame.nodes.length - named.length;
  for (const { x, y, text, dot } of words) {
    if (x < see.box.left - 1 || x > see.width) continue;
    if (y < 8) {
      unnamed += 1;
      continue;
    }
    const before = x + widest + 25 > see.width;
    Object.assign(pen, { textAlign: before ? "right" : "left", textBaseline: "middle", lineJoin: "round", lineWidth: 3.5, strokeStyle: colours.surface, fillStyle: colours.ink });
    for (const how of ["strokeText", "fillText"]) pen[how](text, x + (before ? -21 : 21), y);
    pen.fillStyle = dot;
    pen.beginPath();
    pen.arc(x + (before ? -13 : 13), y, 3.5, 0, 2 * Math.PI);
    pen.fill();
  }
  Object.assign(pen, { textAlign: "left", textBaseline: "alphabetic" });
  return unnamed;
};
