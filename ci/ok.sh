# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2034,SC2154
# Counts checks. Other scripts source this file; they set $log.
passed=0 failed=0 skipped=0

# Prints the last lines of the log but those of what is good, and before them those of
# failures and errors.
last() {
    grep -vE '^(ok|skipped)' "$log" >"$log.bad"
    awk -v lines="$(wc -l <"$log.bad")" \
        'NR > lines - 20 || /^(FAILED|not ok)|[Ee]rror:/ { print "    " $0 }' \
        "$log.bad" | tail -n 40
    rm -f "$log.bad"
}

# ok NAME COMMAND...: runs the command as one check
ok() {
    name=$1
    shift
    if "$@" >"$log" 2>&1; then
        passed=$((passed + 1))
        echo "ok $name"
    else
        failed=$((failed + 1))
        echo "FAILED $name"
        last
    fi
}
