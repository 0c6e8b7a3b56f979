#!/usr/bin/env python3
"""Checks of what readers do with a page: windows that become smaller, keys, buttons that zoom, and names that have no room.

    validation/browser/hands.py target/release/forwardstep
"""

import re

import checks
from checks import FRAMES, becomes, drawn, expect, settled, value, waited
from known import PACKETS, masses

RING = "delay.constant_s = 0.1\nedges.ring = {}"
# Where the program stops on its own, its last row is no round number.
ODD_END_S = 73.35000000000001
WIDE = "document.documentElement.scrollWidth"


def smaller(browser, page, name):
    """A page is as narrow as its window, whatever the window was before."""
    for before, after, touch in [((844, 390), (390, 844), True), ((1400, 900), (500, 700), False), ((1400, 900), (350, 700), False)]:
        browser.screen(*before, touch=touch)
        browser.open(page)
        drawn(browser)
        browser.screen(*after, touch=touch)
        narrow = becomes(browser, f"{WIDE} <= {after[0]}", seconds=5)
        expect(narrow, f"{name}: from {before} to {after} the page is {value(browser, WIDE)} px wide")
    browser.screen(1400, 900)


def focus(browser, selector):
    browser.run("document.activeElement.blur(); document.querySelector(arguments[0])?.focus({ preventScroll: true })", selector)


def moves(browser, key):
    """By how much a key moves the clock that stands in the middle."""
    middle = float(value(browser, 'document.getElementById("slider").max')) / 2
    settled(browser, middle)
    browser.press(key)
    drawn(browser)
    return value(browser, "s.time()") - middle


def keys(browser, name):
    """Space and arrows move the clock wherever nothing has the focus that uses them."""
    for place in ["nothing", "#view", "#slider", "[data-plot=path] .turns"]:
        focus(browser, place)
        settled(browser, 0)
        browser.press("Space")
        expect(becomes(browser, "s.time() > 0"), f"{name}: with {place} in focus Space does not play")
        browser.press("Space")
        expect(moves(browser, "ArrowRight") > 0 > moves(browser, "ArrowLeft"), f"{name}: with {place} in focus arrows move no clock")
    focus(browser, "#play")
    expect(moves(browser, "ArrowRight") > 0, f"{name}: an arrow after the button Play moves no clock")
    for place, key in [("#rate", "ArrowRight"), ("#rate", "ArrowLeft"), ("summary", "Space"), ("#break-points", "Space")]:
        focus(browser, place)
        expect(moves(browser, key) == 0 and not becomes(browser, 'document.getElementById("play").textContent === "Pause"', seconds=0.2), f"{name}: {key} of {place} moves the clock")
    focus(browser, "nothing")
    expect(moves(browser, "End") == 0, f"{name}: the key End does not go to the end of the page but of the run")
    said = value(browser, 'document.getElementById("view-help").textContent')
    expect("wherever nothing has the focus" in said, f"{name}: the help says {said}")


def zoomed(browser, name):
    """Buttons zoom the picture and the plots, by keys too."""
    settled(browser, 1)
    before = value(browser, "s.drawing()")
    focus(browser, ".corner .zoom:nth-of-type(2)")
    browser.press("Space")
    drawn(browser)
    expect(value(browser, "s.drawing()") != before, f"{name}: the button + zooms no picture")
    value(browser, 'document.getElementById("view-reset").click()')
    drawn(browser)
    whole = 'document.getElementById("reset").disabled'
    tick = "document.querySelector('[data-plot=disagreement] .u-over .clock-line').style.transform"
    shift = value(browser, tick)
    browser.run('document.querySelector(".tools .zoom:last-of-type").focus()')
    browser.press("Space")
    drawn(browser)
    expect(not value(browser, whole) and value(browser, tick) != "", f"{name}: the button + zooms no plot")
    browser.run('document.querySelector(".tools .zoom").click()')
    drawn(browser)
    expect(value(browser, whole) and value(browser, tick) == shift, f"{name}: the button − does not show all again")


def met(browser, page, name, count):
    """Names that have no room are counted, on the page and in what is saved of it."""
    browser.open(page)
    settled(browser, float(value(browser, 'document.getElementById("slider").max')))
    said = value(browser, 'document.querySelector("#view .where").textContent')
    left = int((re.match(r"and (\d+) more", said) or [0, 0])[1])
    texts = value(browser, '[...new DOMParser().parseFromString(s.drawing(), "image/svg+xml").querySelectorAll("text")].map((text) => text.textContent)')
    named = len({text for text in texts if text.startswith("point-")})
    expect(left > 0 and named + left == count, f"{name}: {named} names of {count}, and {said}")
    expect(any(text.startswith(f"and {left} more") for text in texts), f"{name}: the drawing says {texts}")


def odd(browser, page, name):
    """The slider reaches the end, whatever the end is."""
    browser.open(page)
    focus(browser, "#slider")
    browser.press("End")
    drawn(browser)
    end = float(value(browser, 'document.getElementById("slider").max'))
    expect(value(browser, "s.time()") == end, f"{name}: the key End of the slider goes to {value(browser, 's.time()')} of {end}")
    value(browser, "s.go(0)")
    browser.run('const r = document.getElementById("slider"); r.value = r.max; r.dispatchEvent(new Event("input"))')
    drawn(browser)
    expect(value(browser, "s.time()") == end, f"{name}: the slider ends at {value(browser, 's.time()')} of {end}")
    browser.press("ArrowLeft")
    drawn(browser)
    expect(0.98 * end < value(browser, "s.time()") < end, f"{name}: an arrow takes the slider from {end} to {value(browser, 's.time()')}")


SLIDE = FRAMES + """
const { talk } = document.getElementById("stage");
document.getElementById("view-slide").click();
await frames(3);
const said = [];
for (const plot of talk.plots()) {
  talk.choose(plot);
  await frames(3);
  said.push(...[...new DOMParser().parseFromString(talk.drawing(), "image/svg+xml").querySelectorAll("text")].map((text) => text.textContent));
}
talk.close();
return said;
"""


def commas(browser, name):
    stray = [text for text in waited(browser, SLIDE) if re.search(r"\s[,:;]", text)]
    expect(not stray, f"{name}: a stray blank in {stray[:3]}")


def still(browser, page, name):
    """The graph stays where it is while the words below it change."""
    browser.open(page)
    times = [0.05 * k for k in range(60)]
    highs = []
    for t in times + times:
        settled(browser, t)
        highs.append(value(browser, 'document.getElementById("graph-picture").clientHeight'))
    expect(len(set(highs[len(times):])) == 1, f"{name}: the graph is {sorted(set(highs))} px high")


def check(browser, folder):
    browser.screen(1400, 900)
    page = folder.run("six-arms")
    smaller(browser, page, "six-arms")
    browser.open(page)
    commas(browser, "six-arms")
    keys(browser, "six-arms")
    zoomed(browser, "six-arms")
    met(browser, folder.run("meeting", masses(folder, "meeting", RING, end=40, count=20)), "meeting", 20)
    odd(browser, folder.run("odd", masses(folder, "odd", RING, end=ODD_END_S)), "odd")
    still(browser, folder.run("words", masses(folder, "words", PACKETS)), "words")
    browser.open(folder.run("formation"))
    drawn(browser)
    said = value(browser, 'document.querySelector("#view .where").textContent')
    expect("arrows: thrust" in said, f"formation: nothing is said of thrust in {said}")
    complaints = browser.complaints()
    expect(not complaints, f"by hand: the console says {complaints[:2]}")


if __name__ == "__main__":
    checks.main(check)
