#!/usr/bin/env python3
"""Checks of how a page is laid out, printed, saved and gone through by keys.

    validation/browser/layout.py target/release/forwardstep [whole] [cards]
"""

import csv
import io
import json
import re
import sys

import checks
from checks import FRAMES, drawn, expect, some, value, waited
from known import masses

RING = "delay.constant_s = 0.1\nedges.ring = {}"

# An s that only rounding makes, and so a V of 1e-35.
ROUNDING = """format = 2
time.end_s = 4
[[agents]]
name = "chain"
count = 3
robot.chain = { order = 2, psi = "x - 0.5" }
start.position = [[1.0], [2.0], [0.1]]
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position"
[law.linearising]
[network]
edges.ring = {}
"""
# Runs away from its target within a part of a second.
BLOWN = """
format = 2
title = "Sampled too slowly"
time.end_s = 60
[[agents]]
name = "mass"
robot.point_mass = { dimension = 2, mass_kg = 2 }
start.position_m = [0.5, -0.5]
target.formulas = ["2*sin(t)", "2*cos(0.7*t)"]
[reference.tracking]
roots_per_s = [1.5, 2]
[law.model_reference]
filter_per_s = 20
adaptation_gain = 8
[control]
sample_hz = 40
"""
MEASURED = """
const box = (part) => document.querySelector(part)?.getBoundingClientRect();
const picture = document.querySelector("#graph-picture svg"), own = picture.getBoundingClientRect();
const texts = [...picture.querySelectorAll("text")].map((text) => text.getBoundingClientRect());
const out = (a) => a.left < own.left - 1 || a.right > own.right + 1 || a.top < own.top - 1 || a.bottom > own.bottom + 1;
const meet = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 3 && b.top < a.bottom - 3;
return {
  bottoms: ["#view", "#slider", ".verdict", "#stage .beside-space .plot canvas", "#graph-picture"].map((part) => Math.round(box(part)?.bottom ?? 0)),
  high: Math.round(own.height), letters: 12 * (picture.getScreenCTM()?.a ?? 0),
  texts: texts.length, lost: texts.filter(out).length + texts.filter((a, k) => texts.some((b, j) => j < k && meet(a, b))).length,
};
"""
PRINTED = """
const names = () => [...document.querySelectorAll(".grid .plot")].filter((card) => !card.hidden);
const wide = () => names().map((card) => Math.round((card.querySelector(".u-wrap, .plane") ?? card).getBoundingClientRect().width));
const before = wide();
dispatchEvent(new Event("beforeprint"));
await frames(3);
const found = {
  main: document.querySelector("main").clientWidth, wide: wide(), columns: new Set(names().map((card) => Math.round(card.getBoundingClientRect().left))).size,
  corner: getComputedStyle(document.querySelector(".corner")).display, legend: document.getElementById("legend").clientHeight,
  curves: [...document.querySelectorAll(".plane")].map((plane) => plane.querySelectorAll("path.curve").length), overlaid: document.querySelectorAll(".plane canvas").length,
};
dispatchEvent(new Event("afterprint"));
await frames(3);
return { ...found, again: String(wide()) === String(before) };
"""


def windows(browser, page, name):
    """All that belongs together stands in one window, and names in the graph can be read in every window."""
    for width, height in [(1400, 900), (1366, 768), (1280, 720), (1024, 768), (390, 844)]:
        browser.screen(width, height, touch=width == 390)
        browser.open(page)
        drawn(browser)
        found, about = browser.run(MEASURED), f"{name} at {width} by {height}"
        expect(found["high"] >= 205 and found["letters"] >= 10, f"{about}: the graph is {found['high']} px high with letters of {found['letters']} px")
        expect(found["texts"] > 0 and found["lost"] == 0, f"{about}: {found['lost']} of {found['texts']} names are cut or covered")
        if width == 1400:
            expect(max(found["bottoms"]) <= height and min(found["bottoms"]) > 0, f"{about}: picture, slider, verdict, plot and graph end at {found['bottoms']} px")
        if width > 1000:
            expect(found["bottoms"][1] <= height, f"{about}: the slider ends at {found['bottoms'][1]} px")
    browser.screen(1400, 900)


