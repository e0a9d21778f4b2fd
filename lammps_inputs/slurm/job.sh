# The same in every job. What it writes into job.state, `granchain status` reads.
set -u
export LC_ALL=C OMP_NUM_THREADS=1
home=${SLURM_SUBMIT_DIR:-$PWD}
cd -- "$home" || exit 1
[ ! /dev/stdout -ef /dev/null ] || exec >>job.out 2>&1
task=${SLURM_ARRAY_TASK_ID:-} number=${1:-1}  # this job's, of those that submit each other
asked() { sed -n "s/^#SBATCH --$1=//p" "$0"; }
ranks=${SLURM_NTASKS:-$((${SLURM_JOB_NUM_NODES:-$(asked nodes)} * ${SLURM_NTASKS_PER_NODE:-$(asked ntasks-per-node)}))}
launch=("${launch[@]//'{ranks}'/$ranks}")
self=${SLURM_ARRAY_JOB_ID:+${SLURM_ARRAY_JOB_ID}_$task}
self=${self:-${SLURM_JOB_ID:-0}}
started=$(date +%s)
ends=${SLURM_JOB_END_TIME:-$(date -d "$(squeue -h -j "$self" -o %e 2>/dev/null | head -n 1 | tr T ' ')" +%s 2>/dev/null)}
[ "$ends" -gt "$started" ] 2>/dev/null ||
    ends=$((started + $(asked time | awk -F '[:-]' '{ print (24 * (NF > 3) * $1 + $(NF-2)) * 3600 + $(NF-1) * 60 + $NF }')))

state() {  # STATE REASON
    printf '%s\n' "state $1" "step $step" "steps $steps" "job $job" "number $number" "ranks $ranks" \
        "cluster ${SLURM_CLUSTER_NAME:-}" "host ${HOSTNAME:-}" "time $(date +%s)" "ends $ends" \
        "reason $(printf '%s' "$2" | head -n 1 | tr -cd '[:print:]' | cut -c 1-300)" >.job.state.part &&
        mv -f .job.state.part job.state
    echo "granchain: $1 $2"
}
fail() { cat .job.check 2>/dev/null; state failed "$1"; exit 1; }
refuse() { echo "granchain: $1" >&2; exit 1; }  # without a change of any file
complaint() { grep -m 1 -e ERROR -e 'Fatal error' .job.check || grep . .job.check | tail -n 1; }
again() {  # submit the next job of this run, and end
    [ "$number" -lt "$max_jobs" ] || { state incomplete "stopped after $number jobs (--max-jobs)"; exit 1; }
    state waiting "for the next job to be submitted"
    next=$(cd -- "$home" &&
        sbatch --parsable ${task:+--array=$task} --dependency="afterany:$self" job.sbatch $((number + 1)) 2>&1) ||
        { state incomplete "the next job could not be submitted: $next"; exit 1; }
    job=${next%%;*} number=$((number + 1))
    state waiting "resumes when the next job begins"
    exit "$onwards"
}

