#!/usr/bin/env bash
# builds the Python wheel, compares it with the command line bit by bit, checks its types, and runs its notebooks
. tests/harness/lib.sh

# In a folder of its own: pip leaves a folder of scripts as it is where there already is one.
readonly maturin=$CARGO_TARGET_DIR/test-maturin/bin/maturin
have_maturin() {
    [ -x "$maturin" ] ||
        python3 -m pip install --quiet --target "$CARGO_TARGET_DIR/test-maturin" 'maturin>=1.9,<2' > "$OLEO_LOGS/pip-$OLEO_STEP.log" 2>&1
    [ -x "$maturin" ]
}
if ! { have_maturin && python_packages 'pandas, numpy, matplotlib, can, cantools, nbclient, nbformat, ipykernel, mypy' \
    'pandas>=2.1' 'numpy>=1.26' matplotlib 'python-can>=4.4,<5' 'cantools>=40,<46' nbclient nbformat ipykernel mypy pandas-stubs; }; then
    skip "Python wheel" "a package cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
fi
export PYTHONPATH=$PYTHON_PACKAGES

wheels=$(mktemp -d)
# The wheel for tests is made of what the tests have built, in the dev profile. Alone, as users build it, the package asks for fewer features of the
# libraries; that it compiles with these is another check, because building all of them once more takes minutes.
CARGO=$PWD/tests/harness/cargo-of-workspace.sh check "wheel builds" "$maturin" build --locked --quiet --manifest-path python/Cargo.toml --out "$wheels" || exit 0
check "the package compiles by itself" cargo check --locked --quiet --manifest-path python/Cargo.toml
check "wheel installs" python3 -m pip install --no-deps --target "$wheels/site" "$wheels"/oleo-*.whl || exit 0
PYTHONPATH=$wheels/site:$PYTHONPATH
check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0

check "wheel = command line, and its complaints" python3 python/tests/test_wheel.py "$CARGO_TARGET_DIR/release/oleo"
tail -n 3 "$log" | sed 's/^/   /'
check "examples of the documentation in the code" python3 -c "import doctest, oleo._strut as strut; raise SystemExit(doctest.testmod(strut).failed)"
check "types of the package" python3 -m mypy --config-file python/pyproject.toml --cache-dir "$OLEO_LOGS/mypy" python/oleo
check "notebooks" python3 python/tests/run_notebooks.py python/notebooks
grep '\.ipynb: ' "$log" | sed 's/^/   /'
rm -r "$wheels"
exit 0
