#!/usr/bin/env bash
# The mirror image of a deck gives the mirror image of the results, for each of the three mirrors.
# ranks: 1 2
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

run_deck "$ranks" plain
for axis in x y z; do
   sed "s/s$axis = 1/s$axis = -1/" "$here/deck.inp" >"$axis.inp"
   if [ "$axis" = x ]; then sed -i 's/slab:+x/slab:-x/' x.inp; fi
   run_deck "$ranks" "$axis" "$axis.inp"
   echo "mirror $axis"
   compare mirror plain/slab "$axis/slab" "$axis" 1e-10
done
finish
