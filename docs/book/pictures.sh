#!/usr/bin/env bash
# Draws the pictures of the book again: `docs/book/pictures.sh PROGRAM`, from the root of the repository.
set -euo pipefail
program=${1:?the program, such as target/release/forwardstep}
pictures=$(cd "$(dirname "$0")" && pwd)/src/pictures
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$program" scenarios | cut -d " " -f 1 | while read -r scenario; do
  "$program" run "$scenario" --out "$scratch/$scenario" >"$scratch/log" </dev/null
  cp "$scratch/$scenario/plots/disagreement.svg" "$pictures/$scenario.svg"
done
python3 "$(dirname "$0")/space.py" "$program" >"$scratch/log"
