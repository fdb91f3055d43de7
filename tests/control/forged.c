/* SPDX-License-Identifier: Apache-2.0 */
/* Checkpoints with right hashes and one field that no step of their world
 * gives: each is refused, and changes nothing. ref/world/checkpoint.c */
#include <math.h>
#include <stdio.h>

#include "ref/base/hash.h"
#include "ref/contact/carry.h"
#include "ref/sleep/sleep.h"
#include "ref/world/state.h"
#include "tests/api/guest.h"
#include "tests/world/recall.h"
#include "tests/world/slab.h"

/* Where the header has its fields; the streams follow it. */
enum {
    CHECK = 24,
    STEP = 32,
    INTERSECTING = 48,
    TIME = 56,
    NEAR = 64,
    PAST = 68,
    KEPT = 72,
    WIND = 80,
    DENSITY = 104,
    DRAG = 112,
    LIFT = 120,
    HEAD = 128,
    NV = SLAB_SMALL * SLAB_SMALL + 8, /* even, so that streams are words */
    NC = SLAB_SMALL * SLAB_SMALL,
    VEC = 3 * REAL_BITS / 8,
    OBSTACLE_X = HEAD + NC * VEC,
    OBSTACLE_V = OBSTACLE_X + NV * VEC,
    WATCH = HEAD + 2 * NV * VEC,
    REST = WATCH + 16,
    ASLEEP = REST + 4,
    GROUP = REST + 8,
    REST_PAST = REST + 12,
    REST_FAR = REST + 16,
    LAMBDA = 16 /* of struct kept */
};

/* A field at an offset: its value, a whole number of so many bytes, or, where
 * bytes is 0, a double, or, where bytes is 1, a real. */
struct forgery {
    size_t at, bytes;
    int64_t whole;
    double number;
    int want;
};

#define WHOLE(at, bytes, value, want)                                          \
    {                                                                          \
        at, bytes, value, 0, want                                              \
    }
#define NUMBER(at, value, want)                                                \
    {                                                                          \
        at, 0, 0, value, want                                                  \
    }
#define REAL(at, value)                                                        \
    {                                                                          \
        at, 1, 0, value, DRAPE_EDATA                                           \
    }
#define ODD DRAPE_EDATA

/* The world: two slices a step at most, a sheet at rest over a slab that never
 * moves, without a past. */
static const struct forgery plain[] = {
    WHOLE(STEP, 8, -1, ODD),
    WHOLE(STEP, 8, 3, ODD), /* the time is that of step 0 */
    WHOLE(INTERSECTING, 8, -1, ODD),
    WHOLE(INTERSECTING, 8, INT64_MAX, ODD),
    NUMBER(TIME, 1, ODD),
    NUMBER(TIME, NAN, ODD),
    WHOLE(NEAR, 4, 2, DRAPE_OK),
    WHOLE(NEAR, 4, 3, ODD),
    WHOLE(PAST, 4, 1, ODD),
    WHOLE(KEPT, 8, -1, DRAPE_EMATCH),
    WHOLE(KEPT, 8, INT64_MAX, DRAPE_EMATCH),
    WHOLE(KEPT, 8, 1 << 29, DRAPE_EIO), /* no memory is taken for them */
    NUMBER(WIND, 0x1p61, ODD),
    NUMBER(WIND, NAN, ODD),
    NUMBER(DENSITY, -1, ODD),
    NUMBER(DRAG, 1e6, DRAPE_OK),
    NUMBER(DRAG, 2e6, ODD),
    NUMBER(LIFT, 2e6, ODD),
    NUMBER(LIFT, -1, ODD),
    REAL(HEAD, INFINITY),
    REAL(HEAD, 0x1p61),
    REAL(OBSTACLE_X, 0.05), /* it never moves */
    REAL(OBSTACLE_V, 1),
    NUMBER(WATCH, -1, ODD),
    NUMBER(WATCH, INFINITY, ODD),
    WHOLE(REST, 4, SLEEP_MOST, DRAPE_OK),
    WHOLE(REST, 4, SLEEP_MOST + 1, ODD),
    WHOLE(REST, 4, -1, ODD),
    WHOLE(ASLEEP, 4, 2, ODD),
    WHOLE(GROUP, 4, 1, ODD),
    WHOLE(GROUP, 4, -1, ODD),
    WHOLE(REST_PAST, 4, 1, ODD),
    NUMBER(REST_FAR, -1, ODD),
    NUMBER(REST_FAR, NAN, ODD),
};

