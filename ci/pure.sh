#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Checks that a flavour's library was built consistently: it has exactly the named
# members, at least one of each file of ref/, and each was compiled by this
# compiler with these options, which -frecord-gcc-switches stores in each object.
# usage: ci/pure.sh LIBRARY COMPILER OPTIONS MEMBER...
set -eu
library=$1 compiler=$2 options=$3
shift 3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

ar t "$library" | sort >"$work/there"
printf '%s\n' "$@" | sort >"$work/named"
diff "$work/named" "$work/there" || {
    echo "$library: its members are not those of the Makefile" >&2
    exit 1
}
for file in ref/*/*.c; do
    name=$(basename "$file" .c)
    grep -qx "$name\.64\.o" "$work/there" || {
        echo "$library: nothing of $file" >&2
        exit 1
    }
done

# Prints one line for each member: its name, and how it was compiled.
readelf -p .GCC.command.line "$library" 2>/dev/null | awk '
    /^File:/ { if (name) print name ": " how; name = $2; how = "" }
    /^ *\[/ { sub(/^[^]]*\]/, ""); how = how $0 " " }
    END { print name ": " how }' >"$work/how"
[ "$(wc -l <"$work/how")" -eq "$(wc -l <"$work/there")" ] || {
    echo "$library: its members could not be read" >&2
    exit 1
}
case $compiler in
*clang*) by=/clang ;;
*) by='GNU C17 ' ;;
esac
wrong=$(grep -vF -- "$by" "$work/how" || true)
for option in $options; do
    case $option in
    # options of the linker, of warnings, or recorded in another form
    -frecord-gcc-switches | -march=native | -g1 | -fno-sanitize-*) continue ;;
    esac
    wrong=$wrong$(grep -vF -- " $option " "$work/how" || true)
done
# Options that were not given must not add sanitizers or change the level.
for option in -fsanitize= -O0 -O1 -O2 -O3; do
    case " $options" in
    *" $option"*) ;;
    *) wrong=$wrong$(grep -F -- " $option" "$work/how" || true) ;;
    esac
done
[ -z "$wrong" ] || {
    echo "$library: not by $compiler $options:" >&2
    printf '%s\n' "$wrong" | head -n 5 >&2
    exit 1
}
