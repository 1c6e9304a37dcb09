#!/usr/bin/env bash
# A study in parts on one machine: in-parts.sh STUDY.toml OUT PARTS [flags of study]
# By GNU parallel, which also reaches other machines (--sshlogin), or by xargs where there is none.
# TURBID_STUDY names the program, such as target/release/study.
set -euo pipefail
study=$1 out=$2 parts=$3
shift 3
program=${TURBID_STUDY:-target/release/study}
# Each part on one thread, as many at once as there are cores.
if command -v parallel > /dev/null; then
  seq "$parts" | parallel --halt soon,fail=1 "$program" "$study" --out "$out" --threads 1 --part "{}/$parts" "$@"
else
  seq "$parts" | xargs -P "$(nproc)" -I {} "$program" "$study" --out "$out" --threads 1 --part "{}/$parts" "$@"
fi
"$program" "$study" --merge "$out" "$@"
