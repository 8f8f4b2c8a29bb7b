#!/usr/bin/env bash
# checks that no committed file names a path of a machine or a registry host, and that all links lead to a file
. tests/harness/lib.sh
check "no path of a machine" python3 tests/harness/documents.py paths
check "links lead somewhere" python3 tests/harness/documents.py links
exit 0
