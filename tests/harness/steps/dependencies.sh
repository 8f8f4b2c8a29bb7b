#!/usr/bin/env bash
# counts the crates of the first command, and holds licences, sources, versions and advisories of all crates against deny.toml
. tests/harness/lib.sh

# Crates that `cargo run --release -- hil` builds. Who needs one more in it raises the number and says why in the commit.
readonly MOST_CRATES=182
crates_of() { cargo tree --locked -e normal --prefix none "$@" | sed 's/ (\*)$//' | sort -u | wc -l; }
first_command() {
    local crates
    crates=$(crates_of)
    echo "$crates crates, with every feature $(crates_of "${FEATURES[@]}")"
    [ "$crates" -gt 50 ] && [ "$crates" -le "$MOST_CRATES" ]
}
check "the first command builds at most $MOST_CRATES crates" first_command
sed 's/^/   /' "$log"

cargo_tool cargo-deny || {
    skip "licences, sources, versions and advisories" "no cargo-deny, and none to be installed"
    exit 0
}
for what in licenses sources bans; do
    check "deny.toml: $what" cargo deny --locked --log-level error check --hide-inclusion-graph -D unmatched-skip "$what"
done
# The database of advisories is a git repository elsewhere, which not every machine can reach.
advisories() {
    cargo deny --locked --log-level error check --hide-inclusion-graph advisories && return 0
    grep -q "advisory database" "$log" || return 1
    echo "the database of advisories cannot be fetched"
    return 77
}
check "deny.toml: advisories" advisories
exit 0