def printed(browser, name):
    """A print has one column, in which everything is drawn, and nothing to press."""
    found = waited(browser, FRAMES + PRINTED)
    expect(found["main"] == 700 and found["columns"] == 1 and all(600 < wide <= 700 for wide in found["wide"]), f"{name} printed: {found}")
    expect(found["corner"] == "none" and found["legend"] > 0, f"{name} printed: buttons are shown or names are not: {found}")
    expect(found["curves"] and min(found["curves"]) > 0 and found["overlaid"] == 0, f"{name} printed: planes and paths have {found['curves']} curves")
    expect(found["again"], f"{name}: the page is another after it was printed")


def named(browser, name):
    """Whatever can be chosen has a name, and so has every plot."""
    nameless = value(browser, "[...document.querySelectorAll('main select, main canvas')].filter((e) => !(e.closest('label') || e.closest('[aria-label]') || e.closest('[aria-hidden]'))).map((e) => e.closest('[data-plot]')?.dataset.plot ?? e.id)")
    expect(not nameless, f"{name}: without a name: {nameless}")
    glued = value(browser, "[...document.querySelectorAll('.canvas[aria-label]')].map((e) => [e.closest('[data-plot]').querySelector('h3').textContent, e.getAttribute('aria-label')]).filter(([title, label]) => /\\s{2}/.test(label) || !label.includes(', '))")
    expect(not glued, f"{name}: {glued}")


def saved(browser, name, unit):
    """Tables have units and no more digits than numbers; pictures have pixels for print."""
    table = value(browser, "s.table('position')")
    rows = list(csv.reader(io.StringIO(table)))
    expect(all(head.endswith(f" in {unit}") for head in rows[0][1:]), f"{name}: columns {rows[0]}")
    long = [cell for row in rows[1:] for cell in row[1:] if len(cell.lstrip("-").replace(".", "").split("e")[0].lstrip("0")) > 9]
    expect(not long, f"{name}: numbers of single precision as {long[:3]}")
    wide, high, screen = value(browser, "s.pixels('position')")
    expect(wide >= 2 * screen and high > 2 * 290, f"{name}: a picture of {wide} by {high} where the plot is {screen} wide")


TABLE = """
const card = document.querySelector("[data-plot=position]");
const table = () => card.querySelector(".exports table");
const fold = card.querySelector(".exports details");
fold.open = true;
await frames(3);
const [all, said] = [table().querySelectorAll("th").length, card.querySelector(".exports .note")?.textContent ?? ""];
const chip = document.querySelector("#legend button:not(.all)");
chip.click();
await frames(3);
const few = table().querySelectorAll("th").length;
chip.click();
fold.open = false;
return [all, few, said];
"""
PRESSED = """
const pick = document.querySelector("[data-plot=position] .pick").querySelector("button[aria-pressed=false], select");
const name = pick.dataset.pick;
pick.focus();
if (pick.tagName === "SELECT") (pick.selectedIndex = 1), pick.onchange();
else pick.click();
return [name, document.activeElement.dataset.pick ?? document.activeElement.tagName];
"""


def tables(browser, name, columns):
    """An open table says what is drawn, and how much it leaves out."""
    all_, few, said = waited(browser, FRAMES + TABLE)
    if columns > 12:
        expect(all_ == 13 and f"12 of {columns}" in said, f"{name}: {all_} columns, and {said}")
    else:
        expect((all_, few) == (columns + 1, columns), f"{name}: {all_} columns, and {few} with one agent hidden")


def keys(browser, name):
    before, after = browser.run(PRESSED)
    expect(before == after, f"{name}: who pressed a choice is then at {after}")


