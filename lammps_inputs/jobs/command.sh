export LC_ALL=C OMP_NUM_THREADS=1
"${command[@]}" </dev/null &
trap 'kill $!' TERM  # from Slurm, before the time limit
while kill -0 $! 2>/dev/null; do wait $!; done  # a signal ends a wait
wait $!
code=$?
if [ $code -eq 130 ] && [ "${1:-1}" -lt "$max_jobs" ]; then
    sbatch --dependency="afterany:$SLURM_JOB_ID" job.sbatch $((${1:-1} + 1))
    exit
fi
echo "granchain: the command ended with exit code $code"
exit $code
