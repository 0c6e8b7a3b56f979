// What leaves the page: each plot as a picture and as numbers, and in words for whoever cannot see it.

const save = (name, blob) => {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};
const shownSeries = (plot) => plot.series.map((s, k) => ({ s, k })).filter(({ s, k }) => k > 0 && s.show && s.label);

// Quotation marks as tables have them; a cell that could be taken for a formula begins with an apostrophe.
const cell = (text) => `"${String(text).replace(/^[=+\-@\t\r]/, "'$&").replaceAll('"', '""')}"`;
const csvOf = (plot) => {
  const series = shownSeries(plot);
  const rows = plot.data[0].map((t, i) => [t, ...series.map(({ k }) => plot.data[k][i] ?? "")].join(","));
  return [["t_s", ...series.map(({ s }) => cell(s.label))].join(","), ...rows, ""].join("\n");
};

// The ground is drawn under the picture, which has none.
const pictureOf = (plot, done) => {
  const from = plot.ctx.canvas;
  const copy = element("canvas", { width: from.width, height: from.height });
  const ctx = copy.getContext("2d");
  ctx.fillStyle = colour("--surface");
  ctx.fillRect(0, 0, copy.width, copy.height);
  ctx.drawImage(from, 0, 0);
  copy.toBlob(done);
};

const TABLE_ROWS = 13;
const tableOf = (plot) => {
  const series = shownSeries(plot).slice(0, 12);
  const times = plot.data[0];
  const rows = [...new Set(Array.from({ length: TABLE_ROWS }, (_, k) => Math.round((k * (times.length - 1)) / (TABLE_ROWS - 1))))];
  const line = (tag, texts) => element("tr", {}, ...texts.map((textContent) => element(tag, { textContent })));
  return element(
    "table",
    { className: "numbers" },
    element("thead", {}, line("th", ["t in s", ...series.map(({ s }) => s.label)])),
    element("tbody", {}, ...rows.map((i) => line("td", [number(times[i]), ...series.map(({ k }) => number(plot.data[k][i]))]))),
  );
};

// Buttons and a table under a plot; called whenever it is drawn anew.
const offer = (card, plot) => {
  card.querySelector(".exports")?.remove();
  const title = card.querySelector("h3").textContent;
  const canvas = card.querySelector(".canvas");
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `${title}: ${shownSeries(plot).length} curves over ${number(whole[1])} s; their numbers are in the table below`);
  const name = card.dataset.plot.replace(/[^a-z0-9-]/gi, "-");
  const button = (text, label, onclick) => {
    const made = element("button", { type: "button", textContent: text, onclick });
    made.setAttribute("aria-label", label);
    return made;
  };
  const table = element("details", {}, element("summary", { textContent: "Table" }));
  table.ontoggle = () => {
    table.querySelector(".scroll")?.remove();
    if (table.open) table.append(element("div", { className: "scroll" }, tableOf(plot)));
  };
  card.append(
    element(
      "div",
      { className: "exports" },
      table,
      button("PNG", `Save ${title} as a picture`, () => pictureOf(plot, (blob) => blob && save(`${name}.png`, blob))),
      button("SVG", `Save ${title} as a drawing`, () => save(`${name}.svg`, new Blob([svgOf(plot, title)], { type: "image/svg+xml" }))),
      button("CSV", `Save ${title} as a table`, () => save(`${name}.csv`, new Blob([csvOf(plot)], { type: "text/csv" }))),
    ),
  );
};
