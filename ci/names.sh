#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Prints `#define X REAL_NAME(X)` for each external function or variable X that the
# sources define, and for each struct of .cu and .cuh that has functions, as these
# are external, too, whether it is a template or not; ref/base/names.h says what
# for. A definition is known by the layout of .clang-format: it begins in the first
# column, and nothing within it does. Two definitions that this script does not see
# fail to link; two of a template become one, which the -O0 flavours show.
# usage: ci/names.sh SOURCE...
set -eu
echo '/* What ci/names.sh finds: see ref/base/names.h. */'
awk '
    /^struct [a-z_0-9]+ [{]$/ { type = $2 } # whose functions may follow
    /^template .*struct [a-z_0-9]+<.*[{]$/ {
        type = $0
        sub(/<[^<]*$|<void .*/, "", type)
        sub(/.*struct /, "", type)
    }
    /^}/ { type = "" }
    type && /^    (__device__|static) / {
        print "#define " type " REAL_NAME(" type ")"
        type = ""
    }
    /^[a-z]/ { text = "" } # text: what may be a definition, as far as read
    FILENAME !~ /[.]cuh$/ && text !~ /[{=;]/ {
        gsub("/[*][^*]*[*]/", "")
        text = text " " $0
        if (!match(text, /[{=;]/))
            next
        ending = substr(text, RSTART, 1)
        head = substr(text, 2, RSTART - 2)
        sub(/^extern "C" /, "", head)
        wanted = sub(/[(].*/, "", head) ? "{" : "=" # a function, a variable
        gsub(/[[][^]]*[]]| +$/, "", head)
        if (ending == wanted && head !~ /^(static|typedef) / &&
            head ~ /^[a-z][a-zA-Z0-9_ *]*[ *][a-z][a-zA-Z0-9_]*$/) {
            sub(/.*[ *]/, "", head)
            print "#define " head " REAL_NAME(" head ")"
        }
    }' "$@" | LC_ALL=C sort -u
