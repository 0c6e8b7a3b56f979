#!/usr/bin/env python3
"""Draws every scenario of the book in space again, and the README's picture of a report, by the page of its run in a headless chromium: `docs/book/space.py PROGRAM`.

Each is drawn when a tenth of its first disagreement, or distance from its target, is left: much of the way lies behind, and not all is at rest.
"""

import math
import pathlib
import re
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "validation" / "browser"))
import webdriver

PICTURES = pathlib.Path(__file__).resolve().parent / "src" / "pictures"
SIZE = (720, 420)
# Points of a path nearer to each other than this cannot be told apart.
APART_PX = 1.5
TELLING = """
const stage = document.getElementById("stage");
document.getElementById("view").style.cssText = "width:720px;height:420px;flex:none;max-width:none;min-height:0";
const times = stage.times();
const gap = stage.gap();
const left = gap.findIndex(([, size]) => size !== null && size < 0.1 * gap[0][1]);
stage.go(left > 0 ? gap[left][0] : times.at(-1));
"""


def thinned(path):
    """A path of straight lines with fewer points, from and to where it was."""
    steps = re.findall(r"([MLZ])([-\d. ]*)", path)
    if len(steps) < 8 or re.search(r"[^MLZ\-\d. ]", path):
        return path
    points = [(step, *map(float, place.split())) for step, place in steps if step != "Z"]
    kept = points[:1]
    for k, (step, x, y) in enumerate(points[1:], 1):
        last = k == len(points) - 1 or points[k + 1][0] == "M"
        if step == "M" or last or math.dist(kept[-1][1:], (x, y)) >= APART_PX:
            kept.append((step, x, y))
    return "".join(f"{step}{x:g} {y:g}" for step, x, y in kept) + ("Z" if path.endswith("Z") else "")


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    scenarios = [line.split()[0] for line in subprocess.run([program, "scenarios"], capture_output=True, text=True, check=True).stdout.splitlines()]
    with tempfile.TemporaryDirectory() as folder, webdriver.Browser(*webdriver.found()) as browser:
        browser.screen(1400, 900)
        for name in sys.argv[2:] or scenarios:
            page = pathlib.Path(folder) / name / "report.html"
            subprocess.run([program, "run", name, "--out", page.parent], capture_output=True, check=False)
            browser.open(page, "?flat")
            browser.run(TELLING)
            size = browser.run('const v = document.getElementById("view"); return [v.clientWidth, v.clientHeight]')
            assert tuple(size) == SIZE, (name, size)
            drawing = browser.run('return document.getElementById("stage").drawing()')
            assert not browser.complaints() and "NaN" not in drawing, name
            drawing = re.sub(r'd="([^"]*)"', lambda found: f'd="{thinned(found[1])}"', drawing)
            (PICTURES / f"{name}-in-space.svg").write_text(drawing + "\n")
            print(f"{name}: {len(drawing)} bytes")
            if name == "six-arms":
                # The picture of the README: the whole page, with what is on its way.
                browser.open(page)
                browser.run('document.getElementById("stage").go(3.25)')
                time.sleep(1)
                browser.picture(PICTURES.parents[2] / "report.png")


if __name__ == "__main__":
    main()
