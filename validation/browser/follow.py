#!/usr/bin/env python3
"""Looks at the page of a run that goes on: it grows, keeps what its reader chose, and becomes the page that the run leaves.

    validation/browser/follow.py target/release/forwardstep
"""

import shutil
import signal
import subprocess
import sys
import time

import checks
from checks import LONG, drawn, expect

SLOW = """format = 2
title = "Two arms"
time = {{ end_s = {end_s}, record_every_s = 0.01 }}
solver.method.fixed.step_s = 2e-5
[[agents]]
name = "arm"
count = 2
robot.planar_arm = {{ mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }}
start.position_rad = [[0.1, 0.2], [0.3, 0.4]]
[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"
[network]
delay.constant_s = 0.1
edges.ring = {{}}
"""
# What a reader can choose, as the page has it now.
CHOSEN = """
  const part = (id) => document.getElementById(id);
  const plot = (name) => document.querySelector(`[data-plot=${name}]`);
  return {
    t: part("stage").time(), rate: part("rate").value, alone: part("chosen").value, joint: part("joint").value, follow: part("follow").checked,
    lines: part("break-points").checked, zoomed: !part("reset").disabled,
    hidden: [...document.querySelectorAll("#legend button")].map((chip) => chip.getAttribute("aria-pressed")),
    table: plot("torque").querySelector("details").open, rows: plot("torque").querySelectorAll("tbody tr").length > 0,
    focus: document.activeElement.id,
  };
"""
CHOOSE = """
  const part = (id) => document.getElementById(id);
  const pick = (id, value) => { part(id).value = value; part(id).dispatchEvent(new Event("change")); };
  part("reload").checked = false; // while this is looked at
  pick("rate", "5"); pick("chosen", "1"); pick("joint", "1");
  part("break-points").click();
  document.querySelector("#legend button").click();
  document.querySelector("[data-plot=torque] details").open = true;
  part("stage").go(0.4);
  part("joint").focus({ preventScroll: true });
"""
SCROLLED = 'document.querySelector("[data-plot=torque]").getBoundingClientRect().top'


def until(what, found, seconds=60):
    begun = time.monotonic()
    while time.monotonic() - begun < seconds:
        value = found()
        if value:
            return value
        time.sleep(0.1)
    sys.exit(f"waited in vain for {what}")


def shown(browser):
    """What the page says of how far the run is; nothing while it is loaded."""
    try:
        return browser.run('return document.readyState === "complete" ? document.querySelector(".ending .badge").textContent : null')
    except OSError:
        return None


