"""Robots that other people wrote, through `forwardstep new` and `run`.

    cargo build --release
    python new.py ROBOTS               compare with new.md
    python new.py ROBOTS --write       write new.md

For every URDF under the folder ROBOTS, such as that of the package
example-robot-data, three robots are to agree: `forwardstep new` tries gains and
writes a scenario, whose goal `forwardstep run` then has to meet. Exits with 1
when the program crashes, when a scenario that worked when it was tried misses
its goal, or when a robot fares otherwise than in new.md.
"""

import argparse
import os
import re
import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
TABLE = HERE / "new.md"
BINARY = Path(os.environ.get("FORWARDSTEP", HERE.parent.parent / "target" / "release" / "forwardstep"))
TIMEOUT_S = 900
TRIED = re.compile(r"tried with bandwidths of (\S+) and (\S+) per second and (.*?): (.*)")


def program(folder, *arguments):
    return subprocess.run([BINARY, *arguments], cwd=folder, capture_output=True, text=True, timeout=TIMEOUT_S)


def row(robots, path):
    """The cells of one robot, and whether something is wrong."""
    name = str(path.relative_to(robots))
    with tempfile.TemporaryDirectory() as folder:
        try:
            new = program(folder, "new", "robot.toml", "--robot", str(path), "--agents", "3")
        except subprocess.TimeoutExpired:
            return [name, "no answer", "", "", "", f"not within {TIMEOUT_S} s"], True
        if new.returncode == 2:
            reason = new.stderr.strip().splitlines()[0].strip(" ×").replace(str(path), path.name)
            return [name, "no scenario", "", "", "", reason], False
        tried = [TRIED.match(line).groups() for line in new.stderr.splitlines() if TRIED.match(line)]
        if new.returncode not in (0, 1) or not tried:
            return [name, f"status {new.returncode}", "", "", "", new.stderr], True
        if new.returncode == 1:
            return [name, "does not agree", "", "", str(len(tried)), tried[-1][3]], False
        text = (Path(folder) / "robot.toml").read_text()
        print(name, flush=True)
        value = lambda key: re.search(rf"^{key} = (.*?) *#", text, re.M).group(1)
        own = [value("damping.bandwidth_per_s"), value("adaptation_gain")[20:-2].strip(), value("estimate_start")]
        gains = ", ".join(own)
        ran = program(folder, "run", "robot.toml")
        # What was written is not always what was tried last.
        known = {'"zero"': "nothing known", '"true"': "all known"}.get(own[2], "0.8 of everything known")
        said = next((said for *those, said in reversed(tried) if those == [own[0], own[1], known] and "after" in said), "")
        remark = said.split(" but ", 1)[1] if " but " in said else ""
        works = ran.returncode == 0
        return [name, "agrees" if works else "misses its goal", gains, value("end_s"), str(len(tried)), remark], not works


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("robots", type=Path)
    arguments.add_argument("--write", action="store_true")
    given = arguments.parse_args()
    rows = [row(given.robots, path) for path in sorted(given.robots.rglob("*.urdf"))]
    head = ["File", "Status", "K, Γ in 1/s, estimate", "End, s", "Trials", "Remarks"]
    cells = [head, ["---"] * len(head)] + [cells for cells, _ in rows]
    count = lambda status: sum(cells[1] == status for cells, _ in rows)
    table = (
        "# What `forwardstep new` makes of robots that other people wrote\n\n"
        "Three of each on a ring with a delay of 0.2 s; written by `new.py --write`, explained in [README.md](README.md).\n\n"
        f"**{count('agrees')} agree, {count('does not agree')} do not and say why, "
        f"{count('no scenario')} cannot be simulated.**\n\n"
        + "".join(f"| {' | '.join(cell.replace('|', '¦') for cell in line)} |\n" for line in cells)
    )
    wrong = [cells for cells, wrong in rows if wrong]
    if given.write:
        TABLE.write_text(table)
    elif table != TABLE.read_text():
        wrong.append("the table differs from new.md")
    for line in wrong:
        print(line)
    raise SystemExit(1 if wrong else 0)


if __name__ == "__main__":
    main()
