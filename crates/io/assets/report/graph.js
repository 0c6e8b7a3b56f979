// The graph at one instant: who hears whom, how old what is heard is, and who is silent.

const spans = index.gantt.spans;
const vertices = bodies.length;
const ageAt = (delay, time) => (delay === null ? null : data.at("delays", delay, data.place("delays", time)));
const oldest = Math.max(1e-12, ...index.delays.flatMap((d) => data.values("delays", d.series).filter((v) => v !== null)));

// Messages on their way are left out that are not under way for `pace`, s.
const heardAt = (time, pace = 0) => {
  let [low, high] = [0, spans.length - 1];
  while (low < high) {
    const half = (low + high + 1) >> 1;
    if (spans[half][0] <= time) low = half;
    else high = half - 1;
  }
  const graph = spans[low]?.[2] ?? 0;
  const edges = (scene.graphs[graph] ?? []).filter(([from, to]) => from < vertices && to < vertices).map(([from, to, delay]) => {
    const age = ageAt(delay, time);
    return { from, to, age, share: age === null ? 0 : Math.min(1, age / oldest), flights: flightsOf({ from, to, delay }, time, pace) };
  });
  return { graph, edges };
};

const someNames = (list) => (list.length > 4 ? `${list.slice(0, 3).join(", ")} and ${list.length - 3} more` : list.join(", "));
const graphWords = ({ edges }) => {
  const name = (v) => bodies[v].name;
  const [speak, hear] = [new Set(edges.map((e) => e.from)), new Set(edges.map((e) => e.to))];
  const everyone = [...bodies.keys()];
  const silent = everyone.filter((v) => !speak.has(v)).map(name);
  const deaf = everyone.filter((v) => !hear.has(v) && !bodies[v].leads).map(name);
  const late = edges.reduce((most, e) => (e.age !== null && e.age > (most?.age ?? 1e-6) ? e : most), null);
  const count = edges.length === 1 ? "1 edge" : `${edges.length} edges`;
  if (!scene.graphs.some((g) => g.length > 0)) return vertices > 1 ? "No agent hears another." : "One agent alone.";
  return [
    `${count}.`,
    ...(late ? [`Oldest message heard: ${number(late.age, 3)} s (${name(late.from)} → ${name(late.to)}).`] : []),
    ...(silent.length ? [`No agent hears ${someNames(silent)}.`] : []),
    ...(deaf.length ? [`Nothing is heard by ${someNames(deaf)}.`] : []),
    ...(flightWords ? [flightWords] : []),
  ].join(" ");
};

// Names around a circle, with an arrow for every edge in force.
const GRAPH = { width: 400, height: 190 };
const svg = (tag, attributes, ...children) => {
  const e = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) e.setAttribute(name, String(value));
  e.append(...children);
  return e;
};
const graphPlaces = bodies.map((_, v) => {
  const angle = 2 * Math.PI * (v / Math.max(1, vertices) - 0.25);
  const [rx, ry] = vertices === 1 ? [0, 0] : vertices > 24 ? [84, 84] : [118, 68];
  return { x: 200 + rx * Math.cos(angle), y: 95 + ry * Math.sin(angle), side: Math.cos(angle), top: Math.sin(angle) };
});
const graphIn = (place) => {
  const picture = svg("svg", { viewBox: `0 0 ${GRAPH.width} ${GRAPH.height}`, role: "img", class: "now" });
  const [arrows, dots] = [svg("g", {}), svg("g", {})];
  const r = vertices > 24 ? 2.5 : 7;
  const nodes = bodies.map((body, v) => {
    const { x, y, side, top } = graphPlaces[v];
    const group = svg("g", { class: `node a${v}` }, svg("title", {}, body.name), svg("circle", { cx: x, cy: y, r }));
    if (body.leads) group.append(svg("circle", { cx: x, cy: y, r: r + 3, class: "lead" }));
    if (vertices <= 24) {
      const anchor = Math.abs(side) < 0.3 ? "middle" : side > 0 ? "start" : "end";
      const short = body.name.length > 14 ? `${body.name.slice(0, 13)}…` : body.name;
      const dx = anchor === "middle" ? 0 : 12 * Math.sign(side);
      const dy = anchor === "middle" ? (top > 0 ? 21 : -12) : 4;
      group.append(svg("text", { x: x + dx, y: y + dy, "text-anchor": anchor }, leading(short, body.leads)));
    }
    return group;
  });
  picture.append(arrows, dots, ...nodes);
  place.append(picture);
  let shown = null;
  const along = (from, to) => {
    const [a, b] = [graphPlaces[from], graphPlaces[to]];
    const far = Math.hypot(b.x - a.x, b.y - a.y) || 1;
    const [ux, uy] = [(b.x - a.x) / far, (b.y - a.y) / far];
    const p = { x: a.x + ux * (r + 2) - 2.4 * uy, y: a.y + uy * (r + 2) + 2.4 * ux };
    const q = { x: b.x - ux * (r + 3) - 2.4 * uy, y: b.y - uy * (r + 3) + 2.4 * ux };
    return { p, q, ux, uy, far };
  };
  return ({ graph, edges }) => {
    // Ages change all the time, arrows only with the graph.
    picture.setAttribute("aria-label", `The graph: ${graphWords({ graph, edges })}`);
    if (shown !== graph) {
      shown = graph;
      arrows.replaceChildren(...edges.slice(0, 2000).map(({ from, to }) => {
        const { p, q, ux, uy, far } = along(from, to);
        const head = Math.min(7, 0.4 * far);
        const points = [[q.x, q.y], [q.x - head * ux - 0.4 * head * uy, q.y - head * uy + 0.4 * head * ux], [q.x - head * ux + 0.4 * head * uy, q.y - head * uy - 0.4 * head * ux]];
        return svg("g", { class: `edge a${from}` }, svg("line", { x1: p.x, y1: p.y, x2: q.x - 0.7 * head * ux, y2: q.y - 0.7 * head * uy }), svg("polygon", { points: points.join(" ") }));
      }));
    }
    const flying = edges.length > 120 ? [] : edges.flatMap(({ from, to, flights }) => {
      const { p, q } = along(from, to);
      return flights.map(({ share, lost }) => ({ from, lost, share, x: p.x + share * (q.x - p.x), y: p.y + share * (q.y - p.y) }));
    });
    dots.replaceChildren(...flying.map(({ from, lost, share, x, y }) =>
      svg("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: 3, class: `flight a${from}${lost ? " lost" : ""}`, opacity: lost ? (1 - share).toFixed(2) : 1 })));
    if (edges.length <= 200) edges.forEach(({ share }, k) => arrows.children[k]?.setAttribute("opacity", (1 - 0.6 * share).toFixed(2)));
  };
};
