#!/usr/bin/env bash
# A closed crack slips as Coulomb says, with the K_II of it on any number of ranks, and stays shut;
# without contact its faces overlap, which is told once. K of a crack in tension is the same with contact and without.
# ranks: 2
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

sed 's/contact = friction, friction = 0.3/contact = frictionless/' "$here/deck.inp" >free.inp
sed '/contact = friction/d' "$here/deck.inp" >none.inp
sed 's/stress = .*/stress = 0 100 0 0 0 0/' "$here/deck.inp" >tension.inp
sed 's/stress = .*/stress = 0 100 0 0 0 0/' none.inp >untouched.inp
run_deck "$ranks" friction
run_deck 1 one
run_deck "$ranks" free free.inp
run_deck "$ranks" none none.inp >none.txt 2>&1
run_deck "$ranks" tension tension.inp
run_deck "$ranks" untouched untouched.inp
PYTHONPATH=$here/../../../postproc "${XMPM_PYTHON:-python3}" - <<'PYTHON' || failed=1
import sys

import numpy as np

from xmpm_post import open_run

met, free, none = (open_run(name).crack().fields["opening"] for name in ("friction", "free", "none"))
ratio = np.abs(met[:, 0]).max() / np.abs(free[:, 0]).max()
tension, untouched = (open_run(name).front["K_I"] for name in ("tension", "untouched"))
shear, one, plain = (open_run(name).front for name in ("friction", "one", "free"))
k_two = np.abs(shear["K_II"]).mean() / np.abs(plain["K_II"]).mean()
rows = (
    ("slip over the frictionless one", abs(ratio / 0.5 - 1), 0.03),  # (tau - mu p) / tau = 0.5
    ("K_II over the frictionless one", abs(k_two / 0.5 - 1), 0.05),  # likewise
    ("K_II on 2 ranks, off that on 1", np.abs(shear["K_II"] / one["K_II"] - 1).max(), 1e-9),  # rounding
    ("overlap in cells", -met[:, 1].min() / 2, 1e-3),
    ("opening in cells", met[:, 1].max() / 2, 1e-3),
    ("K_I of closed faces over K_II", np.abs(shear["K_I"] / shear["K_II"]).max(), 0.01),
    ("K_I in tension, with contact over without", np.abs(tension / untouched - 1).max(), 1e-6),
    ("without contact: overlap, inverse", 1e-3 * 2 / -none[:, 1].min(), 1),
)
for name, value, limit in rows:
    print(f"{'ok    ' if value < limit else 'FAILED'} {name}: {value:.3g}, limit {limit}")
sys.exit(not all(value < limit for _, value, limit in rows))
PYTHON
expect_text none/slab.log "warning: the faces of crack slit overlap by" 'its contact is off'
if [ "$(grep -c 'overlap by' none/slab.log)" -ne 1 ] || grep -q 'overlap by' friction/slab.log; then
   echo 'FAILED the warning must come once, and not where contact is on'
   failed=1
fi
finish
