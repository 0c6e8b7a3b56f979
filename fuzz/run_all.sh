#!/usr/bin/env bash
# Runs all fuzzers side by side: run_all.sh SECONDS [FOLDER]. Exits with 1 if any of them found anything.
#
# Logs, and inputs that were found, go to FOLDER (fuzz/runs). SANITIZER=address builds with that sanitizer; NICE is how much
# the fuzzers give way to others (19).
set -euo pipefail

seconds=${1:?usage: run_all.sh SECONDS [FOLDER]}
cd "$(dirname "$0")"
mkdir -p "${2:-runs}"
folder=$(cd "${2:-runs}" && pwd)
sanitizer=${SANITIZER:-none}
targets=(scenario urdf csv state mesh)

./seeds.sh
nice -n 5 cargo +nightly fuzz build --fuzz-dir . --sanitizer "$sanitizer"
bin=target/$(rustc +nightly -vV | sed -n 's/^host: //p')/release

# How often a fuzzer failed; the inputs that it failed on stand beside.
failures() { find "$folder/$1" -name 'failure-*' | wc -l; }

# They write thousands of files per second: in memory, where there is such a place.
[ -d /dev/shm ] && TMPDIR=/dev/shm
TMPDIR=$(mktemp -d -t forwardstep-fuzz-XXXXXX)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

# Runs one fuzzer until the time is over. It stops at what it finds, so it begins again.
fuzz() {
  local target=$1 found=$folder/$1 log=$folder/$1.log end=$((SECONDS + seconds)) left
  mkdir -p "$found" "corpus/$target"
  rm -f "$found"/*
  : >"$log"
  while left=$((end - SECONDS)) && [ "$left" -gt 0 ] && [ "$(failures "$target")" -lt 20 ]; do
    # Slow inputs are found by the processor time they take; the timeout is for those that never end.
    nice -n "${NICE:-19}" "$bin/$target" "corpus/$target" "seeds/$target" -dict="seeds/$target.dict" -artifact_prefix="$found/" \
      -max_len=16384 -timeout=120 -rss_limit_mb=3000 -max_total_time="$left" -print_final_stats=1 >>"$log" 2>&1 ||
      printf 'exit status %d\n' $? >"$found/failure-$(date +%s%N)"
  done
}

children=()
trap 'kill "${children[@]}" 2>/dev/null || true' INT TERM
for target in "${targets[@]}"; do
  fuzz "$target" &
  children+=($!)
done
wait

status=0
for target in "${targets[@]}"; do
  runs=$(grep -c 'stat::number_of_executed_units' "$folder/$target.log" || true)
  executed=$(sed -n 's/^stat::number_of_executed_units: *//p' "$folder/$target.log" | paste -sd+ | bc)
  found=$(failures "$target")
  printf '%-10s %12s inputs, %d found, log %s\n' "$target" "${executed:-0}" "$found" "$folder/$target.log"
  # A fuzzer that never ran has shown nothing.
  if [ "$found" -gt 0 ] || [ "$runs" -eq 0 ] || [ "${executed:-0}" -eq 0 ]; then
    status=1
  fi
done
exit "$status"
