#!/usr/bin/env python3
"""Runs checks of pages, side by side: most of their time they wait. With FORWARDSTEP_LONG all of them, and what measures speed last, alone.

    validation/browser/all.py target/release/forwardstep

Status 77 where chromium or chromedriver is not there. Needs nothing but Python.
"""

import pathlib
import subprocess
import sys

import webdriver
from checks import LONG, NO_BROWSER
from pages import SCENARIOS

BESIDE = [["layout.py", "whole"], ["layout.py", "cards"], ["stage.py"], ["follow.py"], ["hands.py"], ["compare.py"]]
BESIDE += [["pages.py", *SCENARIOS[::2]], ["pages.py", *SCENARIOS[1::2]]] if LONG else [["pages.py", SCENARIOS[0]]]
ALONE = [["speed.py"]] if LONG else []


def begun(check):
    script, *more = check
    command = [sys.executable, "-u", pathlib.Path(__file__).with_name(script), sys.argv[1], *more]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def main():
    if webdriver.found() is None:
        print("skipped: no browser (chromium and chromedriver)")
        return NO_BROWSER
    failed = 0
    for group in [BESIDE, ALONE]:
        for check, process in [(check, begun(check)) for check in group]:
            said = process.communicate()[0]
            failed += process.returncode != 0
            print(f"{' '.join(check)}\n{said}", end="", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
