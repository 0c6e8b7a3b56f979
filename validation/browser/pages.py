#!/usr/bin/env python3
"""Runs scenarios and drives the top of their pages: the picture, its clock, the plots, what is drawn for a talk.

    validation/browser/pages.py target/release/forwardstep [SCENARIO…]
"""

import sys

import checks
from checks import FRAMES, done, drawn, expect, plays, quiet, settled, value, waited
from curves import chart, paths

SCENARIOS = ["six-arms", "formation", "theorem-7", "theorem-8", "five-ships", "strict-feedback", "task-space-ur5e"]
# These have no third dimension.
FLAT = ["five-ships", "strict-feedback"]


def clock(browser, name):
    """Slider, keys, play, and cursor: one clock."""
    end = float(value(browser, 'document.getElementById("slider").max'))
    before = value(browser, "s.tips(0)")
    browser.run('const r = document.getElementById("slider"); r.value = r.max / 2; r.dispatchEvent(new Event("input"))')
    drawn(browser)
    expect(abs(value(browser, "s.time()") - end / 2) < end / 100, f"{name}: the slider sets no time")
    expect(value(browser, f"s.tips({end / 2})") != before, f"{name}: nothing moves")
    shift = value(browser, '[...document.querySelectorAll(".clock-line")].map((l) => l.style.transform).join()')
    settled(browser, end / 4)
    expect(shift != value(browser, '[...document.querySelectorAll(".clock-line")].map((l) => l.style.transform).join()'), f"{name}: plots do not follow")
    browser.run('document.getElementById("view").focus()')
    browser.press("End")
    drawn(browser)
    expect(value(browser, "s.time()") == end, f"{name}: the key End")
    browser.press("ArrowLeft")
    drawn(browser)
    expect(value(browser, "s.time()") < end, f"{name}: the left arrow")
    over = 'document.querySelector("[data-plot=disagreement] .u-over")'
    if value(browser, f"{over} !== null"):
        x, y, wide = value(browser, f"(({{x, y, width, height}}) => [x, y + height / 2, width])({over}.getBoundingClientRect())")
        browser.point(x + 0.7 * wide, y)
        drawn(browser)
        expect(abs(value(browser, "s.time()") - 0.7 * end) < 0.02 * end, f"{name}: the cursor of a plot is not the clock")
        browser.point(1, 1)
    settled(browser, 0)
    browser.run('document.getElementById("view").focus()')
    plays(browser, name)


DRAWN = """
const seen = (svg) => {
  const found = new DOMParser().parseFromString(svg, "image/svg+xml");
  const values = [...found.querySelectorAll("*")].flatMap((part) => [...part.attributes].map((a) => a.value));
  return [found.querySelectorAll("path.curve").length, found.querySelectorAll("path").length, found.querySelectorAll("text").length,
    found.querySelector("parsererror") !== null || values.some((v) => /NaN|undefined|Infinity/.test(v)), found.querySelector("title")?.textContent ?? ""];
};
const stage = document.getElementById("stage");
return [document.title, seen(stage.drawing()), stage.drawings().map(({ curves, svg }) => [curves, ...seen(svg)])];
"""


def drawings(browser, name):
    """The picture and every plot as SVG: documents of their own, with all curves, and with texts that are nothing but text."""
    title, picture, plots = browser.run(DRAWN)
    expect(picture[1] > 5 and not picture[3] and picture[4].startswith(title), f"{name}: the picture as SVG is {picture}")
    expect(plots, f"{name}: no plot is drawn as SVG")
    for curves, drawn, _, texts, broken, said in plots:
        expect(drawn == curves > 0 and texts > 4 and not broken and said == title, f"{name}: a plot of {curves} curves as SVG has {drawn}: {said}")


POINTED = """
const stage = document.getElementById("stage"), over = document.querySelector("[data-plot=plane] .over");
if (!over) return null;
stage.go(0);
const { left, top, width, height } = over.getBoundingClientRect();
for (let x = 70; x < width; x += 9) for (let y = 20; y < height; y += 9) {
  over.dispatchEvent(new MouseEvent("mousemove", { clientX: left + x, clientY: top + y }));
  if (stage.time() > 0) return true;
}
return false;
"""


