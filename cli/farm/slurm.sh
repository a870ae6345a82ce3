#!/usr/bin/env bash
# Computes a table on a Slurm cluster: an array of tasks with one part each, and a task that joins the parts.
#
#   slurm.sh SCENE TABLE.exr PARTS [OPTION OF ESTIMATE]...
#
#   slurm.sh beetle-pits pits.exr 64 --target-error 1e-4
#
# GONIOCHROME   the program [goniochrome]
# AT_ONCE       how many tasks may run at once [all]
# SBATCH_*      options of sbatch, as its manual lists them, such as SBATCH_PARTITION=long SBATCH_TIMELIMIT=4:00:00
# CPUS          processors of each task [1]
#
# Parts are kept in TABLE.exr.parts. A task that is killed or preempted is queued again, and goes on where it stopped.
# The same command submits again what has failed: finished parts are not computed twice. Prints the number of the task
# that joins the parts; it removes them.
set -euo pipefail
if [ $# -lt 3 ]; then
    sed -n '4p' "$0" | cut -c5- >&2
    exit 2
fi
scene=$1 table=$(realpath -m "$2") parts=$3
shift 3
program=${GONIOCHROME:-goniochrome}
program=$(command -v "$program") || { echo "slurm.sh: no program $program; set GONIOCHROME" >&2; exit 2; }
program=$(realpath -s "$program")
folder=$table.parts
mkdir -p "$folder"
quoted=$(printf '%q ' "$program" estimate "$scene" "$@")
part="$(printf '%q' "$folder")/\$SLURM_ARRAY_TASK_ID.part"
name=$(basename "$table")

array=$(sbatch --parsable --job-name="$name" --requeue --open-mode=append --array="1-$parts${AT_ONCE:+%$AT_ONCE}" \
    --ntasks=1 --cpus-per-task="${CPUS:-1}" --output="$folder/%a.log" \
    --wrap "test -s $part || exec $quoted --part array --output $part --threads ${CPUS:-1} --quiet")
sbatch --parsable --job-name="$name-merge" --requeue --dependency="afterok:$array" --kill-on-invalid-dep=yes \
    --ntasks=1 --cpus-per-task="${CPUS:-1}" --output="$folder/merge.log" \
    --wrap "cd $(printf '%q' "$folder") && $(printf '%q ' "$program" merge) *.part \
        $(printf '%q ' --output "$table" --threads "${CPUS:-1}" --quiet) && rm -r $(printf '%q' "$folder")"
