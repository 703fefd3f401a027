#!/usr/bin/env bash
# Every example of input/, with cracks prepared from its geometry and large cells, takes five steps.
# The deck's own shapes give the same fronts; tests/python/test_prep_examples.py measures them.
# ranks: 2
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

input=$here/../../../input
rm -rf prepared
"${XMPM_PYTHON:-python3}" "$input/prepare.py" --coarse -o prepared

# fronts LOG: cracks with the numbers of their fronts.
fronts() {
   sed -n 's/^crack \([^:]*\): .* front points in \([0-9]*\) fronts.*/\1 \2/p' "$1"
}

for folder in prepared/*; do
   name=${folder##*/}
   echo "$name"
   (cd "$folder" && run_deck "$ranks" run "$name.inp")
   compare check "$folder/run/$name" <<TABLE
last row of energy | energy["step"][-1] | 4 | 0 | the balance of a step is known in the next
energy error | np.abs(energy["relative_error"]).max() | 0 | 0.1 | the limit of a run
TABLE
   size=$(grep '^  h = ' "$folder/$name.inp")
   sed "s/^  h = [0-9.]*/${size%%,*}/" "$input/$name.inp" >"$folder/shapes.inp"
   "${XMPM3D:-xmpm3d}" --check -o "$folder/shapes" "$folder/shapes.inp" >"$folder/shapes.txt"
   fronts "$folder/run/$name.log" >"$folder/files.fronts"
   fronts "$folder/shapes.txt" >"$folder/shapes.fronts"
   if [ -s "$folder/shapes.fronts" ] && diff "$folder/shapes.fronts" "$folder/files.fronts"; then
      echo "ok     as many fronts as the shapes of the deck give"
   else
      echo "FAILED fronts: above those of the deck's shapes, those of the files below"
      failed=1
   fi
done
finish
