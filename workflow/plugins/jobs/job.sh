export LC_ALL=C OMP_NUM_THREADS=1
home=$PWD job=@job@ number=@number@ flag=go
trap 'flag=stop; ! grep -qs go job.flag || echo stop 1<>job.flag' USR1  # from @sender@, before the time limit
state() {  # STATE REASON: a line of fixed length, written in place of the one before, which a full disk takes
    local line="$1 job=$job cluster=@cluster@ host=$HOSTNAME at=$(date -Is) until=$ends $2"
    printf '%-500.500s\n' "${line//[^[:print:]]/ }" 1<>job.state
    echo "granchain: $1 $2"
}
end() { trap - TERM; rm -f job.room chains.restart.part; state "$1" "$2"; [ "$1" = done ] || [ "$1" = waiting ]; }
refuse() { echo "granchain: $1"; return 1; }

compute() {  # the run in the present directory
    [ -f in.job ] || refuse "this run is done, or its in.job is not here" || return
    [ -z "$(find log.lammps chains.* job.* -prune -type l 2>/dev/null)" ] || refuse "a file of the job is a link" || return
    exec 9<. && flock -n 9 || [ $? -ne 1 ] || refuse "something computes here already" || return
    IFS=' =' read -r _ _ last _ 2>/dev/null <job.state
    [ "${last:-$job}" = "$job" ] || ! @running@ | grep -qxe "$last" ||
        refuse "job $last runs here" || return
    trap 'end incomplete "cancelled, or stopped at its time limit"; exit 1' TERM
    echo $flag >job.flag  # in.job reads it between stretches of the run
    state running
@modules@
    part=1  # of the frames; after a restart the next one, and the one before it as it was at the restart
    [ -s chains.restart ] && part=$(($(ls chains.dump*.bin | wc -l) + 1)) || rm -f job.frames
    while IFS=: read -r file bytes; do
        [[ $file:$bytes =~ ^chains\.dump(\.([1-9][0-9]{0,8}))?\.bin:[0-9]{1,18}$ ]] &&
            [ "$(stat -c %s "$file")" -ge "$bytes" ] && truncate -s "$bytes" "$file" ||
            end failed "$file is shorter than at the restart, or job.frames is damaged" || return
        part=$((${BASH_REMATCH[2]:-1} + 1))
    done < <(cat job.frames 2>/dev/null)
    echo "# job $job" | tee -a log.lammps
    "${lammps[@]}" -in in.job -var part $part -var ranks "$ranks" -var checkpoint $checkpoint </dev/null &
    while kill -0 $! 2>/dev/null; do wait $!; done  # a signal ends a wait

    word=$(cat job.flag)
    [ "$word" != done ] || { end done; rm -f in.job in.continue chains.restart job.f*; return; }
    [ "$word" = stopped ] || head -c 1000000 /dev/zero >job.room || word=full
    [ "$word" != full ] || end failed "the disk does not take what is written (is it full?); make room" || return
    why=$(sed -s "0,/^# job $job$/d" log.lammps job.out | grep -m 1 -e ERROR -e error: || tail -n 1 job.out)
    [[ $why != *"Specified processors"* ]] || why="it has not $ranks ranks; is the launcher that of its MPI?"
    [ "$word" = stopped ] || end failed "'${lammps[*]}' ended before in.job did: $why" || return
    [ "$number" -lt "$max_jobs" ] || end incomplete "stopped after $number jobs (--max-jobs)" || return
    next=$(cd -- "$home" && @submission@) ||
        end incomplete "the next job could not be submitted: $(tail -n 1 job.out)" || return
    job=@next@ end waiting "resumes when the job begins"
}

