# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154,SC2016
# drape fetch-models fetches the statues of the scenes by ci/data.sh: here from a
# folder that stands for the public addresses, with small meshes in the archives'
# form.
# Read by tests/app.sh, whose functions it calls.

public=from/3Dscanrep
mkdir -p $public/happy $public/dragon happy_recon dragon_recon data/ccd/queries
cp quiet.ply happy_recon/happy_vrip_res3.ply
cp quiet.ply dragon_recon/dragon_vrip_res3.ply
tar -czf $public/happy/happy_recon.tar.gz happy_recon
tar -czf $public/dragon/dragon_recon.tar.gz dragon_recon
mkdir -p data/models
cp quiet.ply data/models/lion_20k.ply # which comes from Debian
"$drape" fetch-models data --from from >data.log 2>data.err
is 'what the folder lacks is reported' test $? -eq 1 -a -s data.err
is 'by name' grep -q 'missing: from/Sample-Queries/' data.err
for name in buddha_100k dragon_100k; do
    is "$name is there, 1 m high" sh -c '"$0" convert "data/models/$1.ply" - >size &&
        cmp size "data/models/$1.ply"' "$drape" $name
    is "a scene finds $name" env DRAPE_DATA="$work/data" "$drape" plan \
        "$root/app/scenes/${name%_*}_20k.json" --allow-intersecting
done
# An installed tool finds the script in share/, and the lion's folder is DIR.
mkdir -p at/bin at/share/drape at/data/models
cp "$drape" at/bin
cp "$root/ci/data.sh" "$root/ci/data.py" "$root/ci/lion.sh" at/share/drape
cp quiet.ply at/data/models/lion_20k.ply
at/bin/drape fetch-models at/data --from from >at.log 2>at.err
is 'an installed tool fetches them, too' cmp data/models/buddha_100k.ply \
    at/data/models/buddha_100k.ply
is 'what an installed tool cannot find is by name' grep -q \
    'missing: from/Sample-Queries/' at.err
# So does the tool of a checkout in build/, or a flavour of it in build/…/.
mkdir -p of/ci of/build/gcc of/data/models
cp "$root/ci/data.sh" "$root/ci/data.py" "$root/ci/lion.sh" of/ci
cp quiet.ply of/data/models/lion_20k.ply
for place in build build/gcc; do
    cp "$drape" of/$place
    rm -f of/data/models/buddha_100k.ply
    of/$place/drape fetch-models of/data --from from >of.log 2>of.err
    is "the tool in $place fetches them, too" cmp data/models/buddha_100k.ply \
        of/data/models/buddha_100k.ply
done
# no_script NAME COMMAND...: exit 3, and one line that says where no script is.
no_script() {
    name=$1
    shift
    "$@" >out 2>err </dev/null
    got=$?
    if [ $got -eq 3 ] && [ ! -s out ] && [ "$(wc -l <err)" -eq 1 ] &&
        grep -q 'share/drape/data.sh is not beside' err; then
        ok "$name"
    else
        bad "$name (exit $got, expected 3)"
    fi
}
# A system that does not tell the tool where it is. What the call leaves in its
# buffer is no answer then, even if it is the right one.
cat >lost.c <<'EOF'
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
ssize_t readlink(const char *path, char *to, size_t size)
{
    const char *left = getenv("LEFT");
    if (left && strcmp(path, "/proc/self/exe") == 0 && strlen(left) < size)
        strcpy(to, left);
    errno = ENOENT;
    return -1;
}
EOF
if ldd "$drape" | grep -q 'lib[a-z]*san' ||
    ! "${CC:-cc}" -shared -fPIC lost.c -o lost.so 2>/dev/null; then
    skip 'a tool that does not find itself: no library can stand before this one'
else
    no_script 'a tool that does not find itself' env LEFT="$work/at/bin" \
        LD_PRELOAD="$PWD/lost.so" at/bin/drape fetch-models at/data --from from
fi
rm -r at/share
no_script 'a tool without the script' at/bin/drape fetch-models at/data --from from
refused 'fetch-models: no folder' 'expected one DIR' fetch-models
refused 'fetch-models: two folders' 'expected one DIR' fetch-models a b
is 'no credit is left out' grep -q 'Stanford 3D Scanning Repository' data.log
cp "$root/app/scenes/buddha_20k.json" .
unset DRAPE_DATA DRAPE_MODELS # this part is the last
refused 'without the statues: how to get them' \
    'drape fetch-models DIR fetches' run buddha_20k.json --out refused

# Numbers of runs, of which a build with sanitizers has others.
[ -z "$brief" ] || return 0
# The tables of the paper's figures, made from a very small scene.
is 'runs for the tables' sh -c 'cd "$1" && SCENES=tiny CONTACT=sphere \
    FRAMES=6 SHORT=4 EVERY=2 STEPS=1 THREADS="1 2" BACKEND=ref sh bench/scenes.sh \
    "${2%/*}" "$3/bench"' sh "$root" "$drape" "$work"
is 'tables of them' python3 "$root/bench/tables.py" bench/results tables
cp "$root/bench/steps.csv" .
is 'rows of them' python3 "$root/bench/steps.py" --file steps.csv add mine card \
    bench/results/*.ours.json bench/results/*.ours.json
is 'a row a scene, once' sh -c '[ $(grep -c ",mine,.*,card,.*,2\$" steps.csv) -eq \
    $(ls bench/results/*.ours.json | wc -l) ]'
is 'a tree beside itself' sh -c 'python3 "$1" --file steps.csv mine min | tail -n 1 |
    grep -q "1.00   1.00   1.00$"' sh "$root/bench/steps.py"
is 'steps of frames 5 and 6 by the reference, the same' sh -c \
    '[ "$(cut -d, -f1-4,8 tables/figure12.csv | tr "\n" " ")" = "scene,from \
step,steps,threads,same counts and energies tiny,5,1,1,yes tiny,5,1,2,yes " ]'
is 'the paper beside them' grep -q '^scene.*GTX 680' tables/figure8.csv
is 'scenes of contact in a table of their own' sh -c \
    '[ "$(cut -d, -f1,4,5,21,22 tables/contact.csv | tail -n 1)" = "sphere,6,6,4,0" ] &&
    ! grep -q sphere tables/figure8.csv && grep -q "^## Contact" tables/tables.md'
is 'what a step took' grep -q ',ref,....-..-..,.*,32,' tables/speed.csv
exits 'a plan by it' 0 plan tiny.json --speed tables/speed.csv
is 'plots are XML' python3 -c '
import xml.dom.minidom
for k in range(8, 13):
    xml.dom.minidom.parse("tables/figure%d.svg" % k)'
