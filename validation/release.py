"""An ordinary and a static program side by side: the same bits, and how long each takes.

    release.py ORDINARY STATIC [--bench six-arms] [--repeat 7] [--scenarios NAME…]

Every shipped scenario that takes less than a few seconds, or those that are named,
is run by both. trajectory.parquet must have the same digest, and summary.json be
equal but for its timings. Then both run --bench in turns; the ratio of each pair is
taken in processor time, so that what else runs on the machine matters less. Exits
with 1 when digests differ or the median ratio exceeds 1.05.
"""

import argparse
import json
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path

MOST = 1.05
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
        ratios = []
        # The first pair warms up.
        for k in range(given.repeat + 1):
            order = programs if k % 2 == 0 else programs[::-1]
            took = {program: processor_s(program, given.bench, Path(name) / "bench") for program in order}
            if k > 0:
                ratios.append(took[programs[1]] / took[programs[0]])
    for scenario in differ:
        print(f"{scenario}: the two programs give different numbers")
    median = statistics.median(ratios)
    print(
        f"{equal} scenarios with equal digests, {len(differ)} that differ, {len(long)} that take longer than {LONGEST_S} s left out;"
        f" static to ordinary on {given.bench}: {median:.3f} ({min(ratios):.3f} to {max(ratios):.3f}, {len(ratios)} pairs)"
    )
    raise SystemExit(1 if differ or equal == 0 or median > MOST else 0)


if __name__ == "__main__":
    main()
