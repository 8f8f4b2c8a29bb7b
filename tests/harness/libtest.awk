# What `cargo test -- --show-output` said, as lines "kind<TAB>name<TAB>reason": one for each failed and skipped test, and
# one "passed<TAB>count". tests/vcan.rs is left out: the step `vcan` runs it where there is a bus.
/^ +Running / { binary = $2; if (binary == "unittests") binary = $3; block = ""; next }
/^ +Doc-tests / { binary = $2; block = ""; next }
/^---- .* stdout ----$/ { block = $2; next }
/^(failures|successes):$/ { block = "" }
binary == "tests/vcan.rs" { next }
/SKIPPED: / && block != "" && !((binary, block) in told) {
    told[binary, block] = 1
    skipped++
    sub(/.*SKIPPED: /, "")
    print "skipped\t" binary " " block "\t" $0
}
/^test .* \.\.\. ignored/ { reason = $0; sub(/.*ignored,? ?/, "", reason); print "skipped\t" binary " " $2 "\t" (reason == "" ? "ignored" : reason) }
/^test .* \.\.\. FAILED$/ { name = $0; sub(/^test /, "", name); sub(/ \.\.\. FAILED$/, "", name); print "failed\t" binary " " name }
/^test result: / { for (i = 1; i < NF; i++) if ($(i + 1) == "passed;") passed += $i }
END { print "passed\t" passed - skipped }
