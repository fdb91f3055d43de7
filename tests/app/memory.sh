# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# Whichever allocation of the tool finds no memory, the tool says so, leaves no
# half of a file, and gives back what it has taken, as after any end.
# Read by tests/app.sh, whose functions it calls.

# A library that counts the allocations that the tool's own code makes, and
# refuses them from number $STARVE on; in a child, from $STARVE_CHILD on. Where
# the tool or libjansson has not given back all memory at the end, the exit status
# is 99; where a file is still open, 98.
cat >starve.c <<'EOF'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);
extern void *__libc_memalign(size_t line, size_t size);
extern void __libc_free(void *old);

enum { OWN, JSON, OBJECTS, FILES = 256, KEPT = 1 << 16 };
static struct { uintptr_t low, high; } object[OBJECTS];
static void *kept[KEPT]; /* what was taken and not given back */
static int used;         /* no place from here on was ever taken */
static long left = -1;
static pid_t process;
static int open_before[FILES];

static int is_open(int file)
{
    return fcntl(file, F_GETFD) != -1;
}

/* The first object is the program. */
static int see(struct dl_phdr_info *info, size_t size, void *user)
{
    int *seen = user, k = (*seen)++ == 0 ? OWN : JSON;
    (void)size;
    if (k == JSON && !strstr(info->dlpi_name, "libjansson.so"))
        return 0;
    object[k].low = UINTPTR_MAX;
    for (int j = 0; j < info->dlpi_phnum; j++) {
        uintptr_t a = info->dlpi_addr + info->dlpi_phdr[j].p_vaddr;
        uintptr_t b = a + info->dlpi_phdr[j].p_memsz;
        if (info->dlpi_phdr[j].p_type != PT_LOAD)
            continue;
        object[k].low = a < object[k].low ? a : object[k].low;
        object[k].high = b > object[k].high ? b : object[k].high;
    }
    return 0;
}

static int is_in(int k, void *caller)
{
    uintptr_t a = (uintptr_t)caller;
    return a >= object[k].low && a < object[k].high;
}

__attribute__((constructor)) static void begin(void)
{
    const char *count = getenv("STARVE");
    int seen = 0;
    dl_iterate_phdr(see, &seen);
    left = count ? atol(count) : -1;
    process = getpid();
    for (int k = 3; k < FILES; k++)
        open_before[k] = is_open(k);
}

__attribute__((destructor)) static void end(void)
{
    for (int k = 0; k < used; k++)
        if (kept[k] && process == getpid())
            _exit(99);
    for (int k = 3; k < FILES; k++)
        if (is_open(k) && !open_before[k] && process == getpid())
            _exit(98);
}

static int fails(void *caller)
{
    const char *count = getenv("STARVE_CHILD");
    if (process != getpid()) {
        process = getpid();
        left = count ? atol(count) : -1;
    }
    if (left < 0 || !is_in(OWN, caller))
        return 0;
    left -= left > 0;
    errno = ENOMEM;
    return left == 0;
}

/* The place of a pointer among those kept; of NULL: a free one. */
static void **place(void *old)
{
    for (int k = 0; k < used; k++)
        if (kept[k] == old)
            return &kept[k];
    if (!old && used == KEPT)
        abort();
    return old ? NULL : &kept[used++];
}

static void *keep(void *caller, void *data)
{
    if (data && (is_in(OWN, caller) || is_in(JSON, caller)))
        *place(NULL) = data;
    return data;
}

static void drop(void *old)
{
    void **at = old ? place(old) : NULL;
    if (at)
        *at = NULL;
}

void *malloc(size_t size)
{
    void *caller = __builtin_return_address(0);
    return fails(caller) ? NULL : keep(caller, __libc_malloc(size));
}

void *calloc(size_t count, size_t size)
{
    void *caller = __builtin_return_address(0);
    return fails(caller) ? NULL : keep(caller, __libc_calloc(count, size));
}

void *realloc(void *old, size_t size)
{
    void *caller = __builtin_return_address(0);
    void *data = fails(caller) ? NULL : __libc_realloc(old, size);
    if (data)
        drop(old);
    return keep(caller, data);
}

void free(void *old)
{
    drop(old);
    __libc_free(old);
}

/* What the library of the simulation takes never fails here, as its own tests let
 * it fail, but is to be given back. */
void *aligned_alloc(size_t line, size_t size)
{
    return keep(__builtin_return_address(0), __libc_memalign(line, size));
}

/* The data of a stream to memory is the caller's when the stream is closed. */
static FILE *stream;
static char **stream_data;

FILE *open_memstream(char **data, size_t *size)
{
    FILE *(*real)(char **, size_t *) =
        (FILE * (*)(char **, size_t *)) dlsym(RTLD_NEXT, "open_memstream");
    void *caller = __builtin_return_address(0);
    FILE *made = real(data, size);
    if (is_in(OWN, caller)) {
        stream = made;
        stream_data = data;
    }
    return made;
}

int fclose(FILE *file)
{
    int (*real)(FILE *) = (int (*)(FILE *))dlsym(RTLD_NEXT, "fclose");
    int status = real(file);
    if (file && file == stream) {
        *place(NULL) = *stream_data;
        stream = NULL;
    }
    return status;
}
EOF

