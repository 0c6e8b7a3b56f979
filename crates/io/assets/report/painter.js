// The picture: a camera that turns about the middle, and lines, words and bodies projected through it.

const FIELD = (34 * Math.PI) / 180;
// Pictures that lie flat are seen from above.
const flatScene = bodies.every((b) => layout.rails.has(b) || (b.kind === "point" && b.q.length <= 2));
const FIRST_VIEW = flatScene ? { az: -90, el: 90 } : bodies.some((b) => b.kind === "ship") ? { az: -90, el: 62 } : { az: -66, el: 25 };
const camera = { ...FIRST_VIEW, zoom: 1, follow: world.follows };
// What is to be seen: everything that ever happens, or those that travel together.
const allOfIt = { middle: [0, 1, 2].map((k) => 0.5 * (world.low[k] + world.high[k])), points: world.points, extent: world.extent };
const aim = (nodes) => {
  const here = camera.follow ? nodes.map(({ at }) => at).filter(finite) : [];
  if (here.length === 0) return allOfIt;
  const box = boxOf(here);
  const middle = [0, 1, 2].map((k) => 0.5 * (box.low[k] + box.high[k]));
  const far = 0.9 * world.spread;
  const tall = bodies.some((b) => b.kind === "vehicle") ? 0.5 * (box.high[2] - box.low[2]) + THRUST * world.symbol : 0;
  const points = [-far, far].flatMap((x) => [-far, far].flatMap((y) => [0, tall].map((z) => add(middle, [x, y, z]))));
  return { middle, points, extent: world.spread };
};

// Axes of the camera and where it stands; as far away as everything needs to be seen.
const lookingFrom = (width, height, { middle, points, extent }, { zoom, ...angles }) => {
  const [az, el] = [(angles.az * Math.PI) / 180, (angles.el * Math.PI) / 180];
  const back = [Math.cos(el) * Math.cos(az), Math.cos(el) * Math.sin(az), Math.sin(el)];
  const right = [-Math.sin(az), Math.cos(az), 0];
  const upward = cross(back, right);
  const focal = 0.5 * height / Math.tan(0.5 * FIELD);
  // A point at a, b to the side and c towards the camera fits where focal·|a| ≤ room·(distance − c).
  const [wide, high] = [Math.max(40, 0.5 * width - 46), Math.max(40, 0.5 * height - 34)];
  let distance = 1e-6 * extent;
  for (const p of points) {
    const d = minusVector(p, middle);
    const nearer = dot(d, back);
    distance = Math.max(distance, nearer + (focal * Math.abs(dot(d, right))) / wide, nearer + (focal * Math.abs(dot(d, upward))) / high, nearer + 1e-3 * extent);
  }
  distance = Math.max(distance, 0.4 * extent) / zoom;
  const eye = add(middle, scaled(back, distance));
  const project = (p) => {
    const d = minusVector(p, eye);
    const depth = -dot(d, back);
    if (!(depth > 0.01 * distance)) return null;
    const k = focal / depth;
    return { x: 0.5 * width + k * dot(d, right), y: 0.5 * height - k * dot(d, upward), k, depth };
  };
  return { project, eye, middle, back, right, upward, distance, width, height };
};

const looking = (width, height, nodes) => (charted ? chartLooking(width, height, nodes) : lookingFrom(width, height, aim(nodes), camera));
const turnCamera = (az, el) => {
  camera.az += az;
  camera.el = Math.min(90, Math.max(-20, camera.el + el));
};

// A length that is read easily: 1, 2 or 5 of some power of ten.
const easy = (length) => {
  const unit = 10 ** Math.floor(Math.log10(length));
  return unit * ([5, 2, 1].find((m) => m * unit <= length) ?? 1);
};
const afloat = bodies.every((b) => b.kind === "spacecraft");
const floorGrid = (() => {
  if (charted || afloat) return { lines: [], step: 0 };
  const { middle } = allOfIt;
  const size = [0, 1].map((k) => Math.max(world.high[k] - world.low[k], 0.2 * world.extent));
  const step = easy(Math.max(...size) / (world.follows ? 20 : 5));
  const [x0, x1] = [0, 0].map((_, s) => (s ? Math.ceil((middle[0] + 0.62 * size[0]) / step) : Math.floor((middle[0] - 0.62 * size[0]) / step)));
  const [y0, y1] = [0, 0].map((_, s) => (s ? Math.ceil((middle[1] + 0.62 * size[1]) / step) : Math.floor((middle[1] - 0.62 * size[1]) / step)));
  const z = bodies.some((b) => b.kind === "arm") ? 0 : world.low[2] - (flatScene ? 0 : 0.02 * world.extent);
  const lines = [];
  for (let x = x0; x <= x1; x++) lines.push([[x * step, y0 * step, z], [x * step, y1 * step, z]]);
  for (let y = y0; y <= y1; y++) lines.push([[x0 * step, y * step, z], [x1 * step, y * step, z]]);
  return { lines, step };
})();

