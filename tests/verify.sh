#!/usr/bin/env bash
# Cases against reference solutions: accuracy and cost on one line.
#
#    bash tests/verify.sh [CASE ...] [--full] [--jobs N] [--list]
#
# Builds the program for this machine (preset native), runs the named cases or all, prints a table
# and writes verification.csv. As many cases run at a time as there are cores. Ends with 1 where an error passes its limit or a run fails. --full
# adds the sizes that take hours.
set -euo pipefail

# shellcheck source=setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

case " $* " in
   *' --list '* | *' --help '* | *' -h '*) ;;
   *) if [ -z "${XMPM3D:-}" ]; then ensure_all native; fi ;;
esac
export XMPM3D=${XMPM3D:-$xmpm_root/build/native/bin/xmpm3d}
export PYTHONPATH=$xmpm_root/tests${PYTHONPATH:+:$PYTHONPATH}
if [ ! -x "$XMPM_PYTHON" ]; then ensure_all native; fi
exec "$XMPM_PYTHON" -m verify "$@"