/* A world that never sleeps, whose slab moves, and that has a past. */
static const struct forgery other[] = {
    WHOLE(PAST, 4, 2, DRAPE_OK), WHOLE(PAST, 4, 3, ODD),
    REAL(OBSTACLE_X, 0x1p61),    WHOLE(REST, 4, 1, ODD),
    WHOLE(ASLEEP, 4, 1, ODD),    WHOLE(REST_PAST, 4, 2, DRAPE_OK),
    WHOLE(REST_PAST, 4, 3, ODD),
};

/* What contacts carry on, from its start on: a world whose sheet presses on its
 * slab. carry.md §3 */
static const struct forgery pressed[] = {
    WHOLE(0, 4, NV, ODD),
    WHOLE(4, 4, NV, ODD),
    WHOLE(8, 4, NV, ODD),
    WHOLE(12, 4, NV, ODD),
    WHOLE(0, 8, (int64_t)(NV - 1) << 32 | (NV - 1), ODD), /* not by key */
    REAL(LAMBDA, -1),
    REAL(LAMBDA, NAN),
    REAL(LAMBDA, INFINITY),
    REAL(LAMBDA + sizeof(real), NAN),
    REAL(LAMBDA + 3 * sizeof(real), -INFINITY),
    {LAMBDA, 1, 0, 0.5, DRAPE_OK},
};

static void rehash(struct recall *r)
{
    const uint64_t none = 0;
    memcpy(r->data + CHECK, &none, sizeof none);
    uint64_t check = hash_mix(HASH_SEED, r->data, r->size);
    memcpy(r->data + CHECK, &check, sizeof check);
}

static void put(struct recall *r, const struct forgery *f)
{
    real number = (real)f->number;
    if (f->bytes == 0)
        memcpy(r->data + f->at, &f->number, sizeof f->number);
    else if (f->bytes == 1)
        memcpy(r->data + f->at, &number, sizeof number);
    else
        memcpy(r->data + f->at, &f->whole, f->bytes);
    rehash(r);
}

/* kept: the rows' offsets are from the start of what contacts carry on. */
static const char *forge(drape_world *world, const struct forgery *f, int n,
                         bool kept)
{
    static struct recall own, forged, after;
    static char text[96];
    EXPECT(recall_save(world, &own));
    forged = own;
    rehash(&forged);
    EXPECT(recall_same(&own, &forged)); /* the hash and the layout are known */
    int64_t n_kept;
    memcpy(&n_kept, own.data + KEPT, sizeof n_kept);
    EXPECT(kept == (n_kept > 1));
    size_t from = kept ? own.size - (size_t)n_kept * sizeof(struct kept) : 0;
    for (int k = 0; k < n; k++) {
        struct forgery row = f[k];
        row.at += from;
        forged = own;
        put(&forged, &row);
        int status = recall_load(world, &forged);
        EXPECT(recall_save(world, &after));
        bool same = recall_same(&after, status == DRAPE_OK ? &forged : &own);
        ran(1);
        if (status == f[k].want && same) {
            EXPECT(recall_load(world, &own) == DRAPE_OK);
            continue;
        }
        snprintf(text, sizeof text, "row %d, byte %d: %d, expected %d%s", k,
                 (int)f[k].at, status, f[k].want, same ? "" : "; not as said");
        return text;
    }
    return NULL;
}

const char *test_checkpoint_forged(void)
{
    struct slab d;
    slab_small(&d, DRAPE_BW, 0.375);
    d.obstacle.motion = -1;
    d.def.n_motions = 0;
    d.def.max_slices = 2;
    drape_world *world = slab_world(&d);
    EXPECT(world);
    const char *what =
        forge(world, plain, (int)(sizeof plain / sizeof *plain), false);
    drape_destroy(world);
    slab_small(&d, DRAPE_CK, 0.375);
    d.def.max_slices = 2;
    d.def.sleep = 0;
    world = slab_world(&d);
    EXPECT(what || world);
    if (!what)
        what = forge(world, other, (int)(sizeof other / sizeof *other), false);
    drape_destroy(world);
    slab_small(&d, DRAPE_BW, 0.104);
    d.obstacle.motion = -1;
    d.def.n_motions = 0;
    world = slab_world(&d);
    EXPECT(what || (world && guest_go(world, 8) == DRAPE_OK));
    if (!what)
        what = forge(world, pressed, (int)(sizeof pressed / sizeof *pressed),
                     true);
    drape_destroy(world);
    return what;
}