LEADER = """
const chips = [...document.querySelectorAll("#legend button:not(.all)")];
const chip = chips.find((one) => one.textContent === "leader");
const drawn = () => document.getElementById("stage").table("position").split("\\n")[0].split(",").length;
if (!chip) return null;
const before = drawn();
chip.click();
const after = drawn();
chip.click();
return [before, after];
"""


def leader(browser, name):
    """A leader that is no agent can be hidden like one."""
    found = browser.run(LEADER)
    expect(found is not None and found[1] == found[0] - 1, f"{name}: the leader has no chip that hides it: {found}")


def joints(browser, name):
    """No joint empties a card that has others."""
    empty = browser.run("""
        const joint = document.getElementById("joint"), found = [];
        for (const { value } of [...joint.options]) {
          joint.value = value;
          joint.onchange();
          found.push(...[...document.querySelectorAll("#signals [data-plot]:not([hidden])")].filter((card) => card.querySelector(".none")).map((card) => `${card.dataset.plot} at ${value}`));
        }
        return found;""")
    expect(not empty, f"{name}: nothing is drawn in {empty}")


def dashes(browser, name, wanted):
    """Keys name what is dashed."""
    found = value(browser, "[...document.querySelectorAll('.key span')].map((e) => e.textContent)")
    expect(all(word in found for word in wanted), f"{name}: {wanted} are missing in {found}")


MANY = """
const heads = () => document.getElementById("stage").table("position").split("\\n")[0].split(",").length - 1;
const before = heads();
const chosen = document.getElementById("chosen");
chosen.value = "5";
chosen.onchange();
const one = heads();
chosen.value = "";
chosen.onchange();
const filter = document.querySelector("#legend input");
filter.value = "point-1";
filter.oninput();
const chips = [...document.querySelectorAll("#legend button:not(.all):not([hidden])")].length;
[...document.querySelectorAll("#legend .all")].find((button) => button.textContent === "only these").click();
return [before, one, chips, heads()];
"""
SPREAD = """
const rows = document.getElementById("stage").table("position").trim().split("\\n").slice(1).map((row) => row.split(",").map(Number));
return rows.every(([, greatest, high, middle, low, least]) => greatest >= high && high >= middle && middle >= low && low >= least) && rows[0][1] > rows[0][5];
"""


APART = """
const found = new DOMParser().parseFromString(document.getElementById("stage").drawing(), "image/svg+xml");
const places = [...found.querySelectorAll("text")].filter((text) => text.textContent.startsWith("point-")).map((text) => [Number(text.getAttribute("x")), Number(text.getAttribute("y"))]);
return Math.max(...places.flatMap((a) => places.map((b) => Math.abs(a[0] - b[0]))));
"""


def tiny(browser, name):
    """What is small is drawn as large as anything else."""
    apart = browser.run(APART)
    expect(apart > 60, f"{name}: names are within {apart} px of each other")


def many(browser, name):
    """Of very many agents quantiles are drawn, and curves of those that are chosen; a filter finds them."""
    expect(browser.run(SPREAD), f"{name}: quantiles are not in order")
    found = browser.run(MANY)
    expect(found == [5, 6, 12, 12], f"{name}: quantiles, with one agent, names that match, curves of them: {found}")


def units(browser, name, card, title, unit):
    found = value(browser, f"document.querySelector('[data-plot={card}] h3').textContent")
    expect(found.startswith(title) and found.endswith(f" {unit}"), f"{name}: {found} is not {title} in {unit}")


READOUT = """
const over = document.querySelector('[data-plot="disagreement"] .u-over'), box = over.querySelector(".readout").getBoundingClientRect();
const card = over.closest(".card").getBoundingClientRect();
return [over.querySelector(".readout").hidden, box.left - card.left, card.right - box.right, document.documentElement.scrollWidth - innerWidth];
"""


