// The clock: one time for the picture, the graph and all plots, whoever moves it.

// As many rows as leave doubt about what is between them.
const FEW_ROWS = 20;

const stage = (() => {
  const part = (id) => document.getElementById(id);
  const [view, slider, play, timeWords, rate, chosen] = ["view", "slider", "play", "time", "rate", "chosen"].map(part);
  const graphPicture = graphIn(part("graph-picture"));
  const overlay = element("canvas", { className: "over" });
  const tip = element("p", { className: "where" });
  view.append(...(lighting ? [lighting.layers] : []), overlay, tip);
  const ctx = overlay.getContext("2d");
  const end = whole[1];
  const now = { t: part("stage").dataset.goesOn === "true" ? end : 0, playing: false, since: 0, hovered: null, alone: null, flat: lighting === null };
  let colours = sceneColours();
  let asked = 0;
  let seen = null;
  let frames = 0;
  let said = []; // of the picture, whatever the time
  let slow = false;
  const watchers = [];

  slider.max = String(end);
  slider.disabled = play.disabled = end === 0;
  bodies.forEach((body) => chosen.append(element("option", { value: String(body.vertex), textContent: body.name })));
  part("choice").hidden = bodies.length < 2;
  const hidden = (body) => !shownAgents.has(body.vertex);

  const paint = (pen, see, frame, heard, flat) => {
    if (flat) {
      drawUnder(pen, see, colours);
      drawSolids(pen, see, frame, colours);
    }
    drawTrails(pen, see, frame, colours, hidden, now.alone);
    drawMarks(pen, see, frame, colours, now.hovered ?? now.alone);
    drawEdges(pen, see, frame, colours, heard);
    return drawWords(pen, see, frame, colours, now);
  };
  // What is to be said of the picture.
  const notesOf = (frame, unnamed, flat) => [
    unnamed > 0 && unnamedWords(unnamed, frame.nodes.length), ...said, lostWords(frame),
    flat && scene.solids.length > 0 && "links as rods: shapes need light and depth",
  ].filter(Boolean);
  // All of the picture at a time, projected.
  const paintAt = (pen, t, width, height) => {
    const frame = frameAt(t, hidden);
    pen.fillStyle = colour("--surface");
    pen.fillRect(0, 0, width, height);
    const unnamed = paint(pen, looking(width, height, frame.nodes), frame, heardAt(t, 0, now.alone), true);
    // What the page says beside the picture, from the last line upwards.
    Object.assign(pen, { font: WORDS, fillStyle: colours.muted });
    const lines = [];
    for (const part of notesOf(frame, unnamed, true)) {
      const longer = lines.length ? `${lines.at(-1)}; ${part}` : part;
      if (lines.length && pen.measureText(longer).width <= width - 16) lines[lines.length - 1] = longer;
      else lines.push(part);
    }
    lines.reverse().forEach((line, k) => pen.fillText(line, 8, height - 8 - 15 * k));
  };
  const drawing = () => {
    const [width, height] = [view.clientWidth, view.clientHeight];
    const pen = svgPen(width, height, measuring());
    paintAt(pen, now.t, width, height);
    return pen.document(`${document.title}, t = ${number(now.t, 4)} s`);
  };
  part("view-svg").onclick = () => save("view.svg", new Blob([drawing()], { type: "image/svg+xml" }));

  // Where nothing moves for a moment it is drawn finely.
  let finely = 0;
  const lit = () => {
    clearTimeout(finely);
    lighting.draw(seen.see, seen.frame, colours);
    if (!now.playing) finely = setTimeout(() => now.flat || lighting.draw(seen.see, seen.frame, colours, true), 160);
  };
  // The graph above does not move when there is less to say.
  const heardWords = part("graph-words");
  const sayHeard = (text) => {
    if (heardWords.textContent === text) return;
    heardWords.textContent = text;
    heardWords.style.minHeight = `${Math.max(parseFloat(heardWords.style.minHeight) || 0, heardWords.getBoundingClientRect().height)}px`;
  };
  addEventListener("resize", () => (heardWords.style.minHeight = ""));
  // The corner in which the scale stands.
  const corner = { wide: 0, high: 0 };
  const measured = () => Object.assign(corner, { wide: view.clientWidth - tip.offsetLeft, high: view.clientHeight - tip.offsetTop });
  new ResizeObserver(() => (measured(), ask())).observe(tip);
  const draw = () => {
    asked = 0;
    const [width, height, scale] = [view.clientWidth, view.clientHeight, Math.min(2, devicePixelRatio || 1)];
    if (width === 0 || height === 0) return;
    if (overlay.width !== Math.round(width * scale)) overlay.width = Math.round(width * scale);
    if (overlay.height !== Math.round(height * scale)) overlay.height = Math.round(height * scale);
    ctx.setTransform(scale, 0, 0, scale, 0, 0);
    ctx.clearRect(0, 0, width, height);
    const frame = frameAt(now.t, hidden);
    const see = looking(width, height, frame.nodes);
    see.kept = [[width - corner.wide, height - corner.high, width, height]];
    // What passes in less than six frames only flickers.
    const heard = heardAt(now.t, now.playing ? 0.1 * Number(rate.value) : 0, now.alone);
    const unnamed = paint(ctx, see, frame, heard, now.flat);
    seen = { see, frame };
    if (!now.flat) lit();
    frames += 1;
    timeWords.textContent = timeOf(now.t, end);
    slider.value = String(now.t);
    slider.setAttribute("aria-valuetext", `${number(now.t, 4)} seconds`);
    graphPicture(heard);
    const where = [...notesOf(frame, unnamed, now.flat), ...(charted ? ["drag to set the clock"] : []), ...(slow ? ["projected, since light and depth are slow here"] : [])].join("; ");
    if (tip.textContent !== where) tip.textContent = where;
    const nameless = graphPicture.unnamed();
    const words = nameless > 0 && vertices > 1 ? ` ${nameless === vertices ? "Names have no room" : `${nameless} names have no room`}: point at a node.` : "";
    sayHeard(`${graphWords(heard)}${words}`);
    const graphs = scene.graphs.length;
    part("graph-when").textContent = `${heard.graph === null ? "unknown " : graphs > 1 ? `graph ${heard.graph + 1} of ${graphs}, ` : ""}at ${timeAt(now.t, end)}`;
    for (const plot of plots) plot.clock?.(now.t);
    watchers.forEach((watch) => watch(now.t));
  };
  const ask = () => {
    if (!asked) asked = requestAnimationFrame(draw);
  };
  const go = (t) => {
    now.t = Math.min(end, Math.max(0, t));
    ask();
  };

  // Without a graphics card light and depth are slow: then the picture is projected.
  let usual = 16;
  const noticeSlowness = (interval) => {
    usual += 0.1 * (Math.min(100, interval) - usual);
    if (now.flat || usual < 33) return;
    // Fewer pixels first.
    if (lighting.coarser()) {
      usual = 16;
      return;
    }
    if (usual < 40) return;
    now.flat = true;
    lighting.layers.hidden = true;
    slow = true;
  };
  // Whoever asked for less motion sees a picture every half second.
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const later = () => (calm.matches ? setTimeout(() => requestAnimationFrame(step), 480) : requestAnimationFrame(step));
  const step = (stamp) => {
    if (!now.playing) return;
    // The rate is kept where frames take long; a page that was asleep does not jump by more than half a second.
    if (!calm.matches) noticeSlowness(stamp - now.since);
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
    ask();
    if (!on) return;
    if (now.t >= end) now.t = 0;
    now.since = performance.now();
    later();
  };
  play.onclick = () => setPlaying(!now.playing);
  slider.oninput = () => (setPlaying(false), go(slidTo(slider, end)));
  chosen.onchange = () => ((now.alone = chosen.value === "" ? null : Number(chosen.value)), regroup(), ask());
  part("view-reset").onclick = () => (Object.assign(camera, FIRST_VIEW, { zoom: 1 }), ask());
  const follow = part("follow");
  follow.parentElement.hidden = charted || !world.follows;
  follow.onchange = () => ((camera.follow = follow.checked), ask());
  part("graph-now").hidden = !scene.graphs.some((graph) => graph.length > 0);
  fitRates(rate, end);

  const zoom = (by) => ((camera.zoom = Math.min(30, Math.max(charted ? 1 : 0.3, camera.zoom * by))), ask());
  const turn = (az, el) => (turnCamera(az, el), ask());
  view.addEventListener("keydown", (event) => {
    const does = {
      a: () => turn(-6, 0), d: () => turn(6, 0), w: () => turn(0, 6), s: () => turn(0, -6),
      "+": () => zoom(1.2), "=": () => zoom(1.2), "-": () => zoom(1 / 1.2),
    }[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    does();
  });
  clockKeys({ end, now, go, toggle: () => setPlaying(!now.playing) }, "#view");
  part("view-reset").before(...zoomButtons("the picture", zoom));
  part("reset").before(element("span", { className: "zooms" }, ...zoomButtons("all plots, at the clock", (by) => zoomAbout(now.t, by))));

  // One finger or the mouse turns, two fingers zoom; the page scrolls as ever where the picture lies flat.
  const held = new Map();
  let moved = false;
  const apart = () => {
    const [a, b] = [...held.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  const nearest = (x, y) => {
    let best = { far: 16, vertex: null };
    for (const { body, at } of seen?.frame.nodes ?? []) {
      const s = seen.see.project(body.kind === "arm" ? add(at, [0, 0, 0.1 * layout.reach]) : at);
      const far = s ? Math.hypot(s.x - x, s.y - y) : Infinity;
      if (far < best.far) best = { far, vertex: body.vertex };
    }
    return best.vertex;
  };
  overlay.addEventListener("pointerdown", (event) => {
    held.set(event.pointerId, { x: event.clientX, y: event.clientY });
    moved = false;
    overlay.setPointerCapture(event.pointerId);
  });
  overlay.addEventListener("pointermove", (event) => {
    const before = held.get(event.pointerId);
    const here = { x: event.clientX, y: event.clientY };
    if (!before) {
      const box = overlay.getBoundingClientRect();
      const vertex = nearest(here.x - box.left, here.y - box.top);
      if (vertex !== now.hovered) (now.hovered = vertex), ask();
      return;
    }
    const wide = held.size === 2 ? apart() : 0;
    held.set(event.pointerId, here);
    if (Math.hypot(here.x - before.x, here.y - before.y) > 1) moved = true;
    if (held.size === 2) zoom(apart() / Math.max(1, wide));
    else if (charted) setPlaying(false), go(seen.see.timeAt(here.x - overlay.getBoundingClientRect().left));
    else turn(-0.4 * (here.x - before.x), 0.4 * (here.y - before.y));
  });
  const release = (event) => {
    if (!held.delete(event.pointerId) || moved || event.type !== "pointerup") return;
    const box = overlay.getBoundingClientRect();
    const vertex = nearest(event.clientX - box.left, event.clientY - box.top);
    now.alone = vertex === now.alone ? null : vertex;
    chosen.value = now.alone === null ? "" : String(now.alone);
    regroup();
    ask();
  };
  overlay.addEventListener("pointerup", release);
  overlay.addEventListener("pointercancel", release);
  overlay.addEventListener("pointerleave", () => ((now.hovered = null), ask()));
  overlay.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoom(Math.exp(-0.004 * event.deltaY));
  }, { passive: false });

  const help = () => {
    const time = "Space plays and pauses, and ← and → move in time, with Shift faster, wherever nothing has the focus that uses these keys. With the picture or the slider in focus, Home and End go to the start and the end.";
    const space = charted ? "Drag to set the clock; the wheel with Ctrl, two fingers, + and − zoom in on it." : "Drag or W, A, S, D turn the picture; the wheel with Ctrl, two fingers, + and − zoom.";
    return `${time} ${space} Plots follow the same clock: point at one to go to that time.`;
  };
  const describe = () => {
    const kinds = [...new Set(bodies.map((b) => b.kind))].join(", ");
    const led = scene.leader ? `, led by ${scene.leader.name}` : "";
    view.setAttribute("aria-label", charted ? `positions of ${bodies.length} over time${led}; time by keys` : `${bodies.length} in space (${kinds})${led}; turn and time by keys`);
    part("view-help").textContent = help();
    const unit = bodies.some((b) => b.kind !== "point") ? " m" : ` ${unitsOf(agents.flatMap((a) => a.axes.map((x) => x.units.q)))}`.trimEnd();
    const symbolic = bodies.some((b) => b.kind === "ship" || b.kind === "vehicle") ? "; bodies not to scale" : "";
    const size = floorGrid.step ? `squares of ${number(floorGrid.step, 2)}${unit}${symbolic}` : "";
    const rows = sceneTimes.length > 1 && sceneTimes.length <= FEW_ROWS && `${sceneTimes.length} rows were recorded, with straight lines between them`;
    said = [...(charted ? [chart.bands.length > 0 && "dark: median and tenths"] : [size, ...marksOf(bodies)]), rows].filter(Boolean);
  };
  describe();
  const themed = () => ((colours = sceneColours()), ask());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", themed);
  let flatBefore = now.flat;
  addEventListener("beforeprint", () => ((flatBefore = now.flat), (now.flat = true), lighting && (lighting.layers.hidden = true), (colours = sceneColours()), graphPicture.again(), draw(), measured(), draw()));
  addEventListener("afterprint", () => ((now.flat = flatBefore), lighting && (lighting.layers.hidden = flatBefore), graphPicture.again(), themed()));
  lighting?.canvas.addEventListener("webglcontextlost", () => ((now.flat = true), (lighting.layers.hidden = true), ask()));
  // The picture reaches to the end of the window, below however many words stand above it.
  const fit = () => {
    const top = part("stage").getBoundingClientRect().top + scrollY;
    part("stage").style.setProperty("--room", `${Math.round(Math.max(470, Math.min(780, innerHeight - top - 12)))}px`);
  };
  new ResizeObserver(fit).observe(document.querySelector(".top"));
  addEventListener("resize", fit);
  fit();
  new ResizeObserver(ask).observe(view);
  draw();
  return { go, ask, now, end, drawing, paint: paintAt, watch: (watcher) => void watchers.push(watcher), frames: () => frames, playing: () => now.playing };
})();
stageGo = (t) => !stage.playing() && stage.go(t);
stageAsk = stage.ask;
// For tests: where bodies are, as they are drawn.
Object.assign(document.getElementById("stage"), {
  frames: stage.frames,
  go: stage.go,
  time: () => stage.now.t,
  flat: () => stage.now.flat,
  software: () => lighting?.inSoftware ?? false,
  parts: (t) => frameAt(t).parts,
  names: () => bodies.map((body) => body.name),
  flights: (t) => heardAt(t).edges,
  gap: () => (index.disagreement ? data.values("main", index.disagreement.overall).map((size, row) => [data.t("main")[row], size]) : []),
  tips: (t) => bodies.map((body) => trailPoint(body, data.place("scene", t))),
  recorded: (row) => bodies.map((body) => ({ coordinates: body.coordinates, base: layout.bases.get(body) ?? null, tip: read(body.tip, { row, part: 0 }) })),
  times: () => sceneTimes,
  drawing: stage.drawing,
  pixels: (id) => {
    const { plot } = state.get(all.find((card) => card.dataset.plot === id));
    const { width, height } = pictureOf(plot, document.title);
    return [width, height, plot.width];
  },
  table: (id) => csvOf(state.get(all.find((card) => card.dataset.plot === id)).plot),
  drawings: () => [...plots].map((plot) => ({ curves: plot.curves?.() ?? shownSeries(plot).length, svg: svgOf(plot, document.title) })).filter(({ curves }) => curves > 0),
});
