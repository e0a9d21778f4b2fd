[ "$(sha256sum <cases.txt)" = "$cases_sum  -" ] || refuse "cases.txt is not the list that this array was made for"
read -r -a directories < <(sed -n "$((task + 1))p" cases.txt)
past=3 onwards=4 failed=0
for directory in "${directories[@]}"; do
    ( cd -- "$directory" && exec >>job.out 2>&1 && compute ) &
    running=$!
    trap 'kill -TERM "$running" 2>/dev/null; wait "$running"; exit 1' TERM
    wait "$running"
    code=$?
    [ $code -ne $onwards ] || exit $failed  # the next job does the rest
    [ $code -eq $past ] || first=no
    [ $code -ne 0 ] || checked=yes
    [ $code -eq 0 ] || [ $code -eq $past ] || failed=1
done
exit $failed
