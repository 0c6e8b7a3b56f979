#!/usr/bin/env bash
# Explains every shipped scenario and hands the LaTeX to KaTeX and Temml, and to pdflatex if it is on PATH. Needs node and a network.
#
#   validation/formulas/check.sh target/release/forwardstep
set -euo pipefail

[ $# = 1 ] || { echo "usage: $0 FORWARDSTEP" >&2; exit 2; }
program=$(realpath "$1")
folder=$(realpath "$(dirname "$0")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$folder"/package.json "$folder"/package-lock.json "$folder"/check.mjs "$work"
(cd "$work" && npm ci --silent --no-audit --no-fund)
names=$("$program" scenarios | awk '/^[a-z0-9]/ { print $1 }')
for name in $names; do
  "$program" explain "$name" --json >"$work/$name.json"
done
failed=0
node "$work/check.mjs" $(printf "$work/%s.json " $names) || failed=1
if command -v pdflatex >/dev/null; then
  for name in $names; do
    {
      echo '\documentclass{article}\usepackage[utf8]{inputenc}\usepackage{amsmath}\begin{document}'
      "$program" explain "$name" --latex
      echo '\end{document}'
    } >"$work/$name.tex"
    if ! (cd "$work" && pdflatex -interaction=nonstopmode -halt-on-error "$name.tex" >"$name.out"); then
      echo "FAILED $name: $(grep -m1 '^!' "$work/$name.out")"
      failed=1
    fi
  done
  echo "pdflatex: $(ls "$work"/*.pdf | wc -l) documents"
fi
exit $failed
