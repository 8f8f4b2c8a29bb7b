# The firmware image in the loop on an emulated board. Sourced after lib.sh and cross.sh.
# shellcheck shell=bash disable=SC2154

# Builds what is compared, or skips.
emulated_board_builds() {
    local oleo=$CARGO_TARGET_DIR/release/oleo
    cross_find || { must_not_skip "image on an emulated board" "$cross_how"; return 1; }
    need qemu-system-arm qemu-system-arm || { must_not_skip "image on an emulated board" "no qemu-system-arm"; return 1; }
    local release=$FIRMWARE_TARGET/$BOARD/release
    emulated_image=$release/oleo-firmware-slcan
    check "image for the emulated board builds" cross_cargo build --release --features slcan || return 1
    check "oleo builds" cargo build "${FEATURES[@]}" --locked --quiet --release || return 1
    check "the image is sealed" "$oleo" seal "$release/oleo-firmware" --out "$emulated_image" || return 1
    check "image for the vehicle builds" cross_cargo build --release || return 1
    check "benchmark builds for the board" cross_cargo build --release -p oleo-bench || return 1
    : > "$OLEO_LOGS/emulated-ticks"
    need binutils-arm-none-eabi arm-none-eabi-objdump || { must_not_skip "the same tick" "no arm-none-eabi-objdump"; return 0; }
    same_tick() { python3 tests/harness/same_function.py oleo_controller::tick::tick "$@"; }
    check "the tick is the same code in both images and in the benchmark" \
        same_tick "$release/oleo-firmware" "$emulated_image" "$release/oleo-bench"
    sed 's/^/   /' "$log"
    # A comparison that cannot fail is none: the same image with another instruction in the tick.
    differs() {
        arm-none-eabi-objcopy "$release/oleo-firmware" "$OLEO_LOGS/other" &&
            python3 - "$OLEO_LOGS/other" << 'END'
import sys
sys.path.insert(0, "tests/harness")
from image import read_sections
from same_function import Image
path = sys.argv[1]
image = Image(path)
address = image.functions["oleo_controller::tick::tick"][100][0]
code = bytearray(image.bytes)
section = next(s for s in image.sections if s.address <= address < s.address + s.size)
code[section.offset + address - section.address] ^= 1
open(path, "wb").write(code)
END
        ! same_tick "$release/oleo-firmware" "$OLEO_LOGS/other"
    }
    check "another instruction in the tick is found" differs
}

# in_the_loop SCENARIO [OPTION...]: the plant here, the image on the emulated board. Each frame that the image sends is compared with that of
# the same controller in this process; the first difference ends the run, and the scenario's checks must be met as without an image.
in_the_loop() {
    local scenario=$1 oleo=$CARGO_TARGET_DIR/release/oleo
    shift
    check "image in the loop: $scenario${*:+ $*}" \
        "$oleo" hil --scenario "$scenario" "$@" --firmware "$emulated_image" --out "$OLEO_LOGS/emulated-$scenario" || return
    sed -n 's/.*"ticks": *\([0-9]*\).*/\1/p' "$OLEO_LOGS/emulated-$scenario/summary.json" | head -n 1 >> "$OLEO_LOGS/emulated-ticks"
}

# What the image sends of itself within three seconds, as lines of a serial CAN adapter.
says_by_itself() {
    timeout --foreground 3 qemu-system-arm -machine netduinoplus2 -display none -monitor none -serial stdio -kernel "$1" < /dev/null 2> /dev/null |
        tr '\r' '\n' | head -n 5
}

# The flash is checked before anything else: an image with another byte says nothing, and one with the right check value says so in BOARD.
flash_is_checked() {
    speaks() { says_by_itself "$emulated_image" | grep -q '^T1FFF01E1'; }
    check "the sealed image speaks" speaks
    cp "$emulated_image" "$OLEO_LOGS/other-flash"
    python3 - "$OLEO_LOGS/other-flash" << 'END'
import sys
sys.path.insert(0, "tests/harness")
from image import read_sections
path = sys.argv[1]
image = bytearray(open(path, "rb").read())
text = next(s for s in read_sections(bytes(image)) if s.name == ".text")
# The last byte of the code belongs to a function of the runtime that this image never calls with it.
image[text.offset + text.size - 1] ^= 1
open(path, "wb").write(image)
END
    silent() { [ -z "$(says_by_itself "$OLEO_LOGS/other-flash")" ]; }
    check "an image with another byte in its flash does not start" silent
    sealed() { grep -q ' 301#' "$1" && ! grep ' 301#' "$1" | grep -qv ' 301#......[0-9A-F][159D]'; }
    check "the board says that its image is sealed" sealed "$OLEO_LOGS/emulated-lane-change-on-belgian/candump.log"
}
