# A compiler for the board, whichever this machine can have: `cross_cargo ARGUMENTS...`. Sourced after lib.sh.
# shellcheck shell=bash disable=SC2034
#
# 1. rustup's target, where it is installed or can be downloaded;
# 2. Debian's rustc-web and cargo-web with the library source rust-web-src: core is then built from source, with
#    the linker of the host's toolchain.
# OLEO_CROSS=rustup or OLEO_CROSS=debian takes that way only.
readonly BOARD=thumbv7em-none-eabihf
readonly FIRMWARE_TARGET=$CARGO_TARGET_DIR/firmware

rustup_has_board() { rustup target list --installed 2> /dev/null | grep -qx $BOARD; }
rustup_adds_board() { timeout 120 rustup target add $BOARD > "$OLEO_LOGS/rustup.log" 2>&1 && rustup_has_board; }

# Finds the way once; says it, or why there is none, in $cross_how.
cross_find() {
    if [ "${OLEO_CROSS:-rustup}" = rustup ] && { rustup_has_board || rustup_adds_board; }; then
        cross_how="rustup target $BOARD, $(rustc --version)"
        cross_way=rustup
        return 0
    fi
    packages rustc-web cargo-web rust-web-src
    cross_linker=$(find "$(rustc --print sysroot)" /usr/lib/rustlib -name rust-lld -type f 2> /dev/null | head -n 1)
    if packages_present rustc-web cargo-web rust-web-src && [ -n "$cross_linker" ]; then
        cross_how="core built from source, $(/usr/bin/rustc --version)"
        cross_way=debian
        return 0
    fi
    cross_how="no $BOARD: rustup cannot add it ($(tail -n 1 "$OLEO_LOGS/rustup.log" 2> /dev/null)) and Debian's rustc-web, cargo-web, rust-web-src or a rust-lld are missing"
    return 1
}

# cargo in firmware/ for the board. What is read from its images (stacks, lines) needs their debug information.
cross_cargo() (
    cd firmware || exit 1
    unset CARGO_PROFILE_RELEASE_DEBUG
    export CARGO_TARGET_DIR=$FIRMWARE_TARGET RUSTC_BOOTSTRAP=1 RUSTFLAGS="-C link-arg=-Tlink.x -Z emit-stack-sizes"
    if [ "$cross_way" = rustup ]; then
        exec cargo "$1" --locked --target $BOARD "${@:2}"
    fi
    PATH=$PATH:$(dirname "$cross_linker")
    export PATH RUSTC=/usr/bin/rustc
    exec /usr/bin/cargo "$1" --locked -Zbuild-std=core --target $BOARD "${@:2}"
)

# Builds firmware/bench for this machine, into $bench_binary.
host_bench() (
    cd firmware || exit 1
    unset CARGO_PROFILE_RELEASE_DEBUG
    CARGO_TARGET_DIR=$FIRMWARE_TARGET cargo build --release --locked -p oleo-bench --target "$(rustc --print host-tuple)"
)
bench_binary=$FIRMWARE_TARGET/$(rustc --print host-tuple)/release/oleo-bench
