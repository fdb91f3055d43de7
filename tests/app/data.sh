# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154,SC2016
# ci/data.sh fetches the statues of the scenes: here from a folder that stands for
# the public addresses, with small meshes in the archives' form.
# Read by tests/app.sh, whose functions it calls.

public=from/3Dscanrep
mkdir -p $public/happy $public/dragon happy_recon dragon_recon data/ccd/queries
cp quiet.ply happy_recon/happy_vrip_res3.ply
cp quiet.ply dragon_recon/dragon_vrip_res3.ply
tar -czf $public/happy/happy_recon.tar.gz happy_recon
tar -czf $public/dragon/dragon_recon.tar.gz dragon_recon
mkdir -p data/models
cp quiet.ply data/models/lion_20k.ply # which comes from Debian
sh "$root/ci/data.sh" data from "${drape%/*}" >data.log 2>data.err
is 'what the folder lacks is reported' test $? -eq 1 -a -s data.err
is 'by name' grep -q 'missing: from/Sample-Queries/' data.err
for name in buddha_100k dragon_100k; do
    is "$name is there, 1 m high" sh -c '"$0" convert "data/models/$1.ply" - >size &&
        cmp size "data/models/$1.ply"' "$drape" $name
    is "a scene finds $name" env DRAPE_DATA="$work/data" "$drape" plan \
        "$root/app/scenes/${name%_*}_20k.json" --allow-intersecting
done
is 'no credit is left out' grep -q 'Stanford 3D Scanning Repository' data.log
cp "$root/app/scenes/buddha_20k.json" .
unset DRAPE_DATA DRAPE_MODELS # this part is the last
refused 'without the statues: how to get them' \
    'sh ci/data.sh DIR fetches' run buddha_20k.json --out refused
