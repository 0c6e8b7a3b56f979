#!/usr/bin/env python3
"""Compares runs and drives the page that lays them side by side in a headless chromium: pictures, clock, table and plots.

    validation/browser/compare.py target/release/forwardstep

Status 77 where chromium or chromedriver is not there. Needs nothing but Python.
"""

import json
import pathlib
import subprocess
import sys

import checks
from checks import done, drawn, expect, plays, quiet, some

SHIPS = pathlib.Path(__file__).resolve().parents[2] / "docs/book/src/ships"
HOSTILE = "</script><img src=x onerror=alert(1)> & <b>more</b>"
LIGHTS = "document.querySelectorAll('.clock-line')"


def value(browser, expression):
    return checks.value(browser, expression, "side")


def painted(browser):
    """How many pixels of each picture are not empty."""
    return value(browser, "[...document.querySelectorAll('.scene canvas')].map((c) => c.getContext('2d').getImageData(0, 0, c.width, c.height).data.filter((v, k) => k % 4 === 3 && v > 0).length)")


def table(browser, name, document):
    """The table of the page says what the document says."""
    rows = value(browser, "[...document.querySelectorAll('.compared [data-row]')].map((r) => [r.dataset.row, r.classList.contains('differs'), [...r.querySelectorAll('td')].map((d) => d.firstChild.textContent)])")
    expect(len(rows) == len(document["rows"]), f"{name}: {len(rows)} rows")
    for (key, differs, cells), own in zip(rows, document["rows"]):
        words = [cell["words"] for cell in own["cells"]]
        expect(key == own["key"] and differs != own["same"], f"{name}: {key} is marked in another way")
        expect([c.strip() for c in cells] == (words[:1] if own["same"] else words), f"{name}: {key} says {cells}")


def clock(browser, name, runs):
    """Slider, keys, play and cursor: one clock for all pictures and plots."""
    end = float(value(browser, 'document.getElementById("slider").max'))
    expect(len(value(browser, "s.tips(0)")) == runs, f"{name}: a run has no picture")
    browser.run('const r = document.getElementById("slider"); r.value = r.max / 2; r.dispatchEvent(new Event("input"))')
    drawn(browser)
    expect(abs(value(browser, "s.time()") - end / 2) < end / 100, f"{name}: the slider sets no time")
    for run, (before, after) in enumerate(zip(value(browser, "s.tips(0)"), value(browser, f"s.tips({end / 2})"))):
        expect(before != after, f"{name}: nothing moves in run {run}")
    lines = f"[...{LIGHTS}].map((l) => l.style.transform).join()"
    shift = value(browser, lines)
    browser.run('document.querySelector(".scenes").focus()')
    browser.press("End")
    drawn(browser)
    expect(value(browser, "s.time()") == end, f"{name}: the key End")
    expect(value(browser, lines) != shift, f"{name}: plots do not follow")
    browser.press("Home")
    drawn(browser)
    plays(browser, name, "side")
    over = 'document.querySelector("[data-plot=gap] .u-over")'
    browser.run(f'document.documentElement.style.scrollBehavior = "auto"; {over}.scrollIntoView({{ block: "center" }})')
    drawn(browser)
    x, y, wide = value(browser, f"(({{x, y, width, height}}) => [x, y + height / 2, width])({over}.getBoundingClientRect())")
    browser.point(x + 0.7 * wide, y)
    drawn(browser)
    expect(abs(value(browser, "s.time()") - 0.7 * end) < 0.02 * end, f"{name}: the cursor of a plot is not the clock")
    browser.point(1, 1)


def by_hand(browser, name):
    """Space plays and arrows move time with nothing in focus; buttons zoom pictures and plots."""
    browser.run("document.activeElement.blur(); document.getElementById('side').go(0)")
    plays(browser, f"{name}, nothing in focus", "side")
    before = value(browser, "s.time()")
    browser.press("ArrowRight")
    drawn(browser)
    expect(value(browser, "s.time()") > before, f"{name}: with nothing in focus an arrow moves no clock")
    pictures = "[...document.querySelectorAll('.scene canvas')].map((c) => c.toDataURL())"
    seen = value(browser, pictures)
    browser.run("document.querySelector('.clock .zoom:last-of-type').click()")
    drawn(browser)
    expect(all(a != b for a, b in zip(seen, value(browser, pictures))), f"{name}: the button + does not zoom all pictures")
    browser.run("document.querySelector('.tools .zoom:last-of-type').click()")
    expect(not value(browser, "document.getElementById('reset').disabled"), f"{name}: the button + zooms no plot")
    browser.run("document.getElementById('reset').click()")


