// What stands where: the bodies of all agents at one instant, from their joint values, in one world whose z points up.

const scene = index.scene;
const sceneTimes = data.t("scene");
const RAIL = 10; // how long the longest way on a rail is drawn

// Whom all others come to without a law that leads them: the one agent that hears no other and is heard, where all others hear some.
const root = (() => {
  if (scene.leader || agents.length < 2 || scene.graphs.some((graph, k) => graph.length < (scene.edge_counts[k] ?? 0))) return null;
  const hear = new Set(scene.graphs.flatMap((graph) => graph.map(([, to]) => to)));
  const heard = new Set(scene.graphs.flatMap((graph) => graph.map(([from]) => from)));
  const deaf = [...agents.keys()].filter((i) => !hear.has(i));
  return deaf.length === 1 && heard.has(deaf[0]) ? deaf[0] : null;
})();
// Everybody, and a leader that is no agent, which looks like those that follow it.
const bodies = (() => {
  const own = scene.agents.map((agent, i) => {
    // A gantry has no turns: what it holds is a point in the space of all.
    const slides = agent.kind === "arm" && scene.arms[agent.arm].joints.every((joint) => !joint.turns);
    return { ...agent, ...(slides ? { kind: "point" } : {}), name: agents[i].name, vertex: i, leads: (scene.leader?.vertex ?? root) === i };
  });
  if (scene.leader && scene.leader.vertex >= own.length && own.length > 0) {
    const like = own[0];
    const { name, vertex, q } = scene.leader;
    own.push({ ...like, attitude: [], wheels: [], wheel_axes: [], tip: [], target: [], thrust: null, name, vertex, q, leads: true, motion: true });
  }
  return own;
})();
const read = (columns, place) => columns.map((k) => data.at("scene", k, place));

// The first row at which a number of a body is beyond single precision, or none at all; from there on it stands where it was, in grey.
const lostRow = (() => {
  const kept = new Map();
  return (body) => {
    if (!kept.has(body)) {
      const rows = [...body.q, ...body.attitude].map((k) => data.values("scene", k).indexOf(null)).filter((row) => row >= 0);
      kept.set(body, Math.min(Infinity, ...rows));
    }
    return kept.get(body);
  };
})();
const lastPlace = (body, place) => {
  const lost = lostRow(body);
  const gone = lost > 0 && place.row + (place.part > 0 ? 1 : 0) >= lost;
  return gone ? { place: { row: lost - 1, part: 0 }, gone } : { place, gone };
};
const GREY = bodies.length;
const lostWords = (frame) => {
  const lost = bodies.map(lostRow).filter((row) => row <= frame.place.row);
  return lost.length ? `beyond what the page can draw from t = ${number(sceneTimes[Math.min(...lost)])} s on; in grey where it was last` : "";
};

// Where those stand that have a base of their own, and how much is drawn of those that have no size.
const layout = (() => {
  const points = bodies.filter((b) => b.kind === "point");
  const based = bodies.filter((b) => b.kind === "arm" || b.kind === "spacecraft");
  // Angles of arms and metres of masses have no common place: each has its own.
  const cells = based.length > 0 && based.length < bodies.length ? bodies : based;
  const reach = Math.max(0, ...scene.arms.map((arm) => arm.reach)) || 1;
  const planar = scene.arms.length > 0 && scene.arms.every((arm) => arm.planar);
  const apart = based.some((b) => b.kind === "arm") ? (planar ? 2.1 : 1.3) * reach : 3.2;
  const columns = cells.length <= 3 ? cells.length : Math.ceil(Math.sqrt(cells.length));
  const bases = new Map(cells.map((b, k) => [b, [apart * (k % columns), -apart * Math.floor(k / columns), 0]]));
  const rails = points.filter((b) => b.q.length === 1 && !bases.has(b));
  let [low, high] = [Infinity, -Infinity];
  for (const b of rails) {
    for (const k of [...b.q, ...b.target]) {
      for (const v of keptValues(data.values("scene", k))) if (v !== null) [low, high] = [Math.min(low, v), Math.max(high, v)];
    }
  }
  if (!(high > low)) [low, high] = [Number.isFinite(low) ? low - 1 : -1, Number.isFinite(low) ? low + 1 : 1];
  const gap = Math.min(1.4, 4.6 / Math.max(1, rails.length));
  rails.forEach((b, k) => bases.set(b, [0, -gap * k, 0]));
  return { bases, rails: new Set(rails), low, high, gap, reach, cells: new Set(cells) };
})();
// Of a run that blew up at its end: what it was before, so that this is not flat.
function keptValues(values) {
  const far = outliers([{ values: values.filter((v) => v !== null) }]);
  return far ? values.filter((v) => v !== null && Math.abs(v) <= far.usual) : values;
}
function keptPoints(points) {
  const sizes = points.filter((p) => p && finite(p)).map((p) => Math.max(...p.map(Math.abs)));
  const far = outliers([{ values: sizes }]);
  return far ? points.filter((p) => p && finite(p) && Math.max(...p.map(Math.abs)) <= far.usual) : points;
}
const onRail = (value) => (RAIL * (value - layout.low)) / (layout.high - layout.low);
const up = scene.down ? ([x, y, z]) => [x, -y, -z] : (p) => p;

