#!/usr/bin/env bash
# Opens reports in a headless chromium from PATH, and fails unless every plot is drawn and nothing goes wrong.
#
#   cargo run --release -p forwardstep-io --example sample_reports -- target/samples
#   validation/browser/check_report.sh target/samples/*/report.html
#
# With --shipped and the program, runs every shipped scenario, has its report built anew from its tables, which must not change
# a byte, and looks at that:
#
#   validation/browser/check_report.sh --shipped target/release/forwardstep
set -euo pipefail

chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
  echo "no chromium on PATH" >&2
  exit 2
}
[ $# -gt 0 ] || { echo "usage: $0 report.html ... | --shipped FORWARDSTEP" >&2; exit 2; }

profile=$(mktemp -d)
runs=$(mktemp -d)
trap 'rm -rf "$profile" "$runs"' EXIT
failed=0
if [ "$1" = --shipped ]; then
  [ $# = 2 ] || { echo "usage: $0 --shipped FORWARDSTEP" >&2; exit 2; }
  program=$(realpath "$2")
  set --
  for name in $("$program" scenarios | awk '/^[a-z0-9]/ { print $1 }'); do
    report=$runs/$name/report.html
    "$program" run "$name" --out "$runs/$name" >/dev/null
    mv "$report" "$runs/written.html"
    "$program" report "$runs/$name" >/dev/null
    cmp "$report" "$runs/written.html" || { echo "FAILED $name: the report built anew differs"; failed=1; }
    set -- "$@" "$report"
  done
  [ $# -gt 0 ] || { echo "$program lists no scenarios" >&2; exit 2; }
fi
for report in "$@"; do
  rm -rf "${profile:?}"/*
  dom=$profile/dom.html
  log=$profile/log.txt
  "$chromium" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --enable-unsafe-swiftshader --user-data-dir="$profile/data" --window-size=1280,2000 \
    --virtual-time-budget=8000 --enable-logging=stderr --dump-dom "file://$(realpath "$report")" >"$dom" 2>"$log"
  canvases=$(grep -oE 'class="(u-wrap|plane|plane turns)"' "$dom" | wc -l)
  plots=$(grep -o 'data-ready="[0-9]*"' "$dom" | grep -o '[0-9]*' || echo none)
  words=$(grep -o '<p class="none">[^<]*' "$dom" | wc -l || true)
  problem=""
  [ "$plots" != none ] || problem="the script did not finish"
  [ "$canvases" = "$plots" ] || problem="$canvases canvases for $plots plots"
  [ $((canvases + words)) -ge 5 ] || problem="only $canvases plots and $words explanations"
  grep -q '<div id="error-banner" role="alert"></div>' "$dom" || problem="the error banner is not empty"
  # Remarks of the graphics driver are none of the page.
  said=$(grep CONSOLE "$log" | grep -v 'GL Driver Message\|GroupMarkerNotSet' | head -n 1 || true)
  [ -z "$said" ] || problem="console: $said"
  if [ -n "$problem" ]; then
    echo "FAILED $report: $problem"
    failed=1
  else
    echo "ok     $report: $canvases plots, $words cards without"
  fi
done
exit $failed
