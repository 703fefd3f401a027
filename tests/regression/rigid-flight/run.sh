#!/usr/bin/env bash
# Rigid translation of a cracked block leaves stress zero, momentum and energy exact, to rounding.
# ranks: 1 2
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

run_deck "$ranks" linear
sed 's/shape = linear/shape = gimp/' "$here/deck.inp" >gimp.inp
run_deck "$ranks" gimp gimp.inp
for shape in linear gimp; do
   echo "shape $shape"
   # Mass: 1000 * 1.2 * 0.8 * 0.8 = 768.
   compare check "$shape/flight" <<'TABLE'
momentum x    | max(abs(energy["momentum_x"]/3072 - 1))    | 0 | 1e-12 | 768 * 4
momentum y    | max(abs(energy["momentum_y"]/1920 - 1))    | 0 | 1e-12 | 768 * 2.5
momentum z    | max(abs(energy["momentum_z"]/-1152 - 1))   | 0 | 1e-12 | 768 * -1.5
kinetic       | max(abs(energy["kinetic"]/9408 - 1))       | 0 | 1e-12 | 384 * 24.5
stress work   | max(abs(energy["strain"]))                 | 0 | 1e-12 | no strain
stress        | np.abs(last["stress"]).max()               | 0 | 1e-6  | rounding of young 1e6
path          | np.abs(last["x"] - start["x"] - [0.8, 0.5, -0.3]).max() | 0 | 1e-12 | velocity times 0.2
crack is there | min(abs(start["side"]).max(), abs(last["side"]).max()) | 1 | 0 | particles on its sides
TABLE
done
finish
