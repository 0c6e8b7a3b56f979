#!/usr/bin/env bash
# Draws the pictures of the book again: `docs/book/pictures.sh PROGRAM`, from the root of the repository.
set -euo pipefail
program=${1:?the program, such as target/release/forwardstep}
pictures=$(cd "$(dirname "$0")" && pwd)/src/pictures
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for scenario in theorem-1 theorem-2 theorem-3-a5-order-3 theorem-4 theorem-5 theorem-6 theorem-7 theorem-8 theorem-9; do
  "$program" run "$scenario" --out "$scratch/$scenario" >"$scratch/log"
  cp "$scratch/$scenario/plots/disagreement.svg" "$pictures/$scenario.svg"
done
