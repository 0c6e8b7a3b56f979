// What leaves the page: each plot as a picture and as numbers, and in words for whoever cannot see it.

const save = (name, blob) => {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};
// A sheet cannot be scrolled: tables and formulas that are wider than it are printed smaller.
const fitSheet = (on) => {
  for (const wide of document.querySelectorAll(".scroll > table, .formula > math")) {
    wide.style.zoom = "";
    const room = wide.parentElement;
    const { paddingLeft, paddingRight } = getComputedStyle(room);
    const beside = [...room.children].filter((other) => other !== wide && room.matches(".formula")).reduce((sum, other) => sum + other.offsetWidth + 24, 0);
    const share = (room.clientWidth - parseFloat(paddingLeft) - parseFloat(paddingRight) - beside) / wide.getBoundingClientRect().width;
    if (on && share < 1) wide.style.zoom = String(Math.floor(1000 * share) / 1000);
  }
};
const shownSeries = (plot) => plot.series.map((s, k) => ({ s, k })).filter(({ s, k }) => k > 0 && s.show && s.label);

// Rows of a plot as they were recorded, where not all of its points are.
const recordedIn = (plot) => plot.recorded?.() ?? plot.data;

// A single-precision number in as few digits as tell it from all others.
const single = (v) => {
  if (v == null) return "";
  if (Math.fround(v) !== v) return String(v);
  for (let digits = 6; digits < 9; digits++) if (Math.fround(+v.toPrecision(digits)) === v) return String(+v.toPrecision(digits));
  return String(+v.toPrecision(9));
};

// Quotation marks as tables have them; a cell that could be taken for a formula begins with an apostrophe.
const cell = (text) => `"${String(text).replace(/^[=+\-@\t\r]/, "'$&").replaceAll('"', '""')}"`;
const withUnit = (plot, { label, unit = plot.unit }) => (unit ? `${label} in ${unit}` : label);
const csvOf = (plot) => {
  if (plot.rows) return [plot.rows.head.map(cell), ...plot.rows.all.map((row) => row.map((v) => (typeof v === "number" ? v : cell(v)))), []].map((row) => row.join(",")).join("\n");
  const series = shownSeries(plot);
  // Times may be a typed array, whose own map() would make numbers of the lines.
  const own = recordedIn(plot);
  const rows = Array.from(own[0], (t, i) => [t, ...series.map(({ k }) => single(own[k][i]))].join(","));
  // A table that left the page does not say what was chosen on it.
  const named = (s) => ({ ...s, label: [s.label, plot.columnsSayAll ? "" : plot.chosen].filter(Boolean).join(" · ") });
  return [["t_s", ...series.map(({ s }) => cell(withUnit(plot, named(s))))].join(","), ...rows, ""].join("\n");
};

const TABLE_ROWS = 13;
const TABLE_SERIES = 12;
const TABLE_LINES = 60;
const tableWith = (head, rows, more) => {
  const line = (tag, texts) => element("tr", {}, ...texts.map((textContent) => element(tag, { textContent })));
  const table = element("table", { className: "numbers" }, element("thead", {}, line("th", head)), element("tbody", {}, ...rows.map((row) => line("td", row))));
  return [table, ...(more ? [element("p", { className: "note", textContent: more })] : [])];
};
const tableOf = (plot) => {
  if (plot.rows) {
    const { head, all } = plot.rows;
    const some = all.slice(0, TABLE_LINES).map((row) => row.map((v) => (typeof v === "number" ? number(v) : v)));
    return tableWith(head, some, all.length > some.length && `The first ${some.length} of ${all.length} rows. The CSV has all.`);
  }
  const all = shownSeries(plot);
  const series = all.slice(0, TABLE_SERIES);
  const own = recordedIn(plot);
  const times = own[0];
  const rows = [...new Set(Array.from({ length: TABLE_ROWS }, (_, k) => Math.round((k * (times.length - 1)) / (TABLE_ROWS - 1))))];
  const lines = rows.map((i) => [number(times[i]), ...series.map(({ k }) => number(own[k][i]))]);
  const more = all.length > series.length && `The first ${series.length} of ${all.length} columns; hide agents to see others. The CSV has all.`;
  return tableWith(["t in s", ...series.map(({ s }) => withUnit(plot, s))], lines, more);
};
// Tables that are open say what is drawn.
const refreshTables = () => document.querySelectorAll(".exports details[open]").forEach((table) => table.dispatchEvent(new Event("toggle")));

// The first of the words of a heading.
const headingOf = (heading) => heading?.firstChild?.textContent.trim() ?? "";

// The parts of a heading, each told apart from the next.
const titleOf = (card) => {
  const heading = card.querySelector("h3");
  return [...heading.childNodes].map((part) => part.textContent.trim()).filter(Boolean).join(", ");
};

// A curve in a plane or in space has two or three columns.
const curvesWords = (plot) => {
  if (plot.rows) return plot.rows.said;
  const count = plot.curves?.() ?? shownSeries(plot).length;
  return count === 1 ? "1 curve" : `${count} curves`;
};

const labelled = (card, plot) =>
  card.querySelector(".canvas").setAttribute("aria-label", `${wholeTitleOf(card)}: ${curvesWords(plot)} over ${number(whole[1])} s; their numbers are in the table below`);

// What leaves the page says what was chosen on it: the joint, the agent, the derivative.
const chosenOf = (card) => card.querySelector(".picked")?.textContent ?? "";
const wholeTitleOf = (card) => [titleOf(card), chosenOf(card)].filter(Boolean).join(", ");

// Buttons and a table under a plot; called whenever it is drawn anew.
const offer = (card, plot) => {
  card.querySelector(".exports")?.remove();
  const title = wholeTitleOf(card);
  plot.chosen = chosenOf(card);
  const canvas = card.querySelector(".canvas");
  canvas.setAttribute("role", "img");
  labelled(card, plot);
  const name = [card.dataset.plot, chosenOf(card)].filter(Boolean).join(" ").replace(/[^\p{L}\p{M}\p{N}-]+/gu, "-");
  const button = (text, label, onclick) => {
    const made = element("button", { type: "button", textContent: text, onclick });
    made.setAttribute("aria-label", label);
    return made;
  };
  const table = element("details", {}, element("summary", { textContent: "Table" }));
  table.ontoggle = () => {
    table.querySelector(".scroll")?.remove();
    if (table.open) table.append(element("div", { className: "scroll" }, ...tableOf(plot)));
  };
  card.append(
    element(
      "div",
      { className: "exports" },
      table,
      button("PNG", `Save ${title} as a picture`, () => pictureOf(plot, title).toBlob((blob) => blob && save(`${name}.png`, blob))),
      button("SVG", `Save ${title} as a drawing`, () => save(`${name}.svg`, new Blob([svgOf(plot, title)], { type: "image/svg+xml" }))),
      button("CSV", `Save ${title} as a table`, () => save(`${name}.csv`, new Blob([csvOf(plot)], { type: "text/csv" }))),
    ),
  );
};
