#!/usr/bin/env bash
# extra: changes the controller's code in each way that cargo-mutants knows; a change that no test notices must be explained
. tests/harness/lib.sh
readonly python=$CARGO_TARGET_DIR/test-python-mutants

have() { PYTHONPATH=$python python3 -c 'import tree_sitter, tree_sitter_rust' 2> /dev/null; }
if ! have; then
    echo "   installing tree-sitter"
    python3 -m pip install --quiet --target "$python" 'tree-sitter>=0.25,<0.27' 'tree-sitter-rust>=0.24,<0.25' > "$OLEO_LOGS/pip.log" 2>&1
fi
have || { skip "mutants" "tree-sitter is not to be had: $(tail -n 1 "$OLEO_LOGS/pip.log")"; exit 0; }
cargo_tool cargo-mutants || { skip "mutants" "no cargo-mutants, and none to be installed"; exit 0; }
tree=$CARGO_TARGET_DIR/mutants
CARGO_TARGET_DIR=$tree/target PYTHONPATH=$python OLEO_TAIL=200 check "no survivor without an explanation" \
    python3 tests/harness/mutants.py --tree "$tree" --report "$OLEO_LOGS/mutants.tsv" --files "${OLEO_MUTANTS_FILES:-.}"
sed -n '/^   file /,$p' "$log"
exit 0
