// The graph at one instant: who hears whom, how old what is heard is, and who is silent.

const spans = index.gantt.spans;
// Where the graph changes very often it is on the page until then, and after that where it takes turns again and again.
const drawnUntil = index.gantt.drawn_until_s ?? Infinity;
const turnOf = index.gantt.turn_of ?? 0;
const inTurn = (time) => (time > drawnUntil && turnOf > 0 ? time % spans[turnOf - 1][1] : time);
const vertices = bodies.length;

// What is known of the age of what is heard: what it is, or between what it is where a delay changes too often to be on the page.
const ageOf = (from, to, delay, time) => {
  const exact = packetAge(from, to, time);
  if (exact !== null) return [exact, exact];
  if (delay === null) return null;
  const { series, band } = index.delays[delay];
  const { row, part } = data.place("delays", time);
  if (!band) return Array(2).fill(data.at("delays", series, { row, part }));
  // The greatest and the least around each time stand in turn.
  const first = Math.max(0, Math.min(row, index.grids.delays - 2));
  const pair = [0, 1].map((k) => data.at("delays", series, { row: Math.min(first + k, index.grids.delays - 1), part: 0 }));
  return [Math.min(...pair), Math.max(...pair)];
};
const [youngest, oldest] = (() => {
  let [low, high] = [Infinity, 0];
  const take = (age) => age !== null && ([low, high] = [Math.min(low, age), Math.max(high, age)]);
  for (const { series } of index.delays) data.values("delays", series).forEach(take);
  packetAges().forEach(take);
  return [low, high];
})();
// From 0 for the youngest that is ever heard to 1 for the oldest; what never changes is not stale.
const staleness = (age) => (oldest - youngest > 1e-6 * oldest ? Math.min(1, Math.max(0, (age - youngest) / (oldest - youngest))) : 0);

// Of very many edges so many are drawn, spread evenly.
const MOST_ARROWS = 2000;
// Of more, what is on its way would hide them.
const MOST_FLIGHTS = 120;
// Multiples of the golden ratio leave nobody out, in whatever order edges come.
const someOf = (edges) => {
  if (edges.length <= MOST_ARROWS) return edges;
  const part = (k) => (k * 0.6180339887498949) % 1;
  const kept = [...edges.keys()].sort((a, b) => part(a) - part(b)).slice(0, MOST_ARROWS);
  return kept.sort((a, b) => a - b).map((k) => edges[k]);
};
// What stays while a graph is in force: its edges, those that are drawn, for each age that something heard can have the first edge and how many,
// and who is silent or hears nothing.
const knownOf = (() => {
  const kept = new Map();
  const found = (graph) => {
    const edges = (scene.graphs[graph] ?? []).filter(([from, to]) => from < vertices && to < vertices).map(([from, to, delay]) => ({ from, to, delay }));
    const ages = new Map();
    for (const edge of edges) {
      // Packets have ages of their own.
      const key = links.has(`${edge.from} ${edge.to}`) ? edge : edge.delay;
      ages.set(key, { edge: ages.get(key)?.edge ?? edge, count: (ages.get(key)?.count ?? 0) + 1 });
    }
    const [speak, hear] = [new Set(edges.map((e) => e.from)), new Set(edges.map((e) => e.to))];
    const everyone = [...bodies.keys()];
    const silent = everyone.filter((v) => !speak.has(v));
    const deaf = everyone.filter((v) => !hear.has(v) && !bodies[v].leads);
    return { edges, drawn: someOf(edges), ages: [...ages.values()], silent, deaf };
  };
  return (graph) => {
    if (!kept.has(graph)) kept.set(graph, found(graph));
    return kept.get(graph);
  };
})();

// Of more edges than can be told apart only those of one that was chosen are drawn.
const MOST_TOLD_APART = 300;
const isOf = ({ from, to }, vertex) => from === vertex || to === vertex;
// Of the edges in force those that are drawn. Messages on their way are left out that are not under way for `pace`, s.
const heardAt = (time, pace = 0, chosen = null) => {
  const at = inTurn(time);
  if (at > drawnUntil) return { graph: null, time, chosen, edges: [] };
  let [low, high] = [0, spans.length - 1];
  while (low < high) {
    const half = (low + high + 1) >> 1;
    if (spans[half][0] <= at) low = half;
    else high = half - 1;
  }
  const graph = spans[low]?.[2] ?? 0;
  const known = knownOf(graph);
  const isAlone = chosen !== null && known.edges.length > MOST_TOLD_APART;
  const drawn = isAlone ? known.edges.filter((edge) => isOf(edge, chosen)).slice(0, MOST_ARROWS) : known.drawn;
  const edges = drawn.map((edge) => {
    const ages = ageOf(edge.from, edge.to, edge.delay, time);
    return {
      from: edge.from, to: edge.to,
      age: ages !== null && ages[0] === ages[1] ? ages[0] : null,
      between: ages !== null && ages[0] !== ages[1] ? ages : null,
      share: ages === null ? 0 : staleness(0.5 * (ages[0] + ages[1])),
      flights: drawn.length > MOST_FLIGHTS ? [] : flightsOf(edge, time, pace),
    };
  });
  return { graph, time, chosen, edges };
};

