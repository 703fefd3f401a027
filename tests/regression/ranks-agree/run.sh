#!/usr/bin/env bash
# Runs on other numbers of ranks agree to rounding, and a repeat is the same bit for bit.
# ranks: 1 2 3 7
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

run_deck 1 one
run_deck "$ranks" many
run_deck "$ranks" again
compare agree one/plate many/plate 1e-10
compare same many/plate again/plate
finish
