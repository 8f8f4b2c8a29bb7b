#!/usr/bin/env bash
# times our strut beside diffsol's and SciPy's solvers, and our vehicle beside CommonRoad's
. tests/harness/lib.sh

python_packages 'numpy, scipy, vehiclemodels' 'numpy>=1.26' 'scipy>=1.11,<2' 'commonroad-vehicle-models>=3.0.2,<4' || {
    skip "side by side" "scipy or commonroad-vehicle-models cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
}
check "example builds" cargo build --locked --quiet --release -p oleo-plant-sim --example vehicle_side_by_side || exit 0
check "solvers build" cargo build --locked --quiet --release --manifest-path benches/solvers/Cargo.toml || exit 0
# Fewer rounds where the machine has no time.
rounds=${OLEO_ROUNDS:-5}
built=$CARGO_TARGET_DIR/release
PYTHONPATH=$PYTHON_PACKAGES check "side by side" python3 tests/side_by_side.py "$built/strut_by_solvers" "$built/examples/vehicle_side_by_side" --rounds "$rounds"
sed 's/^/   /' "$log"
exit 0
