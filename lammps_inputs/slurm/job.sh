export LC_ALL=C OMP_NUM_THREADS=1
job=$SLURM_JOB_ID number=${1:-1} stop=
state() {  # STATE REASON: a line of fixed length, which a full disk takes in place of the one before
    local line="$1 job=$job cluster=$SLURM_CLUSTER_NAME host=$HOSTNAME at=$(date -Is) until=$(date -Is -d "@$ends") $2"
    printf '%-500.500s\n' "${line//[^[:print:]]/ }" 1<>job.state
    echo "granchain: $1 $2"
}
end() { rm -f job.room chains.restart.part; state "$1" "$2"; [ "$1" = done ] || [ "$1" = waiting ]; exit; }
refuse() { echo "granchain: $1"; exit 1; }

compute() {  # the run in the present directory, and exit
    trap 'stop=yes; mv -f job.stop job.flag 2>/dev/null' USR1  # from Slurm, before the time limit
    trap 'end incomplete "cancelled, or stopped at its time limit"' TERM
    [ -f in.job ] || refuse "this run is done, or its in.job is not here"
    for file in log.lammps chains.* job.f* job.st*; do [ ! -L "$file" ] || refuse "$file is a link; put a file there"; done
    exec 9<. && flock -n 9 || [ $? -ne 1 ] || refuse "something computes here already"
    IFS=' =' read -r _ _ last _ 2>/dev/null <job.state
    [ "${last:-$job}" = "$job" ] || ! squeue -h -t R -o %A -j "$last" |& grep -qxe "$last" || refuse "job $last runs here"
    echo go >job.flag; echo stop >job.stop; echo full >job.full  # words for in.job: to rename one needs no room
    [ -z "$stop" ] || mv -f job.stop job.flag
    state running
# modules

    part=1  # of the frames
    if [ -s chains.restart ] && [ -f job.frames ]; then  # resume with the next part, and the others as at the restart
        while IFS=: read -r file bytes; do
            [[ $file:$bytes =~ ^chains\.(dump|snapshots)(\.([1-9][0-9]{0,8}))?\.bin:[0-9]{1,18}$ ]] &&
                [ "$(stat -c %s "$file")" -ge "$bytes" ] && truncate -s "$bytes" "$file" ||
                end failed "$file is shorter than at the restart, or job.frames is damaged"
            part=$((${BASH_REMATCH[3]:-1} + 1))
        done <job.frames
    fi
    echo "# job $job" | tee -a log.lammps
    "${lammps[@]}" -in in.job -var part $part -var ranks "$ranks" -var checkpoint $checkpoint &
    while kill -0 $! 2>/dev/null; do wait $!; done  # a signal ends a wait

    word=$(cat job.flag)
    [ "$word" != done ] || { rm -f in.job in.continue chains.restart job.f* job.stop; end done; }
    [ "$word" = stopped ] || head -c 1000000 /dev/zero >job.room || word=full
    [ "$word" != full ] || end failed "the disk does not take what is written (is it full?); make room"
    why=$(sed -s "0,/^# job $job$/d" log.lammps job.out | grep -m 1 -e ERROR -e error: || tail -n 1 job.out)
    [[ $why != *"Specified processors"* ]] || why="it has not $ranks ranks; is the launcher that of its MPI?"
    [ "$word" = stopped ] || end failed "'${lammps[*]}' ended before in.job did: $why"
    [ "$number" -lt "$max_jobs" ] || end incomplete "stopped after $number jobs (--max-jobs)"
    next=$("${again[@]}" $((number + 1)) 2>&1) || end incomplete "the next job could not be submitted: $next"
    job=${next%%;*} end waiting "resumes when the job begins"
}

