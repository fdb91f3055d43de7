/* SPDX-License-Identifier: Apache-2.0 */
/* A small scene with a brute-force broad phase, for collision response. */
#include "tests/contact/tangle.h"

#include <stdlib.h>

#include "ref/narrow/narrow.h"

static void *must(void *p)
{
    if (!p)
        abort();
    return p;
}

static void *zeros(int64_t n, size_t size)
{
    return must(calloc((size_t)n + 1, size));
}

void tangle_make(struct tangle *t, int64_t nv, int64_t nt)
{
    memset(t, 0, sizeof *t);
    arena_init(&t->arena, &(drape_allocator){0});
    t->nv = nv;
    t->nt = nt;
    t->tri = zeros(nt, sizeof *t->tri);
    t->edge = zeros(3 * nt, sizeof *t->edge);
    t->w = zeros(nv, sizeof *t->w);
    t->x0 = zeros(nv, sizeof *t->x0);
    t->x1 = zeros(nv, sizeof *t->x1);
    t->v = zeros(nv, sizeof *t->v);
    t->of = zeros(nv, sizeof *t->of);
    t->surface = (struct surface){R(0.01), R(0.3)};
    t->r = (struct response){.run = &backend_ref,
                             .on = backend_of(&t->arena),
                             .nv = nv,
                             .w = t->w,
                             .surfaces = {1, t->of, &t->surface},
                             .x0 = t->x0,
                             .x1 = t->x1,
                             .v = t->v,
                             .dt = R(0.01),
                             .stiffness = 1000,
                             .range = 1,
                             .margin = R(0.25),
                             .iterations = 16,
                             .max_rounds = 16,
                             .zone_rounds = 8,
                             .roll_rounds = 64,
                             .broad = tangle_broad,
                             .user = t,
                             .u = zeros(nv, sizeof(vec)),
                             .touched = zeros(nv, 1),
                             .rolled = zeros(nv, 1),
                             .start = zeros(nv + 1, sizeof(int32_t)),
                             .first = zeros(nv, sizeof(uint64_t))};
}

static bool has_edge(const struct tangle *t, int32_t a, int32_t b)
{
    for (int64_t k = 0; k < t->ne; k++)
        if ((t->edge[k][0] == a && t->edge[k][1] == b) ||
            (t->edge[k][0] == b && t->edge[k][1] == a))
            return true;
    return false;
}

void tangle_edges(struct tangle *t)
{
    t->ne = 0;
    for (int64_t k = 0; k < 3 * t->nt; k++) {
        int32_t a = t->tri[k / 3][k % 3], b = t->tri[k / 3][(k + 1) % 3];
        if (has_edge(t, a, b))
            continue;
        t->edge[t->ne][0] = a;
        t->edge[t->ne++][1] = b;
    }
}

void tangle_free(struct tangle *t)
{
    struct response *r = &t->r;
    arena_free(&t->arena);
    void *memory[] = {t->tri,     t->edge,   t->w,     t->x0,   t->x1,
                      t->v,       t->of,     t->pair,  t->kind, r->u,
                      r->touched, r->rolled, r->start, r->first};
    for (size_t k = 0; k < sizeof memory / sizeof *memory; k++)
        free(memory[k]);
}

/* Appends pair v if its vertices are distinct and not all prescribed, one of
 * them is touched, and the swept boxes overlap. */