compute() {  # in this directory
    if grep -qx 'state done' job.state 2>/dev/null; then echo "granchain: this run is done"; exit "$past"; fi
    [ -f in.chains ] && [ -f data.chains ] && [ -f in.job ] || refuse "no deck here; submit in its directory"
    for file in log.lammps chains.* job.state job.step job.frames; do
        [ ! -L "$file" ] || refuse "$file is a link, and nothing is written through one"
    done
    job=${SLURM_JOB_ID:-$$} step=$(head -n 1 job.step 2>/dev/null | grep -x '[0-9]\{1,18\}' || echo 0)
    steps=$(sed -n 's/^variable steps index \([0-9]*\).*/\1/p' in.chains)
    atoms=$(sed -n 's/^\([0-9]*\) atoms$/\1/p;10q' data.chains)
    [ -n "$steps" ] && [ -n "$atoms" ] || refuse "in.chains or data.chains is not what granchain wrote"
    other=$(sed -n 's/^job //p' job.state 2>/dev/null | tail -n 1)
    if [ "${other:-$job}" != "$job" ] && squeue -h -j "$other" -t R 2>/dev/null | grep -q .; then
        refuse "job $other computes here"
    fi
    exec 9<.
    flock -n 9 2>/dev/null
    [ $? -ne 1 ] || refuse "something computes here already"
    trap 'state incomplete "cancelled, or stopped at its time limit"; kill "${!:-}" 2>/dev/null; exit 1' TERM
    rm -f .job.check
    state running checks
    [ -z "$missing" ] || fail "module load $missing failed"
    if [ "$checked" = no ]; then  # LAMMPS, its packages, the ranks and the deck, without a step
        mkdir -p .job && ln -sf ../in.chains ../data.chains .job/ || fail "no room for a check of the deck"
        (cd .job && exec timeout 1800 "${launch[@]}" "$lmp" -in in.chains -log none -skiprun -var steps 0) \
            </dev/null >.job.check 2>&1 &
        wait $!
        code=$?
        rm -rf .job
        grep -q '^LAMMPS (' .job.check || fail "$lmp cannot be started as LAMMPS: $(complaint)"
        found=$(sed -n 's/^ *\([0-9]* by [0-9]* by [0-9]*\) MPI processor grid.*/\1/p' .job.check | sort -u)
        [ "${found:-$ranks by 1 by 1}" = "$ranks by 1 by 1" ] ||
            fail "$ranks ranks asked, found: $(echo $found); '${launch[*]}' does not belong to the MPI library of $lmp"
        [ $code -eq 0 ] || fail "the deck cannot be read: $(complaint)"
    fi

    # in.job runs .job.keep: a restart counts when it and the frames before it are on the disk
    echo kept >.job.yes
    echo lost >.job.no
    cat >.job.keep <<'END'
ln -sf .job.no .job.kept
[ "$(tail -c 16 chains.restart.part | tr -d '\0')" = "LammpS RestartT" ] || exit 0
head -c 4096 chains.restart.part | sha256sum >job.frames.part || exit 0
while [ $# -gt 0 ]; do
    [ "$(wc -c <"$1" || echo 0)" -eq "$2" ] && echo "$1 $2" >>job.frames.part || exit 0
    shift 2
done
mv -f job.frames.part job.frames && mv -f chains.restart.part chains.restart &&
    ln -sf .job.yes .job.kept  # a link needs no room
END

    # from the restart, with the next part of the frames; frames after the restart are computed again
    dump=chains.dump.bin snapshots=chains.snapshots.bin part=1 input=in.chains sum=
    if [ -s chains.restart ]; then
        input=in.continue
        [ -f job.frames ] && read -r sum <job.frames
        if [ "$sum" = "$(head -c 4096 chains.restart | sha256sum)" ]; then
            while read -r last size; do
                [[ "$last $size" =~ ^chains\.(dump|snapshots)(\.([1-9][0-9]{0,8}))?\.bin\ [0-9]{1,18}$ ]] ||
                    fail "job.frames cannot be read"
                part=$((${BASH_REMATCH[3]:-1} + 1))
                [ "$(wc -c <"$last" || echo 0)" -ge "$size" ] || fail "$last is shorter than it was"
                [ ! -e "$last" ] || truncate -s "$size" "$last"
            done < <(tail -n +2 job.frames)
            dump=chains.dump.$part.bin snapshots=chains.snapshots.$part.bin
        else  # of a run that was no job
            while [ -e "$dump" ] || [ -e "$snapshots" ]; do
                part=$((part + 1)) dump=chains.dump.$part.bin snapshots=chains.snapshots.$part.bin
            done
        fi
    else
        step=0
    fi

    left=$((ends - $(date +%s) - margin))
    [ $left -gt 0 ] || [ "$first" = no ] || fail "nothing is left of the time limit after the checks and a margin of $margin s"
    [ $left -gt 0 ] || again
    pace=$((checkpoint * 1000 / 60 < margin * 50 ? checkpoint * 1000 / 60 : margin * 50))  # ms between looks at the clock
    look=$((pace * 1000000 / (20 * atoms / ranks + 15000) + 1))  # steps, at some 20 ns a bead and messages
    head -c 16384 /dev/zero >.job.reserve  # room for a message that there is none
    state running computes
    rm -f .job.kept
    old=$(wc -c 2>/dev/null <log.lammps || echo 0)
    "${launch[@]}" "$lmp" -in in.job -log none -screen none -nocite -var part "$input" -var restart chains.restart \
        -var dump "$dump" -var snapshots "$snapshots" -var ranks "$ranks" -var look "$look" \
        -var rounds $((checkpoint * 1000 / pace + 1)) -var seconds "$((left / 3600)):$((left / 60 % 60)):$((left % 60))" \
        </dev/null >.job.check 2>&1 &
    wait $!
    code=$? full=no
    tail -c +$((old + 1)) log.lammps 2>/dev/null | grep -m 1 ERROR >>.job.check
    [ $code -eq 0 ] || head -c 1000000 /dev/zero >.job.room || full=yes
    rm -f .job.room .job.reserve chains.restart.part
    [ $full = no ] && [ "$(cat .job.kept 2>/dev/null)" != lost ] ||
        fail "the disk does not take what is written (is it full?); make room"
    [ $code -eq 0 ] || fail "LAMMPS ended with exit code $code: $(complaint)"
    before=$step
    step=$(head -n 1 job.step 2>/dev/null | grep -x '[0-9]\{1,18\}') ||
        fail "LAMMPS ended before its input did: $(complaint)"
    if [ "$step" -ge "$steps" ]; then
        state done ""
        rm -f chains.restart job.frames job.step in.job in.continue .job.{check,keep,yes,no,kept}
        exit 0
    fi
    [ "$step" -gt "$before" ] || [ "$first" = no ] || fail "no progress beyond step $step in $left s; ask for more --time"
    again
}

set +u  # the scripts of a site may use unset variables
missing=
for module in "${modules[@]}"; do
    type module >/dev/null 2>&1 || . /etc/profile
    module load "$module" || missing=$module
done
set -u
# whether this job has computed no case yet, and checked LAMMPS; exit codes of a run that was done before, or resumes
first=yes checked=no past=0 onwards=0
