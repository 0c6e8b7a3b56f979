"""Checks that a page says what is known, and no more: ages of what is heard, graphs that are not drawn, runs that blow up or end at once."""

import csv
import io
import re
import signal
import subprocess
import time

from checks import drawn, expect, settled, value

MASSES = """format = 2
title = "{title}"
time = {{ end_s = {end}, record_every_s = {every} }}
[[agents]]
name = "point"
count = {count}
robot.point_mass = {{ mass_kg = 1.0, dimension = 2 }}
start.position_m = {{ random = {{ seed = 1, within = [-1.0, 1.0] }} }}
[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"
[law.known]
{law}
[network]
{network}
"""
PACKETS = "delay.packets = { period_s = 0.2, latency_s = 0.3, jitter_s = 0.2, seed = 11, loss.bursts = { enter = 0.04, leave = 0.2 } }\nedges.ring = {}"
TURNS = """delay.constant_s = 0.01
[[network.phases]]
dwell_s = 0.01
edges = [["point-1", "point-2"], ["point-2", "point-3"]]
[[network.phases]]
dwell_s = 0.02
edges = [["point-3", "point-4"], ["point-4", "point-1"]]"""

DRAWN = TURNS.replace("[[network.phases]]\ndwell_s = 0.01", "switching.random = { seed = 1, dwell_s = [0.01, 0.02] }\n[[network.phases]]").replace("dwell_s = 0.02\n", "")


def masses(folder, name, network, end=4, every=0.1, count=4, law="", title="Masses"):
    scenario = folder / f"{name}.toml"
    scenario.write_text(MASSES.format(end=end, every=every, count=count, law=law, network=network, title=title))
    return scenario


def words(browser):
    return value(browser, 'document.getElementById("graph-words").textContent')


def text(browser, selector):
    return value(browser, f"[...document.querySelectorAll('{selector}')].map((e) => e.textContent).join(' | ')")


def packet_ages(browser, page, times):
    """By edge and time: what the table of packets says, beside what the page says."""
    names = value(browser, "s.names()")
    links = {}
    for row in csv.DictReader(page.with_name("packets.csv").open()):
        if row["delay_s"]:
            links.setdefault((row["from"], row["to"]), []).append((float(row["send_s"]), float(row["delay_s"])))
    for t in times:
        for edge in value(browser, f"s.flights({t})"):
            sent = [sent for sent, took in links[(names[edge["from"]], names[edge["to"]])] if sent + took <= t]
            yield t, t - max(sent, default=0.0), edge


def ages(browser, folder):
    """Ages on links that carry packets: exact where the page has them all, else between two values, and never drawn as if exact."""
    page = folder.run("packets", masses(folder, "packets", PACKETS, end=400, every=1))
    browser.open(page)
    found = list(packet_ages(browser, page, [0.05, 3.21, 77.7, 200.03, 333.3, 399.9]))
    wrong = [(t, true, edge["age"]) for t, true, edge in found if edge["age"] is None or abs(edge["age"] - true) > 1e-6]
    expect(len(found) == 24 and not wrong, f"packets: ages beside those of the table: {wrong[:3]}")
    settled(browser, 200.03)
    oldest = max(true for t, true, _ in found if t == 200.03)
    said = float(re.search(r"Oldest message heard: ([\d.]+) s", words(browser)).group(1))
    expect(abs(said - oldest) < 0.006, f"packets: the oldest is {oldest}, said to be {words(browser)}")
    page = folder.run("many-packets", masses(folder, "many-packets", PACKETS, end=2000, every=1))
    browser.open(page)
    found = list(packet_ages(browser, page, [3.21, 777.7, 1500.03]))
    wrong = [(t, true, edge["between"]) for t, true, edge in found if edge["age"] is not None or not edge["between"][0] - 1e-6 <= true <= edge["between"][1] + 1e-6]
    expect(not wrong, f"many packets: {wrong[:3]}")
    settled(browser, 777.7)
    expect("every 2nd packet" in words(browser) and "between" in words(browser), f"many packets: {words(browser)}")
    keys = text(browser, "[data-plot=delay] .key")
    expect("greatest" in keys and "least" in keys, f"many packets: the delays are said to be {keys}")


