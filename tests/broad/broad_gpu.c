/* SPDX-License-Identifier: Apache-2.0 */
/* Compares the broad phase on the device with the reference: candidates, front,
 * counters and digests are equal to the last bit. spec/gpu.md §1 */
#include <stdio.h>
#include <stdlib.h>

#include "gpu/broad/broad.h"
#include "gpu/run/backend.h"
#include "gpu/run/gpu.h"
#include "gpu/world/state.h"
#include "ref/base/clock.h"
#include "ref/narrow/narrow.h"
#include "tests/base/data.h"
#include "tests/base/notes.h"
#include "tests/broad/fabric.h"
#include "tests/narrow/ply.h"

/* A scene, in the reference and on the device. */
struct both {
    struct gpu *g;
    struct fabric f;
    struct broad ref, dev;
    struct notes notes[2]; /* digests of the last query: reference, device */
    struct trace trace[2];
    vec *x0, *x1;   /* on the device */
    uint8_t *moved; /* on the device */
    double seconds[2];
};

static bool make(struct both *t, bool self)
{
    int64_t n = t->f.scene.vertices;
    bool good =
        broad_make(&t->ref, &t->f.scene, self, &t->f.arena) == DRAPE_OK &&
        gpu_broad_make(t->g, &t->ref, &t->dev) == DRAPE_OK;
    t->x0 = gpu_take(t->g, ARENA_OTHER, n, sizeof *t->x0);
    t->x1 = gpu_take(t->g, ARENA_OTHER, n, sizeof *t->x1);
    t->moved = gpu_take(t->g, ARENA_OTHER, n, 1);
    return good && t->x0 && t->x1 && t->moved;
}

static void unmake(struct both *t)
{
    gpu_close(t->g);
    fabric_free(&t->f);
    for (int k = 0; k < 2; k++)
        notes_free(&t->notes[k]);
}

static void limit(struct pool *p, int64_t cap)
{
    p->cap = p->cap < cap ? p->cap : cap;
}

/* Shrinks the front and its scratch to the front's size, and the results to 0,
 * so that every stream must grow. The front's scratch must not be smaller than
 * the front. */
static void shrink(struct broad *b)
{
    limit(&b->front, b->n_front > 0 ? b->n_front : 1);
    limit(&b->pair, b->front.cap);
    limit(&b->both, 0);
    limit(&b->kind, 0);
}

/* Records the digests of the next query only. */
static void trace(struct both *t)
{
    for (int k = 0; k < 2; k++) {
        t->notes[k].n = 0;
        t->trace[k] = (struct trace){notes_take, &t->notes[k], 0, 0};
    }
    t->ref.trace = &t->trace[0];
    t->dev.trace = &t->trace[1];
}

static bool same_bytes(struct gpu *g, const void *want, const void *device,
                       size_t bytes)
{
    void *got = malloc(bytes + 1);
    if (!got)
        return false;
    gpu_down(g, got, device, bytes);
    bool same = !bytes || !memcmp(want, got, bytes);
    free(got);
    return same;
}

static const char *compare(struct both *t)
{
    const struct broad *a = &t->ref, *b = &t->dev;
    size_t n = (size_t)a->n, front = (size_t)a->n_front;
    EXPECT(a->n == b->n && a->n_vf == b->n_vf);
    EXPECT(a->n_front == b->n_front && a->n_both == b->n_both);
    EXPECT(a->front_visited == b->front_visited && a->visited == b->visited);
    EXPECT(a->walked == b->walked && a->cleared == b->cleared);
    EXPECT(same_bytes(t->g, a->pair.data, b->pair.data, 16 * n));
    EXPECT(same_bytes(t->g, a->kind.data, b->kind.data, n));
    EXPECT(same_bytes(t->g, a->front.data, b->front.data, 8 * front));
    EXPECT(gpu_status(t->g) == DRAPE_OK);
    ran(1);
    return NULL;
}

/* Runs a query on both sides and measures the times. With `still`, x1 = x0. */
static const char *query(struct both *t, bool still, real r,
                         const uint8_t *moved)
{
    const struct fabric *f = &t->f;
    size_t bytes = (size_t)f->scene.vertices * sizeof(vec);
    const vec *x1 = still ? f->x0 : f->x1;
    gpu_up(t->g, t->x0, f->x0, bytes);
    gpu_up(t->g, t->x1, f->x1, bytes);
    if (moved)
        gpu_up(t->g, t->moved, moved, (size_t)f->scene.vertices);
    gpu_wait(t->g);
    double start = clock_now();
    int want = broad_query(&t->ref, f->x0, x1, r, moved);
    double between = clock_now();
    int got = broad_query(&t->dev, t->x0, still ? t->x0 : t->x1, r,
                          moved ? t->moved : NULL);
    gpu_wait(t->g);
    t->seconds[0] = between - start;
    t->seconds[1] = clock_now() - between;
    EXPECT(want == got);
    return want == DRAPE_OK ? compare(t) : NULL;
}

