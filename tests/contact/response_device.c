/* SPDX-License-Identifier: Apache-2.0 */
/* Runs collision response on the reference and on the device, on the same
 * scenes: every stage gives the same bits. spec/contact/response.md, gpu.md */
#include <stdlib.h>

#include "gpu/run/backend.h"
#include "gpu/world/state.h"
#include "tests/base/choices.h"
#include "tests/base/notes.h"
#include "tests/contact/tangle.h"

/* The same scene twice: `ref` is stepped by the reference, `r` by the device.
 * `a` is a copy of the device's data for the host's broad phase. */
struct rival {
    struct tangle ref, a;
    struct response r; /* streams on the device */
    struct gpu *g;
    void *pair, *kind; /* device: candidates */
    struct trace trace[2];
    struct notes notes[2];
    int outcomes;    /* bitwise or of the outcomes of all steps */
    int64_t started; /* pairs that touch at the start, of all steps */
    int64_t kept;    /* contacts found for a solve that go on into rounds */
};

/* A stand-in for the broad phase */

/* fetch copies a stream of a.nv items from the device, send copies it back. */
static void fetch(struct rival *t, void *to, const void *from, size_t size)
{
    gpu_down(t->g, to, from, (size_t)t->a.nv * size);
}

static void send(struct rival *t, void *to, const void *from, size_t size)
{
    gpu_up(t->g, to, from, (size_t)t->a.nv * size);
}

static void *upload(struct rival *t, void *old, const void *from, size_t bytes)
{
    gpu_give(t->g, old);
    void *p = gpu_take(t->g, ARENA_PAIRS, (int64_t)bytes, 1);
    if (p)
        gpu_up(t->g, p, from, bytes);
    gpu_wait(t->g);
    return p;
}

static int rival_broad(void *user, const uint8_t *touched, struct pairs *out)
{
    struct rival *t = user;
    fetch(t, t->a.x1, t->r.x1, sizeof(vec));
    if (touched)
        fetch(t, t->a.r.touched, touched, 1);
    int status = tangle_broad(&t->a, touched ? t->a.r.touched : NULL, out);
    t->pair =
        upload(t, t->pair, out->pair, (size_t)out->n * 4 * sizeof *out->pair);
    t->kind = upload(t, t->kind, out->kind, (size_t)out->n);
    out->pair = t->pair;
    out->kind = t->kind;
    return status == DRAPE_OK ? gpu_status(t->g) : status;
}

/* Both backends */

static void *give(struct rival *t, const void *from, int64_t n, size_t size)
{
    void *p = gpu_take(t->g, ARENA_RESPONSE, n, size);
    if (p && from)
        gpu_up(t->g, p, from, (size_t)n * size);
    return p;
}

/* Sets up the device's response: the same settings, streams on the device. */
static void rival_open(struct rival *t)
{
    struct response *r = &t->r;
    int64_t nv = t->a.nv;
    *r = t->a.r;
    r->run = &backend_gpu;
    r->on = t->g;
    r->w = give(t, t->a.w, nv, sizeof(real));
    r->surfaces.of = give(t, t->a.of, nv, sizeof *t->a.of);
    r->surfaces.surface = give(t, &t->a.surface, 1, sizeof t->a.surface);
    r->x0 = give(t, NULL, nv, sizeof(vec));
    r->x1 = give(t, NULL, nv, sizeof(vec));
    r->v = give(t, NULL, nv, sizeof(vec));
    r->u = give(t, NULL, nv, sizeof(vec));
    r->touched = give(t, NULL, nv, 1);
    r->rolled = give(t, NULL, nv, 1);
    r->start = give(t, NULL, nv + 1, sizeof(int32_t));
    r->first = give(t, NULL, nv, sizeof(uint64_t));
    r->broad = rival_broad;
    r->user = t;
    for (int k = 0; k < 2; k++)
        t->trace[k] = (struct trace){notes_take, &t->notes[k], 0, 0};
    t->ref.r.trace = &t->trace[0];
    r->trace = &t->trace[1];
}

/* One step on the device, as tangle_step on the host. */
static int rival_step(struct rival *t, vec a)
{
    struct pairs near;
    tangle_start(&t->a, a);
    send(t, (vec *)t->r.x0, t->a.x0, sizeof(vec));
    send(t, t->r.x1, t->a.x1, sizeof(vec));
    send(t, t->r.v, t->a.v, sizeof(vec));
    int status = response_start(&t->r);
    t->a.reach = t->a.surface.thickness;
    if (status == DRAPE_OK)
        status = rival_broad(t, NULL, &near);
    if (status == DRAPE_OK)
        status = tangle_respond(&t->r, &near);
    t->a.reach = 0;
    if (status == DRAPE_OK)
        status = response_penetrate(&t->r);
    fetch(t, t->a.x1, t->r.x1, sizeof(vec));
    fetch(t, t->a.v, t->r.v, sizeof(vec));
    fetch(t, t->a.r.u, t->r.u, sizeof(vec));
    fetch(t, t->a.r.rolled, t->r.rolled, 1);
    t->kept += t->r.rounds > 1 ? t->r.n_solved : 0;
    return status == DRAPE_OK ? gpu_status(t->g) : status;
}