def turns(browser, folder):
    """Graphs that take turns more often than a page can hold: known from then on where they do so again and again, and in force as long as they are."""
    browser.open(folder.run("turns", masses(folder, "turns", TURNS, end=90)))
    settled(browser, 30)
    expect("2 edges." in words(browser), f"turns: at 30 s {words(browser)}")
    for t, sender in [(80.005, "point-3"), (80.015, "point-1"), (89.999, "point-3")]:
        settled(browser, t)
        expect("2 edges." in words(browser) and f"({sender} " in words(browser), f"turns: at {t} s {words(browser)}")
    rows = list(csv.reader(io.StringIO(value(browser, "s.table('gantt')"))))
    expect(rows[0] == ["edge", "from, in s", "to, in s"] and len(rows) > 4000, f"turns: a table of {len(rows)} rows, {rows[0]}")
    expect([row[0] for row in rows[1:5]] == ["point-1 → point-2", "point-2 → point-3", "point-3 → point-4", "point-4 → point-1"], f"turns: {rows[1:5]}")
    expect([abs(float(row[1]) - 0.01) < 1e-9 and abs(float(row[2]) - 0.03) < 1e-9 for row in rows[3:5]] == [True, True], f"turns: {rows[3:5]}")
    fold = "document.querySelector('[data-plot=gantt] .exports details')"
    browser.run(f"{fold}.open = true; {fold}.dispatchEvent(new Event('toggle'))")
    expect(value(browser, f"{fold}.querySelectorAll('tbody tr').length") == 60, "turns: the table under the strip")
    shares = text(browser, "#network figcaption")
    expect("in force 30 s" in shares and "in force 60 s" in shares, f"turns: {shares}")
    expect("not drawn after 60 s" in value(browser, "document.querySelector('[data-plot=gantt] .canvas').getAttribute('aria-label')"), "turns: the strip says nothing")
    browser.open(folder.run("drawn", masses(folder, "drawn", DRAWN, end=90)))
    settled(browser, 80)
    expect("not drawn after" in words(browser), f"drawn: at 80 s {words(browser)}")
    expect(value(browser, "s.flights(80).length") == 0, "drawn: edges are drawn where the graph is unknown")
    browser.open(folder.run("saw", masses(folder, "saw", "delay.saw_tooth = { min_s = 0.05, max_s = 0.4, period_s = 0.6 }\nedges.ring = {}", end=3000, every=1)))
    between = [edge["between"] for t in [10, 1234, 2999] for edge in value(browser, f"s.flights({t})")]
    expect(all(b and abs(b[0] - 0.05) < 2e-3 and abs(b[1] - 0.4) < 2e-3 for b in between), f"saw: {between[:3]}")
    expect("until t =" not in text(browser, "footer"), f"saw: {text(browser, 'footer')}")


def compared(folder, name, *runs):
    subprocess.run([folder.program, "compare", *runs, "--out", folder / name], capture_output=True, check=False)
    return folder / name / "compare.html"


def beyond(browser, folder):
    """A run that outgrows the numbers of a page: it says from when on, and agents stay where they were."""
    law = "damping.gain = 100\n[control]\nsample_hz = 10"
    scenario = masses(folder, "unstable", "delay.constant_s = 0.1\nedges.ring = {}", end=60, every=0.02, law=law)
    browser.open(folder.run("unstable", scenario))
    end = float(value(browser, 'document.getElementById("slider").max'))
    settled(browser, end)
    note = text(browser, "[data-plot=position] .beyond")
    expect("beyond what the page can draw from t =" in note.lower(), f"unstable: {note}")
    where = text(browser, "#view .where")
    expect("beyond what the page can draw" in where, f"unstable: {where}")
    picture = value(browser, "s.drawing()")
    expect(all(f">point-{k}<" in picture for k in [1, 2, 3, 4]) and "NaN" not in picture, "unstable: agents are gone at the end")
    browser.open(compared(folder, "unstable-beside", scenario, "double-integrators"))
    browser.run('document.getElementById("side").go(arguments[0])', end)
    drawn(browser)
    expect("eyond what the page can draw" in text(browser, ".scene .words"), f"unstable, compared: {text(browser, '.scene .words')}")