static void consider(struct tangle *t, const int32_t v[4], uint8_t kind,
                     const uint8_t *touched)
{
    int split = kind == CONTACT_VF ? 1 : 2;
    bool any_free = false, any_touched = !touched;
    vec lo[2], hi[2];
    for (int k = 0; k < 4; k++) {
        for (int j = 0; j < k; j++)
            if (v[j] == v[k])
                return;
        any_free |= t->w[v[k]] > 0;
        any_touched |= touched && touched[v[k]];
        vec a = vec_min(t->x0[v[k]], t->x1[v[k]]);
        vec b = vec_max(t->x0[v[k]], t->x1[v[k]]);
        int side = k >= split;
        bool first = k == 0 || k == split;
        lo[side] = first ? a : vec_min(lo[side], a);
        hi[side] = first ? b : vec_max(hi[side], b);
    }
    vec r = vec_make(t->reach, t->reach, t->reach);
    vec gap = vec_max(vec_sub(lo[0], hi[1]), vec_sub(lo[1], hi[0]));
    gap = vec_sub(gap, r);
    if (!any_free || !any_touched || gap.x > 0 || gap.y > 0 || gap.z > 0)
        return;
    if (t->n == t->cap) {
        t->cap = 2 * t->cap + 1024;
        t->pair = must(realloc(t->pair, (size_t)t->cap * 4 * sizeof(int32_t)));
        t->kind = must(realloc(t->kind, (size_t)t->cap));
    }
    memcpy(t->pair + 4 * t->n, v, 4 * sizeof *v);
    t->kind[t->n++] = kind;
}

int tangle_broad(void *user, const uint8_t *touched, struct pairs *out)
{
    struct tangle *t = user;
    t->n = 0;
    for (int32_t i = 0; i < t->nv; i++)
        for (int64_t k = 0; k < t->nt; k++)
            consider(t,
                     (int32_t[4]){i, t->tri[k][0], t->tri[k][1], t->tri[k][2]},
                     CONTACT_VF, touched);
    for (int64_t i = 0; i < t->ne; i++)
        for (int64_t k = i + 1; k < t->ne; k++)
            consider(t,
                     (int32_t[4]){t->edge[i][0], t->edge[i][1], t->edge[k][0],
                                  t->edge[k][1]},
                     CONTACT_EE, touched);
    *out = (struct pairs){t->n, t->pair, t->kind};
    return DRAPE_OK;
}

void tangle_start(struct tangle *t, vec a)
{
    for (int64_t i = 0; i < t->nv; i++) {
        if (t->w[i] > 0)
            t->v[i] = vec_axpy(t->v[i], t->r.dt, a);
        t->x1[i] = vec_axpy(t->x0[i], t->r.dt, t->v[i]);
    }
}

int tangle_respond(struct response *r, const struct pairs *close)
{
    if (!r->solves)
        return response_repel(r, close);
    int status = response_find_close(r, close);
    if (status == DRAPE_OK)
        status = response_detect(r, 0);
    return status == DRAPE_OK && r->hits > 0 ? response_join(r) : status;
}

int tangle_step(struct tangle *t, vec a)
{
    struct pairs near;
    tangle_start(t, a);
    int status = response_start(&t->r);
    t->reach = t->surface.thickness;
    if (status == DRAPE_OK)
        status = tangle_broad(t, NULL, &near);
    if (status == DRAPE_OK)
        status = tangle_respond(&t->r, &near);
    t->reach = 0;
    if (status == DRAPE_OK)
        status = response_penetrate(&t->r);
    return status;
}

int64_t tangle_touching(struct tangle *t)
{
    struct pairs p;
    int64_t touching = 0;
    t->reach = 0;
    tangle_broad(t, NULL, &p);
    for (int64_t k = 0; k < p.n; k++) {
        vec x0[4], x1[4];
        int tier;
        for (int j = 0; j < 4; j++) {
            x0[j] = t->x0[p.pair[4 * k + j]];
            x1[j] = t->x1[p.pair[4 * k + j]];
        }
        uint32_t toi = p.kind[k] == CONTACT_VF ? narrow_vf(x0, x1, &tier)
                                               : narrow_ee(x0, x1, &tier);
        touching += toi != NARROW_MISS;
    }
    return touching;
}

void tangle_next(struct tangle *t)
{
    memcpy(t->x0, t->x1, (size_t)t->nv * sizeof *t->x0);
}
