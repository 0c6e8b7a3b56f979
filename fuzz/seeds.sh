#!/usr/bin/env bash
# Writes fuzz/seeds: every text that the tests of crates/io read, the shipped scenarios and robots, meshes, and dictionaries.
set -euo pipefail
cd "$(dirname "$0")/.."
seeds=$PWD/fuzz/seeds

rm -rf "$seeds"
mkdir -p "$seeds"/{scenario,urdf,csv,state,mesh}
# The tables of malformed inputs hand all they read to the folder. Properties read random texts, which are no better than
# those the fuzzers make.
FORWARDSTEP_SEEDS=$seeds cargo test --quiet --release --package forwardstep-io \
  --test all -- scenario:: urdf:: state:: --skip prop_ >"$seeds/log" 2>&1 || {
  cat "$seeds/log" >&2
  exit 1
}
cp crates/io/scenarios/*.toml fuzz/tables/*.toml "$seeds/scenario"
cp crates/io/robots/*.urdf fuzz/two-joints.urdf "$seeds/urdf"
# The first byte says how a mesh is read.
for mesh in fuzz/meshes/*; do
  case $mesh in *.stl) format=0 ;; *.obj) format=1 ;; *) format=2 ;; esac
  { printf %s "$format" && cat "$mesh"; } >"$seeds/mesh/$(basename "$mesh")"
done
# A binary STL of one triangle: a head of 80 bytes, the number of triangles, twelve numbers, two bytes.
{ printf '0%80s\1\0\0\0' && printf '\0\0\200\77%.0s' {1..4} && printf '\0%.0s' {1..16} && printf '\0\0\0\100%.0s' {1..4} && printf '\0\0'; } \
  >"$seeds/mesh/binary.stl"

# Words in quotation marks, one per line, are a dictionary: those of the schema, and those in the reader's source.
words() { grep -ohE '"[A-Za-z][A-Za-z0-9_:-]{0,40}"' "$@" | sort -u; }
cargo run --quiet --release --package forwardstep -- schema | words >"$seeds/scenario.dict"
words crates/io/src/urdf/*.rs >"$seeds/urdf.dict"
words crates/io/src/scenario/*.rs >"$seeds/csv.dict"
words crates/io/src/shapes/collada.rs >"$seeds/mesh.dict"
printf '%s\n' '"\"q\":"' '"\"dq\":"' '"\"z\":"' '"\"dz\":"' '"\"shoulder\":{"' '"\"elbow\":{"' >"$seeds/state.dict"

for kind in scenario urdf csv state mesh; do
  count=$(find "$seeds/$kind" -type f | wc -l)
  printf '%s: %d seeds, %d words\n' "$kind" "$count" "$(wc -l <"$seeds/$kind.dict")"
  [ "$count" -ge 5 ]
done
