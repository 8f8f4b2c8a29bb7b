#!/usr/bin/env bash
# what is committed names no path of a machine and no registry host, and its links lead somewhere
. tests/harness/lib.sh
check "no path of a machine" python3 tests/harness/documents.py paths
check "links lead somewhere" python3 tests/harness/documents.py links
exit 0
