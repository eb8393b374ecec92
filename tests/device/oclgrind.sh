#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# oclgrind.sh OPENCL_TEST: runs its smallest case in oclgrind, an interpreter that checks every memory access and API
# call; any complaint is a failure.
set -euo pipefail
[ $# -eq 1 ] || { echo "usage: oclgrind.sh OPENCL_TEST" >&2; exit 2; }
command -v oclgrind >/dev/null || { echo "oclgrind.sh: oclgrind is not installed (Debian package: oclgrind)" >&2; exit 1; }
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Unoptimised: it does not know what inlining makes of `restrict`.
oclgrind --build-options -cl-opt-disable --check-api --data-races --max-errors 20 --log "$log" "$1" --gtest_filter='small.*' | tee /dev/stderr \
    | grep '\[  PASSED  \] 1 test' >/dev/null
if [ -s "$log" ]; then
    echo "oclgrind.sh: oclgrind complains:" >&2
    cat "$log" >&2
    exit 1
fi
