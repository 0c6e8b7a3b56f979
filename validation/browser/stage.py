#!/usr/bin/env python3
"""Holds what pages draw beside what runs recorded: tips, shapes, packets; then what is known and what is not, and films.

    validation/browser/stage.py target/release/forwardstep
"""

import base64
import csv
import io
import pathlib
import struct
import tarfile

import checks
import known
from checks import TOLERANCE_M, done, expect, quiet, settled, some, value, waited
from pages import drawings

RING = "delay.constant_s = 0.1\nedges.ring = {}"
HOSTILE = "</script><img src=x onerror=alert(1)> & more"
SAVED = """
const { talk } = document.getElementById("stage");
document.getElementById("view-slide").click();
const blob = await talk[arguments[0]](arguments[1]);
talk.close();
const bytes = new Uint8Array(await blob.arrayBuffer());
let text = "";
for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192));
return btoa(text);
"""
PLAYED = """
const video = document.body.appendChild(document.createElement("video"));
video.muted = true;
video.src = "data:video/webm;base64," + arguments[0];
const happened = (what) => new Promise((done, fail) => (video.addEventListener(what, done, { once: true }), video.addEventListener("error", () => fail(new Error("no film")), { once: true })));
await happened("loadeddata");
const canvas = Object.assign(document.createElement("canvas"), { width: video.videoWidth, height: video.videoHeight });
const ctx = canvas.getContext("2d", { willReadFrequently: true });
const look = () => (ctx.drawImage(video, 0, 0), [...ctx.getImageData(0, 0, canvas.width, canvas.height).data]);
const first = look();
video.play();
await happened("ended");
const last = look();
return [video.videoWidth, video.videoHeight, video.currentTime, first.reduce((n, byte, i) => n + (Math.abs(byte - last[i]) > 40), 0)];
"""


def film(browser, name, page):
    """A film that the browser plays, and frames that another program reads."""
    archive = tarfile.open(fileobj=io.BytesIO(base64.b64decode(waited(browser, SAVED, "pictures", 1))))
    frames = [archive.extractfile(member).read() for member in archive.getmembers()]
    sizes = {struct.unpack(">II", frame[16:24]) for frame in frames if frame[:8] == b"\x89PNG\r\n\x1a\n"}
    expect(len(frames) == 11 and sizes == {(1280, 720)} and frames[0] != frames[-1], f"{name}: {len(frames)} frames of {sizes}")
    taken = waited(browser, SAVED, "film", 1.5)
    empty = page.with_name("empty.html")
    empty.write_text("<!DOCTYPE html><title>A film</title>")
    browser.open(empty)
    width, height, length, changed = waited(browser, PLAYED, taken)
    # A busy machine draws the first and the last of it late.
    expect((width, height) == (1280, 720) and 0.7 < length < 6 and changed > 1000, f"{name}: a film of {width} by {height}, {length} s, {changed} bytes change")


def flights(browser, name, page):
    """Packets on their way are those of the table that the run wrote, and each is drawn."""
    names = value(browser, 's.names()')
    packets = [(row["from"], row["to"], float(row["send_s"]), row["delay_s"]) for row in csv.DictReader(page.with_name("packets.csv").open())]
    arrived = 0
    for t in [0.0, 1.0, 5.0, 17.33, 59.0]:
        settled(browser, t)
        edges = value(browser, f"s.flights({t})")
        for edge in edges:
            link = [(sent, took) for a, b, sent, took in packets if (a, b) == (names[edge["from"]], names[edge["to"]])]
            under = sorted((sent, (t - sent) / float(took)) for sent, took in link if took and sent <= t < sent + float(took))
            drawn = sorted((one["sent"], one["share"]) for one in edge["flights"] if not one["lost"])
            same = len(under) == len(drawn) and all(abs(x - y) < 1e-3 for a, b in zip(under, drawn) for x, y in zip(a, b))
            expect(same, f"{name}: at {t} s {drawn} are on their way, not {under}")
            lost = {round(sent, 4) for sent, took in link if not took}
            expect(all(round(one["sent"], 4) in lost for one in edge["flights"] if one["lost"]), f"{name}: at {t} s others are lost")
            arrived += len(under)
        dots = value(browser, 'document.querySelectorAll("#graph-picture .flight").length')
        expect(dots == sum(len(edge["flights"]) for edge in edges), f"{name}: at {t} s there are {dots} dots")
    expect(arrived > 5, f"{name}: only {arrived} packets")


def marks(browser, name, late_s):
    """What is heard late without packets was said as long ago as the delay."""
    found = [one for t in [0.02, 1.0, 1.93] for edge in value(browser, f"s.flights({t})") for one in [dict(f, t=t) for f in edge["flights"]]]
    expect(len(found) > 5, f"{name}: {len(found)} marks")
    expect(all(0 <= f["share"] < 1 and abs(f["t"] - f["sent"] - f["share"] * late_s) < 1e-6 for f in found), f"{name}: marks {found[:3]}")


