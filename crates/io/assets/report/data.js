// What went wrong stands on the page, where a reader sees it, and a test too.
const banner = document.getElementById("error-banner");
window.addEventListener("error", (event) => {
  banner.textContent += `The plots could not be drawn: ${event.message} `;
});

const index = JSON.parse(document.getElementById("index").textContent);

// The name of an agent; of a leader that it leads, unless the name says so.
function leading(name, leads) {
  return leads && name !== "leader" ? `${name}, leads` : name;
}

// The block: times of the four grids as f64, then the series of the same grids as f32.
const dataOf = (index, block) => {
  const text = atob(block);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const g = index.grids;
  const times = new Float64Array(bytes.buffer, 0, g.main + g.estimates + g.delays + g.scene);
  const numbers = new Float32Array(bytes.buffer, times.byteLength);
  const estimateStart = g.main * g.main_series;
  const delayStart = estimateStart + g.estimates * g.estimate_series;
  const grids = {
    main: { t: times.subarray(0, g.main), start: 0, origins: g.origins.main },
    estimates: { t: times.subarray(g.main, g.main + g.estimates), start: estimateStart, origins: g.origins.estimates },
    delays: { t: times.subarray(g.main + g.estimates, g.main + g.estimates + g.delays), start: delayStart, origins: {} },
    scene: { t: times.subarray(g.main + g.estimates + g.delays), start: delayStart + g.delays * g.delay_series, origins: g.origins.scene },
  };
  // Rows as they were recorded; null where all points are. The others stand where they do so that curves look as they are.
  const recorded = { main: g.rows.main, estimates: g.rows.estimates };
  for (const [grid, bits] of Object.entries(recorded)) {
    if (bits === null) continue;
    const eights = atob(bits);
    recorded[grid] = [...grids[grid].t.keys()].filter((i) => (eights.charCodeAt(i >> 3) >> (i & 7)) & 1);
  }
  const rowsOf = (grid) => recorded[grid] ?? null;
  const picked = (grid, list) => (rowsOf(grid) ? rowsOf(grid).map((i) => list[i]) : list);
  // Series that stay far from zero are stored less where they are: single precision has seven digits.
  const originOf = (grid, k) => grids[grid].origins[k] ?? 0;
  // A gap where a number is missing, or cannot stand on a logarithmic axis; `linear` has those that cannot.
  const values = (grid, k, log) => {
    const { t, start } = grids[grid];
    const from = start + k * t.length;
    const origin = originOf(grid, k);
    const list = Array.from(numbers.subarray(from, from + t.length), (v) => (Number.isFinite(v) && (!log || origin + v > 0) ? origin + v : null));
    return Object.assign(list, { beyond_s: beyond(grid, k), linear: () => (log ? values(grid, k, false) : list) });
  };
  // From when on a number is larger than any of single precision; null if it never is.
  const beyond = (grid, k) => {
    const { t, start } = grids[grid];
    const from = start + k * t.length;
    const row = numbers.subarray(from, from + t.length).findIndex((v) => Math.abs(v) === Infinity);
    return row < 0 ? null : t[row];
  };
  // The value at any time, on the straight line between two rows.
  const at = (grid, k, { row, part }) => {
    const { t, start } = grids[grid];
    const here = numbers[start + k * t.length + row];
    return originOf(grid, k) + (part === 0 ? here : here + part * (numbers[start + k * t.length + row + 1] - here));
  };
  const place = (grid, time) => placeIn(grids[grid].t, time);
  return { beyond, t: (grid) => Array.from(grids[grid].t), values, at, place, picked };
};
// The row before a time, and how far it is to the next.
const placeIn = (t, time) => {
  let [low, high] = [0, t.length - 1];
  if (high <= 0 || time <= t[0]) return { row: 0, part: 0 };
  if (time >= t[high]) return { row: high, part: 0 };
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  return { row: low, part: t[high] > t[low] ? (time - t[low]) / (t[high] - t[low]) : 0 };
};
// A page of several runs has a block for each.
const data = index.runs ? null : dataOf(index, document.getElementById("block").textContent);

const element = (tag, properties = {}, ...children) => {
  const e = Object.assign(document.createElement(tag), properties);
  e.append(...children);
  return e;
};
const colour = (name, within = document.documentElement) => getComputedStyle(within).getPropertyValue(name).trim();
const RAMP = 16;
const ramp = (k, n) => colour(`--r${n > 1 ? Math.round((k * (RAMP - 1)) / (n - 1)) : RAMP / 2}`);

const raise = (n) => String(n).replace(/./g, (c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[+c]));
const minus = (text) => text.replace("-", "−");
const power = (exponent) => (exponent === 0 ? "1" : exponent === 1 ? "10" : `10${raise(exponent)}`);

// A number with about `digits` significant digits.
const number = (v, digits = 4) => {
  if (v == null) return "–";
  if (v === 0) return "0";
  const size = Math.abs(v);
  if (size >= 1e-3 && size < 1e6) return minus(String(+v.toPrecision(digits)));
  const [mantissa, exponent] = v.toExponential(digits - 1).split("e");
  return minus(`${+mantissa} × 10${raise(+exponent)}`);
};

// A time of a run: as many places as tell its thousandths apart.
const timePlaces = (end) => (end > 0 ? Math.max(0, Math.min(12, 4 - Math.ceil(Math.log10(end)))) : 0);
// Never beyond the end, whatever is rounded.
const timeAt = (t, end) => {
  const places = timePlaces(end);
  return `t = ${(t < end ? Math.min(t, Math.floor(end * 10 ** places) / 10 ** places) : end).toFixed(places)} s`;
};
const timeOf = (t, end) => `${timeAt(t, end)} of ${+end.toFixed(timePlaces(end))} s`;

const unnamedWords = (count, all) => (count === all ? "no room for names: point at one" : `and ${count} more without room for ${count === 1 ? "its name" : "their names"}`);
// What tells long names apart often stands at their end.
const shortName = (name, most) => {
  const letters = [...name];
  if (letters.length <= most) return name;
  const end = Math.floor((most - 1) / 3);
  return `${letters.slice(0, most - 1 - end).join("")}…${letters.slice(letters.length - end).join("")}`;
};
// Distinct units, for reading; what has none stands beside what has one.
const unitsOf = (units) => {
  const distinct = [...new Set(units)];
  return distinct.length > 1 ? distinct.map((unit) => unit || "1").join(" or ") : distinct[0] ?? "";
};
// What marks in a picture mean, of those that it has.
const marksOf = (bodies) => {
  const crafts = bodies.filter((b) => b.kind === "spacecraft");
  const spun = crafts.filter((b) => b.wheel_axes.length > 0);
  const spins = spun.some((b) => b.wheels.length > 0);
  const pushed = bodies.some((b) => b.kind === "vehicle" && b.attitude.length === 4 && b.thrust !== null);
  const words = [crafts.some((b) => b.target.length === 4) && "dashed: axes of the target", spun.length > 0 && "circles: reaction wheels", spins && "arrows: their momenta", pushed && "straight arrows: thrust"];
  return words.filter(Boolean);
};

// The label of a tick when neighbours are `step` apart.
const tick = (v, step) => {
  const size = Math.max(Math.abs(v), step);
  if (size >= 1e5 || size < 1e-3) return Math.abs(v) < 1e-6 * step ? "0" : number(v, 3);
  let places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  if (Math.abs(step * 10 ** places - Math.round(step * 10 ** places)) > 1e-6) places += 1; // 0.25
  return minus(v.toFixed(Math.min(6, places)));
};
