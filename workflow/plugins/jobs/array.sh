word= failed=0
sha256sum --check --status <<<"$cases_sum  cases.txt" || refuse "cases.txt is not the list of this array" || exit
for case in $(sed -n "@line@p" cases.txt); do
    [ -f "$home/$case/in.job" ] || continue  # done
    cd -- "$home/$case" && compute >>job.out 2>&1 || failed=1
    [ "$word" != stopped ] || break  # the next job does the rest
done
exit $failed