const inkOf = (colours, item) => (item.ink ? colours.ink : colours.agents[item.colour]);
const sceneColours = () => ({
  ink: colour("--ink"), muted: colour("--muted"), surface: colour("--surface"), grid: colour("--line"), soft: colour("--soft"), accent: colour("--accent"),
  agents: [...bodies.map((b) => (b.vertex < agents.length ? colour(`--a${b.vertex}`) : colour("--ink"))), colour("--muted")],
});

const trace = (ctx, see, points) => {
  let pen = false;
  ctx.beginPath();
  for (const p of points) {
    const s = finite(p) ? see.project(p) : null;
    if (s === null) pen = false;
    else if (pen) ctx.lineTo(s.x, s.y);
    else ctx.moveTo(s.x, s.y), (pen = true);
  }
};
const strokeLine = (ctx, see, line, stroke) => {
  ctx.globalAlpha = line.alpha ?? 1;
  ctx.setLineDash(line.dash ?? []);
  ctx.lineWidth = line.width ?? 1.4;
  ctx.strokeStyle = stroke;
  trace(ctx, see, line.points);
  if (line.closed) ctx.closePath();
  ctx.stroke();
  ctx.globalAlpha = 1;
  ctx.setLineDash([]);
};
const arrowHead = (ctx, from, to, length) => {
  const far = Math.hypot(to.x - from.x, to.y - from.y) || 1;
  const [ux, uy] = [(to.x - from.x) / far, (to.y - from.y) / far];
  ctx.beginPath();
  ctx.moveTo(to.x, to.y);
  ctx.lineTo(to.x - length * ux - 0.45 * length * uy, to.y - length * uy + 0.45 * length * ux);
  ctx.lineTo(to.x - length * ux + 0.45 * length * uy, to.y - length * uy - 0.45 * length * ux);
  ctx.fill();
};

// Bodies without the graphics card: thick strokes with round ends, the farthest first.
const drawSolids = (ctx, see, frame, colours) => {
  const shown = frame.solids.map((s) => ({ s, a: see.project(s.a), b: see.project(s.b) })).filter(({ a, b }) => a && b);
  shown.sort((p, q) => q.a.depth + q.b.depth - p.a.depth - p.b.depth);
  ctx.lineCap = "round";
  for (const { s, a, b } of shown) {
    const width = Math.max(1.5, s.r * (a.k + b.k));
    for (const [stroke, share] of [[colours.surface, width + 2], [inkOf(colours, s), width]]) {
      ctx.globalAlpha = s.faint ? 0.75 : 1;
      ctx.strokeStyle = stroke;
      ctx.lineWidth = share;
      ctx.beginPath();
      ctx.moveTo(a.x, a.y);
      ctx.lineTo(b.x + 0.01, b.y);
      ctx.stroke();
    }
    ctx.globalAlpha = 0.35;
    ctx.strokeStyle = "#ffffff";
    ctx.lineWidth = 0.22 * width;
    ctx.beginPath();
    ctx.moveTo(a.x - 0.18 * width, a.y - 0.18 * width);
    ctx.lineTo(b.x - 0.18 * width, b.y - 0.18 * width);
    ctx.stroke();
    ctx.globalAlpha = 1;
  }
  ctx.lineCap = "butt";
};

const drawUnder = (ctx, see, colours) => {
  if (charted) return drawChartGrid(ctx, see, colours);
  for (const points of floorGrid.lines) strokeLine(ctx, see, { points, width: 1 }, colours.grid);
};

