/* SPDX-License-Identifier: Apache-2.0 */
/* Whole rounds of collision response on small tangles. spec/37_response.md */
#include "ref/response.h"

#include "tests/choices.h"
#include "tests/harness.h"
#include "tests/tangle.h"

/* Triangles of half the cell's size, one a cell of a cubic grid. */
static void make_soup(struct tangle *t, struct bytes *b, int side)
{
    tangle_make(t, 3 * side * side * side, side * side * side);
    for (int64_t k = 0; k < t->nt; k++) {
        vec at = vec_make((real)(k % side), (real)(k / side % side),
                          (real)(k / side / side));
        vec v = vec_scale(30, vec_make(pick_uniform(b, -1, 1),
                                       pick_uniform(b, -1, 1),
                                       pick_uniform(b, -1, 1)));
        for (int j = 0; j < 3; j++) {
            int64_t i = 3 * k + j;
            t->tri[k][j] = (int32_t)i;
            t->w[i] = pick_uniform(b, R(0.5), 2);
            t->x0[i] = vec_add(at, vec_make(pick_uniform(b, 0, R(0.9)),
                                            pick_uniform(b, 0, R(0.9)),
                                            pick_uniform(b, 0, R(0.9))));
            t->v[i] = vec_add(v, vec_make(pick_uniform(b, -9, 9),
                                          pick_uniform(b, -9, 9),
                                          pick_uniform(b, -9, 9)));
        }
    }
    tangle_edges(t);
}

static const char *run_soup(uint64_t seed, int max_rounds, int zone_rounds)
{
    struct bytes b = {.seed = seed, .size = -1};
    struct tangle t;
    make_soup(&t, &b, 4);
    t.r.max_rounds = max_rounds;
    t.r.zone_rounds = zone_rounds;
    for (int step = 0; step < 5; step++) {
        EXPECT(tangle_step(&t, vec_make(0, 0, 0)) == DRAPE_OK);
        EXPECT(!(t.r.outcome & DRAPE_TRAPPED));
        EXPECT(tangle_touching(&t) == 0);
        tangle_next(&t);
        ran(1);
    }
    tangle_free(&t);
    choices_free(&b);
    return NULL;
}

const char *test_tangle_soup(void)
{
    static const int rounds[][2] = {{16, 8}, {0, 8}, {0, 0}, {2, 2}};
    for (uint64_t k = 0; k < 4; k++) {
        const char *failed = run_soup(k + 1, rounds[k][0], rounds[k][1]);
        if (failed)
            return failed;
    }
    return NULL;
}
