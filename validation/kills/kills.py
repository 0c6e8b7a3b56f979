"""Runs that end at random moments, and what `forwardstep report` makes of them.

    kills.py [--kills 200] [--seconds 30] [--seed 1] [--side-by-side 2]

Every run takes --seconds of work or more. Four of five are killed (SIGKILL) at a
random moment, one of ten at any, the others once its rows are kept: before the
first step the program predicts, and nothing can be lost then. Of every fifth the files may not grow beyond a random size,
as on a disk that fills. Then `report` has to show the first rows of a whole run,
bit for bit, up to a second before the end. What is lost is the time from the last
write of the journal to the kill: rows are written in order, so all before are in it.

Needs the packages of ../tables/requirements.txt.
"""

import argparse
import os
import random
import re
import resource
import signal
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pyarrow.parquet as parquet

HERE = Path(__file__).resolve().parent
BINARY = Path(os.environ.get("FORWARDSTEP", HERE.parent.parent / "target" / "release" / "forwardstep")).resolve()
# At most one write per second, and what a busy machine adds to it.
MOST_LOST_S = 1.5


def scenario(folder, end_s):
    path = folder / "long.toml"
    path.write_text((HERE / "long.toml.in").read_text().replace("SECONDS", f"{end_s:g}"))
    return path


def calibrated(folder, seconds):
    """How long must be simulated so that a run takes so long, from a run of some seconds."""
    end_s = 0.5
    while True:
        out = folder / "calibration"
        started = time.monotonic()
        subprocess.run([BINARY, "run", scenario(folder, end_s), "--out", out, "--force"], capture_output=True, check=True)
        took = time.monotonic() - started
        if took > 3:
            return end_s * max(seconds / took, 1) * 1.3
        end_s *= 2


def columns(folder):
    table = parquet.read_table(folder / "trajectory.parquet")
    return {name: table[name].to_numpy() for name in table.column_names}


def same_beginning(part, whole):
    rows = len(part["t_s"])
    # The last row of a run stands at its end, and a run that was cut off has none.
    rows = min(rows, len(whole["t_s"]) - 1)
    equal = part.keys() == whole.keys() and all(part[name][:rows].tobytes() == whole[name][:rows].tobytes() for name in whole)
    return equal, rows


def one(number, seed, folder, path, seconds, whole):
    """Ends one run; what is wrong with what it left, its rows, what was lost in s, and how it ended."""
    draw = random.Random(f"{seed}-{number}")
    out, seen = folder / f"run-{number}", folder / f"seen-{number}"
    fills = number % 5 == 4
    most = int(draw.uniform(2e3, 1.2e6))
    limit = (lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))) if fills else None
    anywhere = number % 10 == 0
    after = draw.uniform(0, seconds if anywhere else 0.5 * seconds)
    journal = out / "rows.journal"
    started = time.monotonic()
    with open(folder / f"said-{number}", "wb") as said:
        run = subprocess.Popen([BINARY, "run", path, "--out", out], stdout=said, stderr=said, preexec_fn=limit)
        while not (fills or anywhere or journal.exists() or run.poll() is not None):
            time.sleep(0.01)
        try:
            run.wait(timeout=None if fills else after)
        except subprocess.TimeoutExpired:
            pass
        running = run.poll() is None
        if running:
            run.send_signal(signal.SIGKILL)
        ended, wall = time.monotonic() - started, time.time()
        run.wait()
    cut = journal.exists()
    lost = wall - journal.stat().st_mtime if cut and running else 0.0
    report = subprocess.run([BINARY, "report", out, "--out", seen], capture_output=True, text=True)
    words = (folder / f"said-{number}").read_text(errors="replace") + report.stdout + report.stderr
    wrong, rows = [], 0
    if "panicked" in words:
        wrong.append(f"panic: {words[-400:]}")
    if report.returncode == 0:
        equal, rows = same_beginning(columns(seen), whole)
        if not equal:
            wrong.append("its rows are not those of a whole run")
        # Rows may all be there where only tables did not fit, and the run then reached its end.
        complete = rows >= len(whole["t_s"]) - 1 and "Reached the horizon" in report.stderr
        if cut and not complete and not re.search(r"Was cut off at t = ", report.stderr):
            wrong.append(f"does not say that it was cut off: {report.stderr}")
    elif running and cut:
        wrong.append(f"nothing to show: {report.stderr}")
    elif running:
        # Before its first write.
        lost = ended
    if lost > MOST_LOST_S and not (rows == 0 and not cut):
        wrong.append(f"{lost:.2f} s lost")
    kind = "file too large" if fills else ("killed" if running else "whole")
    return wrong, rows, lost if running and cut else None, kind, running and not cut and lost or None


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--kills", type=int, default=200)
    arguments.add_argument("--seconds", type=float, default=30.0)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--side-by-side", type=int, default=2)
    given = arguments.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        end_s = calibrated(folder, given.seconds)
        path = scenario(folder, end_s)
        subprocess.run([BINARY, "run", path, "--out", folder / "whole"], capture_output=True, check=True)
        whole = columns(folder / "whole")
        task = lambda number: one(number, given.seed, folder, path, given.seconds, whole)
        with ThreadPoolExecutor(given.side_by_side) as pool:
            results = list(pool.map(task, range(given.kills)))
    for number, (wrong, *_) in enumerate(results):
        for line in wrong:
            print(f"run {number}: {line}")
        failed += bool(wrong)
    kinds = [kind for _, _, _, kind, _ in results]
    lost = [lost for _, _, lost, _, _ in results if lost is not None]
    early = [early for *_, early in results if early is not None]
    rows = sum(rows for _, rows, _, _, _ in results)
    print(
        f"{kinds.count('killed')} killed, {kinds.count('file too large')} with files that may not grow, {kinds.count('whole')} whole"
        f" before their moment; runs of {given.seconds:g} s; {rows} rows back, bit for bit; lost at most"
        f" {max(lost, default=0):.2f} s; {len(early)} killed before there were rows, the last after {max(early, default=0):.2f} s;"
        f" {failed} wrong"
    )
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
