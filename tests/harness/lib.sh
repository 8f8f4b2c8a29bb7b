# What every step of ./test is written with: run a check, skip loudly, get a missing tool. Sourced, never run.
# shellcheck shell=bash
set -u

: "${CARGO_TARGET_DIR:=$PWD/target}" "${OLEO_STEP:=step}"
: "${OLEO_LOGS:=$CARGO_TARGET_DIR/test}" "${OLEO_TALLY:=$CARGO_TARGET_DIR/test/tally}"
export CARGO_TARGET_DIR OLEO_STEP OLEO_LOGS OLEO_TALLY
mkdir -p "$OLEO_LOGS"

# One build serves all steps, so it has every feature; only `dependencies` looks at what the first command builds.
# shellcheck disable=SC2034 # read by the steps
readonly FEATURES=(--features 'logs,mcap,parquet,fmu,calibration')

# tally passed|failed|skipped COUNT NAME [REASON]
tally() { printf '%s\t%s\t%s\t%s\n' "$1" "$2" "$OLEO_STEP: $3" "${4:-}" >> "$OLEO_TALLY"; }

pass() { echo "   passed  $1"; tally passed 1 "$1"; }
fail() { echo "   FAILED  $1: $2"; tally failed 1 "$1" "$2"; }
skip() { echo "   SKIPPED $1: $2"; tally skipped 1 "$1" "$2"; }

# must_not_skip NAME REASON: a skip, and where CI=true a failure, because there every tool can be had.
must_not_skip() {
    if [ "${CI:-}" = true ]; then fail "$1" "$2, and CI=true permits no skip"; else skip "$1" "$2"; fi
}

# check NAME COMMAND...: runs it with its output kept in $log. Status 0 passes, 77 skips (reason: its last line), all
# else fails and shows the end of the output. Returns the command's status.
check() {
    local name=$1 status
    shift
    log=$OLEO_LOGS/$OLEO_STEP.$(tr -c 'a-zA-Z0-9\n' - <<< "$name").log
    "$@" > "$log" 2>&1 < /dev/null
    status=$?
    case $status in
        0) pass "$name" ;;
        77) skip "$name" "$(tail -n 1 "$log")" ;;
        *) fail "$name" "status $status of: $*"; tail -n "${OLEO_TAIL:-40}" "$log" | sed 's/^/           /' ;;
    esac
    return $status
}

packages_present() {
    local status
    status=$(dpkg-query -W -f '${db:Status-Status}\n' "$@" 2> /dev/null) || return 1
    ! grep -qvx installed <<< "$status"
}

# packages NAME...: Debian packages, installed if they are not there and we may. Returns whether all are there.
packages() {
    local root=()
    command -v apt-get > /dev/null || return 1
    packages_present "$@" && return 0
    if [ "$(id -u)" -ne 0 ]; then
        sudo -n true 2> /dev/null || return 1
        root=(sudo -n)
    fi
    echo "   installing $*"
    get() { "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "$@" >> "$OLEO_LOGS/apt.log" 2>&1 < /dev/null; }
    # Lists may be absent or old: fetch them when the first try did not do. One at a time: apt refuses to run twice.
    (
        flock 9
        get install -qq -y --no-install-recommends "$@" ||
            { get update -qq; get install -qq -y --no-install-recommends "$@"; }
    ) 9> "$CARGO_TARGET_DIR/apt.lock"
    packages_present "$@"
}

# need PACKAGE TOOL...: whether all the tools are there, after installing the Debian package if one is not.
need() {
    local package=$1
    shift
    command -v "$@" > /dev/null && return 0
    packages "$package"
    command -v "$@" > /dev/null
}

# cargo_tool NAME: whether a tool of cargo is there, after building and installing it if it is not. One is built at a time, so that a step
# waits for what ./test has begun.
cargo_tool() {
    local name=$1
    cargo "${name#cargo-}" --version > /dev/null 2>&1 && return 0
    echo "   installing $name"
    (
        flock 9
        cargo "${name#cargo-}" --version > /dev/null 2>&1 && exit 0
        # Without optimisation and checks: building takes longer than running. In a folder of its own: cargo locks the one in which it builds.
        CARGO_PROFILE_DEV_DEBUG=0 CARGO_PROFILE_DEV_DEBUG_ASSERTIONS=false CARGO_PROFILE_DEV_OVERFLOW_CHECKS=false cargo install --quiet --debug --locked --target-dir "$CARGO_TARGET_DIR/tools" "$name" > "$OLEO_LOGS/$name.log" 2>&1
    ) 9> "$CARGO_TARGET_DIR/tools.lock"
}

# Where Python packages for the tests are installed.
# shellcheck disable=SC2034 # read by the steps
readonly PYTHON_PACKAGES=$CARGO_TARGET_DIR/test-python

# python_packages "MODULE, MODULE" PACKAGE...: whether the modules can be imported, after installing the packages if one cannot.
python_packages() {
    local modules=$1
    shift
    have() { PYTHONPATH=$PYTHON_PACKAGES python3 -c "import $modules" 2> /dev/null; }
    have && return 0
    echo "   installing $modules"
    # One at a time, into one folder.
    (
        flock 9
        have || python3 -m pip install --quiet --target "$PYTHON_PACKAGES" "$@" > "$OLEO_LOGS/pip-$OLEO_STEP.log" 2>&1
    ) 9> "$CARGO_TARGET_DIR/pip.lock"
    have
}

# libtest NAME COMMAND...: runs Rust tests (with --show-output, so that a test which says "SKIPPED: reason" and returns
# is told from one that passed) and tallies each.
libtest() {
    local title=$1 status kind name reason counts
    shift
    log=$OLEO_LOGS/$OLEO_STEP.$(tr -c 'a-zA-Z0-9\n' - <<< "$title").log
    "$@" > "$log" 2>&1 < /dev/null
    status=$?
    counts=$(awk -v title="$title" -f tests/harness/libtest.awk "$log")
    while IFS=$'\t' read -r kind name reason; do
        case $kind in
            passed) [ "$name" -gt 0 ] && echo "   passed  $name tests of $title" && tally passed "$name" "$title" ;;
            failed) fail "$name" "see $log" ;;
            skipped) skip "$name" "$reason" ;;
        esac
    done <<< "$counts"
    [ $status -eq 0 ] && return 0
    grep -q '^failed' <<< "$counts" || fail "$title" "did not build or run to its end (status $status)"
    grep -vE ' \.\.\. ok$|^ +(Running|Compiling|Doc-tests)|^$' "$log" | tail -n 60 | sed 's/^/           /'
    return $status
}
