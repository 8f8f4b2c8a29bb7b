# What Rust tests run with --show-output said, as lines "kind<TAB>name<TAB>reason": one for each failed and each
# skipped test, then one "passed<TAB>count". `title` names the tests where no line of cargo's does.
# The end-to-end tests that have a step of their own are left out of `cargo test --workspace`.
BEGIN {
    binary = title
    split("tests/vcan.rs tests/recordings.rs tests/diagnose_real.rs", own)
    if (title == "cargo test") for (i in own) elsewhere[own[i]] = 1
}
/^ +Running / { binary = ($2 == "unittests") ? $3 : $2; sub(/^.*\(.*deps\//, "", $NF); sub(/-[0-9a-f]*\)$/, "", $NF); if (binary ~ /^src/) binary = $NF; block = "" }
/^ +Doc-tests / { binary = "doc " $2; block = "" }
binary in elsewhere { next }
/^---- .* stdout ----$/ { block = $0; sub(/^---- /, "", block); sub(/ stdout ----$/, "", block); next }
/^(failures|successes):$/ { block = "" }
/SKIPPED: / && block != "" && !((binary, block) in told) {
    told[binary, block] = 1; skipped++
    sub(/.*SKIPPED: /, "")
    print "skipped\t" binary " " block "\t" $0
}
/^test .* \.\.\. ignored/ {
    name = $0; sub(/^test /, "", name); sub(/ \.\.\. ignored.*/, "", name)
    reason = $0; sub(/.* \.\.\. ignored(, )?/, "", reason)
    print "skipped\t" binary " " name "\t" (reason == "" ? "ignored" : reason)
}
/^test .* \.\.\. FAILED$/ { name = $0; sub(/^test /, "", name); sub(/ \.\.\. FAILED$/, "", name); print "failed\t" binary " " name "\t" }
/^test result: / { for (i = 2; i <= NF; i++) if ($i == "passed;") passed += $(i - 1) }
END { print "passed\t" passed - skipped "\t" }
