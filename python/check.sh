#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Tests the Python package as its users have it: builds the wheel, installs it into
# a fresh environment, and there runs the lines of its page and its tests; checks
# style and types.
# usage: python/check.sh BUILD [apps]; ends with `N passed, N failed, N skipped`.
# `apps`: only the tests that need what `sh ci/deps.sh apps` installs.
set -u
build=$1 only=${2-}
work=$build/python
log=$work/log
mkdir -p "$work"
. ci/ok.sh

if ! python3 -c 'import venv, ensurepip' 2>"$log"; then
    echo 'skipped: all of Python: there is no python3-venv (sh ci/deps.sh)'
    echo '0 passed, 0 failed, 1 skipped'
    exit 0
fi
# suite PYTHON TEST OPTION...: runs tests by python/tests/suite.py and adds up their
# counts, which what Blender prints may follow.
suite() {
    with=$1
    shift
    "$with" python/tests/suite.py "$@" >"$log" 2>&1
    grep -E '^(skipped:|FAILED|    )' "$log"
    line=$(grep -xE '[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped' "$log" | tail -n 1)
    [ -n "$line" ] || {
        echo "FAILED $*: pytest died"
        last
    }
    # shellcheck disable=SC2046 # its numbers
    set -- $(echo "${line:-0 1 0}" | tr -dc '0-9 ')
    passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
}
# Whether the archive's wheel says of itself what the tree's says.
same_certificate() {
    python3 -m venv "$work/of_sdist/venv" &&
        "$work/of_sdist/venv/bin/pip" install -q "$work"/of_sdist/*.whl &&
        "$work/of_sdist/venv/bin/drape" info >"$work/of_sdist/info" &&
        "$work/fresh/bin/drape" info | diff - "$work/of_sdist/info"
}
# The package, its pages and its tests in an environment of their own.
package() {
    ok style "$work/venv/bin/ruff" check python
    ok format "$work/venv/bin/ruff" format --check python
    ok types "$work/venv/bin/mypy" --config-file python/pyproject.toml python/drape
    rm -rf "$work/fresh"
    ok 'a fresh environment' python3 -m venv "$work/fresh"
    python=$work/fresh/bin/python
    ok 'it takes the wheel' "$python" -m pip install -q "${wheel}[ray,s3]" \
        -r python/tests/requirements.txt
    ok "the pages' lines" "$python" python/lines.py README.md python/README.md \
        python/docs/*.md python/docs/tutorials/*.md
    ok 'the site' sh python/docs.sh "$build" tiny=20
    rm -rf "$work/of_sdist"
    # whether it has all that is compiled, which -O0 tells as well
    ok 'a wheel of the archive' env MAKEFLAGS=-j2 DRAPE_MAKE=OPT=-O0 "$python" -m pip \
        wheel -q --no-deps --wheel-dir "$work/of_sdist" dist/drape_cloth-*.tar.gz
    ok 'it installs and is certified as the tree is' same_certificate
    export RAY_USAGE_STATS_ENABLED=0
    # the cells that need torch run below, by Debian's
    suite "$python" python/tests --ignore python/tests/apps \
        -k 'not test_cells_run or host'
}

ok 'a wheel' make BUILD="$build" wheel
ok 'an archive of the sources, and what PyPI checks' make BUILD="$build" sdist
wheel=$(ls dist/drape_cloth-*.whl)
[ "$only" = apps ] || package
# Debian's torch, where it is installed, runs the notebook's cells that need it.
if /usr/bin/python3 -c 'import torch, venv' 2>"$log"; then
    rm -rf "$work/torch"
    ok 'an environment with torch' \
        /usr/bin/python3 -m venv --system-site-packages "$work/torch"
    ok 'torch and the wheel' "$work/torch/bin/python" -m pip install -q "$wheel" \
        pytest nbclient ipykernel
    suite "$work/torch/bin/python" python/tests/test_notebook.py \
        python/tests/test_torch.py
else
    echo "skipped: the notebook's cells with torch: there is no python3-torch" \
        '(sh ci/deps.sh apps installs it)'
    skipped=$((skipped + 1))
fi
# apps/ has an environment of its own
rm -rf "$work/apps"
ok 'an environment for apps' python3 -m venv "$work/apps"
ok 'it takes what they need' "$work/apps/bin/python" -m pip install -q "$wheel" \
    pytest -r python/tests/apps/requirements.txt
ok "the pages' commands" "$work/apps/bin/python" python/lines.py --sh README.md \
    python/README.md python/docs/*.md python/docs/tutorials/*.md
suite "$work/apps/bin/python" python/tests/apps
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