BALANCE = """
const card = document.querySelector("[data-plot=balance]");
const buttons = () => [...card.querySelectorAll(".pick button")];
const names = buttons().map((button) => button.textContent);
for (let k = 0; k < names.length; k++) { buttons()[k].click(); await frames(2); }
return [names, card.hidden, card.querySelector("h3").firstChild.textContent.trim()];
"""


def balances(browser, name, expected, title):
    """What a card offers it can draw: it does not go when that is chosen."""
    names, hidden, found = waited(browser, FRAMES + BALANCE)
    expect((names, hidden, found) == (expected, False, title), f"{name}: the card of V offers {names}, hidden {hidden}, {found}")


def alone(browser, page, name):
    """Of one agent alone no card says that there is nothing to say."""
    browser.open(page)
    drawn(browser)
    found = value(browser, "[...document.querySelectorAll('.card')].filter((card) => !card.hidden && card.querySelector('.none')).map((card) => card.dataset.plot)")
    expect(found == [] and value(browser, "document.querySelector('#network') === null"), f"{name}: cards without a plot: {found}")
    expect(value(browser, "document.querySelector('#stage [data-plot=position] .u-over') !== null"), f"{name}: no positions at the top")


def rows_as_recorded(browser, page, name, joint):
    """A CSV of a plot, and a path in a plane, have values at times at which they occurred, though there is no room for all."""
    browser.open(page)
    drawn(browser)
    recorded = {float(row["t_s"]): row for row in csv.DictReader(page.with_name("trajectory.csv").open())}
    for plot, letter in [("torque", "tau"), ("position", "q")]:
        head, *rows = csv.reader(io.StringIO(value(browser, f"s.table('{plot}')")))
        columns = [f"{agent.split(' · ')[0].rsplit(' in ', 1)[0]}.{letter}.{joint}" for agent in head[1:]]
        far = lambda row: any(abs(float(a) - float(recorded[float(row[0])][b])) > 1e-5 * max(1.0, abs(float(a))) for a, b in zip(row[1:], columns))  # noqa: E731
        wrong = [row[0] for row in rows if float(row[0]) not in recorded or far(row)]
        expect(100 < len(rows) < len(recorded) and not wrong, f"{name}: {plot} has {len(rows)} of {len(recorded)} rows, wrong at {wrong[:3]}")


def zeros(browser, page, name):
    """What cannot stand on a logarithmic axis is a number all the same."""
    browser.open(page)
    drawn(browser)
    _, *rows = csv.reader(io.StringIO(value(browser, "s.table('balance')")))
    empty = sum(cell == "" for row in rows for cell in row)
    expect(len(rows) > 10 and any("0" in row[1:] for row in rows) and not empty, f"{name}: {empty} cells of V are empty")


def exported(browser, page, name):
    """What leaves a page: columns say once what they are, and a strip of edges has no curve to name."""
    browser.open(page)
    drawn(browser)
    head = value(browser, "s.table('plane')").split("\n")[0]
    expect(" in " in head and not any(" in " in cell.rsplit(" in ", 1)[0] for cell in next(csv.reader([head]))[1:]), f"{name}: columns of a plane: {head}")
    named = value(browser, "s.drawings().filter(({ svg }) => svg.includes('>Value<')).length")
    expect(named == 0, f"{name}: {named} pictures name a curve that nobody sees")
    leading = value(browser, "[...document.querySelectorAll('#graph-picture title')].map((e) => e.textContent).filter((name) => name.endsWith(', leads'))")
    expect(leading == [], f"{name}: {leading}, and is heard by nobody")


