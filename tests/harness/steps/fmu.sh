#!/usr/bin/env bash
# writes FMUs of both versions, and lets FMPy validate, simulate, save and restore them, many at once; diagnoses FMUs of others
. tests/harness/lib.sh

if ! python_packages 'fmpy, numpy, lxml, pythonfmu, cantools, e2e' 'fmpy>=0.3.32,<0.4' 'numpy>=1.26' 'pythonfmu>=0.7,<0.8' 'cantools>=40,<46' autosar-e2e; then
    skip "FMUs" "a package cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
fi
export PYTHONPATH=$PYTHON_PACKAGES

check "command and shared library build" \
    cargo build "${FEATURES[@]}" --locked --quiet --release -p oleo -p oleo-fmu || exit 0
readonly program=$CARGO_TARGET_DIR/release/oleo library=$CARGO_TARGET_DIR/release/liboleo_fmu.so
check "FMPy opens the strut, which is that of the command line" python3 fmu/tests/test_strut.py "$program" "$library"
sed -n 's/^\.*\(FMI [23]:\)/   \1/p' "$log"
check "FMPy couples vehicle and controller to our own loop" python3 fmu/tests/test_system.py "$program" "$library"
sed -n 's/^\.*\(SSP:\)/   \1/p' "$log"
check "FMPy puts the controller on a simulated CAN" python3 fmu/tests/test_can.py "$program" "$library"
sed -n 's/^\.*\(CAN:\)/   \1/p' "$log"
check "FMUs of other programs are diagnosed" \
    python3 fmu/tests/test_foreign.py "$program" "$library" ../shared/recordings
sed -n 's/^\.*\(FMI 2: \)/   \1/p' "$log"
exit 0
