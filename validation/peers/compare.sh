#!/usr/bin/env bash
# Every benchmark beside its peer, in one run on one machine: the Slotine-Li step beside Pinocchio, rings beside jitcdde.
# Makes a Python environment under target/peers, where nothing is committed. Usage: compare.sh [rounds]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
environment="$root/target/peers/environment"
if [ ! -x "$environment/bin/python" ]; then
    python3 -m venv "$environment"
    "$environment/bin/pip" install --quiet -r "$here/requirements.txt"
    "$environment/bin/pip" install --quiet -r "$here/../pinocchio/requirements.txt"
fi
grep -m1 'model name' /proc/cpuinfo || true
"$environment/bin/python" "$here/slotine_li.py" "${1:-5}"
"$environment/bin/python" "$here/ring.py" "${1:-3}"
