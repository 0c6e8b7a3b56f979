"""Checks of positions over time and of paths in space."""

import csv
import io

from checks import FRAMES, TOLERANCE_M, drawn, expect, settled, value, waited

STROKED = """
const found = new DOMParser().parseFromString(document.getElementById("stage").drawing(), "image/svg+xml");
const lines = [...found.querySelectorAll("path")].map((path) => [path.getAttribute("stroke"), path.getAttribute("d").slice(1).split("L").map((p) => p.split(" ").map(Number))]);
return [lines.filter(([stroke, points]) => stroke && points.length > 2), [...found.querySelectorAll("text")].map((text) => text.textContent)];
"""
DRAGGED = """
const over = document.querySelector("#view .over"), { left, top, width, height } = over.getBoundingClientRect();
const send = (kind, x) => over.dispatchEvent(new PointerEvent(kind, { pointerId: 1, clientX: left + x, clientY: top + height / 2, isPrimary: true }));
over.setPointerCapture = () => {};
const to = arguments[0] + arguments[1] * (width - arguments[0] - arguments[2]);
send("pointerdown", to - 40), send("pointermove", to), send("pointerup", to);
"""
LEFT_PX, RIGHT_PX = 66, 24


def chart(browser, name):
    """What has one coordinate is drawn over time: of each agent what was, up to the clock, and what is to come, from there on."""
    end = float(value(browser, 'document.getElementById("slider").max'))
    names = value(browser, "s.names()")
    wide = value(browser, 'document.getElementById("view").clientWidth') - LEFT_PX - RIGHT_PX
    for share in [0.25, 0.75]:
        settled(browser, share * end)
        lines, texts = browser.run(STROKED)
        colours = {stroke for stroke, _ in lines}
        expect(len(lines) == 2 * len(names) and len(colours) == len(names), f"{name}: {len(lines)} curves in {len(colours)} colours for {len(names)} agents")
        for points in [points for _, points in lines]:
            met = [points[-1][0], points[0][0]]
            expect(min(abs(x - LEFT_PX - share * wide) for x in met) < 1, f"{name}: a curve does not meet the clock at {share} of the run but {met}")
            expect(all(a[0] <= b[0] for a, b in zip(points, points[1:])), f"{name}: a curve goes back in time")
        expect(set(names) <= set(texts), f"{name}: {texts} name not all of {names}")
    browser.run(DRAGGED, LEFT_PX, 0.4, RIGHT_PX)
    drawn(browser)
    expect(abs(value(browser, "s.time()") - 0.4 * end) < 0.01 * end, f"{name}: dragging sets the clock to {value(browser, 's.time()')} of {end}")


TURNED = """
const stage = document.getElementById("stage"), card = document.querySelector("[data-plot=path]");
card.scrollIntoView({ block: "center", behavior: "instant" });
const frame = card.querySelector(".turns"), [under, over] = frame.querySelectorAll("canvas");
const shots = async () => (await frames(3), [under, over].map((c) => c.toDataURL()).concat(stage.drawing()));
const end = document.getElementById("slider").max;
stage.go(0);
const first = await shots();
stage.go(end / 2);
const later = await shots();
const press = (key) => frame.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
"dddw".split("").forEach(press);
const turned = await shots();
const { left, top } = over.getBoundingClientRect();
const send = (kind, x, y) => over.dispatchEvent(new PointerEvent(kind, { pointerId: 1, clientX: left + x, clientY: top + y }));
over.setPointerCapture = () => {};
send("pointerdown", 100, 100), send("pointermove", 160, 120), send("pointerup", 160, 120);
const dragged = await shots();
stage.go(0);
await shots();
let pointed = false;
for (let x = 40; x < over.clientWidth && !pointed; x += 8) for (let y = 10; y < over.clientHeight && !pointed; y += 8) {
  send("pointermove", x, y);
  pointed = stage.time() > 0;
}
document.getElementById("view-reset").click();
scrollTo({ top: 0, behavior: "instant" });
return [first[0] === later[0], first[1] !== later[1], later[0] !== turned[0], later[2] !== turned[2], turned[0] !== dragged[0], pointed];
"""


def numbers(browser, plot):
    rows = list(csv.DictReader(io.StringIO(value(browser, f"s.table('{plot}')"))))
    return [{key.rsplit(" in ", 1)[0].split(" · ")[0]: float(text) for key, text in row.items() if text} for row in rows]


def paths(browser, name):
    """Paths in space: they follow the clock, turn by keys and by dragging together with the picture, and have the numbers of the run."""
    still, follows, turns, both, drags, points = waited(browser, FRAMES + TURNED)
    expect(still and follows, f"{name}: the paths are {'' if still else 'not '}left alone by the clock, dots {'' if follows else 'do not '}follow it")
    expect(turns and both and drags, f"{name}: paths turn by keys {turns}, with the picture {both}, by dragging {drags}")
    expect(points, f"{name}: pointing at a path in space moves no clock")
    rows = numbers(browser, "path")
    agents = value(browser, "s.names()")
    if name == "task-space-ur5e":
        times = value(browser, "s.times()")
        for row in rows[:: max(1, len(rows) // 20)]:
            own = value(browser, "s.recorded(arguments[0])[0]".replace("arguments[0]", str(times.index(row["t_s"]))))
            found = [row[f"{agents[0]}, {'xyz'[axis]}"] for axis in own["coordinates"]]
            expect(all(abs(a - b) < TOLERANCE_M for a, b in zip(found, own["tip"])), f"{name}: at {row['t_s']} s the path is at {found}, the tip at {own['tip']}")
        expect(any(key.endswith(", desired, z") for key in rows[0]), f"{name}: what is desired has no path among {list(rows[0])}")
    if name == "six-arms":
        # Arms that agree hold their tips alike, each from its own base.
        for axis in "xyz":
            ends = [rows[-1][f"{agent}, {axis}"] for agent in agents]
            expect(max(ends) - min(ends) < 1e-3, f"{name}: paths end at {axis} = {ends}")
    if name == "formation":
        for axis in range(3):
            browser.run('const j = document.getElementById("joint"); j.value = arguments[0]; j.onchange()', str(axis))
            position = numbers(browser, "position")
            for agent in agents:
                for end in [0, -1]:
                    a, b = rows[end][f"{agent}, {'xyz'[axis]}"], position[end][agent]
                    expect(abs(a - b) < 1e-4, f"{name}: the path of {agent} has {'xyz'[axis]} = {a} where the plot has {b}")
