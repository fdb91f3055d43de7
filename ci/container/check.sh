#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the image of ci/container/Dockerfile without a Docker daemon and without a
# registry of images, and tests it: mmdebstrap makes the base image of Debian's
# archive, buildah builds and runs. The tool must give the bits and the picture
# that BUILD/drape gives here, and the library's examples must build and run. Then
# a fresh container of the same Debian takes the wheel of dist/ and runs the quick
# start, the notebook and the test of `drape view` in Chromium; with `all`, all
# tests of python/tests. Run as root, since a container's files belong to many
# users. What it makes is in BUILD/container; only the base images stay.
# usage: ci/container/check.sh BUILD [12|13] [all]: the version of Debian, else 12
# Ends with `N passed, N failed, N skipped`.
set -u
build=$1 version=${2-12} all=${3-}
. ci/release.sh
for tool in buildah mmdebstrap; do
    command -v $tool >/dev/null || {
        echo "$0 needs $tool: apt-get install buildah mmdebstrap" >&2
        exit 1
    }
done
mkdir -p "$build/container"
work=$(cd "$build/container" && pwd)
log=$work/log base=$work/debian-$version.tar out=$work/out
. ci/ok.sh
export BUILDAH_ISOLATION=chroot
store=$work/store.$$ # of this run alone
b() { buildah --log-level error --root "$store/root" --runroot "$store/run" "$@"; }
clean() {
    b rm --all
    b rmi --all --force
    rm -rf "$store"
} >"$work/log.clean" 2>&1
finish() {
    echo "$passed passed, $failed failed, $skipped skipped"
    [ "$failed" -eq 0 ]
    exit
}
trap clean EXIT
rm -rf "$out"
mkdir -p "$out/shots" # of the pages of `drape view`

# The base image, by the name that the Dockerfile gives it.
[ -e "$base" ] || ok "Debian $version" mmdebstrap --variant=minbase $name "$base"
printf 'FROM scratch\nADD debian-%s.tar /\nCMD ["bash"]\n' "$version" >"$work/Base"
ok 'the base image' b bud -q -t "docker.io/library/debian:$version" -f "$work/Base" "$work"
ok 'the image' b bud --pull-never --build-arg "DEBIAN=$version" -t drape \
    -f ci/container/Dockerfile .
[ "$failed" -eq 0 ] || finish

# in_image COMMAND...: with the folder `out` as /work, as a user without a name, as
# docker run -u makes one. buildah knows no entry point.
tool=$(b from --pull-never localhost/drape)
in_image() { b run --user "$user" -v "$out:/work" "$tool" -- "$@"; }
user=1000:1000
chmod 777 "$out"
cp app/scenes/sphere.json "$out"
ok 'drape --version' in_image drape --version
ok 'drape run' in_image drape run sphere.json --frames 60 --out run
ok 'drape audit' in_image drape audit run
ok 'drape render' in_image drape render run --frame 60
ok 'a film' in_image drape render run --every 4 --width 320 --height 240 --samples 2
if [ -x "$build/drape" ]; then
    cp -r "$out/run" "$out/copy"
    ok 'the same scene here' "$build/drape" run app/scenes/sphere.json --frames 60 \
        --out "$out/here"
    ok 'the same bits' cmp "$out/run/cloth.pc2" "$out/here/cloth.pc2"
    ok 'the same frame here' "$build/drape" render "$out/copy" --frame 60
    # a picture depends on the compiler's and Embree's rounding, and yet
    ok 'the same picture' cmp "$out/run/pictures/frame_0060.png" \
        "$out/copy/pictures/frame_0060.png"
else
    echo "skipped: the same bits: there is no $build/drape"
    skipped=$((skipped + 1))
fi
echo "Embree in the image: $(in_image ldd /usr/bin/drape | grep -o 'libembree[0-9]*' | sort -u)"

# The examples of libdrape-dev, by pkg-config and by CMake.
user=0:0
ok 'compilers' in_image sh -c 'apt-get update && apt-get install -y \
    --no-install-recommends gcc g++ libc6-dev make cmake pkg-config'
