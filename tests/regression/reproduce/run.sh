#!/usr/bin/env bash
# input/reproduce.sh lists its cases, refuses others, and runs one at its coarsest: numbers, figures, a page.
# ranks: 1
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

reproduce=$here/../../../input/reproduce.sh
rm -rf page runs
bash "$reproduce" --list >list.txt
expect_text list.txt plates cylinder bar bending eccentric rod tube
expect_code 2 bash "$reproduce" bridge
expect_text complaint "no case bridge; there are: plates"
bash "$reproduce" rod --coarse --ranks "$ranks" --output page --work runs
expect_text page/results.csv 'rod,coarse,5,' 'shear modes in G half-way'
expect_text page/README.md '## 5.3.2: square rod' '| 5 | shear modes in G half-way' \
   '(rod-surface-coarse.png)' 'Where and why we differ'
"${XMPM_PYTHON:-python3}" - <<'PYTHON' || failed=1
import csv
import sys

with open("page/results.csv", encoding="utf-8") as file:
    found = {row["quantity"].split(";")[0]: float(row["value"]) for row in csv.DictReader(file)}
# The crack starts with a third of its energy in shear, and must have turned to mode I.
before, later = found["shear modes in G before growth"], found["shear modes in G half-way"]
print(f"shear modes in G: {before:.3g} before growth, {later:.3g} half-way")
sys.exit(not (before > 0.2 and later < 0.05))
PYTHON
for figure in surface modes; do
   [ -s "page/rod-$figure-coarse.png" ] || { echo "FAILED no figure rod-$figure"; failed=1; }
done
finish
