#!/usr/bin/env bash
# The hash of the valve words of a run of `oleo hil`, on standard output:
#
#     tests/harness/hil-hash.sh OLEO OUT [ARGUMENT...]
#
# OLEO is the binary, OUT the folder of its files, ARGUMENTs those of `oleo hil`. What it says goes to OUT.log.
set -u
oleo=$1 out=$2
shift 2
"$oleo" hil --out "$out" "$@" > "$out.log" 2>&1 < /dev/null
sed -n 's/.*"command_hash": *"\{0,1\}\([0-9a-zA-Z]*\).*/\1/p' "$out/summary.json"
