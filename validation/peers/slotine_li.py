"""The Slotine-Li step, forwardstep beside Pinocchio, run alternately on one machine; prints times and ratios.

Usage: python slotine_li.py [rounds]     (default 5)

Needs a Python with the packages of ../pinocchio/requirements.txt (their wheel carries the headers and Boost), g++, Eigen
(Debian: libeigen3-dev; EIGEN_INCLUDE overrides /usr/include/eigen3) and cargo. The first build takes two minutes; the
binary is kept in target/peers/. Compiler flags: -O3 -march=native for Pinocchio; a baseline build with run-time dispatch
for forwardstep. Ratios compare the medians of both over all rounds, and are the least favourable, the median and the most favourable
of the rounds.
"""

import json
import os
import pathlib
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE.parent / "pinocchio"))


def build_peer():
    import pinocchio as pin

    prefix = pathlib.Path(pin.__file__).resolve()
    prefix = next(parent for parent in prefix.parents if (parent / "include" / "pinocchio").is_dir())
    source, binary = HERE / "pinocchio" / "slotine_li.cpp", ROOT / "target" / "peers" / "slotine_li"
    binary.parent.mkdir(parents=True, exist_ok=True)
    if not binary.exists() or binary.stat().st_mtime < source.stat().st_mtime:
        # The definitions are those of Pinocchio's own CMake target. -w: its headers warn under GCC 12.
        definitions = ["NDEBUG", "BOOST_MPL_LIMIT_LIST_SIZE=30", "BOOST_MPL_LIMIT_VECTOR_SIZE=30"]
        definitions += ["BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "BOOST_FUSION_INVOKE_MAX_ARITY=12"]
        eigen = os.environ.get("EIGEN_INCLUDE", "/usr/include/eigen3")
        command = ["g++", "-std=c++17", "-O3", "-march=native", "-w", *(f"-D{d}" for d in definitions)]
        command += [f"-I{prefix}/include", f"-I{eigen}", str(source), "-o", str(binary)]
        command += [f"-L{prefix}/lib", "-lboost_serialization", f"-Wl,-rpath,{prefix}/lib"]
        subprocess.run(command, check=True)
    return binary


def arms_as_text():
    """What the C++ program reads: fixed links are lumped by Pinocchio, as in the fixtures."""
    models = json.loads((HERE.parent / "pinocchio" / "fixtures" / "arms.json").read_text())["models"]
    lines = []
    for model in models:
        moving = [link for link in model["links"] if link["kind"] != "fixed"]
        lines.append(f"{model['name']} {len(moving)}")
        for i, link in enumerate(moving):
            # Serial arms whose fixed links come last: a moving link's parent is the one before it.
            numbers = [x for row in link["rotation"] for x in row] + link["translation"] + link["axis"]
            numbers += model["theta"][10 * i : 10 * i + 10]
            lines.append(" ".join([str(i), *map(repr, numbers)]))
    return "\n".join(lines) + "\n"


def parse(text):
    return [json.loads(line) for line in text.splitlines() if line.startswith("{")]


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    peer = build_peer()
    bench = ["cargo", "bench", "--quiet", "-p", "forwardstep-core", "--bench", "slotine_li_cpu"]
    subprocess.run([*bench, "--no-run"], cwd=ROOT, check=True)
    arms, seen = arms_as_text(), {}
    for _ in range(rounds):
        ours = subprocess.run(bench, cwd=ROOT, check=True, capture_output=True, text=True).stdout
        theirs = subprocess.run([str(peer)], input=arms, check=True, capture_output=True, text=True).stdout
        for line in parse(ours) + parse(theirs):
            assert line.get("mismatch", 0.0) < 1e-9, line
            seen.setdefault(line["arm"], {}).setdefault(line["case"], []).append(line)
    for arm, cases in seen.items():
        print(arm)
        for case, lines in cases.items():
            medians = [line["median_ns"] for line in lines]
            low, high = min(line["min_ns"] for line in lines), max(line["max_ns"] for line in lines)
            print(f"  {case:40} {statistics.median(medians):8.1f} ns   (medians {min(medians):.1f} to {max(medians):.1f}, batches {low:.1f} to {high:.1f})")
        for ours, peers in [
            ("forwardstep f64", ("pinocchio B", "pinocchio A")),
            ("forwardstep 8 lanes", ("pinocchio B", "pinocchio A")),
            ("forwardstep forward dynamics f64", ("pinocchio forward dynamics",)),
            ("forwardstep forward dynamics 8 lanes", ("pinocchio forward dynamics",)),
        ]:
            for their in peers:
                ratios = sorted(b["median_ns"] / a["median_ns"] for a, b in zip(cases[ours], cases[their]))
                print(f"  {their} / {ours}: {ratios[0]:.1f}  {statistics.median(ratios):.1f}  {ratios[-1]:.1f}")


if __name__ == "__main__":
    main()