/* Moves vertices; x1 keeps its value where the flag is 0. */
static void move_some(struct fabric *f, vec common, real noise,
                      const uint8_t *moved)
{
    size_t bytes = (size_t)f->scene.vertices * sizeof(vec);
    vec *was =
        arena_take(&f->arena, ARENA_OTHER, f->scene.vertices, sizeof *was);
    memcpy(was, f->x1, bytes);
    fabric_move(f, common, noise);
    for (int32_t v = 0; v < f->scene.vertices; v++)
        f->x1[v] = moved[v] ? f->x1[v] : was[v];
}

/* After a query with a bad position, of which a device learns when it has
 * walked, the next query finds and counts the same on both sides: it begins at
 * the roots. */
static const char *recover(struct both *t)
{
    vec *x = &t->f.x1[t->f.scene.vertices / 2], was = *x;
    t->ref.trace = t->dev.trace = NULL;
    const char *failed = query(t, false, R(0.01), NULL);
    x->y = 2 * REAL_BIG;
    failed = failed ? failed : query(t, false, R(0.02), NULL);
    *x = was;
    return failed ? failed : query(t, false, R(0.01), NULL);
}

/* Runs motions one after another (a fall, noise, a jump, rest) with the front
 * kept between them. The last but one has bad positions. */
static const char *steps(struct both *t, int k)
{
    static const real noise[] = {0, R(0.004), R(0.05), 0, R(0.01), 0};
    int32_t n = t->f.scene.vertices;
    uint8_t *moved = arena_take(&t->f.arena, ARENA_OTHER, n, 1);
    const char *failed = NULL;
    for (int step = 0; step < 6 && !failed; step++) {
        bool later = step % 3 == 1;
        for (int32_t v = 0; v < n; v++)
            moved[v] = !later || fabric_random(&t->f) > R(0.8);
        moved[n / 2] = 1;
        move_some(&t->f, vec_make(0, R(-0.02) * (real)step, 0), noise[step],
                  moved);
        if (step == 4)
            t->f.x1[n / 2].y = 2 * REAL_BIG;
        if (k % 2 && step % 2 == 0) {
            shrink(&t->ref);
            shrink(&t->dev);
        }
        trace(t);
        failed = query(t, step % 3 == 2, step % 2 ? R(0.01) : 0,
                       later ? moved : NULL);
        if (!failed)
            failed = notes_compare(&t->notes[0], &t->notes[1]);
        /* A query with bad positions ends in refit. Features run only if there
         * are triangle pairs. */
        size_t least = step == 4 ? 1 : 3 - later + (t->ref.n_both > 0);
        EXPECT(failed || t->notes[0].n >= least);
    }
    if (!failed)
        failed = recover(t);
    if (!failed)
        failed = query(t, false, R(-1), NULL);
    return failed;
}

const char *test_broad_gpu(void)
{
    for (int k = 0; k < 10; k++) {
        int status;
        struct both t = {.g = gpu_open(NULL, &status)};
        if (!t.g)
            return skip("there is no device");
        fabric_scene(&t.f, k);
        const char *failed = make(&t, k % 6 != 5) ? NULL : "it was not made";
        t.ref.stop = t.dev.stop = k % 4 == 3 ? 0 : 2;
        if (!failed)
            failed = steps(&t, k);
        unmake(&t);
        if (failed)
            return failed;
    }
    return NULL;
}

/* Runs a query twice: the first run allocates, the second is timed. */
static const char *large_query(struct both *t, const char *name, bool still,
                               real r)
{
    const char *failed = query(t, still, r, NULL);
    failed = failed ? failed : query(t, still, r, NULL);
    printf("broad_gpu_large: %s, %s, %d bits: %lld triangles, front %lld, "
           "triangle pairs %lld, candidates %lld: %.4g ms, reference %.4g ms\n",
           name, still ? "proximity" : "penetration", REAL_BITS,
           (long long)t->ref.tree.n_tri, (long long)t->ref.n_front,
           (long long)t->ref.n_both, (long long)t->ref.n, 1e3 * t->seconds[1],
           1e3 * t->seconds[0]);
    fflush(stdout);
    return failed;
}

/* Decides the candidates of the last query by the narrow phase of both sides.
 * The device runs twice: the first run allocates, the second is timed. */
