/* SPDX-License-Identifier: Apache-2.0 */
/* Later rounds of contact refit only the boxes of touched vertices; the result
 * equals a refit of all boxes. spec/broad/refit.md §4,
 * spec/contact/response.md §3 */
#include <stdlib.h>

#include "ref/broad/refit.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/solve/system.h"
#include "tests/world/slab.h"

enum { SIDE = 16 };

struct witness {
    struct world *w;
    int later; /* queries that refitted some boxes and kept others */
    const char *failed;
};

static const char *compare(const struct broad *b)
{
    struct refit s = {
        .tree = b->tree, .nv = b->nv, .x0 = b->x0, .x1 = b->x1, .all = 1};
    size_t n = (size_t)b->tree.n;
    s.box = calloc(n, sizeof *s.box);
    s.stir = calloc(n, 1);
    bool same = s.box && s.stir && ref_refit(&s) == DRAPE_OK &&
                !memcmp(s.box, b->box, n * sizeof *s.box);
    free(s.box);
    free(s.stir);
    EXPECT(same);
    return NULL;
}

/* A drape_trace that compares the boxes of each query. */
static void listen(void *user, int64_t step, const char *stage, uint64_t digest,
                   double seconds)
{
    struct witness *a = user;
    const struct broad *b = &a->w->broad;
    (void)step;
    (void)digest;
    (void)seconds;
    if (a->failed || strcmp(stage, "refit") != 0)
        return;
    a->failed = compare(b);
    for (int64_t k = 0; k < b->tree.n_cloth && b->later; k++)
        if (!b->stir[k]) {
            a->later++;
            break;
        }
}

/* Steps a soft, disordered sheet over a slab. mode: contacts are resolved by
 * impulses, by zones, or by rollback. */
static const char *run(int integrator, int mode)
{
    static double v[SIDE * SIDE][3];
    struct slab d;
    struct arena arena;
    struct witness a = {0};
    drape_error error;
    for (uint64_t k = 0; k < sizeof v / sizeof v[0][0]; k++)
        v[k / 3][k % 3] = (mode ? 2 : 5) * noise_of(k);
    slab_make(&d, integrator);
    d.cloth.m = d.cloth.n = SIDE;
    d.cloth.width = d.cloth.height = 0.2;
    d.cloth.origin[0] = d.cloth.origin[2] = -0.1;
    d.cloth.origin[1] = 0.103;
    d.cloth.velocity = (const double(*)[3])v;
    d.def.max_rounds = mode ? 0 : d.def.max_rounds;
    d.cloth.material.stretch = 0.1;
    d.cloth.material.shear = 0.02;
    d.cloth.material.bend = 0;
    d.cloth.bending = DRAPE_SPRINGS;
    d.def.max_slices = 1;
    d.def.response = DRAPE_IMPULSES; /* so that rounds are left */
    d.def.trace = listen;
    d.def.trace_user = &a;
    arena_init(&arena, &d.def.allocator);
    EXPECT(world_make(&d.def, &arena, &a.w, &error) == DRAPE_OK);
    a.w->response.zone_rounds = mode < 2 ? a.w->response.zone_rounds : 0;
    for (int k = 0; k < 12 && !a.failed; k++) {
        drape_step_report r;
        EXPECT(step_advance(a.w, &r) == DRAPE_OK);
    }
    arena_free(&arena);
    EXPECT(a.failed || a.later > 0); /* some query kept boxes */
    ran(a.later);
    return a.failed;
}

const char *test_world_touched(void)
{
    const char *failed = NULL;
    for (int mode = 0; mode < 3 && !failed; mode++) {
        failed = run(DRAPE_BW, mode);
        failed = failed ? failed : run(DRAPE_CK, mode);
        failed = failed ? failed : run(DRAPE_VERLET, mode);
    }
    return failed;
}
