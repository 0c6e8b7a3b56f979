"""An ordinary and a static program side by side: the same bits, and how long each takes.

    release.py ORDINARY STATIC [--bench six-arms] [--repeat 7] [--built PROGRAM] [--scenarios NAME…]

Every shipped scenario that takes less than a few seconds, or those that are named,
is run by both. trajectory.parquet must have the same digest, and summary.json be
equal but for its timings. Then both run --bench in turns; the ratio of each pair is
taken in processor time, so that what else runs on the machine matters less. With
--built, the program that `cargo build --release` makes runs in turn with them: what
is given to others must not be slower than that, within what a machine varies. Exits
with 1 when digests differ, or a median ratio exceeds 1.05, or 1.15 for --built.
"""

import argparse
import json
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path

MOST = 1.05
# Both are compiled from the same text by different settings, and neither is meant to be the faster one.
MOST_TO_BUILT = 1.15
LONGEST_S = 20


def run(program, scenario, folder, timeout=None):
    subprocess.run([program, "run", scenario, "--out", folder, "--force"], capture_output=True, timeout=timeout, check=False)
    summary = json.loads((folder / "summary.json").read_text())
    summary.pop("timings")
    return summary


def processor_s(program, scenario, folder):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "run", scenario, "--out", folder, "--force"], capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("ordinary", type=Path)
    arguments.add_argument("static", type=Path)
    arguments.add_argument("--bench", default="six-arms")
    arguments.add_argument("--repeat", type=int, default=7)
    arguments.add_argument("--built", type=Path)
    arguments.add_argument("--scenarios", nargs="*")
    given = arguments.parse_args()
    programs = [given.ordinary.resolve(), given.static.resolve()]
    listed = subprocess.run([programs[0], "scenarios"], capture_output=True, text=True, check=True).stdout
    names = given.scenarios or [line.split()[0] for line in listed.splitlines() if line and not line[0].isspace()]
    equal, differ, long = 0, [], []
    with tempfile.TemporaryDirectory() as name:
        for scenario in names:
            try:
                both = [run(program, scenario, Path(name) / f"{scenario}-{k}", LONGEST_S) for k, program in enumerate(programs)]
            except subprocess.TimeoutExpired:
                long.append(scenario)
                continue
            if both[0] == both[1]:
                equal += 1
            else:
                differ.append(scenario)
        timed = programs + ([given.built.resolve()] if given.built else [])
        ratios = {program: [] for program in timed}
        # The first round warms up; in every further one another program begins.
        for k in range(given.repeat + 1):
            order = timed[k % len(timed) :] + timed[: k % len(timed)]
            took = {program: processor_s(program, given.bench, Path(name) / "bench") for program in order}
            if k > 0:
                for program in timed:
                    ratios[program].append(took[program] / took[programs[0]])
    for scenario in differ:
        print(f"{scenario}: the two programs give different numbers")
    said = [
        f"{equal} scenarios with equal digests, {len(differ)} that differ, {len(long)} that take longer than {LONGEST_S} s left out",
        f"static to ordinary on {given.bench}: {words(ratios[programs[1]])}",
    ]
    slow = statistics.median(ratios[programs[1]]) > MOST
    if given.built:
        to_built = [1 / ratio for ratio in ratios[timed[2]]]
        said.append(f"ordinary to what cargo build --release makes: {words(to_built)}")
        slow |= statistics.median(to_built) > MOST_TO_BUILT
    print("; ".join(said))
    raise SystemExit(1 if differ or equal == 0 or slow else 0)


def words(ratios):
    return f"{statistics.median(ratios):.3f} ({min(ratios):.3f} to {max(ratios):.3f}, {len(ratios)} rounds)"


if __name__ == "__main__":
    main()
