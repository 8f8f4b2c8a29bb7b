#!/usr/bin/env bash
# runs the flashed image in the loop on an emulated STM32F405, against the controller on the host, in short
. tests/harness/lib.sh
. tests/harness/cross.sh
. tests/harness/emulated-board.sh

emulated_board_builds || exit 0
# A lane change on a rough road, both axles lost in a bend, an attack, a dead sensor, and the safe state for good.
in_the_loop lane-change-on-belgian
in_the_loop bus-silence-in-lane-change
in_the_loop masquerade
in_the_loop nan
in_the_loop killed-plant
flash_is_checked
exit 0