def interrupted(browser, folder):
    """A run that was interrupted neither met nor missed its goal."""
    text_of = folder.scenario("theorem-2")
    scenario = folder / "interrupted.toml"
    scenario.write_text(re.sub(r"record_every_s = \S+", "record_every_s = 1", re.sub(r"end_s = \S+", "end_s = 100000", text_of, count=1), count=1))
    running = subprocess.Popen([folder.program, "run", scenario, "--out", folder / "interrupted"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(2)
    running.send_signal(signal.SIGINT)
    running.wait(timeout=60)
    browser.open(folder / "interrupted" / "report.html")
    top = text(browser, "header.top")
    expect("Goal undecided" in top and "Goal missed" not in top, f"interrupted: {top}")
    expect(value(browser, "document.querySelector('.conclusion .good, .conclusion .bad') === null"), f"interrupted: a verdict on {text(browser, '.conclusion')}")


def few(browser, folder):
    """Constant delays are not stale, complete graphs are drawn evenly, and clocks count in the digits of their run."""
    browser.open(folder.run("constant", masses(folder, "constant", "delay.constant_s = 0.1\nedges.ring = {}")))
    settled(browser, 2)
    faint = value(browser, "[...document.querySelectorAll('#graph-picture .edge')].map((e) => Number(e.getAttribute('opacity')))")
    expect(len(faint) == 4 and min(faint) > 0.99, f"constant: edges are drawn at {faint}")
    browser.open(folder.run("complete", masses(folder, "complete", "delay.constant_s = 0.1\nedges.complete = {}", end=1, count=100)))
    expect("2000 of 9900 edges drawn" in words(browser), f"complete: {words(browser)}")
    for part, arrows in [("#graph-picture", ".edge"), ("#network figure", "g:has(> polygon)")]:
        senders = value(browser, f"[...document.querySelectorAll('{part} {arrows}')].map((e) => e.getAttribute('class'))")
        expect(len(senders) == 2000 and len(set(senders)) == 100, f"complete: {len(senders)} arrows of {len(set(senders))} senders in {part}")
    for end, every, least in [(0.001, 1e-5, 6), (1e5, 50, 0)]:
        browser.open(folder.run(f"end-{end}", masses(folder, f"end-{end}", "delay.constant_s = 0.1\nedges.ring = {}", end=end, every=every)))
        settled(browser, end / 3)
        said = text(browser, "#time")
        shown = re.match(r"t = (\d+)\.?(\d*) s", said)
        expect(len(shown.group(2)) >= least and float(f"{shown.group(1)}.{shown.group(2) or 0}") > 0, f"{end} s: the clock says {said}")
        lasts = end / float(value(browser, 'document.getElementById("rate").value'))
        expect(3 <= lasts <= 60, f"{end} s: would play for {lasts} s")


def instant(browser, folder):
    """A run that broke down where it began has no second that never passed."""
    # Its law divides by zero there.
    (folder / "instant.toml").write_text("""format = 2
time.end_s = 4
[[agents]]
name = "chain"
count = 2
robot.chain = { order = 2, psi = "x" }
start.position = [[0.0], [1.0]]
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position"
[law.linearising]
[network]
edges.ring = {}
""")
    browser.open(folder.run("instant", folder / "instant.toml"))
    expect("of 0 s" in text(browser, "#time") and value(browser, 'document.getElementById("slider").disabled'), f"instant: {text(browser, '#time')}")
    zoomed = value(browser, "document.getElementById('slider').max")
    expect(float(zoomed) == 0, f"instant: the slider ends at {zoomed}")


def all_of(browser, folder):
    ages(browser, folder)
    turns(browser, folder)
    beyond(browser, folder)
    interrupted(browser, folder)
    few(browser, folder)
    instant(browser, folder)
    complaints = browser.complaints()
    expect(not complaints, f"what is known: the console says {complaints[:2]}")