in_image sh -c 'cp -r /usr/share/doc/libdrape-dev/examples .' >"$log" 2>&1
# shellcheck disable=SC2016
ok '1_hang.c by pkg-config' in_image sh -c \
    'cc examples/1_hang.c $(pkg-config --cflags --libs drape) -o hang && ./hang'
ok 'examples by CMake' in_image sh -c 'cmake -S examples -B made &&
    cmake --build made && for name in 1_hang 2_drop 3_pull 4_resume 5_share 1_hang_cpp
    do made/$name || exit; done'

# A fresh Debian with python3 alone, and the wheel. The tree is there, but cannot be
# written to; pip trusts the certificates of this machine.
wheel=$(ls dist/drape_cloth-*.whl 2>/dev/null)
if [ -z "$wheel" ]; then
    echo 'skipped: the wheel: there is none in dist (make wheel)'
    skipped=$((skipped + 1))
    finish
fi
fresh=$(b from --pull-never "docker.io/library/debian:$version")
certificates=/etc/ssl/certs/ca-certificates.crt
in_fresh() {
    set -- "$fresh" -- "$@"
    [ ! -e $certificates ] || set -- -v $certificates:/certificates.crt:ro \
        -e PIP_CERT=/certificates.crt "$@"
    b run --workingdir /drape -v "$PWD:/drape:ro" -e PYTHONDONTWRITEBYTECODE=1 \
        -v "$out/shots:/shots" -e DRAPE_SHOTS=/shots \
        -e DRAPE_TOOL=/venv/bin/drape -e RAY_USAGE_STATS_ENABLED=0 "$@"
}
python=/venv/bin/python
ok python3 in_fresh sh -c 'apt-get update && apt-get install -y \
    --no-install-recommends python3-venv'
ok 'an environment' in_fresh python3 -m venv /venv
ok 'pip install dist/*.whl' in_fresh $python -m pip install -q "$wheel"
ok "the quick start's lines" in_fresh $python python/lines.py \
    python/docs/quickstart.md
ok 'python -m drape' in_fresh $python -m drape run app/scenes/tiny.json --out /tiny
ok 'the notebook' in_fresh $python python/tests/cells.py \
    python/docs/tutorials/torch.ipynb
# suite PYTHON TEST OPTION...: runs tests by python/tests/suite.py and adds up their
# counts, which what Blender prints may follow.
suite() {
    suite_python=$1
    shift
    in_fresh "$suite_python" python/tests/suite.py "$@" >"$log" 2>&1
    grep -E '^(skipped:|FAILED|    )' "$log"
    line=$(grep -xE '[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped' "$log" | tail -n 1)
    # shellcheck disable=SC2046 # its numbers
    set -- $(echo "${line:-0 1 0}" | tr -dc '0-9 ')
    passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
}
ok 'a browser' in_fresh sh -c 'apt-get install -y --no-install-recommends chromium libatomic1'
ok 'the viewer, and a kernel of Jupyter' in_fresh $python -m pip install -q \
    -c python/tests/apps/requirements.txt \
    viser pygltflib playwright pillow pytest nbclient ipykernel
ok 'the notebook in a kernel' in_fresh sh -c "cp -r python/docs/tutorials / &&
    $python python/tests/cells.py /tutorials/torch.ipynb"
suite $python python/tests/apps/test_view.py
if [ "$all" = all ]; then
    ok 'what all tests need' in_fresh sh ci/deps.sh apps
    ok "the tests' packages" in_fresh $python -m pip install -q "${wheel}[ray,s3]" \
        -r python/tests/requirements.txt
    suite $python python/tests --ignore python/tests/apps
    # bpy wants an older NumPy than pyarrow does
    ok "the exports' packages" in_fresh sh -c "python3 -m venv /apps &&
        /apps/bin/python -m pip install -q $wheel pytest \
        -r python/tests/apps/requirements.txt"
    suite /apps/bin/python python/tests/apps --ignore python/tests/apps/test_view.py
    ok "Debian's torch" in_fresh sh -c "python3 -m venv --system-site-packages \
        /torch && /torch/bin/python -m pip install -q $wheel pytest nbclient ipykernel"
    suite /torch/bin/python python/tests/test_notebook.py python/tests/test_torch.py
fi
finish