def ended(browser, name, document):
    """Below a picture of a run that is over stands until when it was recorded; when it ended the table says."""
    end = float(value(browser, 'document.getElementById("slider").max'))
    browser.run('document.getElementById("side").go(arguments[0])', end)
    drawn(browser)
    row = next(row for row in document["rows"] if row["key"] == "horizon_s")
    said = value(browser, "[...document.querySelectorAll('.scene .words')].map((e) => e.textContent)")
    horizons = [cell["value"] for cell in row["cells"]] if not row["same"] else [end] * len(said)
    for words, horizon in zip(said, horizons):
        expect(words.startswith("Recorded until") == (horizon < end), f"{name}: of a run to {horizon} of {end} s it says {words}")


BROKEN = """
const texts = (part) => [...part.childNodes].flatMap((node) => (node.nodeType === Node.TEXT_NODE ? [node] : texts(node)));
const broken = [];
for (const text of [...document.querySelectorAll(".compared tbody th, .compared td")].flatMap(texts)) {
  for (const word of text.data.matchAll(/[\\p{L}\\p{N}]+/gu)) {
    const range = document.createRange();
    range.setStart(text, word.index);
    range.setEnd(text, word.index + word[0].length);
    if (new Set([...range.getClientRects()].map(({ top }) => Math.round(top))).size > 1) broken.push(word[0]);
  }
}
return broken;
"""


def unbroken(browser, name):
    """No word of the table is broken, on the page or on a sheet."""
    for event in [None, "beforeprint", "afterprint"]:
        browser.run("arguments[0] && dispatchEvent(new Event(arguments[0]))", event)
        drawn(browser)
        broken = browser.run(BROKEN)
        expect(not broken, f"{name}{f' {event}' if event else ''}: broken in the table: {broken[:5]}")


def check(browser, folder):
    def compare(name, *runs):
        answer = subprocess.run([folder.program, "compare", "--json", *runs, "--out", folder / name], capture_output=True, text=True, check=False)
        page = folder / name / "compare.html"
        if not page.exists():
            sys.exit(f"{name}: {answer.stderr}")
        expect(page.stat().st_size < 5_000_000, f"{name}: {page.stat().st_size} bytes")
        return page, json.loads(answer.stdout)

    hostile = folder / "hostile.toml"
    lines = folder.scenario("double-integrators").splitlines()
    hostile.write_text("\n".join(f"title = {json.dumps(HOSTILE)}" if line.startswith("title") else line for line in lines) + "\n")
    ships = [SHIPS / f"{name}.toml" for name in ["backstepping", "order-1", "order-2", "order-3"]]
    pages = [("ships", ships), ("arms", ["six-arms", "theorem-2"]), ("hostile", [hostile, "strict-feedback"]), ("kinds", ["theorem-7", "theorem-8", "theorem-2", "five-ships", "formation"])]
    for name, runs in some(pages, 2):
        page, document = compare(name, *runs)
        for dark in [False, True]:
            browser.screen(1400, 900, dark=dark)
            browser.open(page)
            about = f"{name}{' dark' if dark else ''}"
            expect(all(pixels > 500 for pixels in painted(browser)), f"{about}: an empty picture")
            if not dark:
                table(browser, about, document)
                clock(browser, about, len(runs))
                by_hand(browser, about)
                ended(browser, about, document)
                unbroken(browser, about)
            quiet(browser, about, 1400)
        browser.screen(390, 844, touch=True, calm=True)
        browser.open(page)
        expect(all(pixels > 200 for pixels in painted(browser)), f"{name} on a phone: an empty picture")
        quiet(browser, f"{name} on a phone", 390)
        unbroken(browser, f"{name} on a phone")
        stays = value(browser, "getComputedStyle(document.querySelector('.compared th[scope=row]')).position")
        expect(stays == "sticky", f"{name} on a phone: names of rows leave when the table is moved")
        done(f"{name}: {len(runs)} runs side by side")
        if name == "ships":
            # What is drawn is what the table says: the largest torque of each run.
            row = next(row for row in document["rows"] if row["key"] == "peak_torque")
            for cell, seen in zip(row["cells"], value(browser, 's.series("torque")')):
                expect(abs(seen["peak"] - cell["value"]) < 1e-5 * cell["value"], f"ships: {seen} beside {cell}")
        if name == "hostile":
            expect(HOSTILE in value(browser, "document.querySelector('.scene .by').textContent"), "a title is not told as it is")
            expect(value(browser, "document.querySelectorAll('main img').length") == 0, "a title became an element")
    # A run with none of what the others share is named where its curves are missing.
    page, _ = compare("odd", "theorem-2", "first-order", "double-integrators")
    browser.screen(1400, 900)
    browser.open(page)
    said = value(browser, "document.getElementById('alone')?.textContent ?? ''")
    drawn_ids = value(browser, "[...document.querySelectorAll('.card.plot')].map((card) => card.dataset.plot)")
    expect("position" in drawn_ids and "double-integrators" in said, f"odd: plots {drawn_ids}, and {said!r}")


if __name__ == "__main__":
    checks.main(check)
