# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2034,SC2154
# The name that Debian's archive has for a version. Scripts that set $version source
# this file, and have $name.
case $version in
12) name=bookworm ;;
13) name=trixie ;;
*)
    echo "$0: $version: expected 12 or 13" >&2
    exit 2
    ;;
esac
