#!/usr/bin/env bash
# A study in parts by GNU parallel: gnu-parallel.sh STUDY.toml OUT PARTS [flags of study]
# TURBID_STUDY names the program, such as target/release/study.
set -euo pipefail
study=$1 out=$2 parts=$3
shift 3
program=${TURBID_STUDY:-target/release/study}
# Each part on one thread; parallel starts as many as there are cores.
seq "$parts" | parallel --halt soon,fail=1 "$program" "$study" --out "$out" --threads 1 --part "{}/$parts" "$@"
"$program" "$study" --merge "$out" "$@"
