// A picture in vectors: a pen with what of a canvas's context the page uses, so that whatever is drawn on the page is drawn with it too.

// Text as XML takes it: no mark that begins something else, and none of the characters that no document may hold.
const xml = (text) =>
  String(text)
    .replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f\ufffe\uffff]|[\ud800-\udbff](?![\udc00-\udfff])|(?<![\ud800-\udbff])[\udc00-\udfff]/g, "\ufffd")
    .replace(/[&<>"']/g, (mark) => `&#${mark.codePointAt(0)};`);

const ANCHORS = { center: "middle", right: "end", end: "end" };
const BASELINES = { middle: "central", top: "hanging" };
const PEN = { strokeStyle: "#000", fillStyle: "#000", lineWidth: 1, lineCap: "butt", lineJoin: "miter", font: "10px sans-serif", globalAlpha: 1, textAlign: "start", textBaseline: "alphabetic", mark: "" };

// Several may stand in one page, where no two may have a clip of the same name.
let clips = 0;
// Draws in units of its own, `width` by `height` of them; `measure` is a context that knows how wide texts are.
const svgPen = (width, height, measure) => {
  const parts = [];
  const kept = [];
  let [path, dash, open] = [[], [], 0];
  const short = (x) => String(Math.round(x * 10) / 10);
  const to = (command) => (...numbers) => void path.push(command + numbers.map(short).join(" "));
  const shape = (attributes) => parts.push(`<path d="${path.join("")}" ${attributes}${pen.globalAlpha < 1 ? ` opacity="${pen.globalAlpha}"` : ""}/>`);
  const text = (said, x, y, look) => {
    const anchor = ANCHORS[pen.textAlign] ? ` text-anchor="${ANCHORS[pen.textAlign]}"` : "";
    const baseline = BASELINES[pen.textBaseline] ? ` dominant-baseline="${BASELINES[pen.textBaseline]}"` : "";
    const opacity = pen.globalAlpha < 1 ? ` opacity="${pen.globalAlpha}"` : "";
    parts.push(`<text x="${short(x)}" y="${short(y)}" style="font:${xml(pen.font)}"${anchor}${baseline}${opacity} ${look}>${xml(said)}</text>`);
  };
  const moved = (how) => {
    open += 1;
    parts.push(`<g transform="${how}">`);
  };
  const line = () =>
    `stroke="${xml(pen.strokeStyle)}" stroke-width="${pen.lineWidth}" stroke-linecap="${pen.lineCap}" stroke-linejoin="${pen.lineJoin}"` +
    (dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : "");
  const pen = {
    ...PEN,
    save: () => void kept.push({ ...Object.fromEntries(Object.keys(PEN).map((key) => [key, pen[key]])), dash, open }),
    restore: () => {
      const { dash: before, open: opened, ...look } = kept.pop();
      parts.push("</g>".repeat(open - opened));
      [dash, open] = [before, opened];
      Object.assign(pen, look);
    },
    beginPath: () => void (path = []),
    moveTo: to("M"),
    // As a canvas has it, a path that begins with a line begins at its end.
    lineTo: (x, y) => to(path.length ? "L" : "M")(x, y),
    quadraticCurveTo: to("Q"),
    closePath: () => void path.push("Z"),
    rect: (x, y, w, h) => void path.push(`M${short(x)} ${short(y)}h${short(w)}v${short(h)}h${short(-w)}Z`),
    // Whole circles alone, which is what the page draws; a path of two halves.
    arc: (x, y, r) => void path.push(`M${short(x - r)} ${short(y)}a${short(r)} ${short(r)} 0 1 0 ${short(2 * r)} 0a${short(r)} ${short(r)} 0 1 0 ${short(-2 * r)} 0Z`),
    // `mark` is an attribute of lines, by which they are found again.
    stroke: () => shape(`fill="none" ${line()}${pen.mark}`),
    fill: () => shape(`fill="${xml(pen.fillStyle)}"`),
    fillRect: (x, y, w, h) => {
      pen.beginPath();
      pen.rect(x, y, w, h);
      pen.fill();
    },
    fillText: (said, x, y) => text(said, x, y, `fill="${xml(pen.fillStyle)}"`),
    strokeText: (said, x, y) => text(said, x, y, `fill="none" ${line()}`),
    measureText: (said) => {
      measure.font = pen.font;
      return measure.measureText(said);
    },
    setLineDash: (lengths) => void (dash = lengths),
    // These two hold until what was saved is restored.
    translate: (x, y) => moved(`translate(${short(x)} ${short(y)})`),
    clip: () => {
      clips += 1;
      open += 1;
      parts.push(`<clipPath id="clip-${clips}"><path d="${path.join("")}"/></clipPath><g clip-path="url(#clip-${clips})">`);
    },
    document: (title) =>
      `<svg xmlns="http://www.w3.org/2000/svg" width="${short(width)}" height="${short(height)}" viewBox="0 0 ${short(width)} ${short(height)}" role="img">` +
      `<title>${xml(title)}</title>${parts.join("\n")}${"</g>".repeat(open)}</svg>\n`,
  };
  return pen;
};

const measuring = () => element("canvas", {}).getContext("2d");
const FONT = 'ui-sans-serif, system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif';

// The names of curves in rows, from `top` down; how far they reach.
const namesBelow = (pen, named, width, top) => {
  let [x, y] = [14, top];
  pen.font = `11px ${FONT}`;
  for (const { label, colour: own, dash } of named) {
    const wide = 26 + pen.measureText(label).width;
    if (x > 14 && x + wide > width - 14) [x, y] = [14, y + 17];
    // A canvas knows no colour that is none.
    if (own !== "none") {
      Object.assign(pen, { strokeStyle: own, lineWidth: 2 });
      pen.setLineDash(dash ?? []);
      pen.beginPath();
      pen.moveTo(x, y - 4);
      pen.lineTo(x + 16, y - 4);
      pen.stroke();
      pen.setLineDash([]);
    }
    pen.fillStyle = colour("--soft");
    pen.fillText(label, x + 21, y);
    x += wide + 12;
  }
  return y;
};

// What hooks of a plot read of it, for another pen: as the page counts, whatever the density of the canvas, and lower by `head`.
const paperOf = (plot, pen, head) => {
  const density = plot.ctx.canvas.width / plot.width;
  const [left, top, width, height] = ["left", "top", "width", "height"].map((side) => plot.bbox[side] / density);
  return {
    ctx: pen,
    density: 1,
    bbox: { left, top: top + head, width, height },
    scales: plot.scales,
    width: plot.width,
    valToPos: (value, along) => plot.valToPos(value, along, true) / density + (along === "x" ? 0 : head),
  };
};

// One line through points; where a coordinate is no number it is interrupted.
const stroked = (pen, points) => {
  let drawing = false;
  pen.beginPath();
  for (const [x, y] of points) {
    const there = Number.isFinite(x) && Number.isFinite(y);
    if (there) pen[drawing ? "lineTo" : "moveTo"](x, y);
    drawing = there;
  }
  pen.stroke();
};

const drawGrid = (plot, paper, pen) => {
  const { left, top, width, height } = paper.bbox;
  const [right, bottom] = [left + width, top + height];
  plot.axes.forEach((axis, k) => {
    const level = k === 0;
    Object.assign(pen, { font: axisFont, lineWidth: 1, strokeStyle: colour("--grid"), textAlign: level ? "center" : "right", textBaseline: level ? "top" : "middle" });
    (axis._splits ?? []).forEach((split, i) => {
      const place = paper.valToPos(split, level ? "x" : "y");
      if (!(place >= (level ? left : top) - 1 && place <= (level ? right : bottom) + 1)) return;
      if (axis.grid.show) stroked(pen, level ? [[place, top], [place, bottom]] : [[left, place], [right, place]]);
      pen.fillStyle = colour("--muted");
      pen.fillText(axis._values?.[i] ?? "", level ? place : left - 6, level ? bottom + 6 : place);
    });
  });
  Object.assign(pen, { textAlign: "start", textBaseline: "alphabetic" });
};

// A title in lines that fit; a word that is longer than one stays whole.
const titleLines = (pen, title, width) => {
  pen.font = TITLE_FONT;
  const lines = [""];
  for (const word of title.split(" ")) {
    const longer = lines.at(-1) ? `${lines.at(-1)} ${word}` : word;
    if (lines.at(-1) && pen.measureText(longer).width > width) lines.push(word);
    else lines[lines.length - 1] = longer;
  }
  return lines;
};

const CURVE = ' class="curve"';
const MOST_NAMED = 40;
const [HEAD, TITLE_LINE, TITLE_FONT] = [30, 17, `600 13px ${FONT}`];
// What `draw` draws, `high`, between the title and the names of all curves, with a pen for a paper of the size that takes.
const pageWith = (penOf, width, high, title, all, draw) => {
  const lines = titleLines(measuring(), title, width - 28);
  const head = HEAD + TITLE_LINE * (lines.length - 1);
  const under = head + high + 18;
  const named = all.slice(0, MOST_NAMED);
  if (all.length > named.length) named.push({ label: `and ${all.length - named.length} more`, colour: "none" });
  const height = namesBelow(svgPen(0, 0, measuring()), named, width, under) + 12;
  const pen = penOf(width, height);
  pen.fillStyle = colour("--surface");
  pen.fillRect(0, 0, width, height);
  Object.assign(pen, { font: TITLE_FONT, fillStyle: colour("--ink") });
  lines.forEach((line, k) => pen.fillText(line, 14, 20 + TITLE_LINE * k));
  draw(pen, head);
  Object.assign(pen, { textAlign: "start", textBaseline: "alphabetic" });
  namesBelow(pen, named, width, under);
  return pen;
};

// A plot as it stands: the range, the curves and the lines that it shows, with its title above and its legend below.
const plotPage = (penOf, plot, title) => pageWith(penOf, plot.width, plot.height, title, namesOf(plot), (pen, head) => drawAgain(plot, pen, head));
const svgOf = (plot, title) => plotPage((width, height) => svgPen(width, height, measuring()), plot, title).document(title);
// The same in pixels, so many of them that a page can be printed with it.
const PIXELS = 3;
const pictureOf = (plot, title) => {
  const canvas = element("canvas", {});
  plotPage((width, height) => {
    Object.assign(canvas, { width: Math.ceil(PIXELS * width), height: Math.ceil(PIXELS * height) });
    const ctx = canvas.getContext("2d");
    ctx.scale(PIXELS, PIXELS);
    return ctx;
  }, plot, title);
  return canvas;
};
const namesOf = (plot) => plot.named?.() ?? foremost(shownSeries(plot).map(({ s }) => ({ label: s.label, colour: s._colour, dash: s.dash, first: s._first })));
const drawAgain = (plot, pen, head) => {
  if (plot.again) return plot.again(pen, head);
  const paper = paperOf(plot, pen, head);
  drawGrid(plot, paper, pen);
  drawBreakPoints(paper);
  clipped(paper, () => {
    const [first, last] = plot.series[0].idxs ?? [0, plot.data[0].length - 1];
    for (const { s, k } of shownSeries(plot)) {
      const points = [];
      for (let i = first; i <= last; i++) points.push([paper.valToPos(plot.data[0][i], "x"), plot.data[k][i] == null ? NaN : paper.valToPos(plot.data[k][i], "y")]);
      Object.assign(pen, { strokeStyle: s._colour, lineWidth: s.width, lineJoin: "round", mark: CURVE });
      pen.setLineDash(s.dash ?? []);
      stroked(pen, points);
    }
  });
  for (const draw of plot.besides) draw(paper);
};
