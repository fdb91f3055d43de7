# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# What the system does seldom: calls that a signal interrupts, that do a part, or that
# bring what no reader of meshes sends; paths as long as may be; files that grow beyond
# a limit.
# Read by tests/app.sh, whose functions it calls.

# A library in which every second call to read, write or waitpid is interrupted, and
# the others do 1,000 bytes; and which changes a reader's reply (app/read/import.h): 8 bytes
# at $AT become the number $TO.
cat >seldom.c <<'EOF'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
enum { ERROR = 8 + 4 * 8 + 256, REPLY = ERROR + 512 };
static int interrupted(void)
{
    static int calls;
    errno = EINTR;
    return getenv("SELDOM") && calls++ % 2 == 0;
}
static size_t part(size_t size)
{
    return getenv("SELDOM") && size > 1000 ? 1000 : size;
}
ssize_t read(int file, void *data, size_t size)
{
    return interrupted() ? -1 : syscall(SYS_read, file, data, part(size));
}
ssize_t write(int file, const void *data, size_t size)
{
    char reply[REPLY];
    if (getenv("AT") && size == REPLY) {
        long long to = atoll(getenv("TO"));
        memcpy(reply, data, size);
        memcpy(reply + atol(getenv("AT")), &to, sizeof to);
        if (to == -2) /* no text ends here */
            memset(reply + ERROR, 'x', 512);
        data = reply;
    }
    return interrupted() ? -1 : syscall(SYS_write, file, data, part(size));
}
int fclose(FILE *file)
{
    int (*real)(FILE *) = (int (*)(FILE *))dlsym(RTLD_NEXT, "fclose");
    int status = real(file);
    errno = getenv("FULL") ? EIO : errno;
    return getenv("FULL") ? EOF : status;
}
int open(const char *path, int how, ...)
{
    va_list list;
    va_start(list, how);
    int mode = va_arg(list, int);
    va_end(list);
    errno = ENOSPC;
    if (getenv("NOPART") && strstr(path, getenv("NOPART")) && strstr(path, ".part"))
        return -1;
    return (int)syscall(SYS_openat, AT_FDCWD, path, how, mode);
}
pid_t fork(void)
{
    errno = EAGAIN;
    return getenv("SINGLE") ? -1 : (pid_t)syscall(SYS_fork);
}
pid_t waitpid(pid_t child, int *status, int how)
{
    return interrupted() ? -1 : wait4(child, status, how, NULL);
}
EOF
if ldd "$drape" | grep -q 'lib[a-z]*san' ||
    ! "${CC:-cc}" -shared -fPIC seldom.c -o seldom.so -ldl 2>/dev/null; then
    skip 'calls that a signal interrupts: no library can stand before this tool'
else
    head -n 8000 sent.obj >some.obj
    exits 'a mesh' 0 convert some.obj some.ply
    is 'a mesh by calls that are interrupted' env SELDOM=1 \
        LD_PRELOAD="$PWD/seldom.so" "$drape" convert some.obj some_2.ply
    is 'is the same' cmp some.ply some_2.ply
    is 'a film by such calls' sh -c 'PATH="$PWD/told:$PATH" SELDOM=1 \
        LD_PRELOAD="$PWD/seldom.so" "$0" render film --width 16 --height 16 \
        --samples 1 >told/out && grep -qx film/film.mp4 told/out' "$drape"
    is 'a scene from a pipe by such calls' sh -c 'cat tiny.json | SELDOM=1 \
        LD_PRELOAD="$PWD/seldom.so" "$0" plan - | grep -q "^tiny: "' "$drape"
    env SINGLE=1 LD_PRELOAD="$PWD/seldom.so" "$drape" convert some.obj none.ply 2>err
    is 'a system without processes' test $? -eq 3
    is 'is said to have none' grep -q '^drape: some.obj: no process to read it: Res' err
    fails 'a file that cannot be closed' 'none.ply: cannot write: Input/output error' \
        env FULL=1 LD_PRELOAD="$PWD/seldom.so" "$drape" convert good.ply none.ply
    is 'it is not there, nor a part of it' sh -c '
        [ ! -e none.ply ] && ! find . -name ".none*" | grep .'
    # Whichever file of a run, of a film or of convert cannot be opened, all ends there.
    while read -r name arguments; do
        rm -rf unopened unopened.*
        # shellcheck disable=SC2086
        fails "no room for $name" "$name: cannot write: No space left" \
            env NOPART="$name" LD_PRELOAD="$PWD/seldom.so" "$drape" $arguments
        is "no part, $name" sh -c '! find . -name "*.part" | grep .'
    done <<'EOT'