const drawTrails = (ctx, see, frame, colours, hidden, alone) => {
  if (charted) return drawChartCurves(ctx, see, frame, colours, hidden, alone);
  const until = Math.max(0, Math.floor((frame.place.row / Math.max(1, sceneTimes.length - 1)) * (TRAIL_ROWS - 1)));
  const many = bodies.length > 40;
  for (const body of bodies) {
    if (hidden(body) || body.kind === "spacecraft" || layout.rails.has(body) || (many && alone !== body.vertex)) continue;
    const stroke = colours.agents[body.vertex];
    if (body.target.length && body.coordinates.length + (body.kind === "arm" ? 0 : 1) > 0) {
      strokeLine(ctx, see, { points: targetPath(body), dash: [5, 4], width: 1.1, alpha: 0.7 }, colours.muted);
    }
    const points = trailOf(body).slice(0, until + 1);
    strokeLine(ctx, see, { points: [...points, trailPoint(body, frame.place)], width: 1.5, alpha: alone === body.vertex ? 0.9 : 0.5 }, stroke);
  }
};

// Who hears whom: from the sender towards the receiver, the fainter the older what is heard, with what is on its way.
const drawEdges = (ctx, see, frame, colours, heard) => {
  const at = new Map(frame.nodes.map(({ body, at }) => [body.vertex, see.project(at)]));
  // Over time they all lie beside the same line.
  const many = heard.edges.length > (charted ? 24 : MOST_FLIGHTS);
  for (const { from, to, age, share, flights } of heard.edges) {
    const b = at.get(to);
    if (!at.has(from) || !b) continue;
    // Over time an edge begins where its sender was when it said what is heard.
    const a = charted && age > 0 ? see.project(chartSaid(bodies[from], Math.max(0, frame.time - age))) : at.get(from);
    if (!a) continue;
    const far = Math.hypot(b.x - a.x, b.y - a.y);
    if (far < 16) continue;
    const [ux, uy] = [(b.x - a.x) / far, (b.y - a.y) / far];
    // Beside the axis they bend away from its labels, those of the other direction farther.
    const away = charted && uy > 0 && Math.min(a.x, b.x) < see.box.left + 26 ? -1.8 : 1;
    const bend = away * Math.min(26, 0.13 * far);
    const inset = Math.min(13, 0.3 * far);
    const beside = 3 * Math.sign(away);
    const [p, q] = [{ x: a.x + inset * ux - beside * uy, y: a.y + inset * uy + beside * ux }, { x: b.x - inset * ux - beside * uy, y: b.y - inset * uy + beside * ux }];
    const c = { x: 0.5 * (a.x + b.x) - bend * uy, y: 0.5 * (a.y + b.y) + bend * ux };
    ctx.globalAlpha = many ? Math.max(0.02, 0.12 * Math.min(1, 400 / heard.edges.length)) : 0.95 - 0.25 * share;
    ctx.strokeStyle = ctx.fillStyle = colours.agents[from];
    ctx.lineWidth = many ? 1 : 1.8;
    ctx.beginPath();
    ctx.moveTo(p.x, p.y);
    ctx.quadraticCurveTo(c.x, c.y, q.x, q.y);
    ctx.stroke();
    if (many) continue;
    arrowHead(ctx, c, q, 8);
    for (const { share: s, lost } of flights) {
      const [wp, wc, wq] = [(1 - s) ** 2, 2 * s * (1 - s), s ** 2];
      ctx.beginPath();
      ctx.arc(wp * p.x + wc * c.x + wq * q.x, wp * p.y + wc * c.y + wq * q.y, 3.2, 0, 2 * Math.PI);
      ctx.globalAlpha = lost ? 1 - s : 1;
      ctx.lineWidth = lost ? 1.4 : 1;
      ctx.strokeStyle = lost ? colours.agents[from] : colours.surface;
      if (!lost) ctx.fill();
      ctx.stroke();
    }
  }
  ctx.globalAlpha = 1;
};

