#!/usr/bin/env bash
# Sharing the work anew changes nothing but the ranks of the particles; nor do ranks without any.
# ranks: 2 3 7
# shellcheck source=../case.sh
source "$(dirname "$0")/../case.sh"

run_deck 1 one
run_deck "$ranks" many
compare agree one/bar many/bar 1e-10
compare check many/bar <<'TABLE'
ranks with particles at the end, at least 2 | min(2, len(set(last["rank"]))) | 2 | 0 | by count; blocks are few
share of particles that changed rank, at least 5 % | min(0.05, (last["rank"] != start["rank"]).mean()) | 0.05 | 0 | shared anew
TABLE
echo 'ranks without particles'
run_deck 1 one-tiny "$here/tiny.inp"
run_deck "$ranks" many-tiny "$here/tiny.inp"
compare agree one-tiny/tiny many-tiny/tiny 1e-10
finish
