failed=0
[ "$(sha256sum <cases.txt)" = "$cases_sum  -" ] || refuse "cases.txt is not the list that this array was made for"
for case in $(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" cases.txt); do
    trap 'stop=yes; kill -USR1 $!' USR1
    trap 'kill $!; wait; exit 1' TERM
    [ -f "$case/in.job" ] || continue  # done
    (cd -- "$case" && exec >>job.out 2>&1 && compute) &
    while kill -0 $! 2>/dev/null; do wait $!; done  # a signal ends a wait
    wait $! || failed=1
    ! grep -q ^waiting "$case/job.state" || break  # the next job does the rest
done
exit $failed