// Where a body is whose coordinates are q.
const placeOf = (body, q) => {
  const base = layout.bases.get(body) ?? ORIGIN;
  if (body.kind === "arm" || body.kind === "spacecraft") return base;
  if (layout.rails.has(body)) return [onRail(q[0]), base[1], 0];
  if (body.kind === "ship") return add(base, [q[0], q[1], 0]);
  return add(base, up([q[0] ?? 0, q[1] ?? 0, q[2] ?? 0]));
};
// What of a body draws a path; of a spacecraft, which stays where it is, the end of its first axis.
const trailPoint = (body, place) => {
  const q = read(body.q, place);
  if (body.kind === "spacecraft") return add(placeOf(body, q), turned(quaternionTurn(q), [1, 0, 0]));
  if (body.kind !== "arm") return placeOf(body, q);
  const arm = scene.arms[body.arm];
  return add(placeOf(body, q), armTip(arm, armFrames(arm, q)));
};
// Where its target is; nothing without one, and for postures and attitudes.
const targetPoint = (body, place) => {
  if (body.target.length === 0 || body.kind === "spacecraft") return null;
  const wanted = read(body.target, place);
  if (body.kind !== "arm") return placeOf(body, wanted);
  if (body.coordinates.length === 0) {
    const arm = scene.arms[body.arm];
    return add(placeOf(body, wanted), armTip(arm, armFrames(arm, wanted)));
  }
  const p = minusVector(trailPoint(body, place), placeOf(body));
  body.coordinates.forEach((axis, k) => (p[axis] = wanted[k]));
  return add(placeOf(body), p);
};

// Paths of all, at so many rows that they can be drawn again and again.
const TRAIL_ROWS = Math.max(2, Math.min(sceneTimes.length, bodies.length > 40 ? 24 : bodies.length > 6 ? 240 : 960));
const trailRow = (k) => (TRAIL_ROWS < 2 ? 0 : Math.round((k * (sceneTimes.length - 1)) / (TRAIL_ROWS - 1)));
const paths = (of) => {
  const kept = new Map();
  return (body) => {
    if (!kept.has(body)) {
      const points = [];
      for (let k = 0; k < TRAIL_ROWS && sceneTimes.length > 0; k++) points.push(of(body, { row: trailRow(k), part: 0 }));
      kept.set(body, points);
    }
    return kept.get(body);
  };
};
const trailOf = paths(trailPoint);
const targetPath = paths(targetPoint);

// The largest thrust of a vehicle, in sizes of what stands for it.
const THRUST = 2.4;
// How large the world is, and so what has no size of its own.
const world = (() => {
  const points = bodies.flatMap((body) => [...keptPoints(trailOf(body)), ...(body.target.length && body.kind !== "spacecraft" ? targetPath(body) : [])]);
  for (const body of bodies) {
    const base = layout.bases.get(body);
    if (body.kind === "arm") for (const k of [0, 2]) points.push(add(base, [0, 0, k * 0.2 * scene.arms[body.arm].reach]), ...[-0.5, 0.5].map((x) => add(base, [x * scene.arms[body.arm].reach, 0, 0])));
    // An elbow reaches where no tip goes.
    if (body.kind === "arm") for (let k = 0; k < TRAIL_ROWS && sceneTimes.length > 0; k += 8) {
      const q = read(body.q, { row: trailRow(k), part: 0 });
      if (finite(q)) points.push(...armFrames(scene.arms[body.arm], q).map((frame) => add(base, frame.at)));
    }
    if (body.kind === "spacecraft") for (const x of [-1, 1]) points.push(add(base, [x, x, x]));
    if (layout.rails.has(body)) points.push([-0.08 * Math.min(24, body.name.length), base[1] - layout.gap / 2, 0], [RAIL, base[1] + layout.gap / 2, 0]);
  }
  // Pictures side by side have one frame.
  const shown = [...points, ...(index.frame?.corners ?? [])].filter((p) => p && finite(p));
  const { low, high } = boxOf(shown);
  const extent = Math.max(...[0, 1, 2].map((k) => high[k] - low[k])) || 1;
  // Those that travel together, far from where they began, are followed.
  let spread = 0;
  for (let k = 0; k < TRAIL_ROWS && layout.bases.size === 0; k++) {
    const here = boxOf(bodies.map((body) => trailOf(body)[k]).filter(Boolean));
    spread = Math.max(spread, ...[0, 1, 2].map((i) => here.high[i] - here.low[i]));
  }
  spread = Math.max(spread, index.frame?.spread ?? 0);
  const follows = bodies.length > 1 && spread > 1e-9 * extent && spread < 0.4 * extent;
  const symbol = follows ? 0.14 * spread : 0.045 * extent;
  // Rotors and thrust reach beyond where a vehicle is.
  const flown = bodies.filter((b) => b.kind === "vehicle").flatMap((body) => keptPoints(trailOf(body)).filter((p, k) => k % 8 === 0 && p && finite(p)));
  const reached = flown.flatMap((p) => [[0, 0, THRUST * symbol], [1.2 * symbol, 0, 0], [-1.2 * symbol, 0, 0]].map((by) => add(p, by)));
  return { points: [...shown, ...reached], low, high, extent, spread, follows, symbol };
})();