static const char *compare(struct rival *t)
{
    const struct response *a = &t->ref.r, *b = &t->r;
    size_t vecs = (size_t)t->a.nv * sizeof(vec);
    const char *failed = notes_compare(&t->notes[0], &t->notes[1]);
    if (failed)
        return failed;
    EXPECT(t->notes[0].n > 0);
    EXPECT(!memcmp(t->ref.x1, t->a.x1, vecs));
    EXPECT(!memcmp(t->ref.v, t->a.v, vecs));
    EXPECT(!memcmp(a->u, t->a.r.u, vecs));
    EXPECT(!memcmp(a->rolled, t->a.r.rolled, (size_t)t->a.nv));
    EXPECT(a->rounds == b->rounds && a->outcome == b->outcome);
    EXPECT(a->contacts == b->contacts && a->impacts == b->impacts);
    EXPECT(a->candidates == b->candidates);
    EXPECT(a->zone_vertices == b->zone_vertices);
    EXPECT(a->rolled_back == b->rolled_back);
    EXPECT(a->started == b->started && a->prescribed == b->prescribed);
    return NULL;
}

static const char *walk(struct rival *t, int steps, vec a)
{
    rival_open(t);
    for (int step = 0; step < steps; step++) {
        t->notes[0].n = t->notes[1].n = 0;
        EXPECT(tangle_step(&t->ref, a) == DRAPE_OK);
        EXPECT(rival_step(t, a) == DRAPE_OK);
        const char *failed = compare(t);
        if (failed)
            return failed;
        t->outcomes |= t->r.outcome;
        t->started += t->r.started;
        tangle_next(&t->ref);
        tangle_next(&t->a);
        ran(1);
    }
    return NULL;
}

/* Makes scene k: soups, then a sheet between plates; resolved by impulses,
 * zones or rollback; some with contacts found for an implicit solve. */
static void make_scene(struct tangle *t, int k)
{
    static const int rounds[][2] = {{16, 8}, {0, 8}, {0, 0}, {2, 2}};
    static const real speed[] = {R(0.9), R(2.0), R(20.0), R(40.0)};
    struct bytes b = {.seed = (uint64_t)k, .size = -1};
    if (k < 8)
        tangle_soup(t, &b, k == 4 ? 5 : 3, k % 2 == 1);
    else
        tangle_press(t, &b, speed[k % 4], k == 11 ? speed[3] : -speed[k % 4]);
    if (k == 7) /* two primitives touch at the start */
        t->x0[3] = t->x0[0];
    t->r.max_rounds = rounds[k % 4][0];
    t->r.zone_rounds = rounds[k % 4][1];
    if (k == 9) /* rollback takes the whole scene at once */
        t->r.max_rounds = t->r.zone_rounds = t->r.roll_rounds = 0;
    t->r.solves = k % 3 == 0;
    choices_free(&b);
}

static const char *run_scene(struct rival *t, int k, int *status)
{
    enum { STEPS = 8 };
    make_scene(&t->ref, k);
    make_scene(&t->a, k);
    t->g = gpu_open(NULL, status);
    const char *failed = NULL;
    if (t->g) {
        gpu_set_block(t->g, k % 2 ? 96 : 256);
        failed = walk(t, STEPS, vec_make(0, k < 8 ? 0 : -10, 0));
    }
    gpu_close(t->g);
    t->pair = t->kind = NULL;
    for (int i = 0; i < 2; i++)
        notes_free(&t->notes[i]);
    tangle_free(&t->ref);
    tangle_free(&t->a);
    return failed;
}

const char *test_response_device(void)
{
    enum { SCENES = 12 };
    static struct rival t;
    const char *failed = NULL;
    int status = DRAPE_OK;
    for (int k = 0; k < SCENES && !failed && status == DRAPE_OK; k++)
        failed = run_scene(&t, k, &status);
    if (status == DRAPE_EDEVICE && !failed)
        return skip("there is no device");
    if (failed)
        return failed;
    EXPECT(status == DRAPE_OK);
    /* the scenes together reach every outcome */
    EXPECT(t.outcomes & DRAPE_ZONES && t.outcomes & DRAPE_ROLLBACK);
    EXPECT(t.outcomes & DRAPE_TRAPPED && t.started > 0 && t.kept > 0);
    return NULL;
}
