#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the documentation site of python/docs with the wheel of dist/: pages that
# are made of the code's tables, a gallery with a picture of each scene, and all
# warnings as errors. Once its environment is made, it needs no network.
# usage: python/docs.sh BUILD [SCENE=FRAME...]: only these pictures
set -eu
build=$1
shift
work=$build/python
python=$work/docs/bin/python
if [ ! -e "$work/docs/made" ]; then
    echo "docs: Sphinx, into $work/docs"
    python3 -m venv "$work/docs"
    "$python" -m pip install -q furo==2025.12.19 myst-parser==5.2.0 sphinx==9.0.4
    "$python" -m pip install -q dist/drape_cloth-*.whl
    touch "$work/docs/made"
fi
"$python" -m pip install -q --no-deps --no-index --force-reinstall dist/drape_cloth-*.whl
rm -rf python/docs/made "$work/site"
"$python" python/docs/gallery.py python/docs/made/gallery "$@"
echo "docs: the pages"
"$python" -m sphinx -q -W --keep-going -b html python/docs "$work/site"
for word in garment instal gripper docker audit viewer seam; do
    grep -q "[{,]\"$word\":" "$work/site/searchindex.js" || {
        echo "docs: the site's search does not find $word" >&2
        exit 1
    }
done
echo "$work/site/index.html"