def blown(browser, page, name):
    """A run that broke down: curves end near their axes, where any reader draws them, and tables have the values."""
    browser.open(page)
    drawn(browser)
    drawings = json.loads(value(browser, "JSON.stringify(s.drawings().map(({ svg }) => svg))"))
    paths = [float(number) for svg in drawings for path in re.findall(r' d="([^"]*)"', svg) for number in re.findall(r"-?[\d.]+(?:e[+-]?\d+)?", path)]
    expect(len(paths) > 1000 and max(map(abs, paths)) < 1e7, f"{name}: {len(paths)} coordinates up to {max(map(abs, paths)):.3g} px")
    _, *rows = csv.reader(io.StringIO(value(browser, "s.table('torque')")))
    largest = max(abs(float(cell)) for row in rows for cell in row[1:] if cell)
    expect(largest > 1e20, f"{name}: the largest force in the table is {largest}")
    plane = next(svg for svg in drawings if ">axis 2 in m<" in svg)
    expect("10<" not in plane and "×" not in plane, f"{name}: the plane is as large as what blew up")


def readouts(browser, page, name):
    """What a plot says under the cursor stays within its card, whatever is pointed at."""
    for width, height in [(1024, 768), (390, 844)]:
        browser.screen(width, height)
        browser.open(page)
        browser.run('document.documentElement.style.scrollBehavior = "auto"; document.querySelector(\'[data-plot="disagreement"]\').scrollIntoView({ block: "center" })')
        drawn(browser)
        left, top, wide, high = browser.run(
            'const { left, top, width, height } = document.querySelector(\'[data-plot="disagreement"] .u-over\').getBoundingClientRect(); return [left, top, width, height]')
        for share in [0.1, 0.45, 0.5, 0.55, 0.9]:
            browser.point(left + share * wide, top + 0.5 * high)
            drawn(browser)
            hidden, before, after, beyond = browser.run(READOUT)
            expect(not hidden and before >= 0 and after >= 0 and beyond <= 0, f"{name} at {width}, {share}: the values stand {before}, {after} px from the ends of the card")
        browser.point(1, 1)
    browser.screen(1400, 900)


def titled(browser, name):
    """Titles of pictures that are saved keep within them."""
    found = waited(browser, """
const out = document.getElementById("stage").drawings().map(({ svg }) => {
  const picture = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  document.body.append(picture);
  const beyond = Math.max(...[...picture.querySelectorAll("text")].map((text) => text.getBBox().x + text.getBBox().width)) - Number(picture.getAttribute("width"));
  picture.remove();
  return beyond;
});
return out;""")
    expect(found and max(found) <= 0, f"{name}: words of {len(found)} pictures stand {found} px beyond them")


def negligible(browser, name):
    """A V of 1e-35 has an axis."""
    ticks = browser.run('return [...document.querySelectorAll(".plot")].length')
    expect(ticks > 0 and value(browser, 'document.getElementById("error-banner").textContent') == "", f"{name}: an error banner")


def chosen(browser, name, vertices):
    """Of very many edges those of a chosen agent are drawn."""
    def edges():
        drawn(browser)
        return browser.run('return document.querySelectorAll("#graph-picture .edge").length')
    before = edges()
    browser.run('const s = document.getElementById("chosen"); s.value = "5"; s.dispatchEvent(new Event("change"))')
    own, words = edges(), browser.run('return document.getElementById("stage").textContent')
    expect(before == 2000 and own == 2 * (vertices - 1) and f"{own} of {vertices * (vertices - 1)} edges drawn" in words, f"{name}: {before} edges, of one {own}")
    expect(browser.run('return document.querySelectorAll("#graph-picture .node.chosen").length') == 1, f"{name}: the chosen node is not marked")


def predicted(browser, page, name):
    """On a phone what was observed stands beside what was predicted."""
    browser.screen(390, 844, touch=True)
    browser.open(page)
    drawn(browser)
    right = browser.run('return Math.max(...[...document.querySelector("#predicted table").querySelectorAll("td:last-child")].map((cell) => cell.getBoundingClientRect().right))')
    expect(right <= 390, f"{name}: what was observed ends at {right} px of 390")
    browser.screen(1400, 900)


