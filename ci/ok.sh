# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2034,SC2154
# Counts checks. Other scripts source this file; they set $log.
passed=0 failed=0 skipped=0

# ok NAME COMMAND...: runs the command as one check
ok() {
    name=$1
    shift
    if "$@" >"$log" 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED $name"
        tail -n 20 "$log"
    fi
}
