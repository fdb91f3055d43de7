/* SPDX-License-Identifier: Apache-2.0 */
/* drape_ccd_frames: finds the pairs of a mesh that touch between two frames, in
 * binary64, by the broad phase (spec/broad/broad.md) and the narrow phase
 * (spec/narrow/narrow.md). */
#include "ref/api/query.h"

#include "ref/base/arena.h"
#include "ref/base/threads.h"
#include "ref/broad/broad.h"
#include "ref/narrow/narrow.h"

/* FRAMES_RUN: candidates tested at once, which bounds the memory beside them.
 * FRAMES_MOST: bound of nt, so that 3 · nt cannot overflow. */
enum { FRAMES_RUN = 1 << 20, FRAMES_MOST = INT32_MAX / 4 };

struct frames {
    const drape_mesh *mesh;
    const vec *x1;
    struct arena arena;
    struct broad broad;
    uint32_t *toi;
    uint8_t *tier;
};

static int check_positions(const double (*x)[3], int64_t nv)
{
    for (int64_t k = 0; k < nv; k++)
        for (int i = 0; i < 3; i++)
            if (!(x[k][i] <= 0x1p60 && x[k][i] >= -0x1p60))
                return DRAPE_EDATA;
    return DRAPE_OK;
}

static int check_mesh(const drape_mesh *mesh, const double (*x1)[3])
{
    if (query_check(mesh, FRAMES_MOST) != DRAPE_OK || mesh->group ||
        (mesh->nv > 0 && !x1))
        return DRAPE_EARG;
    for (int64_t t = 0; t < mesh->nt; t++)
        for (int i = 0; i < 3; i++)
            if (mesh->tri[t][i] < 0 || mesh->tri[t][i] >= mesh->nv)
                return DRAPE_EARG;
    int status = check_positions(mesh->x, mesh->nv);
    return status == DRAPE_OK ? check_positions(x1, mesh->nv) : status;
}

/* Finds all candidates of the mesh with itself between x0 and x1. */
static int find_candidates(struct frames *f)
{
    const drape_mesh *m = f->mesh;
    const vec *x0 = (const vec *)(const void *)m->x;
    struct tree_mesh whole = {
        .kind = TREE_MOVING, .tris = (int32_t)m->nt, .self = true};
    struct tree_scene scene = {.meshes = 1,
                               .vertices = (int32_t)m->nv,
                               .tris = (int32_t)m->nt,
                               .mesh = &whole,
                               .tri = m->tri,
                               .x = x0};
    int status = broad_make(&f->broad, &scene, true, &f->arena);
    return status == DRAPE_OK ? broad_query(&f->broad, x0, f->x1, 0, NULL)
                              : status;
}

/* Tests n candidates, from `first` on, and reports the touching pairs. */
static int decide_candidates(struct frames *f, int64_t first, int64_t n,
                             drape_touch *touch, void *user)
{
    const int32_t(*pair)[4] = broad_pairs(&f->broad) + first;
    const uint8_t *kind = broad_kinds(&f->broad) + first;
    struct narrow s = {.n = n,
                       .pair = &pair[0][0],
                       .kind = kind,
                       .x0 = (const vec *)(const void *)f->mesh->x,
                       .x1 = f->x1,
                       .nv = f->mesh->nv,
                       .toi = f->toi,
                       .tier = f->tier};
    int status = ref_narrow(&s);
    for (int64_t k = 0; k < n && status == DRAPE_OK; k++)
        if (f->toi[k] != NARROW_MISS &&
            touch(user, kind[k], pair[k], (double)f->toi[k] / NARROW_ONE) != 0)
            status = DRAPE_EIO;
    return status;
}

static int query_pairs(struct frames *f, drape_touch *touch, void *user)
{
    int status = find_candidates(f);
    if (status != DRAPE_OK)
        return status;
    f->toi = arena_take(&f->arena, ARENA_OTHER, FRAMES_RUN, sizeof *f->toi);
    f->tier = arena_take(&f->arena, ARENA_OTHER, FRAMES_RUN, 1);
    if (f->arena.failed)
        return DRAPE_ENOMEM;
    int64_t all = f->broad.n;
    for (int64_t k = 0; k < all && status == DRAPE_OK; k += FRAMES_RUN) {
        int64_t n = all - k < FRAMES_RUN ? all - k : FRAMES_RUN;
        status = decide_candidates(f, k, n, touch, user);
    }
    return status;
}

int drape_ccd_frames(const drape_mesh *mesh, const double (*x1)[3],
                     drape_touch *touch, void *user, int64_t candidates[2])
{
    struct frames f = {.mesh = mesh, .x1 = (const vec *)(const void *)x1};
    int status = touch ? check_mesh(mesh, x1) : DRAPE_EARG;
    if (status == DRAPE_OK && mesh->nt > 0) {
        arena_init(&f.arena, &mesh->allocator);
        struct threads threads;
        threads_begin(&threads, mesh->threads);
        status = query_pairs(&f, touch, user);
        threads_end(&threads);
        arena_free(&f.arena);
    }
    if (status == DRAPE_OK && candidates) {
        candidates[0] = f.broad.n_vf;
        candidates[1] = f.broad.n - f.broad.n_vf;
    }
    return status;
}
