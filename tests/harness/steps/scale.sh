#!/usr/bin/env bash
# runs a study as twelve shards on a Slurm of its own, one of them killed, and holds the manifest for Kubernetes against its schema
. tests/harness/lib.sh

check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0
folder=$(mktemp -d)
export SLURM_FOLDER=$CARGO_TARGET_DIR/slurm
check "twelve shards on Slurm, one killed" tests/harness/with-slurm.sh tests/harness/slurm-shards.sh "$CARGO_TARGET_DIR/release/oleo" "$folder"
grep -E 'shard.* (killed|missing|undivided)' "$log" | sed 's/^/   /'
rm -r "$folder"

manifest_is_valid() { PYTHONPATH=$PYTHON_PACKAGES python3 -m kubernetes_validate --strict "$1"; }
if python_packages 'kubernetes_validate' 'kubernetes-validate>=1.30,<2'; then
    check "manifest for Kubernetes" manifest_is_valid examples/kubernetes.yaml
    # A check that cannot fail proves nothing.
    readonly planted=$OLEO_LOGS/planted.yaml
    sed 's/completionMode/completionMood/' examples/kubernetes.yaml > "$planted"
    finds() { ! manifest_is_valid "$planted"; }
    check "a misspelt key of the manifest is found" finds
else
    skip "manifest for Kubernetes" "kubernetes-validate cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
fi
exit 0