const drawMarks = (ctx, see, frame, colours, hovered) => {
  for (const face of frame.faces) {
    trace(ctx, see, face.points);
    ctx.closePath();
    ctx.fillStyle = inkOf(colours, face);
    ctx.globalAlpha = face.hollow ? 0.25 : 0.8;
    ctx.fill();
    ctx.globalAlpha = 1;
    ctx.lineWidth = 1.4;
    ctx.strokeStyle = inkOf(colours, face);
    ctx.stroke();
  }
  for (const line of frame.lines) strokeLine(ctx, see, line, inkOf(colours, line));
  for (const arrow of frame.arrows) {
    const [a, b] = [see.project(arrow.from), see.project(arrow.to)];
    if (!a || !b) continue;
    strokeLine(ctx, see, { points: [arrow.from, arrow.to], width: arrow.width }, inkOf(colours, arrow));
    ctx.fillStyle = inkOf(colours, arrow);
    if (Math.hypot(a.x - b.x, a.y - b.y) > 5) arrowHead(ctx, a, b, 7);
  }
  const small = bodies.length > 100;
  for (const { at, colour: k, leads } of frame.dots) {
    const s = see.project(at);
    if (!s) continue;
    const r = (leads ? 7 : small ? 2.6 : 5.5) + (hovered === k ? 3 : 0);
    ctx.beginPath();
    if (leads) [[0, -r], [r, 0], [0, r], [-r, 0]].forEach(([x, y]) => ctx.lineTo(s.x + x, s.y + y));
    else ctx.arc(s.x, s.y, r, 0, 2 * Math.PI);
    ctx.closePath();
    ctx.fillStyle = colours.agents[k];
    ctx.fill();
    ctx.lineWidth = small ? 0.5 : 1.5;
    ctx.strokeStyle = colours.surface;
    ctx.stroke();
  }
  for (const { at, colour: k } of frame.crosses) {
    const s = see.project(at);
    if (!s) continue;
    ctx.strokeStyle = colours.agents[k];
    ctx.lineWidth = 2;
    ctx.beginPath();
    for (const [x, y] of [[1, 0], [0, 1]]) ctx.moveTo(s.x - 6 * x, s.y - 6 * y), ctx.lineTo(s.x + 6 * x, s.y + 6 * y);
    ctx.stroke();
  }
};

const WORDS = '12px ui-sans-serif, system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif';
// Names beside what they name, none over another or over what is kept free; of many agents only those that are pointed at, chosen, or lead. Returns how many have no room.
const drawWords = (ctx, see, frame, colours, { hovered, alone }) => {
  if (charted) return drawChartWords(ctx, see, frame, colours, { hovered, alone });
  const taken = [...(see.kept ?? [])];
  const write = (text, x, y, fill, must) => {
    const wide = ctx.measureText(text).width;
    const left = Math.min(Math.max(2, x - 0.5 * wide), Math.max(2, see.width - wide - 2));
    for (const dy of must ? [0, 15, -34, 30, -49, 45] : [0]) {
      const box = [left - 2, y + dy, left + wide + 2, y + dy + 14];
      if (box[1] < 0 || box[3] > see.height || taken.some((b) => b[0] < box[2] && box[0] < b[2] && b[1] < box[3] && box[1] < b[3])) continue;
      taken.push(box);
      ctx.lineWidth = 3.5;
      ctx.strokeStyle = colours.surface;
      ctx.strokeText(text, left, y + dy + 11);
      ctx.fillStyle = fill;
      ctx.fillText(text, left, y + dy + 11);
      return true;
    }
    return false;
  };
  ctx.font = WORDS;
  ctx.textAlign = "left";
  ctx.textBaseline = "alphabetic";
  ctx.lineJoin = "round";
  const named = bodies.length <= 24;
  const short = (name) => shortName(name, 24);
  const order = [...frame.nodes].sort((a, b) => (b.body.leads || b.body.vertex === hovered) - (a.body.leads || a.body.vertex === hovered));
  let unnamed = 0;
  for (const { body, label } of order) {
    const picked = body.vertex === hovered || body.vertex === alone || body.leads;
    if (!named && !picked) {
      unnamed += 1;
      continue;
    }
    const s = see.project(label);
    if (!s) continue;
    const text = leading(short(body.name), body.leads);
    const isWritten = layout.rails.has(body)
      ? write(text, s.x - 6 - ctx.measureText(text).width / 2, s.y - 6, colours.soft, picked)
      : write(text, s.x, s.y + (body.kind === "arm" ? 8 : 10), picked ? colours.ink : colours.soft, true);
    if (!isWritten) unnamed += 1;
  }
  for (const { at, text } of frame.words) {
    const s = see.project(at);
    if (s) write(text, s.x, s.y - 7, colours.muted, false);
  }
  if (layout.rails.size > 0 && !layout.cells.size) {
    const unit = bodies.find((b) => layout.rails.has(b) && b.vertex < agents.length);
    const of = unit ? agents[unit.vertex].axes[0]?.units.q : "";
    for (const value of [layout.low, 0.5 * (layout.low + layout.high), layout.high]) {
      const s = see.project([onRail(value), world.low[1], 0]);
      if (s) write(`${number(value, 3)}${of ? ` ${of}` : ""}`, s.x, s.y + 6, colours.muted, true);
    }
  }
  return unnamed;
};
