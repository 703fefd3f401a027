#!/usr/bin/env bash
# Set up, build with warnings as errors, run every test: the unit tests in the debug build with all
# run-time checks, then everything in the release build.
#
#    bash tests/run.sh [--preset NAME] [options of ctest]
#
# With arguments one build alone is tested (release unless named), and ctest gets the options: for
# example `-L unit` for the unit tests alone, `-R plate` for tests of that name, `-N` to list
# them. With `--preset coverage` the lines that ran are counted afterwards: build/coverage.html.
set -euo pipefail

# shellcheck source=setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

preset=release
checked=no
if [ "$#" -eq 0 ]; then checked=yes; fi
if [ "${1:-}" = --preset ]; then
   preset=${2:?--preset needs a name}
   shift 2
fi
cd "$xmpm_root"
status=0
if [ "$checked" = yes ]; then
   ensure_all debug -DXMPM_STRICT=ON -DXMPM_TESTS=ON
   say 'unit tests with all run-time checks (build/debug)'
   ctest --preset debug --parallel "$(nproc)" -L unit || status=$?
fi
ensure_all "$preset" -DXMPM_STRICT=ON -DXMPM_TESTS=ON
say "tests of build/$preset"
ctest --preset "$preset" --parallel "$(nproc)" "$@" || status=$?
if [ "$preset" = coverage ]; then
   "$XMPM_VENV/bin/gcovr" --config tests/gcovr.cfg
fi
exit "$status"
