"""A directed ring with constant delays, forwardstep beside jitcdde, run alternately on one machine; prints times and ratios.

Usage: python ring.py [rounds]     (default 3)

Needs a Python with the packages of requirements.txt, a C compiler and cargo. Both integrate the same equations from the
same start at a tolerance of 1e-6; errors are against runs with much tighter ones. A ratio is the peer's time over ours:
the least favourable, the median and the most favourable of the rounds.
"""

import json
import pathlib
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
CASES = [("linear", 4), ("linear", 16), ("linear", 64), ("linear", 256), ("arms", 4), ("arms", 16), ("arms", 64)]


def run(command):
    output = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return next(json.loads(line) for line in output.splitlines() if line.startswith("{"))


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    bench = ["cargo", "bench", "--quiet", "-p", "forwardstep-sim", "--bench", "ring"]
    subprocess.run([*bench, "--no-run"], cwd=ROOT, check=True)
    print(f"{'ring':>12} {'ours':>10} {'jitcdde':>10}  ms per simulated second; {'error':>8} {'of both':>8}   ratio: least median most")
    for model, agents in CASES:
        ours, theirs = [], []
        for _ in range(rounds):
            ours.append(run([*bench, "--", model, str(agents)]))
            peer = [sys.executable, str(HERE / "jitcdde_ring.py"), "--agents", str(agents), "--model", model, "--end", "20"]
            theirs.append(run(peer))
        time = "ms_per_simulated_second"
        ratios = sorted(b[time] / a[time] for a, b in zip(ours, theirs))
        print(
            f"{model + ' ' + str(agents):>12} {statistics.median(a[time] for a in ours):10.4f} "
            f"{statistics.median(b[time] for b in theirs):10.4f} {'':25}"
            f"{max(a['max_error'] for a in ours):8.1e} {max(b['max_error_q'] for b in theirs):8.1e}   "
            f"{'':5} {ratios[0]:7.1f} {statistics.median(ratios):6.1f} {ratios[-1]:5.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
