/* SPDX-License-Identifier: Apache-2.0 */
/* Checkpoints with right hashes and one field that no step of their world
 * gives: each is refused, and changes nothing. ref/world/checkpoint.c */
#include <math.h>
#include <stdio.h>

#include "ref/base/hash.h"
#include "ref/sleep/sleep.h"
#include "ref/world/state.h"
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
    LEVEL = 72,
    AGAIN = 74,
    CALM = 76,
    FAR = 78,
    BLIND = 80,
    PRESSED = 82,
    WIND = 88,
    DENSITY = 112,
    DRAG = 120,
    LIFT = 128,
    HEAD = 136,
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
    PRESS = REST + 24 /* of Baraff–Witkin, which has no past */
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
    WHOLE(NEAR, 4, 3, DRAPE_OK),
    WHOLE(NEAR, 4, 4, ODD),
    WHOLE(PAST, 4, 1, ODD),
    WHOLE(LEVEL, 2, 1, DRAPE_OK),
    WHOLE(LEVEL, 2, 2, ODD),
    WHOLE(AGAIN, 2, 1, DRAPE_OK),
    WHOLE(AGAIN, 2, 2, ODD),
    WHOLE(CALM, 2, 7, DRAPE_OK),
    WHOLE(CALM, 2, 8, ODD),
    WHOLE(CALM, 2, 65535, ODD),
    WHOLE(FAR, 2, 1, DRAPE_OK),
    WHOLE(FAR, 2, 2, ODD),
    WHOLE(BLIND, 2, 8, DRAPE_OK),
    WHOLE(BLIND, 2, 9, ODD),
    WHOLE(PRESSED, 2, 1, DRAPE_OK),
    WHOLE(PRESSED, 2, 2, ODD),
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
    REAL(PRESS, 1), /* without PRESSED all are 0 */
};

/* A world that never sleeps, whose slab moves, and that has a past. */
static const struct forgery other[] = {
    WHOLE(PAST, 4, 2, DRAPE_OK),      WHOLE(PAST, 4, 3, ODD),
    WHOLE(PRESSED, 2, 1, ODD),        REAL(OBSTACLE_X, 0x1p61),
    WHOLE(REST, 4, 1, ODD),           WHOLE(ASLEEP, 4, 1, ODD),
    WHOLE(REST_PAST, 4, 2, DRAPE_OK), WHOLE(REST_PAST, 4, 3, ODD),
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

static const char *forge(drape_world *world, const struct forgery *f, int n)
{
    static struct recall own, forged, after;
    static char text[96];
    EXPECT(recall_save(world, &own));
    forged = own;
    rehash(&forged);
    EXPECT(recall_same(&own, &forged)); /* the hash and the layout are known */
    for (int k = 0; k < n; k++) {
        forged = own;
        put(&forged, &f[k]);
        int status = recall_load(world, &forged);
        EXPECT(recall_save(world, &after));
        bool kept = recall_same(&after, status == DRAPE_OK ? &forged : &own);
        ran(1);
        if (status == f[k].want && kept) {
            EXPECT(recall_load(world, &own) == DRAPE_OK);
            continue;
        }
        snprintf(text, sizeof text, "row %d, byte %d: %d, expected %d%s", k,
                 (int)f[k].at, status, f[k].want, kept ? "" : "; not as said");
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
    const char *what = forge(world, plain, (int)(sizeof plain / sizeof *plain));
    drape_destroy(world);
    slab_small(&d, DRAPE_CK, 0.375);
    d.def.max_slices = 2;
    d.def.sleep = 0;
    world = slab_world(&d);
    EXPECT(what || world);
    if (!what)
        what = forge(world, other, (int)(sizeof other / sizeof *other));
    drape_destroy(world);
    return what;
}
