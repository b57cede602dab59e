#!/usr/bin/env bash
# Frames of a sequence as a Slurm array: each task makes one part, in one process. What is there already is
# left, so that a task which was requeued, or the whole array once more, only makes what is missing.
#
#     sbatch --array=1-16 farm/slurm.sh anim.svg -o frames/frame.####.png --fps 24 --width 1920
#SBATCH --job-name=toon-raster
#SBATCH --array=1-16
#SBATCH --cpus-per-task=4
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail

# Tasks may be numbered from anywhere, in any steps; parts are from 1.
part=$(((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN) / ${SLURM_ARRAY_TASK_STEP:-1} + 1))

# In place of the shell, so that the signal at the end of the time is the program's: no frame stays half.
exec toon-raster "$@" --chunk "$part/$SLURM_ARRAY_TASK_COUNT" --skip-existing \
    --threads "${SLURM_CPUS_PER_TASK:-0}" --progress none
