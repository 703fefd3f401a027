#!/usr/bin/env bash
# Every example of section 5 of doi:10.1002/nme.6653: prepare, run, compare with its reference.
#
#    bash input/reproduce.sh [CASE ...] [--full | --coarse] [--list] [--ranks N] [--output FOLDER]
#
# Builds the program for this machine (preset native) and runs the named cases or all. Figures and
# a table of errors and costs go to doc/reproduction, the runs to results/reproduction. All of them
# take less than 40 minutes on two cores; --full takes the paper's sizes, which is hours.
set -euo pipefail

# shellcheck source=../tests/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/../tests/setup.sh"

case " $* " in
   *' --list '* | *' --help '* | *' -h '*) ;;
   *) if [ -z "${XMPM3D:-}" ]; then ensure_all native; fi ;;
esac
export XMPM3D=${XMPM3D:-$xmpm_root/build/native/bin/xmpm3d}
for folder in preproc postproc tests input; do
   PYTHONPATH=$xmpm_root/$folder${PYTHONPATH:+:$PYTHONPATH}
done
export PYTHONPATH
if [ ! -x "$XMPM_PYTHON" ]; then ensure_all native; fi
exec "$XMPM_PYTHON" -m reproduction "$@"
