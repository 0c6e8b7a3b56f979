#!/usr/bin/env python3
"""Prints how many frames a second pages draw. How fast depends on what else the machine does: run it with nothing beside.

    validation/browser/speed.py target/release/forwardstep [SECONDS_OF_PLAY]
"""

import sys
import time

import checks
import known
from checks import expect, settled, value
from stage import RING

FRAMES_PER_S = 30


def speed(browser, name, seconds):
    settled(browser, 0)
    # What is too slow with light and depth is projected within the first pictures.
    browser.run('document.getElementById("play").click()')
    time.sleep(1)
    browser.run('document.getElementById("play").click()')
    before, begun = value(browser, "s.frames()"), time.monotonic()
    browser.run('document.getElementById("play").click()')
    time.sleep(seconds)
    rate = (value(browser, "s.frames()") - before) / (time.monotonic() - begun)
    browser.run('document.getElementById("play").click()')
    drawn = "projected" if value(browser, "s.flat()") else "with WebGL in software" if value(browser, "s.software()") else "with WebGL"
    print(f"{'ok    ' if rate >= FRAMES_PER_S else 'slow  '} {name}: {rate:.0f} frames per second, {drawn}")
    return rate


def pixels(browser, name):
    """Without a graphics card what moves has few pixels, and what stands still has more than the screen."""
    if value(browser, "s.flat()") or not value(browser, "s.software()"):
        return
    wide = 'document.querySelector("#view canvas:not(.over):last-of-type").width / document.getElementById("view").clientWidth'
    settled(browser, 1)
    browser.run('document.getElementById("play").click()')
    time.sleep(0.5)
    playing = value(browser, wide)
    browser.run('document.getElementById("play").click()')
    time.sleep(0.8)
    still = value(browser, wide)
    expect(playing <= 1 and abs(still - 2) < 0.01, f"{name}: {playing} of the screen's pixels in motion, {still} at rest")


def check(browser, folder):
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 3.0
    browser.screen(1400, 900)
    ten = folder / "ten.toml"
    ten.write_text(folder.scenario("six-arms").replace("count = 6 ", "count = 10 "))
    page = folder.run("ten", ten)
    size = page.stat().st_size
    expect(size <= 5_000_000, f"ten arms for 60 s take {size} bytes")
    for query in ["", "?flat"]:
        browser.open(page, query)
        expect(value(browser, "s.tips(0).length") == 10, "ten arms: not all are there")
        # Half of what is wanted leaves room for what else the machine does.
        rate = speed(browser, f"ten arms{query}", seconds)
        expect(rate >= FRAMES_PER_S / 2, f"ten arms{query}: {rate:.1f} frames per second")
        if not query:
            pixels(browser, "ten arms")
    for count in [12, 1000]:
        browser.open(folder.run(f"points-{count}", known.masses(folder, f"points-{count}", RING, count=count)))
        speed(browser, f"{count} points", seconds)


if __name__ == "__main__":
    checks.main(check)
