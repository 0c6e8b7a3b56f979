"""What the checks of pages have in common."""

import os
import pathlib
import subprocess
import sys
import tempfile
import time

import webdriver

# What the browser computes from joint values of single precision, beside what the run recorded of the tip.
TOLERANCE_M = 1e-6
NO_BROWSER = 77
# Whether checks may take as long as before a release.
LONG = "FORWARDSTEP_LONG" in os.environ
# What is asked for is drawn before the second of two frames; a page for a talk draws a frame later.
FRAMES = "const frames = async (n) => { for (let k = 0; k < n; k += 1) await new Promise(requestAnimationFrame); };"

problems = []
checked = 0


def some(items, every):
    """Every so many of these, and all of them where there is time."""
    return items[:: 1 if LONG else every]


def expect(holds, what):
    global checked
    checked += 1
    if not holds:
        problems.append(what)
        print(f"FAILED {what}")


def done(what):
    print(f"{'ok    ' if not problems else '      '} {what}")


def value(browser, expression, part="stage"):
    return browser.run(f'const s = document.getElementById("{part}"); return {expression}')


def waited(browser, script, *arguments):
    return browser.run(f"return (async () => {{{script}}})()", *arguments)


def drawn(browser):
    """Waits until the page has drawn what was asked of it, however busy the machine is."""
    waited(browser, f"{FRAMES} await frames(3);")


def settled(browser, t):
    browser.run('document.getElementById("stage").go(arguments[0])', t)
    drawn(browser)


def becomes(browser, expression, part="stage", seconds=20):
    """Whether an expression is true before long."""
    begun = time.monotonic()
    while time.monotonic() - begun < seconds:
        if value(browser, expression, part):
            return True
        time.sleep(0.05)
    return False


def quiet(browser, name, width):
    complaints = browser.complaints()
    expect(not complaints, f"{name}: the console says {complaints[:2]}")
    expect(value(browser, 'document.getElementById("error-banner").textContent') == "", f"{name}: an error banner")
    wide = value(browser, "document.documentElement.scrollWidth")
    expect(wide <= width, f"{name}: {wide} px wide where there are {width}")


def plays(browser, name, part="stage"):
    """The key Space plays from the start, and pauses."""
    browser.press("Space")
    expect(becomes(browser, "s.time() > 0", part), f"{name}: play does not play")
    browser.press("Space")
    stopped = value(browser, "s.time()", part)
    time.sleep(0.3)
    expect(value(browser, "s.time()", part) == stopped, f"{name}: pause does not pause")


class Folder:
    """A folder in which the program runs scenarios."""

    def __init__(self, program, folder):
        self.program, self.path = program, pathlib.Path(folder)

    def __truediv__(self, name):
        return self.path / name

    def run(self, name, scenario=None, *more):
        answer = subprocess.run([self.program, "run", scenario or name, "--out", self / name, *more], capture_output=True, text=True, check=False)
        page = self / name / "report.html"
        if not page.exists():
            sys.exit(f"{name}: {answer.stderr}")
        return page

    def scenario(self, name):
        """The text of a shipped scenario."""
        return subprocess.run([self.program, "scenarios", name], capture_output=True, text=True, check=True).stdout


def main(check):
    """Calls `check` with a browser and a folder, and ends with what it found."""
    tools = webdriver.found()
    if tools is None:
        print("skipped: no browser (chromium and chromedriver)")
        sys.exit(NO_BROWSER)
    with tempfile.TemporaryDirectory() as folder, webdriver.Browser(*tools) as browser:
        check(browser, Folder(pathlib.Path(sys.argv[1]).resolve(), folder))
    print(f"{checked} checks, {len(problems)} failed")
    sys.exit(1 if problems else 0)
