#!/usr/bin/env bash
# Shape functions, schemes, transfers and front rules run on a cracked plate, each with the error of
# its energy balance (mean of the last tenth); what XPIC, a part of PIC and USL lose stands in the
# column `transfer`. Schemes open the crack alike.
# ranks: 1
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

# try SHAPE SCHEME TRANSFER FRONT LIMIT LOST: LOST is the least share of the work that the transfers
# must have taken, `none` where they may take nothing.
try() {
   local lost='energy["transfer"][-1] > 0' part=$6
   sed "s/shape = linear/shape = $1/; s/scheme = musl/scheme = $2/; s/transfer = flip/transfer = $3/
      s/front = graded/front = $4/" "$here/deck.inp" >choice.inp
   if [ "$3" = pic ]; then
      sed -i 's/transfer = pic/transfer = flip/; s/^\*OUTPUT/*DAMPING pic = 200\n*OUTPUT/' choice.inp
   fi
   if [ "$part" = none ]; then
      lost='energy["transfer"].any()'
      part=0
   else
      lost="energy[\"transfer\"][-1] > $part*energy[\"external\"][-1]"
      part=1
   fi
   run_deck "$ranks" "$1-$2-$3-$4" choice.inp
   compare check "$1-$2-$3-$4/plate" <<TABLE
$1 $2 $3 $4: balance | np.mean(energy["relative_error"][-4:]) | 0 | $5 | energy is conserved
$1 $2 $3 $4: losses | $lost | $part | 0 | of the transfers
TABLE
}

# alike SHAPE SCHEME TOLERANCE: largest opening within the plate against MUSL's
alike() {
   compare check "$1-$2-flip-graded/plate" "$1-musl-flip-graded/plate" <<TABLE
$1 $2: opening over that of musl | $(opening crack)/$(opening other_crack) | 1 | $3 | one method in three orders
TABLE
}

opening() {
   echo "np.linalg.norm($1[\"opening\"][abs($1[\"x\"][:, 2]) < 2], axis=1).max()"
}

# Balance with FLIP is 0.002 to 0.003 on 2026-11-22, with XPIC 0.001, with USL 0.003 to 0.009 (its
# loss is taken at the start of a step alone); openings differ by 0.0003 (USF) and 0.02 (USL).
for front in graded node full cut; do
   try linear musl flip "$front" 0.005 none
   try gimp musl flip "$front" 0.005 none
done
for shape in linear gimp; do
   try "$shape" usf flip graded 0.005 none
   try "$shape" usl flip graded 0.015 0.05
   alike "$shape" usf 0.002
   alike "$shape" usl 0.06
   try "$shape" musl xpic graded 0.005 0.05
   try "$shape" usl xpic graded 0.015 0.05
done
# Corrected inertia: 0.006 to 0.007 on 2026-11-22, since the first half of a load's work is taken with
# the velocity as it was.
for shape in linear gimp; do
   try "$shape" 'musl, inertia = corrected' flip graded 0.01 none
done
try linear usf xpic graded 0.005 0.05
try linear musl pic graded 0.005 0.05

# A thick plate without a crack whose faces lie on planes of nodes: next to no mass reaches the nodes
# beyond them, and GIMP gives these nodes any velocity. The work of the loads must not take part in
# that: at every row the balance is within 0.017 of the largest energy so far (on 2026-11-22).
sed '/^\*CRACK/,+2d; s/shape = linear/shape = gimp/; s/-16 -2  24 16 2/-16 -8  24 16 8/
   s/, crack = opening//; s/end = 0.02/end = 0.04/' "$here/deck.inp" >thick.inp
run_deck "$ranks" thick thick.inp
compare check thick/plate <<'TABLE'
thick plate, faces on node planes: worst balance | abs(energy["relative_error"]).max() | 0 | 0.025 | energy is conserved
thick plate, faces on node planes: balance | np.mean(energy["relative_error"][-8:]) | 0 | 0.005 | energy is conserved
TABLE
finish