const someNames = (list) => (list.length > 4 ? `${list.slice(0, 3).join(", ")} and ${list.length - 3} more` : list.join(", "));
const ageWords = ([low, high]) => (low === high ? `${number(low, 3)} s` : `between ${number(low, 3)} s and ${number(high, 3)} s`);
const graphWords = ({ graph, time, edges: drawn }) => {
  if (!scene.graphs.some((g) => g.length > 0)) return vertices > 1 ? "No agent hears another." : "One agent alone.";
  if (graph === null) return `Unknown: the graph changes very often, and is not drawn after ${number(drawnUntil)} s.`;
  const name = (v) => bodies[v].name;
  const { edges, ages, silent, deaf } = knownOf(graph);
  const count = scene.edge_counts[graph] ?? edges.length;
  // Nothing is said of all where not all are on the page.
  const named = (list) => (count === edges.length && list.length ? someNames(list.map(name)) : null);
  let [late, most, unknown] = [null, 1e-6, 0];
  for (const { edge, count } of ages) {
    const age = ageOf(edge.from, edge.to, edge.delay, time);
    if (age === null) unknown += count;
    else if (age[1] > most) [late, most] = [{ ...edge, age }, age[1]];
  }
  return [
    drawn.length < count ? `${drawn.length} of ${count} edges drawn.` : count === 1 ? "1 edge." : `${count} edges.`,
    ...(late ? [`Oldest message heard: ${ageWords(late.age)} (${name(late.from)} → ${name(late.to)}).`] : []),
    ...(unknown ? [`How old it is on ${unknown} edges is not on this page.`] : []),
    ...(named(silent) ? [`No agent hears ${named(silent)}.`] : []),
    ...(named(deaf) ? [`Nothing is heard by ${named(deaf)}.`] : []),
    ...(flightWords ? [flightWords] : []),
  ].join(" ");
};