# A library that writes down how many bytes are in aligned blocks, in whole lines of
# 64 bytes, whenever a file is written whole.
cat >held.c <<'EOF'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

extern void __libc_free(void *old);
enum { BLOCKS = 1 << 14 };
static struct { void *at; size_t bytes; } block[BLOCKS];
static size_t held;

void *aligned_alloc(size_t line, size_t bytes)
{
    void *(*real)(size_t, size_t) =
        (void *(*)(size_t, size_t))dlsym(RTLD_NEXT, "aligned_alloc");
    void *at = real(line, bytes);
    int k = 0;
    while (block[k].at)
        k++;
    block[k].at = at;
    block[k].bytes = (bytes + 63) / 64 * 64;
    held += block[k].bytes;
    return at;
}

void free(void *old)
{
    for (int k = 0; old && k < BLOCKS; k++)
        if (block[k].at == old) {
            held -= block[k].bytes;
            block[k].at = NULL;
        }
    __libc_free(old);
}

int fsync(int file)
{
    FILE *out = fopen("held.txt", "a");
    fprintf(out, "%zu\n", held);
    fclose(out);
    return file < 0 ? -1 : 0;
}
EOF

# A library that counts what the tool takes and gives back; where the counts differ
# at the end the exit status is 97. Its functions hand on what they are given,
# pointers and small numbers, whatever these are.
cat >taken.c <<'EOF'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int refused(const char *name);
typedef void *call(void *, void *, void *, void *, void *, void *);
enum { DEVICE, SCENE, GEOMETRY, IMPORT, BLOB, PICTURE, FOLDER, KINDS };
static int taken[KINDS];
static pid_t process;
#define HAND_ON(name) ((call *)dlsym(RTLD_NEXT, #name))(a, b, c, d, e, f)
#define TAKE(kind, name)                                                       \
    void *name(void *a, void *b, void *c, void *d, void *e, void *f)           \
    {                                                                          \
        void *made = refused(#name) ? NULL : HAND_ON(name);                    \
        FILE *told = made ? fopen("taken.txt", "a") : NULL;                    \
        if (told && fprintf(told, #name "\n") > 0)                            \
            fclose(told);                                                      \
        taken[kind] += made != NULL;                                           \
        return made;                                                           \
    }
#define GIVE(kind, name, held)                                                 \
    void *name(void *a, void *b, void *c, void *d, void *e, void *f)           \
    {                                                                          \
        taken[kind] -= a && (held);                                            \
        return HAND_ON(name);                                                  \
    }
/* Whether $REFUSE names this function, which then fails. */
static int refused(const char *name)
{
    const char *told = getenv("REFUSE");
    return told && strcmp(told, name) == 0;
}
/* A buffer of vertices, b = 1, or of indices, b = 0. */
void *rtcSetNewGeometryBuffer(void *a, void *b, void *c, void *d, void *e, void *f,
                              void *g)
{
    typedef void *more(void *, void *, void *, void *, void *, void *, void *);
    more *real = (more *)dlsym(RTLD_NEXT, "rtcSetNewGeometryBuffer");
    return refused(b ? "vertices" : "indices") ? NULL : real(a, b, c, d, e, f, g);
}
TAKE(DEVICE, rtcNewDevice)
GIVE(DEVICE, rtcReleaseDevice, 1)
TAKE(SCENE, rtcNewScene)
GIVE(SCENE, rtcReleaseScene, 1)
TAKE(GEOMETRY, rtcNewGeometry)
GIVE(GEOMETRY, rtcReleaseGeometry, 1)
TAKE(IMPORT, aiImportFileFromMemory)
GIVE(IMPORT, aiReleaseImport, 1)
TAKE(BLOB, aiExportSceneToBlob)
GIVE(BLOB, aiReleaseExportBlob, 1)
TAKE(PICTURE, png_create_write_struct)
GIVE(PICTURE, png_destroy_write_struct, *(void **)a != NULL)
TAKE(FOLDER, opendir)
GIVE(FOLDER, closedir, 1)

__attribute__((constructor)) static void begin(void)
{
    process = getpid();
}
__attribute__((destructor)) static void end(void)
{
    for (int k = 0; k < KINDS; k++)
        if (taken[k] && process == getpid())
            _exit(97);
}
EOF

# What is said then: for `ccd --frames` a touch that cannot be kept.
meager='^drape: (.*: )?out of memory$|: needs more memory than the limit|no memory left|reader needs more than|ccd: reading or writing failed'
# starves WHO LEAST COMMAND...: the command's first, second, ... allocation is the
# first that fails, until none does in eight runs; there are at least LEAST. Each
# time the exit status is 2 or 3 and the last line names the memory.
starves() {
    who=$1 least=$2 n=1 whole=0
    shift 2
    while [ $n -lt 1000 ]; do
        rm -rf starved starved.*
        env "$who=$n" LD_PRELOAD="$PWD/starve.so" "$drape" "$@" >out 2>err </dev/null
        got=$?
        [ $got -ne 0 ] || whole=$((whole + 1))
        [ $whole -lt 8 ] || break
        case $got in
        0) ;;
        2 | 3)
            [ $whole -eq 0 ] || break
            tail -n 1 err | grep -qE "$meager" || break
            ;;
        *) break ;;
        esac
        n=$((n + 1))
    done
    if [ $whole -eq 8 ] && [ $((n - 8)) -ge "$least" ]; then
        ok "$1 without memory, $((n - 8)) times"
    else
        bad "$1 without memory: allocation $n (exit $got)"
    fi
    is "$1 leaves no part of a file" sh -c '! find . -name "*.part" | grep .'
}
if ldd "$drape" | grep -q 'lib[a-z]*san' ||
    ! "${CC:-cc}" -shared -fPIC starve.c -o starve.so -ldl 2>/dev/null; then
    skip 'a tool without memory: no library can stand before this one'