report.json run tiny.json --out unopened
obstacles.ply run tiny.json --out unopened
obstacles.obj run tiny.json --out unopened --obj
cloth_0000.ply run tiny.json --out unopened
cloth_0000.obj run tiny.json --out unopened --obj
contacts_0001.ply run tiny.json --out unopened --contacts
cloth.pc2 run tiny.json --out unopened
trace.csv run tiny.json --out unopened --trace
checkpoint.drape run tiny.json --out unopened --checkpoint-every 2
obstacles_0001.ply run moves.json --out unopened
obstacles_0001.obj run moves.json --out unopened --obj
frame_0000.png render film --frame 0 --width 16 --height 16
film_0001.png render film --width 16 --height 16 --samples 1 --quiet
unopened.ply convert good.ply unopened.ply
unopened.obj convert good.ply unopened.obj
unopened.stl convert good.ply unopened.stl
EOT
    # reply NAME AT TO: a reader whose reply is changed so sends no mesh
    reply() {
        env AT="$2" TO="$3" LD_PRELOAD="$PWD/seldom.so" timeout 20 "$drape" convert \
            good.dae changed.ply >out 2>err
        is "a reply $1" test $? -eq 2 -a ! -e changed.ply
        is "is none, $1" grep -q 'its reader ended with exit status . and no mesh$' err
    }
    reply 'of another tool' 0 1
    for at in 8 16; do
        reply "of fewer than none, at $at" $at -1
        reply "of more than it sends, at $at" $at 60
        reply "of more than it may hold, at $at" $at 2147483647
        reply "of more than can be counted, at $at" $at 2147483648
    done
    for frames in -1 60000 2147483647; do
        env AT=24 TO=$frames LD_PRELOAD="$PWD/seldom.so" timeout 20 "$drape" plan \
            animated.json >out 2>err
        is "$frames frames of an animation" test $? -eq 2 -a ! -s out
        is "are none, $frames" grep -q 'its reader ended with exit status . and no mesh$' err
    done
    env AT=296 TO=-2 LD_PRELOAD="$PWD/seldom.so" "$drape" convert good.dae changed.ply \
        >out 2>err
    is 'an error without an end has one' test $? -eq 2 -a "$(wc -c <err)" -lt 600
fi

# A process that may open no more files, beside the three that it has.
is 'no pipe to a reader' sh -c '
    (ulimit -n 4 && exec "$0" convert good.dae none.ply 3>&- 4>&- 5>&-) 2>err
    [ $? -eq 3 ] && grep -qx \
        "drape: good.dae: no pipe to its reader: Too many open files" err' "$drape"

# Who started the tool ignores the end of children, which a process inherits.
is 'a crash is told by one whose parent ignores children' sh -c '
    ! python3 -c "
import os, signal, sys
signal.signal(signal.SIGCHLD, signal.SIG_IGN)
os.execv(sys.argv[1], sys.argv[1:])" "$0" convert crash.dae crash.ply 2>err &&
    ! grep -q "exit status 0" err' "$drape"
is 'a film, too' sh -c 'PATH="$PWD/told:$PATH" python3 -c "
import os, signal, sys
signal.signal(signal.SIGCHLD, signal.SIG_IGN)
os.execv(sys.argv[1], sys.argv[1:])" "$0" render film --width 16 --height 16 \
    --samples 1 >told/out && grep -qx film/film.mp4 told/out' "$drape"

# Paths. Each is that of a file here, by as many steps to this folder as it takes.
# long NAME SIZE: a path of this many bytes
long() {
    python3 -c '
import sys
name, size = sys.argv[1], int(sys.argv[2])
print("./" * ((size - len(name)) // 2) + "/" * ((size - len(name)) % 2) + name)' "$@"
}
exits 'a scene by a path of 4095 bytes' 0 plan "$(long tiny.json 4095)"
refused 'a scene by a path of 4096 bytes' '…: the path is too long' \
    plan "$(long tiny.json 4096)"
exits 'a folder by a path of 3995 bytes' 0 run tiny.json --frames 0 --quiet \
    --out "$(long far 3995)"
is 'is the folder' test -s far/report.json
refused 'a folder by a path of 3996 bytes' '--out: the path is too long' \
    run tiny.json --frames 0 --out "$(long refused 3996)"
exits 'an audit by a path of 4070 bytes' 0 audit "$(long far 4070)"
refused 'an audit by a path of 4090 bytes' '…: the path is too long' \
    audit "$(long far 4090)"
refused 'a mesh to a path of 4100 bytes' 'the path of the output is too long' \
    convert good.ply "$(long refused.ply 4120)"
exits 'a mesh to a folder' 0 convert good.ply far/frames/good.ply
is 'is there' test -s far/frames/good.ply

# A folder is where a file goes.
mkdir taken.ply
fails 'a folder as a mesh' 'taken.ply: cannot write: Is a directory' \
    "$drape" convert good.ply taken.ply
is 'leaves no part' sh -c '! find . -name "*.part" | grep .'

sed 's/"detail": 10/"detail": 64/' moves.json >large.json
# Files that grow beyond a limit leave none of their parts. Blocks are of 512 bytes.
for what in '1 a-picture render_still_--frame_0_--width_64_--height_48' \
    '4 obj convert_quiet.ply_grown.obj' '4 stl convert_quiet.ply_grown.stl' \
    '9 obstacles.obj run_tiny.json_--out_grown_--obj_--frames_0' \
    '200 moving.obj run_large.json_--out_grown_--obj_--frames_1' \
    '9 contacts run_tiny.json_--out_grown_--contacts_--frames_12_--every_12' \
    '9 cache run_tiny.json_--out_grown_--frames_40' \
    '9 checkpoint run_tiny.json_--out_grown_--frames_1_--checkpoint-every_1'; do
    rm -rf grown grown.*
    arguments=$(echo "${what##* }" | tr _ ' ')
    limit=${what%% *} name=${what#* }
    # shellcheck disable=SC2086
    fails "${name% *} too large" cannot limited "$limit" $arguments
    is "no part of ${name% *} is left" sh -c '! find . -name "*.part" | grep .'
done
