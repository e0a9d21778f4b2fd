# From here on every job is the same. What it leaves in job.state, `granchain status` reads.
set -u
export LC_ALL=C OMP_NUM_THREADS=1
started=$(date +%s)
itself=${SLURM_ARRAY_JOB_ID:+${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID}
itself=${itself:-${SLURM_JOB_ID:-0}}
ends=${SLURM_JOB_END_TIME:-$(date -d "$(squeue -h -j "$itself" -o %e 2>/dev/null | head -n 1 | tr T ' ')" +%s)}
[ "$ends" -gt "$started" ] 2>/dev/null || ends=$((started + time_limit))
number=${1:-1}  # of this job among those that submitted each other
home=${SLURM_SUBMIT_DIR:-$PWD}
task=${SLURM_ARRAY_TASK_ID:-}
cd -- "$home" || exit 1
[ ! /dev/stdout -ef /dev/null ] || exec >>job.out 2>&1

whole_number() { head -n 1 "$1" 2>/dev/null | grep -x '[0-9]\{1,18\}'; }
last_word() { sed -n "s/^$2 //p" "$1" 2>/dev/null | tail -n 1; }

state() {  # STATE REASON
    {
        printf 'state %s\nstep %s\nsteps %s\n' "$1" "$step" "$steps"
        printf 'job %s\nnumber %s\nranks %s\n' "$job" "$number" "$ranks"
        printf 'cluster %s\nhost %s\ntime %s\nends %s\n' "${SLURM_CLUSTER_NAME:-}" "${HOSTNAME:-}" "$(date +%s)" "$ends"
        printf 'reason %s\n' "$(printf '%s' "$2" | head -n 1 | tr -cd '[:print:]' | cut -c 1-300)"
    } >.job.state.part && mv -f .job.state.part job.state
    printf 'granchain: %s %s\n' "$1" "$2"
}

fail() { state failed "$1"; exit 1; }
refuse() { echo "granchain: $1" >&2; exit 1; }  # and leave everything as it is

if [ -n "$cases" ] && [ "$(sha256sum <"$cases")" != "$cases_sum  -" ]; then
    refuse "$cases is not the list that this array was made for"
fi

again() {  # submit the next job of this run, and end
    [ "$number" -lt "$max_jobs" ] || { state incomplete "stopped after $number jobs (--max-jobs)"; exit 1; }
    state waiting "for the next job to be submitted"
    self=${SLURM_ARRAY_JOB_ID:+${SLURM_ARRAY_JOB_ID}_$task}
    cd -- "$home"
    next=$(sbatch --parsable ${task:+--array=$task} --dependency="afterany:${self:-$job}" job.sbatch $((number + 1)) 2>&1)
    code=$?
    cd - >/dev/null
    if [ $code -eq 0 ]; then
        job=${next%%;*} number=$((number + 1))
        state waiting "to go on"
        exit "$onwards"
    else
        state incomplete "the next job could not be submitted: $next"
        exit 1
    fi
}

one() {  # compute in this directory
[ -f in.chains ] && [ -f data.chains ] && [ -f in.job ] || refuse "no deck here; submit in its directory"
for file in log.lammps chains.* job.state job.step job.frames; do
    [ ! -L "$file" ] || refuse "$file is a link, and nothing is written through one"
done

job=${SLURM_JOB_ID:-$$}
step=$(whole_number job.step)
step=${step:-0}
steps=$(sed -n 's/^variable steps index \([0-9]*\).*/\1/p' in.chains)
atoms=$(sed -n 's/^\([0-9]*\) atoms$/\1/p;10q' data.chains)
[ -n "$steps" ] && [ -n "$atoms" ] || refuse "in.chains or data.chains is not what granchain wrote"
was=$(last_word job.state state) other=$(last_word job.state job)
if [ "$was" = done ]; then echo "granchain: this run is done"; exit "$past"; fi
if [ -n "$other" ] && [ "$other" != "$job" ] && squeue -h -j "$other" -t R 2>/dev/null | grep -q .; then
    refuse "job $other computes here"
fi
if type flock >/dev/null 2>&1; then
    exec 9<.
    flock -n 9
    [ $? -ne 1 ] || refuse "something computes here already"
fi
trap 'state incomplete "cancelled, or stopped at its time limit"; kill "${!:-}" 2>/dev/null; exit 1' TERM
state running "checks"

set +u  # the site's own scripts may not be so strict
for module in "${modules[@]}"; do
    type module >/dev/null 2>&1 || . /etc/profile
    module load "$module" || fail "module load $module failed"
done
set -u
quietly() { timeout 300 "$@" </dev/null >.job.check 2>&1 & wait $!; }
complaint() { grep -h -m 1 -e ERROR -e 'Fatal error' "$@" 2>/dev/null || grep -h . "$@" 2>/dev/null | tail -n 1; }

if [ "$checked" = no ]; then
# the executable and what it can do
quietly "${launch[@]}" "$lmp" -h || fail "$lmp cannot be started: $(complaint .job.check)"
for package in GRANULAR $(grep -q '^bond_style' in.chains && echo MOLECULE) $(grep -q ' dpd/ext' in.chains && echo DPD-BASIC); do
    grep -qw "$package" .job.check || fail "$lmp has no package $package"
done

# the ranks: one LAMMPS on all of them, not as many copies of a serial one
printf 'processors * 1 1\nregion all block 0 1 0 1 0 1\ncreate_box 1 all\n' >.job.in
quietly "${launch[@]}" "$lmp" -in .job.in -log none || fail "a run of nothing failed: $(complaint .job.check)"
found=$(sed -n 's/^ *\([0-9]* by [0-9]* by [0-9]*\) MPI processor grid.*/\1/p' .job.check)
[ "$found" = "$ranks by 1 by 1" ] ||
    fail "$ranks ranks asked, found: $(echo $found); '${launch[*]}' does not belong to the MPI library of $lmp"
fi

# A restart counts when it and the frames before it are on the disk, which LAMMPS itself may not notice.
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

# where to go on: at the restart, with the next part of the frames; those that it will make again are taken away
restart=chains.restart dump=chains.dump.bin snapshots=chains.snapshots.bin part=1 input=in.chains
if [ -s "$restart" ]; then
    sum=
    [ -f job.frames ] && read -r sum <job.frames
    if [ "$sum" = "$(head -c 4096 "$restart" | sha256sum)" ]; then
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
    input=in.continue
else
    step=0
    mkdir -p .job && ln -sf ../in.chains ../data.chains .job/ || fail "there is no room for a check of the deck"
    (cd .job && exec "${launch[@]}" "$lmp" -in in.chains -log none -skiprun -var steps 0) </dev/null >.job.check 2>&1 &
    wait $!
    code=$?
    rm -rf .job
    [ $code -eq 0 ] || fail "the deck cannot be read: $(complaint .job.check)"
fi

left=$((ends - $(date +%s) - margin))
checks=$(($(date +%s) - started))
[ $left -gt 0 ] || [ "$first" = no ] || fail "nothing is left of the time limit after $checks s of checks and a margin of $margin s"
[ $left -gt 0 ] || again
pace=$((checkpoint / 60 * 20 < margin || checkpoint < 60 ? checkpoint * 1000 / 60 : margin * 50))  # ms, or more
look=$((pace * 1000000 / (20 * atoms / ranks + 15000) + 1))  # steps, at some 20 ns a bead and messages
head -c 16384 /dev/zero >.job.reserve  # room to say that there is none
state running computes
rm -f .job.kept
old=$(wc -c 2>/dev/null <log.lammps || echo 0)
"${launch[@]}" "$lmp" -in in.job -log none -screen none -nocite -var part "$input" -var restart "$restart" \
    -var dump "$dump" -var snapshots "$snapshots" -var ranks "$ranks" -var look "$look" -var rounds "$((checkpoint * 1000 / pace + 1))" \
    -var seconds "$((left / 3600)):$((left / 60 % 60)):$((left % 60))" \
    </dev/null >.job.check 2>&1 &
wait $!
code=$?
tail -c +$((old + 1)) log.lammps 2>/dev/null | grep -m 1 ERROR >>.job.check
full=no
[ $code -eq 0 ] || head -c 1000000 /dev/zero >.job.room || full=yes
rm -f .job.room .job.reserve chains.restart.part  # makes room to say so
[ $full = no ] && [ "$(cat .job.kept 2>/dev/null)" != lost ] ||
    fail "the disk does not take what is written (is it full?); make room"
[ $code -eq 0 ] || fail "LAMMPS ended with exit code $code: $(complaint .job.check)"
reached=$(whole_number job.step) || fail "LAMMPS ended before its input did: $(complaint .job.check)"
before=$step step=$reached

if [ "$step" -ge "$steps" ]; then
    state done ""
    rm -f chains.restart .job.check .job.in .job.keep .job.yes .job.no .job.kept job.frames
    exit 0
fi
[ "$step" -gt "$before" ] || [ "$first" = no ] || fail "no progress beyond step $step in $left s; ask for more --time"
again
}

# first: whether nothing has been computed by this job; past, onwards: exit codes of a run that was done, or continues
first=yes checked=no past=0 onwards=0
if [ -z "$cases" ]; then
    one
    exit
fi
read -r -a directories < <(sed -n "$((task + 1))p" "$cases")  # one task of an array: those in a line of the list
if [ ${#directories[@]} -le 1 ]; then
    cd -- "${directories[0]:-}" || exit 1
    exec >>job.out 2>&1
    one
    exit
fi
past=3 onwards=4 failed=0
for directory in "${directories[@]}"; do
    ( cd -- "$directory" && exec >>job.out 2>&1 && one ) &
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
