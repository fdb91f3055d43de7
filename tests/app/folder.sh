# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# A run's folder: which run owns it, which files it has, and refusals where it
# cannot be written.
# Read by tests/app.sh, whose functions it calls.

# One run, one folder
refused 'a folder that holds a run' 'w2: holds a run' run tiny.json --out w2
refused 'it is, before settings are chosen for an error' 'w2: holds a run' \
    run tiny.json --out w2 --error 5
refused 'a folder that holds another run than the checkpoint' \
    'v: holds another run' run tiny.json --out v --resume u2/checkpoint.drape
mkdir -p frames_only/frames
cp w2/frames/cloth_0000.ply frames_only/frames
refused 'a folder that holds frames alone' 'frames_only: holds a run' \
    run tiny.json --out frames_only
exits 'a film' 0 render w2 --width 16 --height 16 --samples 1
mkdir w2/mine
# What a writer that was killed has left goes, too; what is not of a run stays.
for name in report.json obstacles.ply cloth.pc2 trace.csv film.mp4 obstacles.obj \
    checkpoint.drape frames/cloth_0009.obj frames/obstacles_0001.ply \
    frames/contacts_0001.ply pictures/frame_0001.png pictures/film_0001.png; do
    : >"w2/$(dirname $name)/.$(basename $name).77-0.part"
done
for name in .mine.part report.json.part .report.json.old .part frames/.cloth \
    frames/cloth_00001.ply frames/cloth_-001.ply frames/cloth_1000001.ply \
    frames/cloths_0001.ply frames/cloth_0001.plys frames/cloth-0001.ply; do
    : >w2/$name
    echo ./$name
done | sort >mine.txt
exits 'a folder is forced' 0 run tiny.json --out w2 --frames 2 --force --no-obj
is 'files that are like those of a run stay' sh -c '(cd w2 && ls $(cat ../mine.txt)) |
    cmp - mine.txt && cd w2 && rm $(cat ../mine.txt)'
is 'nothing of the run before is in it' sh -c '[ "$(cd w2 && find . -type f |
    sort | tr "\n" " ")" = "./cloth.pc2 ./frames/cloth_0000.ply \
./frames/cloth_0001.ply ./frames/cloth_0002.ply ./obstacles.ply \
./report.json " ] && [ -d w2/mine ] && [ ! -e w2/pictures ]'
exits 'forced, from a checkpoint of another run' 0 run tiny.json --out v \
    --resume u2/checkpoint.drape --force
is 'only what came after it is there' sh -c '[ "$(echo v/frames/*.ply)" = \
    "v/frames/cloth_0004.ply v/frames/cloth_0005.ply \
v/frames/cloth_0006.ply" ]'
scene slow.json ', "steps_per_frame": 37, "sleep": false}'
"$drape" run slow.json --out locked --frames 100000 >/dev/null 2>&1 &
child=$!
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    sleep 0.25
    [ ! -s locked/frames/cloth_0001.ply ] || break
done
refused 'two runs in one folder' 'locked: another run' \
    run tiny.json --out locked
refused 'nor by force' 'locked: another run' run tiny.json --out locked --force
kill -9 $child
wait $child 2>/dev/null
exits 'a lock ends with its run' 0 run tiny.json --out locked --force
is 'all is of that run' python3 "$what" same u2 locked
# Of two runs that start at once one writes, and the other prints why it cannot.
for k in 1 2 3; do
    "$drape" run tiny.json --out at_once$k --frames 3 >/dev/null 2>err1 &
    child=$!
    "$drape" run moves.json --out at_once$k --frames 3 >/dev/null 2>err
    got=$?
    wait $child
    is "two runs at once, $k" test "$got $?" = '0 2' -o "$got $?" = '2 0'
    exits "a whole run is left, $k" 0 audit at_once$k
done

# Whatever file of a run a folder has, it holds a run; frame 1000000 is the last.
for name in report.json obstacles.ply cloth.pc2 trace.csv film.mp4 checkpoint.drape \
    obstacles.obj frames/cloth_0001.ply frames/cloth_1000000.ply \
    frames/cloth_0001.obj frames/obstacles_0001.ply frames/obstacles_0001.obj \
    frames/contacts_0001.ply pictures/frame_0001.png pictures/film_0001.png; do
    mkdir -p "one/$(dirname $name)"
    : >one/$name
    refused "a folder with $name" 'one: holds a run' run tiny.json --out one
    rm -r one
done
cp -R u2 numbers
for k in -001 00001 1000001; do
    cp u2/frames/cloth_0001.ply numbers/frames/cloth_$k.ply
done
exits 'audit of frames whose numbers are none' 0 audit numbers
is 'leaves these out' grep -q '^numbers: 7 frames' out
# A file of a writer that was killed, and that had the same number, is not written.
is 'a file under way is made anew' sh -c ': >.mine.ply.$$-0.part
    : >.mine.ply.$$-1.part && echo $$ >number &&
    exec "$0" convert good.ply mine.ply --quiet' "$drape"
is 'and those that were there stay as they are' sh -c 'test -s mine.ply &&
    for k in 0 1; do
        file=.mine.ply.$(cat number)-$k.part
        [ -f $file ] && [ ! -s $file ] && rm $file || exit 1
    done'

# Folders that cannot be written
refused 'a folder without a name' '--out: expected a value' \
    run tiny.json --out ''
