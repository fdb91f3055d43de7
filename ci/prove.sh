#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Lets Gappa prove every rounding error bound again and compares each bound with
# the constant in the code. Each row is a proof: script, constant, and the files
# that have the constant, which must all have the same value. A constant is
# #defined as a power of two or as a number of units u = 2^-24 or 2^-53 (@P@ in
# the script), or it stands on a page, as 2^-49 or 4u. The proved bound must be
# at least a hundredth below the constant. A row without a script (-) is for a
# constant whose proof is on a page; such a row has the value as well.
# usage: ci/prove.sh [--coq BUILD]    --coq: Coq checks what Gappa proves, where it is
set -eu
cd "$(dirname "$0")/.."
coq=
[ "${1-}" != --coq ] || {
    coq=$2/coq
    command -v coqc >/dev/null || {
        echo "skipped: Coq's proofs: there is no coqc (sh ci/deps.sh proofs)"
        coq=
    }
}

rows='
narrow_form    ERROR_FORM    ref/narrow/filter.c gpu/narrow/filter.cuh
narrow_cubic   ERROR_CUBIC   ref/narrow/filter.c gpu/narrow/filter.cuh
narrow_box     ERROR_BOX     ref/narrow/filter.c gpu/narrow/filter.cuh
narrow_rough   ERROR_ROUGH   gpu/narrow/point.cuh
audit_orient3  ERROR_ORIENT3 ref/narrow/predicates.c gpu/narrow/predicates.cuh
audit_orient2  ERROR_ORIENT2 ref/narrow/predicates.c gpu/narrow/predicates.cuh
audit_orient3  ERROR_BESIDE  ref/narrow/tritri.c gpu/narrow/facing.cuh
audit_parted   ERROR_PARTED  ref/narrow/tritri.c gpu/narrow/facing.cuh
audit_opened   ERROR_OPENED  ref/narrow/tritri.c gpu/narrow/facing.cuh
box_gap        4u            spec/broad/refit.md
box_reach      BOX_REACH     ref/broad/box.h
box_late       BOX_LATE      ref/broad/box.h
cones_room     CONES_ROOM    ref/broad/cones.c gpu/broad/cones.cuh
closest_point  2^-49         spec/contact/proximity.md
- UNDERFLOW=0x1p-800         ref/narrow/filter.c gpu/narrow/filter.cuh
- RANGE=0x1p200              ref/narrow/filter.c gpu/narrow/filter.cuh
- UNDERFLOW=0x1p-1000        ref/narrow/predicates.c gpu/narrow/predicates.cuh
- UNDERFLOW=0x1p-1000        ref/narrow/tritri.c gpu/narrow/facing.cuh
- UNDERFLOW_OPENED=0x1p-700  ref/narrow/tritri.c gpu/narrow/facing.cuh
- UNDERFLOW_ROUGH=0x1p-700   gpu/narrow/point.cuh
'

command -v gappa >/dev/null || {
    echo 'prove: no gappa here; sh ci/deps.sh installs it' >&2
    exit 1
}

# Prints the value of a constant in a file: 0x1p-49, or 32 for 32 u, or nothing.
constant() {
    case $1 in
    2^*) ! grep -qF -- "$1" "$2" || echo "0x1p${1#2^}" ;;
    *u) ! grep -qF -- "$1" "$2" || echo "${1%u}" ;;
    *) sed -n "s/^#define $1 \([0-9][0-9xp-]*\).*/\1/p" "$2" ;;
    esac
}

# Prints the value of a constant in all its files; nothing if they differ or a
# file lacks it.
agreed() {
    name=$1 said=
    shift
    for file; do
        value=$(constant "$name" "$file")
        [ -n "$value" ] && [ "${said:-$value}" = "$value" ] || return 0
        said=$value
    done
    echo "$said"
}

# Prints the upper end of the one interval that Gappa prints, as a decimal.
bound() {
    sed "s/@P@/$2/g" "spec/proofs/$1.gappa" | gappa 2>&1 |
        sed -n 's/.*in \[.*{\([0-9.e+-]*\), 2^.*/\1/p'
}

# Whether bound $1 > 0 lies below 0.99 · $2 · 2^$3.
below() {
    awk -v b="$1" -v n="$2" -v e="$3" \
        'BEGIN { exit !(b > 0 && b <= 0.99 * n * 2 ^ e) }'
}

# Proves one row in one precision: script, name, n and e of n·2^e.
prove() {
    b=$(bound "$1" "${4#-}")
    # the test of this test: a constant 64 times smaller must fail
    if [ -n "$3" ] && [ -n "$b" ] && below "$b" "$3" "$4" &&
        ! below "$b" "$3" $(($4 - 6)); then
        echo "proved $1: $b < $2 = $3 * 2^$4"
        passed=$((passed + 1))
        [ -z "$coq" ] || check_by_coq "$1" "${4#-}"
    else
        echo "FAILED proof $1: bound '$b' against $2 = $3 * 2^$4"
        failed=$((failed + 1))
    fi
}

# Lets Coq check what Gappa proves of a script in one precision, once.
check_by_coq() {
    proof=$1_$2
    [ ! -e "$coq/$proof.v" ] || return 0
    mkdir -p "$coq"
    if sed "s/@P@/$2/g" "spec/proofs/$1.gappa" | gappa -Bcoq >"$coq/$proof.v" 2>/dev/null &&
        (cd "$coq" && coqc -q "$proof.v" >"$proof.log" 2>&1); then
        echo "proved $1 by Coq"
        passed=$((passed + 1))
    else
        echo "FAILED proof $1 by Coq: $coq/$proof.log"
        failed=$((failed + 1))
    fi
}

# Checks a row without a script: NAME=VALUE against the value in the files.
compare() {
    if [ "$2" = "${1#*=}" ]; then
        echo "agreed ${1%=*}: $2"
        passed=$((passed + 1))
    else
        echo "FAILED constant $1: the files agree on '$2'"
        failed=$((failed + 1))
    fi
}

passed=0 failed=0
[ -z "$coq" ] || rm -rf "$coq"
while read -r script name files; do
    [ -n "$script" ] || continue
    # shellcheck disable=SC2086 # a list
    value=$(agreed "${name%=*}" $files)
    case $script$value in
    -*) compare "$name" "$value" ;;
    "$script") compare "$name=one number" '' ;;
    *0x1p*) prove "$script" "$name" 1 "${value#0x1p}" ;;
    *)
        prove "$script" "$name" "$value" -24
        prove "$script" "$name" "$value" -53
        ;;
    esac
done <<END
$rows
END
echo "$passed passed, $failed failed"
[ "$passed" -gt 0 ] && [ "$failed" -eq 0 ]
