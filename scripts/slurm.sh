#!/bin/bash
# One run on the ranks of a SLURM job, in as many jobs as it takes to its end:
#   sbatch [--ntasks=N --cpus-per-task=M --time=...] scripts/slurm.sh SCENE [options of barchan run]
# BARCHAN names the program, if it is not "barchan". See docs/how-to/restart-on-a-cluster.md.
#SBATCH --job-name=barchan
#SBATCH --ntasks=4
#SBATCH --cpus-per-task=8
#SBATCH --time=04:00:00
#SBATCH --signal=TERM@180
#SBATCH --open-mode=append
#SBATCH --requeue
set -u
scene=${1:?usage: sbatch scripts/slurm.sh SCENE [options of barchan run]}
shift
export OMP_PLACES=cores OMP_PROC_BIND=close  # a rank's threads stay on its cores
# SLURM sends SIGTERM to all ranks 180 s before the time is over: they finish the step, write a checkpoint and end with
# status 143. A rank that dies ends the others.
status=0
srun --cpu-bind=cores --kill-on-bad-exit=1 "${BARCHAN:-barchan}" run "$scene" --restart latest \
  --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet "$@" || status=$?
if [ "$status" -eq 143 ]; then scontrol requeue "$SLURM_JOB_ID"; fi  # not at its end: the same job once more
exit "$status"