refused 'a scene without a name' 'argument 1' run ''
fails() {
    name=$1 text=$2
    shift 2
    "$@" >out 2>err </dev/null
    got=$?
    if [ $got -eq 3 ] && grep -qF -- "$text" err &&
        [ "$(grep -c 'cannot' err)" -eq 1 ]; then
        ok "$name"
    else
        bad "$name (exit $got, expected 3 and: $text)"
    fi
}
fails 'a folder below a file' 'tiny.json: cannot make this folder: Not a dir' \
    "$drape" run tiny.json --out tiny.json/below
mkdir no_frames
: >no_frames/frames
fails 'a file where frames go' 'no_frames/frames: cannot make this folder: Not a dir' \
    "$drape" run tiny.json --out no_frames
# What stands where a file of a run goes, and cannot be removed.
for name in report.json obstacles.ply obstacles.obj cloth.pc2 trace.csv film.mp4 \
    checkpoint.drape frames/cloth_0001.ply frames/cloth_0001.obj \
    frames/obstacles_0001.ply frames/obstacles_0001.obj \
    frames/contacts_0001.ply pictures/frame_0001.png pictures/film_0001.png; do
    rm -rf stays
    mkdir -p "stays/$name/here"
    fails "a folder as $name" "stays/$name: cannot be removed: Directory not empty" \
        "$drape" run tiny.json --out stays --force
done
chmod 755 .
mkdir -m 555 shut
if [ "$(id -u)" -ne 0 ]; then
    set --
elif setpriv --reuid 65534 --clear-groups "$drape" plan tiny.json \
    >/dev/null 2>&1; then
    set -- setpriv --reuid 65534 --clear-groups
else
    set -- false
fi
if [ "${1-}" = false ]; then
    skip 'an unwritable folder: nobody cannot run the tool here'
else
    fails 'an unwritable folder' 'shut: cannot write here: Permission denied' \
        "$@" "$drape" run tiny.json --out shut
    fails 'a folder in it' 'shut/a: cannot make this folder: Permission den' \
        "$@" "$drape" run tiny.json --out shut/a/b
fi
# A file system without locks, by a library that refuses them.
cat >nolock.c <<'EOF'
#include <errno.h>
int fcntl(int file, int how, ...)
{
    errno = ENOLCK;
    return file < 0 && how < 0 ? 0 : -1;
}
int fcntl64(int file, int how, ...) __attribute__((alias("fcntl")));
EOF
if ldd "$drape" | grep -q 'lib[a-z]*san' ||
    ! "${CC:-cc}" -shared -fPIC nolock.c -o nolock.so 2>/dev/null; then
    skip 'a folder without locks: no library can stand before this tool'
else
    fails 'a folder without locks' \
        'unlocked: cannot be locked: No locks available' \
        env LD_PRELOAD="$PWD/nolock.so" "$drape" run tiny.json --out unlocked
    is 'a lock that was not taken is not removed' test -e unlocked/.drape.lock
fi
# A lock whose file another run removes, by a library that does so once: the lock is
# taken anew, and no file stays open.
cat >gone.c <<'EOF'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>
static int calls, least;
/* The least number that no open file has. */
static int next(void)
{
    int file = dup(0);
    close(file);
    return file;
}
int fcntl(int file, int how, ...)
{
    int (*real)(int, int, ...) = (int (*)(int, int, ...))dlsym(RTLD_NEXT, "fcntl");
    va_list list;
    va_start(list, how);
    void *lock = va_arg(list, void *);
    va_end(list);
    if (how == F_SETLK && calls++ == 0)
        unlink("gone/.drape.lock");
    return real(file, how, lock);
}
int fcntl64(int file, int how, ...) __attribute__((alias("fcntl")));
__attribute__((constructor)) static void begin(void)
{
    least = next();
}
__attribute__((destructor)) static void end(void)
{
    if (calls != 2 || next() != least)
        _exit(98);
}
EOF
if ldd "$drape" | grep -q 'lib[a-z]*san' ||
    ! "${CC:-cc}" -shared -fPIC gone.c -o gone.so -ldl 2>/dev/null; then
    skip 'a lock that was removed: no library can stand before this tool'
else
    mkdir gone
    is 'a lock that was removed is taken again' env LD_PRELOAD="$PWD/gone.so" \
        "$drape" run tiny.json --out gone --frames 1 --quiet
    is 'and given back' test -s gone/report.json -a ! -e gone/.drape.lock
fi
limited() { (
    ulimit -f "$1"
    shift
    "$drape" "$@"
); }
fails 'a file too large' 'cannot write: File too large' \
    limited 4 run tiny.json --out large --frames 1
fails 'a trace too large' 'trace.csv: cannot write: File too large' \
    limited 60 run tiny.json --out traces --frames 40 --trace --no-obj \
    --every 40
fails 'a mesh too large' 'cannot write: File too large' \
    limited 4 convert u2/obstacles.ply large.ply
is 'no part of any file is left' sh -c '! find . -name "*.part" | grep .'
if [ -e /dev/full ]; then
    fails 'full output' 'standard output: cannot write: No space left' \
        sh -c '"$0" help >/dev/full' "$drape"
else
    skip 'full output: no /dev/full here'
fi
mkdir disk
if mount -t tmpfs -o size=40k drape disk 2>/dev/null; then
    fails 'full disk' 'cannot write: No space left' \
        "$drape" run tiny.json --out disk/run
    is 'frames that are there are whole' sh -c '
        for f in disk/run/frames/cloth_*.ply; do
            "$0" audit "$f" >/dev/null || exit 1
        done' "$drape"
    is 'no part on the full disk' sh -c '! find disk -name "*.part" | grep -q .'
    umount disk
else
    skip 'full disk: no right to mount a small one'
fi