else
    mkdir meager
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >meager/one.obj
    for end in ply off stl; do
        [ $end = off ] || "$drape" convert meager/one.obj meager/one.$end --quiet
    done
    printf 'OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >meager/one.off
    sed 's/"name": "cloth"/&, "look": {"gloss": 1}/' moves.json >meager/moves.json
    "$drape" run meager/moves.json --out meager/run --frames 2 --quiet \
        --checkpoint-every 1 --trace
    starves STARVE 10 plan meager/moves.json
    starves STARVE 40 plan geometry.json
    for end in obj off ply stl; do
        starves STARVE 4 convert meager/one.$end starved.obj
    done
    is 'a plan by measured constants gives back all' env LD_PRELOAD="$PWD/starve.so" \
        "$drape" plan tiny.json --speed speed.csv
    for end in stl glb dae; do
        is "a mesh as $end gives back all" env LD_PRELOAD="$PWD/starve.so" "$drape" \
            convert meager/one.obj meager/written.$end --quiet
    done
    starves STARVE_CHILD 2 convert meager/one.obj starved.ply
    starves STARVE 10 audit meager/run
    starves STARVE 4 audit meager/one.stl
    starves STARVE 1 ccd --kind vf hit.csv
    starves STARVE 4 ccd --frames before.ply after.ply
    starves STARVE 10 render meager/run --frame 1 --width 16 --height 16 --samples 1
    starves STARVE 20 run meager/moves.json --out starved --frames 1 --obj --trace \
        --contacts --checkpoint-every 1
    starves STARVE 20 run meager/moves.json --out starved --frames 3 --quiet \
        --resume meager/run/checkpoint.drape
    starves STARVE 20 run tiny.json --out starved --frames 1 --error 0.05
    is 'a run that goes on gives back all' env LD_PRELOAD="$PWD/starve.so" "$drape" \
        run meager/moves.json --out meager/run --frames 3 --trace --quiet \
        --resume meager/run/checkpoint.drape
    # What the tool takes of Embree, libpng, assimp and the system it gives back.
    "${CC:-cc}" -shared -fPIC taken.c -o taken.so -ldl
    for command in 'render meager/run --frame 1 --width 16 --height 16 --samples 1' \
        'convert meager/one.obj taken.glb' 'audit meager/run'; do
        # shellcheck disable=SC2086
        is "what is taken is given back: $command" env LD_PRELOAD="$PWD/taken.so" \
            "$drape" $command
    done
    # refuses NAME WORDS COMMAND...: a function of a library fails
    refuses() {
        function=$1 words=$2
        shift 2
        env REFUSE="$function" LD_PRELOAD="$PWD/taken.so" "$drape" "$@" >out 2>err
        is "$function fails" test $? -eq 3
        is "$function: $words" grep -q "$words" err
        is "$function: no part of a file" sh -c '! find . -name "*.part" | grep .'
    }
    for name in rtcNewDevice vertices indices; do
        refuses $name 'render: Embree gave up$' render meager/run --frame 1 --width 16 \
            --height 16 --samples 1
    done
    refuses png_create_write_struct 'frame_0001.png: cannot write the picture$' \
        render meager/run --frame 1 --width 16 --height 16 --samples 1
    for name in aiImportFileFromMemory aiExportSceneToBlob; do
        refuses $name 'taken.glb: assimp cannot write it' convert meager/one.obj taken.glb
    done
    is 'of all that the library has counted' test "$(sort -u taken.txt | wc -l)" -ge 7
    # What the library holds at the end of a run is what the report says, by a count
    # of its blocks at each file that is written whole; the report is the last.
    "${CC:-cc}" -shared -fPIC held.c -o held.so -ldl
    is 'a run, counted' env LD_PRELOAD="$PWD/held.so" "$drape" run meager/moves.json \
        --out counted --quiet
    is 'holds what its report says' python3 -c '
import json
held = [int(line) for line in open("held.txt")]
r = json.load(open("counted/report.json"))
assert 0 < r["memory"]["host_bytes"] < held[-1] == r["held_bytes"], held'
    env LD_PRELOAD="$PWD/starve.so" PATH=/nowhere "$drape" export meager/run \
        --to x.usdc >out 2>err
    is 'an export without Python gives back all' test $? -eq 3
fi
