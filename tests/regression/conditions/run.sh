#!/usr/bin/env bash
# Conditions on named sets and in a box: prescribed velocities and accelerations, held bodies, and
# free fall in the directions that are not prescribed.
# ranks: 1 2
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

# body NAME: which particles of the first step belong to it, by their place
body() {
   case $1 in
      sled) echo '(start["x"][:, 0] < 10) & (start["x"][:, 1] < 10)' ;;
      ramp) echo '(start["x"][:, 0] < 10) & (start["x"][:, 1] > 10)' ;;
      post) echo '(start["x"][:, 0] > 10) & (start["x"][:, 0] < 30)' ;;
      middle) echo '(start["x"][:, 0] > 50) & (start["x"][:, 0] < 60)' ;;
   esac
}

# path BODY DIRECTION EXPECTED: largest way off it
path() {
   echo "abs((last[\"x\"] - start[\"x\"])[$(body "$1")][:, $2] - ($3)).max()"
}

for shape in linear gimp; do
   echo "shape $shape"
   sed "s/shape = linear/shape = $shape/" "$here/deck.inp" >case.inp
   run_deck "$ranks" out case.inp
   # Sums over some hundred steps of paths of a millimetre.
   compare check out/bodies <<TABLE
sled: path along x | $(path sled 0 '1000*0.03**2') | 0 | 1e-11 | a t^2/2
sled: free fall | $(path sled 1 '-500*0.03**2') | 0 | 1e-11 | g t^2/2
sled: path along z | $(path sled 2 0) | 0 | 1e-11 | at rest
ramp: path along x | $(path ramp 0 '2000*0.03**2/6') | 0 | 1e-4 | a t^3/6 T, steps of T/60
ramp: path along z | $(path ramp 2 '-1000*0.03**2/6') | 0 | 1e-4 | a t^3/6 T, steps of T/60
ramp: free fall | $(path ramp 1 '-500*0.03**2') | 0 | 1e-11 | g t^2/2
post: path | abs((last["x"] - start["x"])[$(body post)]).max() | 0 | 0 | held
stress of sled, ramp, post | abs(last["stress"][start["x"][:, 0] < 30]).max() | 0 | 1e-9 | they move as a whole
bar: stress behind the front [MPa] | last["stress"][$(body middle)][:, 0].mean() | 1 | 0.02 | rho c v
bar: free fall | $(path middle 1 '-500*0.03**2') | 0 | 1e-11 | g t^2/2
bar: force on its end [N] | -probe["pull_x"][-20:].mean() | 16 | 0.5 | rho c v A
TABLE
done
finish
