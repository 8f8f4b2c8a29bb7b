#!/usr/bin/env bash
# Submits a study as twelve shards to Slurm, kills one with SIGKILL, submits again, and holds the merged results against the
# undivided run. Called in tests/harness/with-slurm.sh.
#
#     tests/harness/slurm-shards.sh OLEO FOLDER
set -u
readonly oleo=$1 shards=12 vehicles=48
cd "$2" || exit 1
study() { echo study robust --vehicles "$vehicles" --first 100; }
fail() { echo "slurm-shards: $1"; tail -n 3 merged.shards/log/* 2> /dev/null; exit 1; }
# Until the queue is empty, 0.2 s at a time: nothing is said of how long it takes.
drain() {
    for _ in $(seq 3000); do
        [ -n "$(squeue --noheader)" ] || return 0
        sleep 0.2
    done
    fail "jobs do not end: $(squeue --noheader)"
}
# A shard that is at work and has something done already, so that it has what it can go on from: its process and its number.
at_work() {
    local process number
    for process in $(pgrep -f -- "--out=$PWD/merged.shards"); do
        number=$(tr '\0' '\n' 2> /dev/null < "/proc/$process/environ" | sed -n 's/^SLURM_ARRAY_TASK_ID=//p')
        [ -n "$number" ] || continue
        if [ -n "$(find merged.shards -name "$(printf 'shard-%02d-of-*.begun' "$number")" -size +0)" ]; then
            echo "$process $number"
            return
        fi
    done
}

# shellcheck disable=SC2046 # words
"$oleo" $(study) --out whole > whole.log 2>&1 || fail "the undivided run: $(tail -n 1 whole.log)"

# shellcheck disable=SC2046
submit() { "$oleo" submit --shards "$shards" -- $(study) --out merged; }
submit || fail "not submitted"
submit 2> again.log && fail "submitted twice"
grep -q 'still runs shards' again.log || fail "refused for another reason: $(cat again.log)"
pid='' killed=''
for _ in $(seq 3000); do
    read -r pid killed <<< "$(at_work)"
    if [ -n "$pid" ] || [ -e merged ]; then break; fi
    sleep 0.02
done
[ -n "$pid" ] || fail "no shard was seen at work"
kill -9 "$pid" || fail "shard $killed could not be killed"
echo "shard $killed killed"
drain
finished=$(find merged.shards -name '*.records' | wc -l)
[ "$finished" -eq $((shards - 1)) ] || fail "$finished shards are finished, where $((shards - 1)) should be"
[ ! -e merged ] || fail "merged without shard $killed"
"$oleo" merge merged.shards --out merged 2> missing.log && fail "merged without shard $killed"
grep -q "1 of $shards shards is missing: $killed;" missing.log || fail "the missing shard is not named: $(cat missing.log)"
cat missing.log

said=$(submit) || fail "not submitted again"
echo "$said"
grep -q ": 1 of $shards shards ($killed)$" <<< "$said" || fail "not only shard $killed was submitted"
drain
[ -e merged/report.html ] || fail "the merge did not follow"

# The page differs in the command line only, the list of files in the digest of the page.
result() { # FOLDER COMMAND
    (
        cd "$1" || exit 1
        sed -i "s|$2|COMMAND|g" report.html
        find . -type f ! -name .oleo ! -name drives.csv | sort | xargs sha256sum
    )
}
whole=$(result whole "oleo $(study) --out whole")
merged=$(result merged "oleo study robust --vehicles=$vehicles --first=100")
echo "$merged"
grep -q COMMAND merged/report.html || fail "the page does not say its command"
[ "$whole" = "$merged" ] || { diff <(echo "$whole") <(echo "$merged"); fail "the results are not those of the undivided run"; }
echo "$(wc -l <<< "$merged") files of $shards shards are those of the undivided run"
