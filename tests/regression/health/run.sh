#!/usr/bin/env bash
# Runs that fail say which, where and when, leave a last output and end with the exit code for it.
# ranks: 1 2
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

last_output() {
   if compgen -G "$1"'_particles/*.vtkhdf' >/dev/null && [ "$(compgen -G "$1"'_particles/*' | wc -l)" -ge 2 ]; then
      echo "ok     $1: a last output"
   else
      echo "FAILED $1: no last output"
      failed=1
   fi
}

echo 'too large a time step'
expect_code 3 run_deck "$ranks" unstable
expect_text complaint 'step ' 'time ' 'particle ' ' at '
last_output unstable/unstable

echo 'too small a limit of the energy balance'
sed 's/step = 0.02/cfl = 0.9/; s/energy = 0.1/energy = 1e-9/' "$here/deck.inp" >energy.inp
expect_code 3 run_deck "$ranks" energy energy.inp
expect_text complaint 'step 50, time ' 'the energy balance is off by' 'the limit of 1e-9'
last_output energy/unstable

echo 'a deck with five faults: all are told at once'
expect_code 2 run_deck "$ranks" faulty "$here/faulty.inp"
expect_text complaint ':3:' 'siz' 'size' ':5:' 'density' '1e6x' ':7:' 'box' ':8:' 'TIMES' 'TIME'
finish
