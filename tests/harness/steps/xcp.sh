#!/usr/bin/env bash
# lets pya2l read the description file and pyxcp measure, record and calibrate over a real SocketCAN interface
. tests/harness/lib.sh
readonly with_vcan=tests/harness/with-vcan.sh

if ! python_packages 'pyxcp.master, pya2l, can' 'pyxcp>=0.29.20,<0.30' 'pya2ldb>=1.0.355,<2' 'python-can>=4.6,<5'; then
    skip "XCP" "a package cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
fi
export PYTHONPATH=$PYTHON_PACKAGES
packages iproute2
OLEO_VCAN_BY=namespace "$with_vcan" true > /dev/null 2>&1 || packages user-mode-linux busybox-static
if ! "$with_vcan" true > "$OLEO_LOGS/xcp.vcan.log" 2>&1; then
    must_not_skip "XCP" "$(tail -n 1 "$OLEO_LOGS/xcp.vcan.log")"
    exit 0
fi

check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0
readonly program=$CARGO_TARGET_DIR/release/oleo
check "pyxcp measures, records and calibrates over vcan0" \
    "$with_vcan" python3 xcp/tests/test_pyxcp.py "$program" vcan0
grep -E '^(DAQ|writing):' "$log" | sed 's/^/   /'

# The slave as a board would build it: without std, without heap, and without the code that writes. The image for the board has none of it.
if rustup target list --installed 2> /dev/null | grep -q thumbv7em-none-eabihf; then
    check "the slave builds without std" \
        cargo build --locked --quiet -p oleo-xcp --lib --target thumbv7em-none-eabihf
else
    skip "the slave builds without std" "rustup has no target thumbv7em-none-eabihf"
fi
check "the slave answers in the build that does not write" cargo test --locked --quiet -p oleo-xcp
exit 0
