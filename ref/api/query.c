/* SPDX-License-Identifier: Apache-2.0 */
/* API calls that need no world, in binary64: audit and CCD of one pair. */
#include "ref/api/query.h"

#include "ref/api/define.h"
#include "ref/base/arena.h"
#include "ref/base/threads.h"
#include "ref/narrow/audit.h"
#include "ref/narrow/narrow.h"

static int take_scratch(struct audit *s, struct arena *a)
{
    s->n_nodes = ref_audit_nodes(s->nt);
    for (int k = 0; k < 2; k++) {
        s->key[k] = arena_take(a, ARENA_OTHER, s->nt, sizeof **s->key);
        s->order[k] = arena_take(a, ARENA_OTHER, s->nt, sizeof **s->order);
    }
    s->node = arena_take(a, ARENA_OTHER, s->n_nodes, sizeof *s->node);
    s->count = arena_take(a, ARENA_OTHER, s->n_nodes, sizeof *s->count);
    s->degenerate = arena_take(a, ARENA_OTHER, s->nt, 1);
    s->pair = arena_take(a, ARENA_OTHER, s->cap, sizeof *s->pair);
    return a->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

/* Runs the audit, and again with enough room if its pairs did not fit. */
static int run_audit(struct audit *s, struct arena *a)
{
    int status = ref_audit(s);
    if (status != DRAPE_EFULL)
        return status;
    s->cap = s->found;
    s->pair = arena_take(a, ARENA_OTHER, s->cap, sizeof *s->pair);
    return a->failed ? DRAPE_ENOMEM : ref_audit(s);
}

int query_check(const drape_mesh *mesh, int64_t most)
{
    if (!mesh || mesh->nv < 0 || mesh->nv > most || mesh->nt < 0 ||
        mesh->nt > most || (mesh->nv > 0 && !mesh->x) ||
        (mesh->nt > 0 && !mesh->tri) || mesh->threads < 0 ||
        mesh->threads > 4096 || !define_check_allocator(&mesh->allocator))
        return DRAPE_EARG;
    return DRAPE_OK;
}

int drape_audit(const drape_mesh *mesh, int64_t capacity, int32_t (*pair)[2],
                int64_t *found, int64_t *degenerate)
{
    int status = query_check(mesh, INT32_MAX);
    if (status != DRAPE_OK || !found || capacity < 0 || (capacity > 0 && !pair))
        return DRAPE_EARG;
    struct arena arena;
    struct audit s = {.nv = mesh->nv,
                      .nt = mesh->nt,
                      .tri = mesh->tri,
                      .group = mesh->group,
                      .cap = 1024};
    arena_init(&arena, &mesh->allocator);
    s.x = (const vec *)(const void *)mesh->x;
    struct threads threads;
    threads_begin(&threads, mesh->threads);
    status = take_scratch(&s, &arena);
    if (status == DRAPE_OK)
        status = run_audit(&s, &arena);
    threads_end(&threads);
    if (status == DRAPE_OK) {
        *found = s.found;
        if (degenerate)
            *degenerate = s.n_degenerate;
        for (int64_t k = 0; k < s.found && k < capacity; k++) {
            pair[k][0] = s.pair[k][0];
            pair[k][1] = s.pair[k][1];
        }
    }
    arena_free(&arena);
    return status;
}

int drape_ccd(int kind, const double x0[4][3], const double x1[4][3],
              double *toi)
{
    vec a[4], b[4];
    int tier;
    if ((kind != 0 && kind != 1) || !x0 || !x1 || !toi)
        return DRAPE_EARG;
    for (int k = 0; k < 4; k++) {
        a[k] = vec_make(x0[k][0], x0[k][1], x0[k][2]);
        b[k] = vec_make(x1[k][0], x1[k][1], x1[k][2]);
        for (int i = 0; i < 3; i++)
            if (!isfinite(x0[k][i]) || !isfinite(x1[k][i]))
                return DRAPE_EDATA;
    }
    uint32_t t = kind ? narrow_ee(a, b, &tier) : narrow_vf(a, b, &tier);
    if (t == NARROW_MISS)
        return 0;
    *toi = (double)t / NARROW_ONE;
    return 1;
}
