// A page for a talk, 16 to 9: title, verdict, space and one plot, at the time of the clock; as a picture, a drawing or a film.

const talk = (() => {
  const [WIDE, HIGH, EDGE] = [1280, 720, 40];
  const SPACE = { left: EDGE, top: 138, width: 740, height: 514 };
  const PLOT = { left: 806, top: 160, width: 440, height: 236 };
  const HEADING = "600 15px";
  const NAME_ROWS = 3;
  const FRAMES_PER_S = 25;
  const PICTURES_PER_S = 10;
  const part = (id) => document.getElementById(id);
  const [dialog, canvas, which, seconds, means, progress] = ["talk", "talk-slide", "talk-plot", "talk-seconds", "talk-means", "talk-progress"].map(part);
  const text = (selector) => document.querySelector(selector)?.textContent.replace(/\s+/g, " ").trim() ?? "";

  // Words in lines of a width; what does not fit the last of them is said to be missing.
  const wrapped = (pen, said, width, most) => {
    const lines = [];
    for (const word of said.split(" ")) {
      const longer = lines.length ? `${lines.at(-1)} ${word}` : word;
      if (lines.length && pen.measureText(longer).width <= width) lines[lines.length - 1] = longer;
      else lines.push(word);
    }
    const cut = lines.slice(0, most);
    const fitting = (line, end) => {
      let letters = [...line];
      while (letters.length > 1 && pen.measureText(letters.join("") + end).width > width) letters = letters.slice(0, -1);
      return letters.join("") + end;
    };
    return cut.map((line, k) => (k === most - 1 && lines.length > most ? fitting(line, "…") : pen.measureText(line).width > width ? fitting(line, "…") : line));
  };
  const written = (pen, said, { font, colour: own, left, top, width, line, most }) => {
    Object.assign(pen, { font: `${font} ${FONT}`, fillStyle: colour(own), textAlign: "left", textBaseline: "alphabetic" });
    const lines = wrapped(pen, said, width, most);
    lines.forEach((each, k) => pen.fillText(each, left, top + k * line));
    return top + lines.length * line;
  };
  const inside = (pen, { left, top }, draw) => {
    pen.save();
    pen.translate(left, top);
    draw();
    pen.restore();
  };

  // The plot has a size of its own, so that its letters can be read from the last row.
  const host = element("div", { className: "plot" }, element("h3"), element("div", { className: "pick" }), element("div", { className: "canvas" }));
  dialog.append(element("div", { className: "talk-plot-host" }, host));
  const choose = () => {
    const card = all.find((c) => c.dataset.plot === which.value);
    host.dataset.plot = card.dataset.plot;
    const [name, letters] = [headingOf(card.querySelector("h3")), card.querySelector("h3 .by")?.textContent];
    host.querySelector("h3").textContent = letters ? `${name}, ${letters}` : name;
    host.dataset.name = name;
    host.dataset.empty = card.dataset.empty ?? "";
    const before = state.get(host)?.plot ?? null;
    state.set(host, { picks: [...(state.get(card)?.picks ?? [])], plot: before });
    fill(host, PLOT.height);
    // Plots are drawn after the script that made them.
    requestAnimationFrame(() => requestAnimationFrame(redraw));
  };
  // Its name, unit and picks; how it is measured only where there is room for that too.
  const heading = (pen) => {
    const unit = host.querySelector(".unit")?.textContent.trim();
    const said = (name) => [name, unit && `in ${unit}`, chosenOf(host)].filter(Boolean).join(", ");
    pen.font = `${HEADING} ${FONT}`;
    const all = said(headingOf(host.querySelector("h3")));
    return pen.measureText(all).width <= PLOT.width ? all : said(host.dataset.name);
  };
  const plotNow = () => state.get(host)?.plot ?? null;

  // What does not move.
  const still = (pen) => {
    pen.fillStyle = colour("--surface");
    pen.fillRect(0, 0, WIDE, HIGH);
    let y = written(pen, text("h1"), { font: "650 29px", colour: "--ink", left: EDGE, top: 56, width: WIDE - 2 * EDGE, line: 35, most: 2 });
    const said = text(".top .conclusion") || text(".top .ending > :last-child");
    if (said) written(pen, said, { font: "16px", colour: "--soft", left: EDGE, top: y, width: WIDE - 2 * EDGE, line: 21, most: y > 100 ? 1 : 2 });
    const plot = plotNow();
    y = PLOT.top;
    if (plot) {
      written(pen, heading(pen), { font: HEADING, colour: "--ink", left: PLOT.left, top: PLOT.top - 12, width: PLOT.width, line: 18, most: 1 });
      inside(pen, PLOT, () => drawAgain(plot, pen, 0));
      const named = namesOf(plot);
      Object.assign(pen, { textAlign: "start", textBaseline: "alphabetic" });
      const some = (count) => (count < named.length ? [...named.slice(0, count), { label: `and ${named.length - count} more`, colour: "none" }] : named);
      // As many as leave room for figures and the verdict.
      let count = named.length > 9 ? 8 : named.length;
      while (count > 1 && namesBelow(svgPen(0, 0, measuring()), some(count), PLOT.width, 17) > NAME_ROWS * 17) count -= 1;
      inside(pen, PLOT, () => (y = PLOT.top + 16 + namesBelow(pen, some(count), PLOT.width, PLOT.height + 20)));
    }
    const figures = [...document.querySelectorAll(".verdict .figures div")].slice(0, 6);
    y += 26;
    figures.forEach((figure, k) => {
      const left = PLOT.left + (k % 2) * (PLOT.width / 2);
      const top = y + Math.floor(k / 2) * 46;
      const width = PLOT.width / 2 - 12;
      const of = (tag) => figure.querySelector(tag)?.textContent.replace(/\s+/g, " ").trim() ?? "";
      // A unit that is cut is another unit.
      let size = 19;
      const font = () => `600 ${size}px`;
      const wide = () => ((pen.font = `${font()} ${FONT}`), pen.measureText(of("dd")).width);
      while (size > 11 && wide() > width) size -= 1;
      written(pen, of("dd"), { font: font(), colour: "--ink", left, top, width, line: 20, most: 1 });
      written(pen, of("dt"), { font: "12.5px", colour: "--muted", left, top: top + 17, width, line: 16, most: 1 });
    });
    y += Math.ceil(figures.length / 2) * 46 + 2;
    const room = Math.floor((SPACE.top + SPACE.height + 14 - y) / 19) + 1;
    if (room > 0) written(pen, text(".promised"), { font: "14px", colour: "--soft", left: PLOT.left, top: y, width: PLOT.width, line: 19, most: room });
    Object.assign(pen, { font: `12.5px ${FONT}`, fillStyle: colour("--muted"), textAlign: "right" });
    pen.fillText("forwardstep", WIDE - EDGE, HIGH - 26);
    pen.textAlign = "left";
  };
  // What does: the picture, where the clock stands in the plot, and the time.
  const moving = (pen, t) => {
    inside(pen, SPACE, () => {
      pen.beginPath();
      pen.rect(0, 0, SPACE.width, SPACE.height);
      pen.clip();
      stage.paint(pen, t, SPACE.width, SPACE.height);
    });
    const plot = plotNow();
    if (plot) inside(pen, PLOT, () => (plot.dotsAt ?? clockLine(plot))(pen, t));
    written(pen, timeOf(t, whole[1]), { font: "600 16px", colour: "--ink", left: EDGE, top: HIGH - 26, width: 400, line: 18, most: 1 });
  };
  const clockLine = (plot) => (pen, t) => {
    const paper = paperOf(plot, pen, 0);
    const { left, top, width, height } = paper.bbox;
    const x = paper.valToPos(t, "x");
    if (!(x >= left && x <= left + width)) return;
    Object.assign(pen, { strokeStyle: colour("--accent"), lineWidth: 1.5, mark: "" });
    stroked(pen, [[x, top], [x, top + height]]);
  };

  const scaled = (picture, k) => {
    const ctx = picture.getContext("2d");
    ctx.setTransform(k, 0, 0, k, 0, 0);
    return ctx;
  };
  const layer = (k) => {
    const made = element("canvas", { width: WIDE * k, height: HIGH * k });
    still(scaled(made, k));
    return made;
  };
  const painted = (picture, under, k, t) => {
    const ctx = scaled(picture, k);
    ctx.drawImage(under, 0, 0, WIDE, HIGH);
    moving(ctx, t);
  };
  const SHARP = 1.5;
  let under = null;
  const show = () => dialog.open && under && painted(canvas, under, SHARP, stage.now.t);
  const redraw = () => {
    under = layer(SHARP);
    show();
  };
  const drawing = () => {
    const pen = svgPen(WIDE, HIGH, measuring());
    still(pen);
    moving(pen, stage.now.t);
    return pen.document(`${document.title}, t = ${number(stage.now.t, 4)} s`);
  };

  // The whole run in so many seconds. A film is taken as it plays, so it lasts as long as asked however slowly frames are drawn.
  const TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
  const type = typeof MediaRecorder === "undefined" || !canvas.captureStream ? null : TYPES.find((t) => MediaRecorder.isTypeSupported(t));
  let stopped = false;
  const film = (length_s, each = () => {}) =>
    new Promise((resolve, reject) => {
      const [picture, ground] = [element("canvas", { width: WIDE, height: HIGH }), layer(1)];
      painted(picture, ground, 1, 0);
      const recorder = new MediaRecorder(picture.captureStream(FRAMES_PER_S), { mimeType: type, videoBitsPerSecond: 6e6 });
      const parts = [];
      recorder.ondataavailable = ({ data: some }) => parts.push(some);
      recorder.onerror = ({ error }) => reject(error);
      recorder.onstop = () => resolve(stopped ? null : new Blob(parts, { type: type.split(";")[0] }));
      recorder.start(1000);
      const begun = performance.now();
      const next = () => {
        const share = Math.min(1, (performance.now() - begun) / (1000 * length_s));
        painted(picture, ground, 1, share * whole[1]);
        each(share);
        // The last picture stays for a while, or a player would never show it.
        if (share < 1 && !stopped) setTimeout(next, 1000 / FRAMES_PER_S);
        else setTimeout(() => recorder.stop(), 200);
      };
      next();
    });

  // Pictures in one archive, as `tar` and every file manager opens it.
  const header = (name, size) => {
    const block = new Uint8Array(512);
    const put = (at, said) => block.set(new TextEncoder().encode(said), at);
    const octal = (value, digits) => value.toString(8).padStart(digits, "0");
    put(0, name), put(100, "0000644\0"), put(108, "0000000\0"), put(116, "0000000\0");
    put(124, `${octal(size, 11)}\0`), put(136, `${octal(0, 11)}\0`), put(148, "        "), put(156, "0"), put(257, "ustar\0"), put(263, "00");
    put(148, `${octal(block.reduce((sum, byte) => sum + byte, 0), 6)}\0 `);
    return block;
  };
  const pictures = async (length_s, each = () => {}) => {
    const [picture, ground] = [element("canvas", { width: WIDE, height: HIGH }), layer(1)];
    const count = Math.max(2, Math.round(length_s * PICTURES_PER_S) + 1);
    const parts = [];
    for (let k = 0; k < count && !stopped; k++) {
      painted(picture, ground, 1, (k / (count - 1)) * whole[1]);
      const png = await new Promise((done) => picture.toBlob(done));
      parts.push(header(`frame-${String(k).padStart(4, "0")}.png`, png.size), png, new Uint8Array((512 - (png.size % 512)) % 512));
      each(k / (count - 1));
    }
    return stopped ? null : new Blob([...parts, new Uint8Array(1024)], { type: "application/x-tar" });
  };

  const buttons = [...dialog.querySelectorAll("button, select")];
  const take = async () => {
    const asFilm = means.value === "film";
    stopped = false;
    buttons.forEach((button) => (button.disabled = button.id !== "talk-close"));
    part("talk-close").textContent = "Stop";
    try {
      const said = (share) => (progress.textContent = `${asFilm ? "filming" : "drawing"} ${Math.round(100 * share)} %`);
      const made = await (asFilm ? film : pictures)(Number(seconds.value), said);
      if (made) save(asFilm ? `film.${made.type.endsWith("mp4") ? "mp4" : "webm"}` : "frames.tar", made);
      progress.textContent = made ? `saved, ${number(made.size / 1e6, 2)} MB` : "stopped";
    } catch (error) {
      progress.textContent = `not filmed: ${error.message ?? error}`;
    } finally {
      buttons.forEach((button) => (button.disabled = false));
      part("talk-close").textContent = "Close";
    }
  };
  const running = () => part("talk-close").textContent === "Stop";

  const open = () => {
    which.replaceChildren(
      ...all.filter((card) => card.dataset.plot !== "gantt" && state.get(card)?.plot)
        .map((card) => element("option", { value: card.dataset.plot, textContent: headingOf(card.querySelector("h3")) })),
    );
    dialog.showModal();
    progress.textContent = "";
    if (which.options.length) choose();
    else redraw();
  };
  const close = () => {
    if (running()) return void (stopped = true);
    dialog.close();
  };
  dialog.addEventListener("cancel", (event) => running() && (event.preventDefault(), (stopped = true)));
  dialog.addEventListener("close", () => {
    const mine = state.get(host);
    if (mine?.plot) removePlot(mine.plot);
    state.delete(host);
    under = null;
  });
  canvas.width = WIDE * SHARP;
  canvas.height = HIGH * SHARP;
  if (!type) means.querySelector('[value="film"]').remove();
  which.onchange = choose;
  part("view-slide").onclick = open;
  part("talk-close").onclick = close;
  part("talk-play").onclick = () => part("play").click();
  part("talk-full").onclick = () => canvas.requestFullscreen?.();
  part("talk-full").hidden = !document.fullscreenEnabled;
  part("talk-png").onclick = () => canvas.toBlob((blob) => blob && save("slide.png", blob));
  part("talk-svg").onclick = () => save("slide.svg", new Blob([drawing()], { type: "image/svg+xml" }));
  part("talk-take").onclick = () => void take();
  // In full screen, and wherever no button has the focus, keys move the clock as in the picture.
  dialog.addEventListener("keydown", (event) => {
    if (["BUTTON", "SELECT"].includes(event.target.tagName) && !document.fullscreenElement) return;
    const step = (event.shiftKey ? 10 : 1) * (stage.end / 200);
    const does = { " ": () => part("play").click(), ArrowRight: () => stage.go(stage.now.t + step), ArrowLeft: () => stage.go(stage.now.t - step), Home: () => stage.go(0), End: () => stage.go(stage.end) }[event.key];
    if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    does();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => dialog.open && choose());
  addEventListener("beforeprint", () => dialog.open && redraw());
  addEventListener("afterprint", () => dialog.open && requestAnimationFrame(redraw));
  stage.watch((t) => {
    part("talk-play").textContent = stage.playing() ? "Pause" : "Play";
    show(t);
  });
  return { open, close, drawing, film, pictures, plots: () => [...which.options].map((o) => o.value), choose: (value) => ((which.value = value), choose()) };
})();
document.getElementById("stage").talk = talk;
