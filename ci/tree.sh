#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# git's hash of a folder as it lies: `git rev-parse HEAD:FOLDER` where nothing
# has changed. Needs git, but no repository: a device gets a copy without one.
# usage: ci/tree.sh FOLDER | flags      flags: those of the Makefile that decide
# what kernels compute
set -eu
if [ "$1" = flags ]; then
    awk '/^(MODEL|CUDA) / { on = 1 } on; !/\\$/ { on = 0 }' Makefile |
        git hash-object --stdin
    exit
fi
GIT_DIR=$(mktemp -d)
export GIT_DIR GIT_WORK_TREE=.
trap 'rm -rf "$GIT_DIR"' EXIT
git init -q .
git -c core.autocrlf=false add -f "$1"
git write-tree --prefix="$1/"
