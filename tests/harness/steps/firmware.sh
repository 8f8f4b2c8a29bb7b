#!/usr/bin/env bash
# builds the firmware for the STM32F405, and prints its size and worst-case stack
. tests/harness/lib.sh
. tests/harness/cross.sh

cross_find || { skip "firmware" "$cross_how"; exit 0; }
echo "   $cross_how"
check "firmware builds" cross_cargo build --release || exit 0
# Debian's compiler comes without clippy; then what is not checked here is at least built without a warning.
if [ "$cross_way" = rustup ]; then
    check "clippy finds nothing in the firmware" cross_cargo clippy --release -p oleo-firmware -- -D warnings
    check "clippy finds nothing in the benchmark" cross_cargo clippy --release -p oleo-bench -- -D warnings
else
    skip "clippy of the firmware" "Debian's compiler has no clippy"
fi

image=$FIRMWARE_TARGET/$BOARD/release/oleo-firmware
need binutils-arm-none-eabi arm-none-eabi-objdump || { skip "size and stack" "no arm-none-eabi-objdump"; exit 0; }
check "size and stack" python3 tests/harness/image.py "$image" --flash 1048576 --ram 131072 --root Reset
sed 's/^/   /' "$log"
exit 0
