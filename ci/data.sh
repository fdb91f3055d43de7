#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Fetches the public data that some tests and scenes use into the folder DIR,
# in the layout that DRAPE_DATA stands for:
#   DIR/models/       statues for the scenes (obstacles)
#   DIR/ccd/queries/  collision queries with their exact truth
#   DIR/ccd/frames/   meshes before and after a step, and every pair that touches
# What is there already stays. Set DRAPE_DATA=DIR afterwards.
#
# FROM, if given, takes the place of the public addresses: a folder or an
# address that holds Sample-Queries/ and Sample-Scalable-CCD-Data/ (clones of
# github.com/Continuous-Collision-Detection/...) and 3Dscanrep/ (the folder of
# that name at graphics.stanford.edu/pub). Whatever FROM lacks is reported, and
# the exit status is 1.
#
# The statues need BUILD/drape (`make`), which scales them and sets them upright.
# `drape fetch-models` calls this script, which is installed with the tool.
# usage: ci/data.sh DIR [FROM] [BUILD]
set -eu
[ $# -ge 1 ] || {
    sed -n 's/^# usage: /usage: sh /p' "$0" >&2
    exit 2
}
to=$1 from=${2-} build=${3-build}
here=$(cd "$(dirname "$0")" && pwd)
github=https://raw.githubusercontent.com/Continuous-Collision-Detection
queries=a744562c7a842e9eee033fcea290e75a4a8e7b4e
frames=d1de594b017d98b37be67f02f74e541e74804109
stanford=https://graphics.stanford.edu/pub
missing=0
mkdir -p "$to/models" "$to/ccd/queries" "$to/ccd/frames"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# get PATH OUT: one file of the public tree, from FROM or its own address.
get() {
    if [ -n "$from" ] && [ -d "$from" ]; then
        cp "$from/$1" "$2" 2>"$work/error" && return 0
        echo "missing: $from/$1" >&2
    else
        address=$from/$1
        [ -n "$from" ] || case $1 in
        Sample-Queries/*) address=$github/Sample-Queries/$queries/${1#*/} ;;
        Sample-Scalable*) address=$github/${1%%/*}/$frames/${1#*/} ;;
        *) address=$stanford/$1 ;;
        esac
        curl -fsSL --retry 2 -o "$2" "$address" && return 0
        echo "missing: $address" >&2
    fi
    rm -f "$2"
    missing=1
    return 1
}

# erleben SCENE PARTS: its query files, one after another.
erleben() {
    for kind in vf:vertex-face ee:edge-edge; do
        out=$to/ccd/queries/erleben-$1-${kind%:*}.csv
        [ ! -s "$out" ] || continue
        : >"$work/all"
        for part in $2; do
            get "Sample-Queries/erleben-$1/${kind#*:}/data_0_$part.csv" \
                "$work/part" || continue 2
            cat "$work/part" >>"$work/all"
        done
        mv "$work/all" "$out"
    done
}

# frame SCENE T0 T1 STEP: two meshes, and the pairs of them that touch.
frame() {
    out=$to/ccd/frames/$1 tree=Sample-Scalable-CCD-Data/$1
    [ ! -s "$out/hits.txt" ] || return 0
    mkdir -p "$out"
    get "$tree/frames/$2.ply" "$out/t0.ply" || return 0
    get "$tree/frames/$3.ply" "$out/t1.ply" || return 0
    for kind in vf ee; do
        get "$tree/boxes/$4$kind.json" "$work/$kind-boxes" || return 0
        get "$tree/mma_bool/$4${kind}_mma_bool.json" "$work/$kind-truth" ||
            return 0
    done
    python3 "$here/data.py" hits "$out/t0.ply" "$work" >"$work/hits"
    mv "$work/hits" "$out/hits.txt"
}

# scene SCENE STEP KIND: the queries of a frame, with their truth as a column.
scene() {
    out=$to/ccd/queries/$1-$3.csv tree=Sample-Scalable-CCD-Data/$1
    [ ! -s "$out" ] || return 0
    get "$tree/queries/$2$3.csv" "$work/queries" || return 0
    get "$tree/mma_bool/$2$3_mma_bool.json" "$work/truth" || return 0
    python3 "$here/data.py" column "$work/queries" "$work/truth" >"$work/all"
    mv "$work/all" "$out"
}

# statue NAME FILE PLY: a scan's reconstruction as the scenes' NAME.ply.
statue() {
    out=$to/models/$1.ply
    [ ! -s "$out" ] || return 0
    get "3Dscanrep/$2" "$work/scan" || return 0
    case $2 in
    *.tar.gz) tar -xzOf "$work/scan" "$3" >"$work/scan.ply" ;;
    *) gzip -dc "$work/scan" >"$work/scan.ply" ;;
    esac
    "$build/drape" convert "$work/scan.ply" "$out" --size 1
}

for name in cube-cliff-edges sliding-spike spikes wedge-crack; do
    erleben $name '0 1'
done
erleben spike-hole 0
scene cloth-funnel 227 vf
scene cloth-funnel 227 ee
scene n-body-simulation 18 vf
frame cloth-ball cloth_ball92 cloth_ball93 92
frame cloth-funnel 227 228 227
frame n-body-simulation balls16_18 balls16_19 18

# Stanford's reconstructions nearest in size to what the numbers in bench
# were measured with (100,000 triangles each), so counts and times will differ.
if [ -x "$build/drape" ]; then
    statue buddha_100k happy/happy_recon.tar.gz happy_recon/happy_vrip_res3.ply
    statue dragon_100k dragon/dragon_recon.tar.gz \
        dragon_recon/dragon_vrip_res3.ply
    lion=$to/models/lion_20k.ply
    if [ ! -s "$lion" ]; then
        sh "$here/lion.sh" "$build" "$to/models" >/dev/null
        [ -s "$lion" ] || {
            echo 'missing: the lion of the Debian package libcgal-demo' >&2
            missing=1
        }
    fi
else
    echo "missing: $build/drape for the statues: type make first" >&2
    missing=1
fi

cat <<END
Credits, which whoever uses the data must give:
  erleben-*: CCD sample queries, Wang et al. 2021, MIT; scenes after Erleben 2018
  frames, cloth-funnel, n-body-simulation: Scalable CCD sample data, Belgrod et
    al., Apache-2.0; cloth-ball after UNC's dynamic scene benchmarks
  buddha, dragon: Stanford 3D Scanning Repository, research use, no commercial use
  lion: AIM@SHAPE, by way of Debian's libcgal-demo
Now type: export DRAPE_DATA=$to
END
exit $missing
