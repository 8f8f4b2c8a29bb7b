#!/usr/bin/env bash
# builds the program for another C library (musl) and another processor (aarch64, emulated), and compares its results bit by bit
. tests/harness/lib.sh

readonly ELSEWHERE=$CARGO_TARGET_DIR/elsewhere
readonly CAMPAIGN=../shared/recordings/real/drive-emps
readonly RUNS=(
    "hil --scenario belgian"
    "hil --scenario lane-change-on-belgian"
    "hil --scenario lossy-bus"
    "drive --manoeuvre lane-change-2 --road iso-d --setting controlled,baseline"
    "diagnose $CAMPAIGN --fit-until 0.5"
)

check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0

# run PROGRAM NAME: every command of RUNS, in its own folder.
run() {
    local k
    mkdir -p "$OLEO_LOGS/$2"
    for k in "${!RUNS[@]}"; do
        [[ ${RUNS[k]} == *$CAMPAIGN* && ! -d $CAMPAIGN ]] && continue
        # shellcheck disable=SC2086 # words are arguments
        $1 ${RUNS[k]} --out "$OLEO_LOGS/$2/$k" || return 1
    done
}

# What may differ between two machines: how long it took, and which build it was. The page holds both.
same() {
    diff -r --exclude report.html --exclude junit.xml --exclude .oleo \
        --ignore-matching-lines '"\(wall_s\|real_time_factor\|runtime_s\|version\)"' "$OLEO_LOGS/here" "$OLEO_LOGS/$1"
}

run_here() { run "$CARGO_TARGET_DIR/release/oleo" here; }
check "runs on this machine" run_here || exit 0

# elsewhere TARGET RUNNER...: builds for a target of the toolchain, which links with its own linker, and compares.
elsewhere() {
    local target=$1 variable=CARGO_TARGET_${1^^}_LINKER
    shift
    rustup target list --installed 2> /dev/null | grep -qx "$target" || timeout 120 rustup target add "$target" > "$OLEO_LOGS/rustup.log" 2>&1 ||
        { skip "$target" "rustup cannot add it"; return; }
    check "build for $target" env "${variable//-/_}=rust-lld" CARGO_TARGET_DIR="$ELSEWHERE" \
        cargo build "${FEATURES[@]}" --locked --quiet --release --target "$target" || return
    run_there() { run "$* $ELSEWHERE/$target/release/oleo" "$target"; }
    check "runs of $target" run_there "$@" && check "$target: the same bits" same "$target"
}

elsewhere x86_64-unknown-linux-musl
if need qemu-user-static qemu-aarch64-static; then
    elsewhere aarch64-unknown-linux-musl qemu-aarch64-static
else
    skip "aarch64-unknown-linux-musl" "no qemu-aarch64-static"
fi
exit 0
