#!/usr/bin/env bash
# Set up, build with warnings as errors, run every test.
#
#    bash tests/run.sh [--preset NAME] [options of ctest]
#
# For example `-L unit` for the unit tests alone, `-R plate` for tests of that name, `-N` to list
# them. With `--preset coverage` the lines that ran are counted afterwards: build/coverage.html.
set -euo pipefail

# shellcheck source=setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

preset=release
if [ "${1:-}" = --preset ]; then
   preset=${2:?--preset needs a name}
   shift 2
fi
ensure_all "$preset" -DXMPM_STRICT=ON -DXMPM_TESTS=ON
cd "$xmpm_root"
status=0
ctest --preset "$preset" --parallel "$(nproc)" "$@" || status=$?
if [ "$preset" = coverage ]; then
   "$XMPM_VENV/bin/gcovr" --config tests/gcovr.cfg
fi
exit "$status"
