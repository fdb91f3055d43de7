#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Has Gappa bound every rounding error anew and compares each bound with the
# constant in the code. One row a proof: script, constant, file that defines
# the constant as a power of two. Bounds must stay a hundredth below.
set -eu
cd "$(dirname "$0")/.."

rows='
narrow_form   ERROR_FORM  ref/filter.c
narrow_cubic  ERROR_CUBIC ref/filter.c
narrow_box    ERROR_BOX   ref/filter.c
'

command -v gappa >/dev/null || {
    echo 'prove: no gappa here; sh ci/deps.sh installs it' >&2
    exit 1
}

# The exponent e of `#define NAME 0x1pe` in a file.
exponent() {
    sed -n "s/^#define $1 0x1p\(-[0-9]*\).*/\1/p" "$2"
}

# The upper end of the one interval that Gappa prints, as a decimal.
bound() {
    gappa "spec/proofs/$1.gappa" 2>&1 |
        sed -n 's/.*in \[.*{\([0-9.e+-]*\), 2^.*/\1/p'
}

# Whether bound $1 > 0 lies below 0.99 · 2^$2.
below() {
    awk -v b="$1" -v e="$2" 'BEGIN { exit !(b > 0 && b <= 0.99 * 2 ^ e) }'
}

passed=0 failed=0
while read -r script name file; do
    [ -n "$script" ] || continue
    e=$(exponent "$name" "$file")
    b=$(bound "$script")
    # a constant 64 times smaller must not pass, else nothing was compared
    if [ -n "$e" ] && [ -n "$b" ] && below "$b" "$e" &&
        ! below "$b" $((e - 6)); then
        echo "proved $name: $b < 2^$e"
        passed=$((passed + 1))
    else
        echo "FAILED proof $script: bound '$b' against $name = 2^$e in $file"
        failed=$((failed + 1))
    fi
done <<END
$rows
END
echo "$passed passed, $failed failed"
[ "$passed" -gt 0 ] && [ "$failed" -eq 0 ]