const HULL = [[-0.5, -0.2], [0.15, -0.2], [0.5, 0], [0.15, 0.2], [-0.5, 0.2]];
const hull = (at, heading, length) => {
  const [s, c] = [Math.sin(heading), Math.cos(heading)];
  return HULL.map(([x, y]) => add(at, [length * (c * x - s * y), length * (s * x + c * y), 0]));
};
const ring = (centre, axis, radius) => {
  const side = unitVector(cross(axis, Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  const other = cross(axis, side);
  return Array.from({ length: 25 }, (_, k) => add(centre, add(scaled(side, radius * Math.cos((k * Math.PI) / 12)), scaled(other, radius * Math.sin((k * Math.PI) / 12)))));
};

// The links of an arm, thinner from joint to joint.
const armSolids = (arm, frames, base, put) => {
  // Where the shape of a body is known its capsules are drawn only in the projection.
  const shaped = new Set(arm.parts.map((part) => part.body));
  const thick = 0.036 * arm.reach;
  const depth = [];
  arm.joints.forEach((joint, k) => {
    depth[k] = joint.parent === null ? 0 : depth[joint.parent] + 1;
    const r = thick * Math.max(0.42, 1 - 0.11 * depth[k]);
    put(add(base, frames[k].before), add(base, frames[k].place), r, shaped.has(joint.parent));
    if (!joint.turns) put(add(base, frames[k].place), add(base, frames[k].at), 0.5 * r, shaped.has(k));
  });
  for (const [k, end] of arm.ends) put(add(base, frames[k].at), add(base, pointOf(frames[k], end)), thick * Math.max(0.36, 0.9 - 0.11 * depth[k]), shaped.has(k));
};
// The shapes of its links, where its joints take them.
const armParts = (arm, frames, base) =>
  arm.parts.map(({ body, place: [turn, at], solid }) => {
    const own = composed(body === null ? IDENTITY : frames[body], { turn, at });
    return { solid, turn: own.turn, at: add(base, own.at) };
  });

// Everything to draw of one body at a time.
const drawBody = (body, now, into) => {
  const { place, gone } = lastPlace(body, now);
  const colour = gone ? GREY : body.vertex;
  const q = read(body.q, place);
  if (!finite(q)) return;
  const at = placeOf(body, q);
  const solid = (a, b, r, shaped = false) => into.solids.push({ a, b, r, colour, faint: body.motion, shaped });
  const line = (points, more) => into.lines.push({ points, colour, width: 1.4, ...more });
  let label = at;
  if (body.kind === "arm") {
    const arm = scene.arms[body.arm];
    const frames = armFrames(arm, q);
    armSolids(arm, frames, at, solid);
    for (const part of armParts(arm, frames, at)) into.parts.push({ ...part, colour, faint: body.motion });
    if (body.target.length && body.coordinates.length === 0) {
      const ghost = (a, b) => line([a, b], { alpha: 0.55, dash: [4, 3] });
      armSolids(arm, armFrames(arm, read(body.target, place)), at, ghost);
    }
    label = add(at, [0, 0, arm.planar ? -0.1 * arm.reach : 0]);
  } else if (body.kind === "ship") {
    into.faces.push({ points: hull(at, q[2] ?? 0, 1.7 * world.symbol), colour, hollow: body.motion });
    if (body.target.length) {
      const wanted = read(body.target, place);
      line([...hull(placeOf(body, wanted), wanted[2] ?? 0, 1.7 * world.symbol), placeOf(body, wanted)].slice(0, -1), { closed: true, dash: [3, 3] });
    }
  } else if (body.kind === "vehicle" && body.attitude.length === 4) {
    const turn = quaternionTurn(read(body.attitude, place));
    const arm = (v) => add(at, scaled(up(turned(turn, v)), world.symbol));
    for (const [x, y] of [[1, 1], [-1, 1]]) solid(arm([0.7 * x, 0.7 * y, 0]), arm([-0.7 * x, -0.7 * y, 0]), 0.07 * world.symbol);
    const normal = unitVector(up(turned(turn, [0, 0, -1])));
    for (const [x, y] of [[1, 1], [-1, 1], [1, -1], [-1, -1]]) line(ring(arm([0.7 * x, 0.7 * y, -0.06]), normal, 0.42 * world.symbol), { width: 1.2 });
    solid(arm([0, 0, 0]), arm([0.35, 0, 0]), 0.13 * world.symbol);
    if (body.thrust !== null) {
      const share = data.at("scene", body.thrust, place) / (mostOf(body.thrust) || 1);
      into.arrows.push({ from: at, to: add(at, scaled(normal, THRUST * share * world.symbol)), colour, width: 2 });
    }
  } else if (body.kind === "spacecraft") {
    drawSpacecraft(body, q, place, at, solid, line, into, colour);
    label = add(at, [0, 0, -0.8]);
  } else {
    into.dots.push({ at, colour, leads: body.leads });
    if (layout.rails.has(body)) line([[0, at[1], 0], [RAIL, at[1], 0]], { alpha: 0.25, width: 1 });
  }
  const target = body.kind === "arm" && body.coordinates.length === 0 ? null : targetPoint(body, place);
  if (target && finite(target)) into.crosses.push({ at: target, colour });
  into.nodes.push({ body, at, label: body.kind === "point" && layout.rails.has(body) ? [0, at[1], 0] : label });
};

const mosts = new Map();
const mostOf = (k) => {
  if (!mosts.has(k)) mosts.set(k, data.values("scene", k).reduce((most, v) => Math.max(most, Math.abs(v ?? 0)), 0));
  return mosts.get(k);
};

const drawSpacecraft = (body, q, place, at, solid, line, into, colour) => {
  const turn = quaternionTurn(q);
  const p = (x, y, z) => add(at, turned(turn, [x, y, z]));
  const [a, b, c] = [0.34, 0.26, 0.26];
  for (const y of [-b, b]) for (const z of [-c, c]) solid(p(-a, y, z), p(a, y, z), 0.012);
  for (const x of [-a, a]) for (const z of [-c, c]) solid(p(x, -b, z), p(x, b, z), 0.012);
  for (const x of [-a, a]) for (const y of [-b, b]) solid(p(x, y, -c), p(x, y, c), 0.012);
  // Panels along y.
  for (const s of [-1, 1]) into.faces.push({ points: [p(-0.2, s * b, 0), p(0.2, s * b, 0), p(0.2, s * 0.95, 0), p(-0.2, s * 0.95, 0)], colour });
  const wanted = body.target.length === 4 ? quaternionTurn(read(body.target, place)) : null;
  ["x", "y", "z"].forEach((name, k) => {
    const axis = [0, 1, 2].map((i) => (i === k ? 1 : 0));
    solid(at, p(...axis), 0.022);
    into.words.push({ at: p(...scaled(axis, 1.1)), text: name });
    if (!wanted) return;
    const to = (far) => add(at, turned(wanted, scaled(axis, far)));
    line([at, to(1.2)], { dash: [4, 3], width: 1.6, ink: true });
    // Where the two are one the letter is there.
    if (Math.hypot(...minusVector(to(1), p(...axis))) > 0.25) into.words.push({ at: to(1.28), text: name });
  });
  const most = Math.max(1e-12, ...body.wheels.map(mostOf));
  body.wheel_axes.forEach((axis, k) => {
    const out = turned(turn, axis);
    const centre = add(at, scaled(out, 0.5));
    line(ring(centre, out, 0.13), { width: 1.6, ink: true });
    if (body.wheels[k] === undefined) return;
    const share = data.at("scene", body.wheels[k], place) / most;
    into.arrows.push({ from: centre, to: add(centre, scaled(out, 0.6 * share)), ink: true, width: 2 });
  });
};

// Everything at a time; `hidden` says of which agents nothing is drawn.
const frameAt = (time, hidden = () => false) => {
  const place = data.place("scene", time);
  const into = { solids: [], parts: [], lines: [], faces: [], dots: [], arrows: [], crosses: [], nodes: [], words: [], place, time };
  if (sceneTimes.length === 0) return into;
  for (const body of bodies) {
    if (hidden(body)) continue;
    if (charted) drawChartBody(body, place, time, into);
    else drawBody(body, place, into);
  }
  return into;
};