def shapes(browser, name):
    """A ball on the end of an arm stands where the run recorded its tip, and nothing is left of the capsules that shapes replace."""
    rows, worst = int(value(browser, "s.times().length")), 0.0
    for row in range(0, rows, max(1, rows // 20)):
        parts, recorded = value(browser, f"[s.parts(s.times()[{row}]), s.recorded({row})]")
        expect(len(parts) == 2, f"{name}: {len(parts)} shapes")
        own = recorded[0]
        for axis, x in zip(own["coordinates"], own["tip"]):
            worst = max(worst, abs(parts[1]["at"][axis] - own["base"][axis] - x))
    expect(0.0 < worst < TOLERANCE_M, f"{name}: shapes are drawn {worst} m from where they are")
    print(f"ok     {name}: shapes within {worst:.1e} m of the library's tip")


def tips(browser, name):
    """What is drawn beside what the run recorded of the tip, at every row."""
    rows, worst = int(value(browser, "s.times().length")), 0.0
    for row in range(0, rows, max(1, rows // 60)):
        drawn, recorded = value(browser, f"[s.tips(s.times()[{row}]), s.recorded({row})]")
        for tip, own in zip(drawn, recorded):
            for axis, x in zip(own["coordinates"], own["tip"]):
                worst = max(worst, abs(tip[axis] - own["base"][axis] - x))
    expect(0.0 < worst < TOLERANCE_M, f"{name}: tips are drawn {worst} m from where they are")
    print(f"ok     {name}: tips within {worst:.1e} m of the library's")


def far_away(browser, folder):
    """What moves by metres millions of metres away is drawn where the table says."""
    scenario = known.masses(folder, "far-away", RING, every=0.05)
    scenario.write_text(scenario.read_text().replace("within = [-1.0, 1.0]", "within = [4e6, 4.000002e6]"))
    page = folder.run("far-away", scenario, "--csv")
    browser.open(page)
    rows = list(csv.DictReader(page.with_name("trajectory.csv").open()))
    times, worst = value(browser, "s.times()"), 0.0
    for k, t in enumerate(times):
        row = rows[round(t / 0.05)]
        for point, tip in enumerate(value(browser, f"s.tips(s.times()[{k}])")):
            worst = max(worst, *(abs(tip[axis] - float(row[f"point-{point + 1}.q.{axis + 1}"])) for axis in range(2)))
    expect(len(times) > 40 and worst < 1e-5, f"far away: drawn {worst} m from where they are, at {len(times)} rows")
    quiet(browser, "far away", 1400)


def many_names(browser, folder):
    """Long names stay apart and within the page, and names that have no room are counted."""
    texts = "return [...document.querySelectorAll('#graph-picture text')].map((e) => e.textContent)"
    for stem, width in [("a-very-long-name-that-has-sixty-characters-and-never-breaks", 1400), ("averylongnamethathassixtycharactersandneverbreaks", 390)]:
        scenario = known.masses(folder, f"{stem[:8]}-{width}", RING, count=6)
        scenario.write_text(scenario.read_text().replace('"point"', f'"{stem}"'))
        page = folder.run(f"{stem[:8]}-{width}", scenario)
        browser.screen(width, 900, touch=width == 390)
        browser.open(page)
        drawn = browser.run(texts)
        expect(len(drawn) > 3 and len(set(drawn)) == len(drawn), f"{stem}: nodes are called {drawn}")
        quiet(browser, stem, width)
    browser.screen(1400, 900)
    for count, told in [(25, False), (60, True)]:
        browser.open(folder.run(f"count-{count}", known.masses(folder, f"count-{count}", RING, count=count)))
        settled(browser, 0.0)
        expect("no room for names" in value(browser, "document.querySelector('.where').textContent"), f"{count} points: none has a name, and nothing says so")
        expect(("Names have no room" in known.words(browser)) == told, f"{count} points: {known.words(browser)}")


def arm_with_shapes(folder):
    """An arm with a ball as its tool and a mesh as its base."""
    arm = pathlib.Path(__file__).resolve().parents[2] / "crates" / "io" / "robots" / "ur5e.urdf"
    ball = '<link name="tool0"><visual><origin xyz="0 0 0.15"/><geometry><sphere radius="0.1"/></geometry></visual></link>'
    box = '<link name="base_link"><visual><geometry><mesh filename="box.stl"/></geometry></visual>'
    text = arm.read_text().replace('<link name="tool0"/>', ball)
    (folder / "ur5e.urdf").write_text(text.replace('<link name="base_link">', box).replace('<link name="base_link"/>', f"{box}</link>"))
    facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    (folder / "box.stl").write_text(f"solid a\n{facet}endsolid a\n")
    scenario = folder / "shaped.toml"
    scenario.write_text(folder.scenario("task-space-ur5e"))
    return folder.run("shaped", scenario, "--meshes")


def check(browser, folder):
    browser.screen(1400, 900)
    for name in some(["theorem-6", "task-space-ur5e", "pose-ur5e", "redundant-panda"], 2):
        browser.open(folder.run(name))
        tips(browser, name)
    page = arm_with_shapes(folder)
    for query in ["", "?flat"]:
        browser.open(page, query)
        shapes(browser, f"shaped{query}")
        quiet(browser, f"shaped{query}", 1400)
    far_away(browser, folder)
    many_names(browser, folder)
    known.all_of(browser, folder)
    page = folder.run("from-a-log")
    browser.open(page)
    flights(browser, "from-a-log", page)
    for name in some(["six-arms", "theorem-7"], 2):
        page = folder.run(name)
        browser.open(page)
        film(browser, name, page)
        done(f"{name}: a film")
    for count in [12, 1000]:
        name = f"{count} points, with a hostile title"
        scenario = known.masses(folder, f"points-{count}", RING, count=count, title=HOSTILE)
        browser.open(folder.run(f"points-{count}", scenario))
        expect(value(browser, "s.tips(0).length") == count, f"{name}: not all are there")
        drawings(browser, name)
        if count == 12:
            marks(browser, "points", 0.1)
        quiet(browser, name, 1400)


if __name__ == "__main__":
    checks.main(check)
