#!/usr/bin/env python3
"""Compares runs and drives the page that lays them side by side in a headless chromium: pictures, clock, table and plots.

    validation/browser/compare.py target/release/forwardstep

Status 77 where chromium or chromedriver is not there. Needs nothing but Python.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

import webdriver

SHIPS = pathlib.Path(__file__).resolve().parents[2] / "docs/book/src/ships"
HOSTILE = "</script><img src=x onerror=alert(1)> & <b>more</b>"
LIGHTS = "document.querySelectorAll('.clock-line')"

problems = []
checked = 0


def expect(holds, what):
    global checked
    checked += 1
    if not holds:
        problems.append(what)
        print(f"FAILED {what}")


def value(browser, expression, *arguments):
    return browser.run(f'const s = document.getElementById("side"); return {expression}', *arguments)


def settle(browser):
    time.sleep(0.2)


def painted(browser):
    """How many pixels of each picture are not empty."""
    return value(browser, "[...document.querySelectorAll('.scene canvas')].map((c) => c.getContext('2d').getImageData(0, 0, c.width, c.height).data.filter((v, k) => k % 4 === 3 && v > 0).length)")


def quiet(browser, name, width):
    complaints = browser.complaints()
    expect(not complaints, f"{name}: the console says {complaints[:2]}")
    expect(value(browser, 'document.getElementById("error-banner").textContent') == "", f"{name}: an error banner")
    wide = value(browser, "document.documentElement.scrollWidth")
    expect(wide <= width, f"{name}: {wide} px wide where there are {width}")


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
    settle(browser)
    expect(abs(value(browser, "s.time()") - end / 2) < end / 100, f"{name}: the slider sets no time")
    for run, (before, after) in enumerate(zip(value(browser, "s.tips(0)"), value(browser, f"s.tips({end / 2})"))):
        expect(before != after, f"{name}: nothing moves in run {run}")
    lines = f"[...{LIGHTS}].map((l) => l.style.transform).join()"
    shift = value(browser, lines)
    browser.run('document.querySelector(".scenes").focus()')
    browser.press("End")
    settle(browser)
    expect(value(browser, "s.time()") == end, f"{name}: the key End")
    expect(value(browser, lines) != shift, f"{name}: plots do not follow")
    browser.press("Home")
    settle(browser)
    browser.press("Space")
    time.sleep(0.6)
    browser.press("Space")
    stopped = value(browser, "s.time()")
    expect(stopped > 0, f"{name}: play does not play")
    time.sleep(0.3)
    expect(value(browser, "s.time()") == stopped, f"{name}: pause does not pause")
    over = 'document.querySelector("[data-plot=gap] .u-over")'
    browser.run(f'document.documentElement.style.scrollBehavior = "auto"; {over}.scrollIntoView({{ block: "center" }})')
    settle(browser)
    x, y, wide = value(browser, f"(({{x, y, width, height}}) => [x, y + height / 2, width])({over}.getBoundingClientRect())")
    browser.point(x + 0.7 * wide, y)
    settle(browser)
    expect(abs(value(browser, "s.time()") - 0.7 * end) < 0.02 * end, f"{name}: the cursor of a plot is not the clock")
    browser.point(1, 1)


def main():
    tools = webdriver.found()
    if tools is None:
        print("skipped: no browser (chromium and chromedriver)")
        return 77
    program = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder, webdriver.Browser(*tools) as browser:
        folder = pathlib.Path(folder)

        def compare(name, *runs):
            done = subprocess.run([program, "compare", "--json", *runs, "--out", folder / name], capture_output=True, text=True, check=False)
            page = folder / name / "compare.html"
            if not page.exists():
                sys.exit(f"{name}: {done.stderr}")
            expect(page.stat().st_size < 5_000_000, f"{name}: {page.stat().st_size} bytes")
            return page, json.loads(done.stdout)

        hostile = folder / "hostile.toml"
        text = subprocess.run([program, "scenarios", "double-integrators"], capture_output=True, text=True, check=True).stdout
        hostile.write_text("\n".join(f"title = {json.dumps(HOSTILE)}" if line.startswith("title") else line for line in text.splitlines()) + "\n")
        ships = [SHIPS / f"{name}.toml" for name in ["backstepping", "order-1", "order-2", "order-3"]]
        for name, runs in [("ships", ships), ("arms", ["six-arms", "theorem-2"]), ("kinds", ["theorem-7", "theorem-8"]), ("hostile", [hostile, "strict-feedback"])]:
            page, document = compare(name, *runs)
            for dark in [False, True]:
                browser.screen(1400, 900, dark=dark)
                browser.open(page)
                about = f"{name}{' dark' if dark else ''}"
                expect(all(pixels > 500 for pixels in painted(browser)), f"{about}: an empty picture")
                if not dark:
                    table(browser, about, document)
                    clock(browser, about, len(runs))
                quiet(browser, about, 1400)
            browser.screen(390, 844, touch=True, calm=True)
            browser.open(page)
            expect(all(pixels > 200 for pixels in painted(browser)), f"{name} on a phone: an empty picture")
            quiet(browser, f"{name} on a phone", 390)
            stays = value(browser, "getComputedStyle(document.querySelector('.compared th[scope=row]')).position")
            expect(stays == "sticky", f"{name} on a phone: names of rows leave when the table is moved")
            print(f"{'ok    ' if not problems else '      '} {name}: {len(runs)} runs side by side")
            if name == "ships":
                # What is drawn is what the table says: the largest torque of each run.
                row = next(row for row in document["rows"] if row["key"] == "peak_torque")
                for cell, drawn in zip(row["cells"], value(browser, 's.series("torque")')):
                    expect(abs(drawn["peak"] - cell["value"]) < 1e-5 * cell["value"], f"ships: {drawn} beside {cell}")
            if name == "hostile":
                expect(HOSTILE in value(browser, "document.querySelector('.scene .by').textContent"), "a title is not told as it is")
                expect(value(browser, "document.querySelectorAll('main img').length") == 0, "a title became an element")
    print(f"{checked} checks, {len(problems)} failed")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
