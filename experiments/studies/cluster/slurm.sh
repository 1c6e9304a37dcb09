#!/usr/bin/env bash
# A study in parts by a Slurm job array, on a file system that all nodes share:
#   array=$(sbatch --parsable --array=1-16 slurm.sh STUDY.toml OUT)
#   sbatch --dependency=afterok:$array --wrap "target/release/study STUDY.toml --merge OUT"
#SBATCH --cpus-per-task=1
#SBATCH --output=part-%a.log
set -euo pipefail
program=${TURBID_STUDY:-target/release/study}
"$program" "$1" --out "$2" --threads "${SLURM_CPUS_PER_TASK:-1}" --part "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
