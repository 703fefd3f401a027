#!/usr/bin/env bash
# What the command line says, and the exit codes: 0 success, 2 usage or deck, 4 files.
# ranks: 1
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

program=${XMPM3D:-xmpm3d}

expect_code 0 "$program" --help >help
expect_text help 'Usage: xmpm3d' --check --keywords --quiet
expect_code 0 "$program" --version >version
expect_text version 'xmpm3d ' compiler HDF5 METIS
expect_code 0 "$program" --keywords >keywords
expect_text keywords '*JOB NAME' '*GRID' '*CRACK' '*END'

# A check sets everything up and runs nothing.
mkdir -p checked
expect_code 0 "$program" --check -o checked "$here/deck.inp" >check
expect_text check 'job          command-line' 'time step'
if grep -q '^Progress' check; then
   echo 'FAILED --check ran the deck'
   failed=1
fi

# Each fault is told with the line of the deck and, for a slip of the pen, the right word.
sed 's/\*GRID/*GRIDD/; s/density/densty/' "$here/deck.inp" >broken.inp
expect_code 2 "$program" broken.inp
expect_text complaint "broken.inp:3: unknown keyword '*GRIDD'; did you mean '*GRID'?" \
   "did you mean 'density'"
expect_code 2 "$program" --chekc "$here/deck.inp"
expect_text complaint "did you mean '--check'"
expect_code 2 "$program" "$here/deck.inp" another.inp

expect_code 4 "$program" missing.inp
expect_text complaint missing.inp
touch file
expect_code 4 "$program" --quiet -o file/folder "$here/deck.inp"
expect_text complaint file/folder
finish
