#!/usr/bin/env bash
# A single particle that flies through faces, edges and corners of cells keeps its energy and
# momentum to rounding.
# ranks: 1 2
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

for shape in linear gimp; do
   for scheme in musl usf; do
      echo "shape $shape, scheme $scheme"
      sed "s/shape = linear/shape = $shape/; s/end = 1.5/end = 1.5, scheme = $scheme/" \
         "$here/deck.inp" >"$shape-$scheme.inp"
      run_deck "$ranks" "$shape-$scheme" "$shape-$scheme.inp"
      # Each has 2000 kg. Velocities are single precision in the file.
      compare check "$shape-$scheme/particle" <<'TABLE'
kinetic     | max(abs(energy["kinetic"]/351290 - 1))     | 0 | 1e-12 | 1000 (100 + 98 + 75 + 78.29)
momentum x  | max(abs(energy["momentum_x"]/30000 - 1))   | 0 | 1e-12 | 2000 (10 + 7 - 5 + 3)
momentum y  | max(abs(energy["momentum_y"]/-12000 - 1))  | 0 | 1e-12 | 2000 (7 - 5 - 8)
momentum z  | max(abs(energy["momentum_z"]/-5400 - 1))   | 0 | 1e-12 | 2000 (-5 + 2.3)
stress work | max(abs(energy["strain"]))                 | 0 | 1e-9  | no strain; rounding of 3.5e5
path        | np.abs(last["x"] - start["x"] - 1.5*np.array([[10, 0, 0], [7, 7, 0], [-5, -5, -5], [3, -8, 2.3]])).max() | 0 | 1e-12 | velocity times 1.5
velocity    | np.abs(last["velocity"] - np.array([[10, 0, 0], [7, 7, 0], [-5, -5, -5], [3, -8, 2.3]])).max() | 0 | 5e-7 | single precision
stress      | np.abs(last["stress"]).max()               | 0 | 1e-5  | rounding of young 1e7
TABLE
   done
done
finish
