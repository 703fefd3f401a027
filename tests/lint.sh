#!/usr/bin/env bash
# All linters: layout and house rules of Fortran, fortitude, ruff, shellcheck.
# The tools come from the project's Python (tests/setup.sh). `--fix` lays the sources out.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
tools=${XMPM_VENV:-$root/.venv}/bin
cd "$root"
if [ ! -x "$tools/python" ]; then
   echo "lint: no Python in ${tools%/bin}; run: bash tests/setup.sh" >&2
   exit 1
fi
fix=()
format=(--check --diff)
if [ "${1:-}" = --fix ]; then
   fix=(--fix)
   format=()
fi

python_folders=()
for folder in preproc postproc tests input; do
   if [ -d "$folder" ]; then python_folders+=("$folder"); fi
done
mapfile -d '' shell_files < <(find "${python_folders[@]}" .ci -name '*.sh' -print0 -o -path .ci/run -print0)

failed=0
run() {
   echo "== $1"
   "${@:2}" || failed=1
}
run fortitude "$tools/fortitude" check --quiet --output-format concise "${fix[@]}" src tests
run 'Fortran layout and house rules' "$tools/python" tests/lint/fortran.py "${fix[@]}"
run 'ruff check' "$tools/ruff" check --quiet --no-cache "${fix[@]}" "${python_folders[@]}"
run 'ruff format' "$tools/ruff" format --quiet --no-cache "${format[@]}" "${python_folders[@]}"
run shellcheck "$tools/shellcheck" --external-sources --source-path=SCRIPTDIR "${shell_files[@]}"

if [ "$failed" -ne 0 ]; then
   echo 'lint: faults found (see above); layout is mended by: bash tests/lint.sh --fix' >&2
   exit 1
fi
echo 'lint: no faults'
