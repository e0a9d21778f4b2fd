export LC_ALL=C OMP_NUM_THREADS=1
"${command[@]}" </dev/null &
trap 'kill $!' @command_signal@  # from @sender@, before the time limit
while kill -0 $! 2>/dev/null; do wait $!; done  # a signal ends a wait
wait $!
code=$?
if [ $code -eq 130 ] && [ "@number@" -lt "$max_jobs" ]; then
    @submission@
    exit
fi
echo "granchain: the command ended with exit code $code"
exit $code
