"""Forged tables, summaries and journals in number, given to `forwardstep report`.

    forged.py [--number 10000] [--seed 1] [--side-by-side 2]

A small run is made, and one of some seconds that is killed. Of their table, their
summary and their journal mutants are made: bytes changed, lengths made large, pieces
cut out, doubled or exchanged, words of terminals written into texts. `report` then
has 2 GB and 20 s of the processor for each, and must end by itself: without a panic,
without a signal, with nothing that steers a terminal, and never with an exit status
that is not 0, 1, 2 or 3.
"""

import argparse
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
BINARY = Path(os.environ.get("FORWARDSTEP", HERE.parent.parent / "target" / "release" / "forwardstep")).resolve()
SMALL = """format = 2
title = "Carts"
time = { end_s = 1, record_every_s = 0.1 }
[[agents]]
name = "cart"
count = 2
robot.point_mass = { dimension = 1, mass_kg = 2 }
start.position_m = [[0], [1]]
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position_velocity"
[network]
delay.constant_s = 0.1
edges = [["cart-1", "cart-2"], ["cart-2", "cart-1"]]
"""
STEERS = re.compile(rb"[\x00-\x08\x0b-\x1f\x7f]|\xe2\x80[\x8e\x8f\xaa-\xae]|\xe2\x81[\xa6-\xa9]|\xc2[\x80-\x9f]")
WORDS = [b"\x1b]0;mine\x07", b"\x1b[2J", "\u202e".encode(), b"\r\n", b"\x00", b"\\u001b[2J", b"\\u202e", b"1e999", b"-1", b"null"]
LARGE = [b"\xff" * 4, b"\x7f" * 8, b"\xff" * 8, b"\x00" * 8, (1 << 31).to_bytes(4, "little"), (1 << 40).to_bytes(8, "little")]


def program(*arguments, **how):
    return subprocess.run([BINARY, *arguments], capture_output=True, **how)


def mutant(bytes_, draw):
    """The same with one to four changes."""
    data = bytearray(bytes_)
    for _ in range(draw.choice([1, 1, 2, 4])):
        if not data:
            break
        # Footers and heads have most of what is believed.
        near = draw.choice([0, len(data), None])
        at = draw.randrange(len(data)) if near is None else min(max(near + draw.choice([1, -1]) * draw.randrange(600), 0), len(data) - 1)
        length = draw.choice([1, 2, 4, 8, 30, 200])
        match draw.randrange(8):
            case 0:
                data[at] ^= 1 << draw.randrange(8)
            case 1:
                data[at : at + length] = draw.randbytes(length)
            case 2:
                piece = draw.choice(LARGE)
                data[at : at + len(piece)] = piece
            case 3:
                del data[at : at + length]
            case 4:
                data[at:at] = data[at : at + length]
            case 5:
                del data[at:]
            case 6:
                piece = draw.choice(WORDS)
                data[at : at + draw.choice([0, len(piece)])] = piece
            case 7:
                other = draw.randrange(len(data))
                data[at : at + length], data[other : other + length] = data[other : other + length], data[at : at + length]
    return bytes(data)


def limits():
    resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))
    resource.setrlimit(resource.RLIMIT_CPU, (20, 20))


def one(number, seed, seeds, folder):
    """Forges one file of one run; which, what `report` made of it, and what is wrong with that."""
    draw = random.Random(f"{seed}-{number}")
    source, name = seeds[number % len(seeds)]
    own, out = folder / f"forged-{number}", folder / f"out-{number}"
    shutil.copytree(source, own)
    (own / name).write_bytes(mutant((own / name).read_bytes(), draw))
    done = program("report", own, "--out", out, preexec_fn=limits)
    said, wrong = done.stdout + done.stderr, []
    # Written files may quote what they like, in their own escapes: they are not looked at here.
    if done.returncode not in (0, 1, 2, 3):
        wrong.append(f"status {done.returncode}")
    if b"panicked" in said or b"RUST_BACKTRACE" in said:
        wrong.append("panic")
    if STEERS.search(said):
        wrong.append("steers a terminal")
    if wrong:
        keep = Path(os.environ.get("FORGED_KEEP", tempfile.gettempdir())) / f"forged-{seed}-{number}"
        shutil.rmtree(keep, ignore_errors=True)
        shutil.copytree(own, keep)
        wrong.append(said[-300:].decode(errors="backslashreplace"))
    shutil.rmtree(own)
    shutil.rmtree(out, ignore_errors=True)
    return name, done.returncode, wrong


def cut_off(folder):
    """The folder of a run that was killed, with a journal of a few frames."""
    text = (HERE / "long.toml.in").read_text().replace("SECONDS", "1000")
    (folder / "long.toml").write_text(text)
    out = folder / "cut"
    with subprocess.Popen([BINARY, "run", folder / "long.toml", "--out", out], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
        until = time.monotonic() + 120
        journal = out / "rows.journal"
        first = None
        while time.monotonic() < until and (first is None or journal.stat().st_size < first + 20_000):
            time.sleep(0.1)
            if first is None and journal.exists():
                first = journal.stat().st_size
        run.send_signal(signal.SIGKILL)
    return out


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--number", type=int, default=10_000)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--side-by-side", type=int, default=2)
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "carts.toml").write_text(SMALL)
        program("run", folder / "carts.toml", "--out", folder / "carts", check=True)
        cut = cut_off(folder)
        seeds = [(folder / "carts", "trajectory.parquet"), (cut, "rows.journal"), (folder / "carts", "summary.json"), (cut, "rows.journal")]
        with ThreadPoolExecutor(given.side_by_side) as pool:
            results = list(pool.map(lambda number: one(number, given.seed, seeds, folder), range(given.number)))
    failed = 0
    for number, (name, _, wrong) in enumerate(results):
        if wrong:
            failed += 1
            print(f"{name} {number}: {'; '.join(wrong)}")
    per_file = Counter(name for name, *_ in results)
    accepted = sum(status == 0 for _, status, _ in results)
    counts = ", ".join(f"{count} of {name}" for name, count in per_file.items())
    print(f"{counts}; {accepted} shown all the same, {len(results) - accepted} refused; {failed} wrong")
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
