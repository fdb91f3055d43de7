#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Tests the Python package as its users have it: builds the wheel, installs it into
# a fresh environment, and there runs the lines of its page and its tests; checks
# style and types.
# usage: python/check.sh BUILD; ends with `N passed, N failed, N skipped`.
set -u
build=$1
work=$build/python
log=$work/log
tests=$work/tests.log
mkdir -p "$work"
. ci/ok.sh

if ! python3 -c 'import venv, ensurepip' 2>"$log"; then
    echo 'skipped: python3 has no venv'
    echo '0 passed, 0 failed, 1 skipped'
    exit 0
fi
ok 'a wheel' make BUILD="$build" wheel
ok style "$work/venv/bin/ruff" check python
ok format "$work/venv/bin/ruff" format --check python
ok types "$work/venv/bin/mypy" --config-file python/pyproject.toml python/drape
rm -rf "$work/fresh"
ok 'a fresh environment' python3 -m venv "$work/fresh"
python=$work/fresh/bin/python
wheel=$(ls dist/drape_cloth-*.whl)
ok 'it takes the wheel' "$python" -m pip install -q "$wheel[ray,s3]" \
    -r python/tests/requirements.txt
ok "the pages' lines" "$python" python/lines.py README.md python/README.md \
    python/docs/*.md python/docs/tutorials/*.md
ok 'the site' sh python/docs.sh "$build" tiny=20
export RAY_USAGE_STATS_ENABLED=0
# The summary in pytest's log: `1 failed, 2 passed, 3 skipped in 4.56s`. What Blender
# has printed may follow it.
number() {
    of=$(grep -E '^[0-9]+ [a-z]+.* in [0-9.]+s' "$tests" | tail -n 1 |
        sed -n "s/.*\\b\\([0-9][0-9]*\\) $1.*/\\1/p")
    echo "${of:-0}"
}
# suite PYTHON FOLDER OPTION...: runs tests and adds up their counts.
suite() {
    with=$1
    shift
    "$with" -m pytest -q -rs -p no:cacheprovider "$@" >"$tests" 2>&1 ||
        sed -n '/^=.* FAILURES/,$p' "$tests" | tail -n 60
    grep '^SKIPPED' "$tests"
    good=$(number passed) bad=$(($(number failed) + $(number error)))
    [ "$good" -gt 0 ] || bad=$((bad + 1)) # no test ran
    passed=$((passed + good)) failed=$((failed + bad))
    skipped=$((skipped + $(number skipped)))
}
suite "$python" python/tests --ignore python/tests/apps
# Debian's torch, where it is installed, runs the notebook's cells that need it.
if /usr/bin/python3 -c 'import torch, venv' 2>"$log"; then
    rm -rf "$work/torch"
    ok 'an environment with torch' \
        /usr/bin/python3 -m venv --system-site-packages "$work/torch"
    ok 'torch and the wheel' "$work/torch/bin/python" -m pip install -q "$wheel" \
        pytest nbclient ipykernel
    suite "$work/torch/bin/python" python/tests/test_notebook.py \
        python/tests/test_torch.py
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
