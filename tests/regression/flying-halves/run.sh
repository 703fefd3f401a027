#!/usr/bin/env bash
# A crack through all of a block frees two halves: they fly apart with their momenta, unstrained.
# ranks: 1 2
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

run_deck "$ranks" out
# Mass of a half: 1000 * 0.55 * 0.6 * 0.6 = 198. Fields are single precision: 1e-7 of the value.
compare check out/halves <<'TABLE'
momentum x           | max(abs(energy["momentum_x"]))          | 0 | 1e-9 | 198 (3 - 3); rounding of 594
momentum y           | max(abs(energy["momentum_y"]))          | 0 | 1e-9 | 198 (0.7 - 0.7)
momentum z           | max(abs(energy["momentum_z"] - 118.8))  | 0 | 1e-9 | 198 (0.2 + 0.4)
kinetic energy       | max(abs(energy["kinetic"]/1898.82 - 1)) | 0 | 1e-12 | 99 (9.53 + 9.65)
stress work          | max(abs(energy["strain"]))              | 0 | 1e-12 | no strain, over 1e3 of energy
velocity of the left | np.abs(last["velocity"][last["body"] == 1] - [-3, 0.7, 0.2]).max() | 0 | 3e-7 | as given
velocity of the right | np.abs(last["velocity"][last["body"] == 2] - [3, -0.7, 0.4]).max() | 0 | 3e-7 | as given
way of the left      | np.abs((last["x"] - start["x"])[last["body"] == 1] - [-0.6, 0.14, 0.04]).max() | 0 | 1e-12 | velocity times 0.2
way of the right     | np.abs((last["x"] - start["x"])[last["body"] == 2] - [0.6, -0.14, 0.08]).max() | 0 | 1e-12 | velocity times 0.2
stress               | np.abs(last["stress"]).max() | 0 | 1e-6 | rounding of 1e6
TABLE
finish
