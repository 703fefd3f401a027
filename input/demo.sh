#!/usr/bin/env bash
# The one-crack plate on two ranks, from nothing: set up, build, run, draw one picture.
#
#    bash input/demo.sh
#
# The second time it installs and builds nothing. Results go to results/plate-1.
set -euo pipefail

# shellcheck source=../tests/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/../tests/setup.sh"

ensure_all release
program=$xmpm_root/build/release/bin/xmpm3d
results=$xmpm_root/results/plate-1
mkdir -p "$results"

say "running input/plate-1.inp on 2 ranks"
mpirun -n 2 "$program" -o "$results" <"$xmpm_root/input/plate-1.inp"

say 'drawing the displacement jump across the crack'
"$XMPM_VENV/bin/xmpm-post" jump "$results/plate-1" -o "$results/plate-1_jump.png"

say 'result files:'
find "$results" -maxdepth 1 -type f | sort
say 'picture of the displacement jump:'
echo "$results/plate-1_jump.png"
