#!/usr/bin/env bash
# What is wrong with a growth: in the deck exit code 2 with the line, in the run exit code 3 with
# the place and a last output that shows it.
# ranks: 1
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

program=${XMPM3D:-xmpm3d}

# refused TEXT SED-EXPRESSION: the changed deck is refused at its *GROWTH with a text.
refused() {
   sed "$2" "$here/deck.inp" >wrong.inp
   expect_code 2 "$program" --quiet -o wrong wrong.inp
   expect_text complaint 'wrong.inp:' "$1"
}
mkdir -p wrong
refused "the crack 'slit' has no front inside the material" \
   's/centre = -8 0 0/centre = -40 0 0/; s/^\*FRACTURE.*//; s/^\*GROWTH.*/*GROWTH criterion = straight, law = speed, speed = 1/'
refused "the crack 'slit' has no front inside the material" 's/centre = -8 0 0/centre = -40 0 0/'
refused "enters a body without a toughness at" 's/centre = -8 0 0/centre = -1 0 0/'
refused "the crack 'slit' grows already by another *GROWTH" \
   's/^\*GROWTH.*/*GROWTH cracks = slit\n*GROWTH cracks = slit/'

refused "no strip can be drawn so near: at least 1.5" 's/^\*GROWTH.*/*GROWTH cracks = slit, meeting = 1.4/'

# stopped NAME TEXT...: the run ends with exit code 3 and these texts.
stopped() {
   mkdir -p "$1"
   expect_code 3 "$program" --quiet -o "$1" "$2"
   expect_text complaint "${@:3}"
}
stopped faults "$here/deck.inp" "the crack 'slit' enters a body without a toughness at" 'step '
compare check faults/faults <<'TABLE'
tip in the last output | crack["x"][:,0].max() | 2.25 | 0.3 | where the second body begins, and an increment
TABLE
stopped horseshoe "$here/horseshoe.inp" 'growth found no valid triangles' "crack 'shoe'" 'step '
compare check horseshoe/horseshoe <<'TABLE'
gap of the limbs in the last output | np.abs(crack["x"][crack["x"][:,1] > 0, 0]).min() | 0.3 | 0.3 | less than an increment is left
TABLE
finish
