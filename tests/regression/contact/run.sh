#!/usr/bin/env bash
# Bodies that meet agree on other numbers of ranks, take up the momentum of each other, and the ledger closes.
# ranks: 2 3
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

run_deck 1 one
run_deck "$ranks" many
compare agree one/meeting many/meeting 1e-10
compare check many/meeting <<TABLE
energy never above the first | max(energy["kinetic"] + energy["strain"])/energy["kinetic"][0] | 1 | 0.02 | contact only takes
contact has begun | energy["contact"][-1] > 0.05*energy["kinetic"][0] | 1 | 0 | half a cell of each face stops at once
error of the balance | max(abs(energy["relative_error"])) | 0 | 0.02 | 1 % measured: shocks over a step
TABLE
finish