// Names around a circle, with an arrow for every edge in force. It is as large as its place, so that names have the size of the page's.
const GRAPH = { width: 400, height: 190, font: '12px ui-sans-serif, system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif' };
const svg = (tag, attributes, ...children) => {
  const e = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) e.setAttribute(name, String(value));
  e.append(...children);
  return e;
};
const wideIn = (() => {
  const measure = document.createElement("canvas").getContext("2d");
  return (text) => ((measure.font = GRAPH.font), measure.measureText(text).width);
})();
const angleOf = (v) => 2 * Math.PI * (v / Math.max(1, vertices) - 0.25);
// Where everybody stands in a picture of a size, and what is written beside: names as long as there is room, none over another.
const graphLayout = (width, height) => {
  const named = vertices <= MOST_NAMES;
  const longest = Math.max(30, 0.5 * width - 60);
  const shortened = (text) => {
    let letters = [...text];
    const most = () => shortName(text, letters.length);
    while (letters.length > 4 && wideIn(most()) > longest) letters = letters.slice(0, -1);
    return most();
  };
  const short = (name) => shortName(name, 16);
  const texts = bodies.map((body) => (named ? shortened(leading(short(body.name), body.leads)) : ""));
  let rx = named ? 1.75 * (0.5 * height - 28) : 0.5 * height - 8;
  bodies.forEach((_, v) => {
    const side = Math.abs(Math.cos(angleOf(v)));
    if (named && side >= 0.3) rx = Math.min(rx, (0.5 * width - 16 - wideIn(texts[v])) / side);
  });
  const ry = vertices === 1 ? 0 : named ? 0.5 * height - 28 : 0.5 * height - 8;
  rx = vertices === 1 ? 0 : Math.max(24, Math.min(rx, 0.5 * width - 12));
  const taken = [];
  return bodies.map((_, v) => {
    const [side, top] = [Math.cos(angleOf(v)), Math.sin(angleOf(v))];
    const place = { x: 0.5 * width + rx * side, y: 0.5 * height + ry * top, text: null };
    if (!named) return place;
    const anchor = Math.abs(side) < 0.3 ? "middle" : side > 0 ? "start" : "end";
    const wide = wideIn(texts[v]);
    const at = { x: place.x + (anchor === "middle" ? 0 : 12 * Math.sign(side)), y: place.y + (anchor === "middle" ? (top > 0 ? 21 : -12) : 4) };
    const left = at.x - { middle: 0.5, start: 0, end: 1 }[anchor] * wide;
    const box = [left, at.y - 10, left + wide, at.y + 3];
    if (taken.some((b) => b[0] < box[2] && box[0] < b[2] && b[1] < box[3] && box[1] < b[3])) return place;
    taken.push(box);
    return { ...place, text: { ...at, anchor, said: texts[v] } };
  });
};
// Of more no name is written, and nodes are small.
const MOST_NAMES = 40;
const graphIn = (place) => {
  const picture = svg("svg", { role: "img", class: "now" });
  const [arrows, dots, nodes] = [svg("g", {}), svg("g", {}), svg("g", {})];
  const r = vertices > MOST_NAMES ? 2.5 : vertices > 24 ? 4.5 : 7;
  picture.append(arrows, dots, nodes);
  place.append(picture);
  let [places, shown, last] = [[], "", null];
  const along = (from, to) => {
    const [a, b] = [places[from], places[to]];
    const far = Math.hypot(b.x - a.x, b.y - a.y) || 1;
    const [ux, uy] = [(b.x - a.x) / far, (b.y - a.y) / far];
    const p = { x: a.x + ux * (r + 2) - 2.4 * uy, y: a.y + uy * (r + 2) + 2.4 * ux };
    const q = { x: b.x - ux * (r + 3) - 2.4 * uy, y: b.y - uy * (r + 3) + 2.4 * ux };
    return { p, q, ux, uy, far };
  };
  const laidOut = () => {
    const [width, height] = [place.clientWidth || GRAPH.width, place.clientHeight || GRAPH.height];
    picture.setAttribute("viewBox", `0 0 ${width} ${height}`);
    places = graphLayout(width, height);
    shown = "";
    nodes.replaceChildren(...bodies.map((body, v) => {
      const { x, y, text } = places[v];
      const group = svg("g", { class: `node a${v}` }, svg("title", {}, leading(body.name, body.leads)), svg("circle", { cx: x, cy: y, r }));
      if (body.leads) group.append(svg("circle", { cx: x, cy: y, r: r + 3, class: "lead" }));
      if (text) group.append(svg("text", { x: text.x, y: text.y, "text-anchor": text.anchor }, text.said));
      return group;
    }));
  };
  const draw = (heard) => {
    const { graph, edges, chosen } = heard;
    last = heard;
    // Ages change all the time, arrows only with the graph.
    picture.setAttribute("aria-label", `The graph: ${graphWords(heard)}`);
    picture.classList.toggle("unknown", graph === null);
    if (shown !== `${graph} of ${chosen}`) {
      shown = `${graph} of ${chosen}`;
      [...nodes.children].forEach((node, v) => node.classList.toggle("chosen", v === chosen));
      // So many arrows would hide each other, and the nodes.
      const faint = edges.length > MOST_TOLD_APART ? Math.max(0.08, MOST_TOLD_APART / edges.length) : 1;
      for (const ink of ["stroke-opacity", "fill-opacity"]) arrows.setAttribute(ink, faint.toFixed(2));
      arrows.replaceChildren(...edges.map(({ from, to }) => {
        const { p, q, ux, uy, far } = along(from, to);
        const head = Math.min(7, 0.4 * far);
        const points = [[q.x, q.y], [q.x - head * ux - 0.4 * head * uy, q.y - head * uy + 0.4 * head * ux], [q.x - head * ux + 0.4 * head * uy, q.y - head * uy - 0.4 * head * ux]];
        return svg("g", { class: `edge a${from}${chosen !== null && !isOf({ from, to }, chosen) ? " faded" : ""}` }, svg("line", { x1: p.x, y1: p.y, x2: q.x - 0.7 * head * ux, y2: q.y - 0.7 * head * uy }), svg("polygon", { points: points.join(" ") }));
      }));
    }
    const flying = edges.flatMap(({ from, to, flights }) => {
      const { p, q } = along(from, to);
      return flights.map(({ share, lost }) => ({ from, lost, share, x: p.x + share * (q.x - p.x), y: p.y + share * (q.y - p.y) }));
    });
    dots.replaceChildren(...flying.map(({ from, lost, share, x, y }) =>
      svg("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: Math.min(3, 0.6 * r), class: `flight a${from}${lost ? " lost" : ""}`, opacity: lost ? (1 - share).toFixed(2) : 1 })));
    if (edges.length <= 200) edges.forEach(({ share }, k) => arrows.children[k]?.setAttribute("opacity", (1 - 0.3 * share).toFixed(2)));
  };
  laidOut();
  const again = () => (laidOut(), last && draw(last));
  new ResizeObserver(again).observe(place);
  const unnamed = () => places.filter(({ text }) => text === null).length;
  return Object.assign(draw, { again, unnamed });
};
