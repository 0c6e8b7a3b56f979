"""What checks of the page of a run have in common."""

import time

# What the browser computes from joint values of single precision, beside what the run recorded of the tip.
TOLERANCE_M = 1e-6

problems = []
checked = [0]


def expect(holds, what):
    checked[0] += 1
    if not holds:
        problems.append(what)
        print(f"FAILED {what}")


def value(browser, expression):
    return browser.run(f'const s = document.getElementById("stage"); return {expression}')


def settled(browser, t):
    browser.run('document.getElementById("stage").go(arguments[0])', t)
    time.sleep(0.15)


def waited(browser, script, *arguments):
    return browser.run(f"return (async () => {{{script}}})()", *arguments)