def whole(browser, folder):
    """Pages as a whole: their columns at every width, in print, with many agents, their tables and keys."""
    long = folder / "long-title.toml"
    long.write_text(masses(folder, "long-title", RING).read_text().replace('"Masses"', f'"{"Long words of a title " * 8}"').replace('"point"', '"a-point-with-a-very-long-name"'))
    ten = folder / "ten-arms.toml"
    ten.write_text(folder.run("six-arms").with_name("scenario.toml").read_text().replace("count = 6 ", "count = 10 ").replace("end_s = 60", "end_s = 6"))
    for name, scenario in some([("long-title", long), ("ten-arms", ten), ("theorem-8", None), ("ten-different-robots", None)], 2):
        windows(browser, folder.run(name, scenario), name)
    for name in ["theorem-8", "formation"]:
        browser.open(folder.run(name))
        printed(browser, name)
        named(browser, name)
    browser.open(folder.run("theorem-8"))
    leader(browser, "theorem-8")
    saved(browser, "theorem-8", "rad")
    tables(browser, "theorem-8", 5)
    keys(browser, "theorem-8")
    browser.open(folder.run("seventeen", masses(folder, "seventeen", RING, count=17)))
    tables(browser, "seventeen", 17)
    units(browser, "seventeen", "torque", "Forces", "N")
    dashes(browser, "seventeen", ["predicted", "guaranteed for s ≡ 0"])
    browser.open(folder.run("hundred", masses(folder, "hundred", RING, count=100)))
    many(browser, "hundred")
    small = masses(folder, "tiny", RING)
    small.write_text(small.read_text().replace("[-1.0, 1.0]", "[-1e-12, 1e-12]"))
    browser.open(folder.run("tiny", small))
    tiny(browser, "tiny")
    page = folder.run("six-arms")
    readouts(browser, page, "six-arms")
    predicted(browser, page, "six-arms")
    browser.open(page)
    titled(browser, "six-arms")


def cards(browser, folder):
    """What single cards draw and say."""
    rounding = folder / "rounding.toml"
    rounding.write_text(ROUNDING)
    browser.open(folder.run("rounding", rounding))
    negligible(browser, "rounding")
    sixty = masses(folder, "sixty", "delay.constant_s = 0.1\nedges.complete = {}", count=60)
    browser.open(folder.run("sixty", sixty))
    chosen(browser, "sixty", 60)
    browser.open(folder.run("theorem-7"))
    joints(browser, "theorem-7")
    units(browser, "theorem-7", "velocity", "Angular velocity and reference", "rad/s")
    rows_as_recorded(browser, folder.run("with-rows", "six-arms", "--csv"), "six-arms", "shoulder_pan_joint")
    sampled = masses(folder, "sampled", RING, law="damping.gain = 5\n[control]\nsample_hz = 100")
    browser.open(folder.run("sampled", sampled))
    balances(browser, "sampled", [], "Lyapunov function")
    browser.open(folder.run("theorem-1"))
    balances(browser, "theorem-1", ["V", "V + ∫ dissipation", "error"], "Lyapunov balance")
    zeros(browser, folder.run("remark-4"), "remark-4")
    exported(browser, folder.run("unheard", masses(folder, "unheard", 'edges = [["point-1", "point-2"], ["point-2", "point-1"], ["point-2", "point-3"]]')), "nobody hears one")
    slow = folder / "slow.toml"
    slow.write_text(BLOWN)
    blown(browser, folder.run("blown", slow), "blown")
    one = masses(folder, "one", "edges = []", count=1)
    alone(browser, folder.run("one", one), "one alone")
    browser.open(folder.run("gusts"))
    units(browser, "gusts", "external", "External forces", "N")


PARTS = {"whole": whole, "cards": cards}


def check(browser, folder):
    for part in sys.argv[2:] or PARTS:
        browser.screen(1400, 900)
        PARTS[part](browser, folder)
    complaints = browser.complaints()
    expect(not complaints, f"layout: the console says {complaints[:2]}")


if __name__ == "__main__":
    checks.main(check)