static const char *settle(struct both *t, const char *name)
{
    int64_t n = t->ref.n, touching = 0;
    size_t bytes = (size_t)n * sizeof(uint32_t);
    struct narrow a = {.n = n,
                       .pair = broad_pairs(&t->ref)[0],
                       .kind = broad_kinds(&t->ref),
                       .x0 = t->f.x0,
                       .x1 = t->f.x1,
                       .nv = t->f.scene.vertices,
                       .toi = malloc(bytes + 1),
                       .tier = malloc((size_t)n + 1)};
    struct narrow b = {.n = n,
                       .pair = t->dev.pair.data,
                       .kind = t->dev.kind.data,
                       .x0 = t->x0,
                       .x1 = t->x1,
                       .nv = a.nv,
                       .toi = gpu_take(t->g, ARENA_OTHER, n, sizeof *b.toi),
                       .tier = gpu_take(t->g, ARENA_OTHER, n, 1)};
    bool good = gpu_narrow(t->g, &b) == DRAPE_OK;
    gpu_wait(t->g);
    double start = clock_now();
    good = gpu_narrow(t->g, &b) == DRAPE_OK && good;
    gpu_wait(t->g);
    double seconds = clock_now() - start;
    good = ref_narrow(&a) == DRAPE_OK && good &&
           same_bytes(t->g, a.toi, b.toi, bytes) &&
           same_bytes(t->g, a.tier, b.tier, (size_t)n);
    for (int64_t k = 0; k < n; k++)
        touching += a.toi[k] != NARROW_MISS;
    printf("broad_gpu_large: %s, %d bits: %lld candidates decided, %lld touch: "
           "%.4g ms\n",
           name, REAL_BITS, (long long)n, (long long)touching, 1e3 * seconds);
    free(a.toi);
    free(a.tier);
    EXPECT(good);
    return NULL;
}

static const char *large(struct both *t, const char *name, real r)
{
    const char *failed = make(t, true) ? NULL : "it was not made";
    failed = failed ? failed : large_query(t, name, false, 0);
    failed = failed ? failed : settle(t, name);
    return failed ? failed : large_query(t, name, true, r);
}

/* A wavy cloth of n × n particles that falls on a sphere of 100,000 triangles.
 * `noise` is in cells. */
static const char *large_sheet(const char *name, int32_t n, real noise)
{
    int status;
    real cell = 1 / (real)(n - 1);
    struct both t = {.g = gpu_open(NULL, &status)};
    fabric_make(&t.f, n * n + 51000, 2 * n * n + 101000, 1);
    fabric_cloth(&t.f, n, n, FABRIC_WAVY, 0);
    fabric_sphere(&t.f, TREE_STATIC, 159, vec_make(R(0.5), R(-0.38), R(0.5)),
                  R(0.4));
    fabric_move(&t.f, vec_make(0, R(-0.01), 0), noise * cell);
    for (int32_t v = n * n; v < t.f.scene.vertices; v++)
        t.f.x1[v] = t.f.x0[v];
    const char *failed = large(&t, name, R(0.5) * cell);
    unmake(&t);
    return failed;
}

/* A public frame as one mesh against itself. */
static const char *large_frame(const char *name)
{
    int status;
    char path[512];
    struct ply p[2] = {{0}, {0}};
    bool good = true;
    struct both t = {.g = gpu_open(NULL, &status)};
    for (int k = 0; k < 2; k++) {
        snprintf(path, sizeof path, "%s/ccd/frames/%s/t%d.ply", data_home(),
                 name, k);
        good = ply_read(path, &p[k]) && good;
    }
    fabric_make(&t.f, p[0].nv + 1, p[0].nt + 1, 1);
    if (good) {
        struct tree_scene *s = &t.f.scene;
        t.f.mesh[0].kind = TREE_MOVING;
        t.f.mesh[0].self = true;
        t.f.mesh[0].tris = s->tris = p[0].nt;
        s->meshes = 1;
        s->vertices = p[0].nv;
        memcpy(t.f.tri, p[0].tri, (size_t)p[0].nt * sizeof *t.f.tri);
        memcpy(t.f.x0, p[0].x, (size_t)p[0].nv * sizeof *t.f.x0);
        memcpy(t.f.x1, p[1].x, (size_t)p[0].nv * sizeof *t.f.x1);
    }
    const char *failed = good ? large(&t, name, 0) : "a frame is not here";
    unmake(&t);
    ply_free(&p[0]);
    ply_free(&p[1]);
    return failed;
}

/* Where DRAPE_SOAK is set: scenes of up to two million triangles are equal on
 * both sides, and the times are printed. */
const char *test_broad_gpu_large(void)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    bool there = g != NULL;
    gpu_close(g);
    if (!there || !getenv("DRAPE_SOAK"))
        return skip(there ? "DRAPE_SOAK is not set" : "there is no device");
    const char *failed = large_frame("cloth-ball");
    failed = failed ? failed : large_sheet("1008, smooth", 1008, R(0.05));
    return failed ? failed : large_sheet("1008, rough", 1008, R(0.3));
}