HIDDEN = """
const drawn = () => document.getElementById("stage").drawings().length;
const chips = document.querySelectorAll("#legend button:not(.all)");
const all = drawn();
chips.forEach((chip) => chip.click());
const few = drawn();
chips.forEach((chip) => chip.click());
return [all, few, drawn()];
"""


def plane(browser, name):
    """Paths and phase planes: whoever points at a curve moves the clock, and who is hidden is not drawn."""
    expect(browser.run(POINTED) is True, f"{name}: pointing at a path moves no clock")
    before = browser.run(HIDDEN)
    expect(before[0] == before[2] > before[1], f"{name}: hidden agents are drawn: {before}")


SLIDES = FRAMES + "const seen = " + DRAWN.split("const seen = ")[1].split("const stage")[0] + """
const stage = document.getElementById("stage"), { talk } = stage;
stage.go(document.getElementById("slider").max / 3);
document.getElementById("view-slide").click();
await frames(3);
const slides = [];
for (const plot of talk.plots()) {
  talk.choose(plot);
  await frames(3);
  slides.push([plot, ...seen(talk.drawing())]);
}
const before = document.getElementById("talk-slide").toDataURL();
stage.go(document.getElementById("slider").max);
await frames(3);
const after = document.getElementById("talk-slide").toDataURL();
talk.close();
return [document.title, slides, before !== after, document.getElementById("talk").open];
"""
def slides(browser, name):
    """A page for a talk: with each plot it is a drawing with that plot's curves, and it follows the clock."""
    title, drawn, moves, still_open = waited(browser, SLIDES)
    expect(drawn, f"{name}: no plot for a slide")
    for plot, curves, paths, texts, broken, said in drawn:
        expect(curves > 0 and paths > curves and texts > 8 and not broken and said.startswith(title), f"{name}: the slide with {plot} has {curves} curves: {broken}, {said}")
    expect(moves and not still_open, f"{name}: the slide does not follow the clock, or stays open")


def top(browser, page, name):
    """A page in both ways of drawing, dark and light."""
    for query in ["", "?flat"]:
        for dark in [False, True]:
            browser.screen(1400, 900, dark=dark)
            browser.open(page, query)
            about = f"{name}{query}{' dark' if dark else ''}"
            expect(value(browser, "s.flat()") == bool(query or name in FLAT), f"{about}: drawn in the other way")
            for part in ["view", "slider", "graph-now"] + ([] if dark else ["time"]):
                bottom = value(browser, f'document.getElementById("{part}").getBoundingClientRect().bottom')
                expect(bottom <= 990, f"{about}: {part} ends at {bottom} px")
            if not dark:
                clock(browser, about)
                drawings(browser, about)
                plane(browser, about)
                slides(browser, about)
                spatial = value(browser, "document.querySelector('[data-plot=path] canvas') !== null")
                expect(spatial == (name not in FLAT), f"{about}: paths in space are {'' if spatial else 'not '}drawn")
                if spatial and not query:
                    paths(browser, name)
                if name == "strict-feedback":
                    chart(browser, about)
            quiet(browser, about, 1400)


def plots(browser, name):
    # Where there is no graph, its place is taken by the torques.
    alone = value(browser, 'document.querySelector(\'#stage [data-plot="torque"] canvas\') !== null')
    expect(alone == (name in ["theorem-7", "task-space-ur5e"]), f"{name}: torques are {'' if alone else 'not '}beside the picture")
    # ψ is there where agents agree by their references, and its interval holds all positions, less offsets where they keep some.
    cascade = value(browser, 'document.querySelector(\'[data-plot="cascade"] canvas\') !== null')
    expect(cascade == (name in ["six-arms", "formation", "five-ships"]), f"{name}: the interval of the cascade is {'' if cascade else 'not '}drawn")


def check(browser, folder):
    for name in sys.argv[2:] or SCENARIOS:
        page = folder.run(name)
        top(browser, page, name)
        plots(browser, name)
        browser.screen(390, 844, touch=True, calm=True)
        browser.open(page)
        quiet(browser, f"{name} on a phone", 390)
        if name == "theorem-8":
            leader = value(browser, '[...document.querySelectorAll(".now text")].some((e) => e.textContent.includes("leader"))')
            expect(leader, f"{name}: no leader in the graph")
        done(f"{name}: opened")


if __name__ == "__main__":
    checks.main(check)
