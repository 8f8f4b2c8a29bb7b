#!/usr/bin/env bash
# builds the firmware for the STM32F405, and prints its size and worst-case stack
. tests/harness/lib.sh
. tests/harness/cross.sh

cross_find || { must_not_skip "firmware" "$cross_how"; exit 0; }
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
need binutils-arm-none-eabi arm-none-eabi-objdump || { must_not_skip "size and stack" "no arm-none-eabi-objdump"; exit 0; }
# Budgets: a change that needs more raises them here, and says so.
in_budget() {
    python3 tests/harness/image.py "$image" --flash 24576 --ram 8192 --root Reset --stack 1024 &&
        python3 tests/harness/image.py "$image" --flash 24576 --ram 8192 --root oleo_firmware::run --stack 1024
}
check "flash, RAM and stack are in budget (24 KiB, 8 KiB; 1 KiB at the start and in the loop)" in_budget
sed 's/^/   /' "$log"
# A budget that cannot be exceeded is none.
too_small() { ! python3 tests/harness/image.py "$image" --flash 24576 --ram 8192 --root Reset --stack 100; }
check "a stack above its budget is found" too_small
exit 0
