/* SPDX-License-Identifier: Apache-2.0 */
/* A step whose solve with contacts was ended early says so.
 * spec/contact/lagrange.md §3.4 */
#include "tests/twins/ensemble.h"

/* What is left undone is reported as such: more than the tolerance is
 * UNCONVERGED, also where only the loop of contacts has left it. */
static const char *check(int how, int undone[2])
{
    static struct ensemble e;
    drape_step_report r;
    ensemble_make(&e, how);
    e.d.def.max_iterations = 2;
    drape_world *world = slab_world(&e.d);
    EXPECT(world);
    for (int k = 0; k < 16; k++) {
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        bool much = r.residual > (double)(real)e.d.def.tolerance;
        EXPECT(!much || r.outcome & DRAPE_UNCONVERGED);
        undone[much] += r.contacts > 0;
        ran(1);
    }
    drape_destroy(world);
    return NULL;
}

const char *test_undone_told(void)
{
    const char *failed = NULL;
    for (int how = 0; how < ENSEMBLE_HOWS - 1 && !failed; how++) {
        int undone[2] = {0};
        failed = check(how, undone);
        EXPECT(failed || undone[1] > 0);
    }
    return failed;
}
