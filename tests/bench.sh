#!/usr/bin/env bash
# Speed, memory and the cost of cracks.
#
#    bash tests/bench.sh [CASE ...] [--pairs N] [--list]
#
# Builds the presets native and release, measures the named cases or all, prints a table and writes
# benchmark.csv. Keep the machine quiet meanwhile.
set -euo pipefail

# shellcheck source=setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

case " $* " in
   *' --list '* | *' --help '* | *' -h '*)
      if [ ! -x "$XMPM_PYTHON" ]; then ensure_all release; fi
      ;;
   *)
      ensure_all native
      ensure_all release
      cmake --build "$xmpm_root/build/native" --target triad >/dev/null
      ;;
esac
export PYTHONPATH=$xmpm_root/tests${PYTHONPATH:+:$PYTHONPATH}
exec "$XMPM_PYTHON" -m bench "$@"
