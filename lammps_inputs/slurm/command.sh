# From here on every such job is the same.
set -u
export LC_ALL=C OMP_NUM_THREADS=1
number=${1:-1}  # of this job among those that submitted each other
cd -- "${SLURM_SUBMIT_DIR:-$PWD}" || exit 1
[ ! /dev/stdout -ef /dev/null ] || exec >>job.out 2>&1

set +u  # the site's own scripts may not be so strict
for module in "${modules[@]}"; do
    type module >/dev/null 2>&1 || . /etc/profile
    module load "$module" || exit 1
done
set -u

"${command[@]}" </dev/null &
child=$!
trap 'kill -TERM "$child" 2>/dev/null' TERM  # from Slurm, before the time limit
code=143  # also where the trap ended the waiting, not the command
while [ $code -eq 143 ] && kill -0 "$child" 2>/dev/null; do
    wait "$child"
    code=$?
done
[ $code -ne 143 ] || { wait "$child"; code=$?; }
if [ $code -eq 130 ] && [ "$number" -lt "$max_jobs" ]; then
    sbatch --dependency="afterany:${SLURM_JOB_ID:-0}" job.sbatch $((number + 1))
    exit
fi
echo "granchain: the command ended with exit code $code"
exit $code
