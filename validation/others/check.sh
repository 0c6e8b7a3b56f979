#!/usr/bin/env bash
# Every URDF of the package example-robot-data, in forwardstep and in Pinocchio. Makes a Python environment under
# target/others, where nothing is committed; needs a network the first time. Usage: check.sh [--write]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
environment="$root/target/others/environment"
if [ ! -e "$environment/complete" ]; then
    python3 -m venv "$environment"
    "$environment/bin/pip" install --quiet --require-hashes -r "$here/requirements.txt"
    touch "$environment/complete"
fi
# With FORWARDSTEP a program that is built already.
[ -n "${FORWARDSTEP:-}" ] || cargo build --release --quiet --manifest-path "$root/Cargo.toml" -p forwardstep
"$environment/bin/python" "$here/check.py" ${FORWARDSTEP:+--binary "$FORWARDSTEP"} "$@"
