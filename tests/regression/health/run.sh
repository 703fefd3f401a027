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

echo 'a speed whose square is no number'
sed 's/1.2 0.4 0.4/&, velocity = 1e160 0 0/; s/step = 0.02/step = 1e-170, steps = 3/; s/energy = 0.1/energy = 0/' \
   "$here/deck.inp" >overflow.inp
expect_code 3 run_deck "$ranks" overflow overflow.inp
expect_text complaint 'step 1, time ' 'the energies are not numbers' 'has the speed 1e160'
last_output overflow/unstable

echo 'a stress that tears the particles out of all numbers'
sed 's/1.2 0.4 0.4/&, stress = 1e307 0 0 0 0 0/; s/step = 0.02/step = 1e-3, steps = 3/; s/energy = 0.1/energy = 0/' \
   "$here/deck.inp" >torn.inp
expect_code 3 run_deck "$ranks" torn torn.inp
expect_text complaint 'step 1, time ' 'a particle has a volume that is not positive, or a value that is not a number'
last_output torn/unstable

echo 'a body that falls ever faster'
sed 's/step = 0.02/cfl = 0.5/; s/energy = 0.1/energy = 0, smallest_step = 0.5/
   s/^\*OUTPUT/*GRAVITY acceleration = 1e6 0 0\n&/' "$here/deck.inp" >falls.inp
expect_code 3 run_deck "$ranks" falls falls.inp
expect_text complaint 'the time step fell to ' 'less than 0.5 of the first one' 'the fastest particle has the speed '
last_output falls/unstable

if [ "$ranks" -gt 1 ]; then
   echo 'bodies that jump over their neighbours'
   sed 's/1.2 0.4 0.4/&, velocity = 1e3 0 0/; s/step = 0.02/step = 0.1, steps = 3/; s/energy = 0.1/energy = 0/' \
      "$here/deck.inp" >jump.inp
   expect_code 3 run_deck "$ranks" jump jump.inp
   expect_text complaint ' particles moved further than the next block in one step'
fi

echo 'no rest in the time that is given'
sed 's/step = 0.02/cfl = 0.5/; s/^\*OUTPUT/*RELAX limit = 1e-3\n&/' "$here/deck.inp" >restless.inp
expect_code 3 run_deck "$ranks" restless restless.inp
expect_text complaint 'the bodies did not come to rest within the limit of 0.001'

echo 'a deck with five faults: all are told at once'
expect_code 2 run_deck "$ranks" faulty "$here/faulty.inp"
expect_text complaint ':3:' 'siz' 'size' ':5:' 'density' '1e6x' ':7:' 'box' ':8:' 'TIMES' 'TIME'
finish