def check(browser, folder):
    def run(name, end_s, *more):
        scenario = folder / f"{name}.toml"
        scenario.write_text(SLOW.format(end_s=end_s))
        command = [folder.program, "run", scenario, "--out", folder / name, *more]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return process, folder / name / "report.html"

    # Longer than anybody looks at it.
    process, page = run("stopped", 3000, "--follow")
    until("a page", page.exists)
    browser.screen(1400, 900)
    browser.open(page)
    first = shown(browser)
    expect(first and first.startswith("running: ") and first.endswith(" s of 3000 s"), f"it says {first}")
    at_end = browser.run('const s = document.getElementById("slider"); return Math.abs(s.value - s.max) <= s.max / 500')
    expect(at_end, "the clock does not stand at the end")
    later = until("a later page", lambda: (lambda now: now if now != first else None)(shown(browser)))
    expect(browser.run('const s = document.getElementById("slider"); return Math.abs(s.value - s.max) <= s.max / 500'), f"the clock does not move with the run: {later}")
    browser.run(CHOOSE)
    over = browser.run('const {x, y, width, height} = document.querySelector("[data-plot=disagreement] .u-over").getBoundingClientRect(); return [x, y, width, height]')
    for kind, share in [("mousePressed", 0.2), ("mouseMoved", 0.5), ("mouseReleased", 0.6)]:
        browser.tool("Input.dispatchMouseEvent", type=kind, x=over[0] + share * over[2], y=over[1] + over[3] / 2, button="left", clickCount=1)
    browser.run('document.getElementById("stage").go(0.4)')
    browser.run('document.querySelector("[data-plot=torque]").scrollIntoView({ behavior: "instant", block: "start" }); scrollBy({ top: 37, behavior: "instant" })')
    drawn(browser)
    chosen, at = browser.run(CHOSEN), browser.run(f"return {SCROLLED}")
    expect(chosen["t"] == 0.4 and chosen["zoomed"] and chosen["rows"] and "false" in chosen["hidden"], f"nothing was chosen: {chosen}")
    browser.run('document.getElementById("reload").checked = true')
    for k in range(2 if LONG else 1):
        before = until("a page", lambda: shown(browser))
        until("a later page", lambda: shown(browser) not in [before, None])
        drawn(browser)
        kept, now = browser.run(CHOSEN), browser.run(f"return {SCROLLED}")
        expect(kept == chosen, f"reload {k + 1} loses {[(key, chosen[key], kept[key]) for key in chosen if chosen[key] != kept[key]]}")
        expect(abs(now - at) < 2, f"reload {k + 1} scrolls from {at} to {now}")
    browser.picture(sys.argv[2]) if len(sys.argv) > 2 else None
    # Whoever is reading may say so.
    browser.run('document.getElementById("reload").click()')
    before = shown(browser)
    time.sleep(8)
    expect(shown(browser) == before, "the page is loaded again although nobody wants that")
    browser.run('document.getElementById("reload").click()')
    process.send_signal(signal.SIGINT)
    expect(process.wait() == 130, f"an interrupted run exits with {process.returncode}")
    until("the whole page", lambda: shown(browser) == "Interrupted")
    drawn(browser)
    kept = browser.run(CHOSEN)
    expect(kept == chosen, f"the whole page loses {[(key, chosen[key], kept[key]) for key in chosen if chosen[key] != kept[key]]}")
    expect(abs(browser.run(f"return {SCROLLED}") - at) < 2, "the whole page scrolls")
    expect("location.reload" not in page.read_text() and "http-equiv=\"refresh\"" not in page.read_text(), "the whole page is loaded again and again")
    loaded = browser.run("return performance.timeOrigin")
    time.sleep(8)
    expect(browser.run("return performance.timeOrigin") == loaded, "the whole page is loaded again")
    # What was chosen on a page that grew is no matter of another day.
    browser.open(page)
    expect(browser.run('return document.getElementById("stage").time()') == 0, "a page opened anew has another's clock")

    process, page = run("killed", 3000, "--follow")
    until("a page", page.exists)
    process.kill()
    process.wait()
    browser.open(page)
    expect(until("a page", lambda: shown(browser)).startswith("running: "), "the page of a run that was killed")
    expect(browser.run('return document.querySelectorAll("canvas").length') > 3, "it has no plots")
    subprocess.run([folder.program, "report", folder / "killed"], check=True, capture_output=True)
    browser.open(page)
    expect(shown(browser) == "Cut off", "`report` does not finish the page")
    left = sorted(path.name for path in (folder / "killed").iterdir())
    expect(not [name for name in left if "partial" in name or name == "rows.journal"], f"it leaves {left}")

    if LONG:
        # The same with and without, bit for bit, which a test shows without a browser for every change.
        pages = []
        for more in [[], ["--follow"]]:
            process, page = run("whole", 30, "--csv", *more)
            expect(process.wait() == 0, "a run that is whole")
            pages.append({p.name: p.read_bytes() for p in page.parent.rglob("*") if p.is_file() and p.name != "summary.json"})
            shutil.rmtree(page.parent)
        expect(pages[0] == pages[1] and "trajectory.csv" in pages[0], "following changes what is written")
    complaints = browser.complaints()
    expect(not complaints, f"the console says {complaints[:2]}")


if __name__ == "__main__":
    checks.main(check)
