/* SPDX-License-Identifier: Apache-2.0 */
/* A start that intersects is refused, unless the definition allows it.
 * spec/world/step.md §11 */
#include <stdio.h>

#include "tests/solve/system.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum crossing { ITSELF, ANOTHER, SLAB, CROSSINGS };

/* Makes a start that intersects: a sheet through itself; a flat sheet through a
 * crumpled one, in more pairs than the audit's first capacity; or a sheet
 * through the slab. */
static void make_crossing(struct slab *d, enum crossing how)
{
    enum { M = 30 };
    static double x[M * M][3];
    static drape_cloth cloth[2];
    slab_make(d, DRAPE_BW);
    d->cloth.m = d->cloth.n = M;
    for (int k = 0; k < M * M; k++) {
        double i = k % M, away = i > M / 2 ? i - M / 2 : 0;
        x[k][0] = how == ITSELF ? 0.01 * (i - 2 * away) : 0.01 * i;
        x[k][1] = how == ITSELF ? 0.3 + (i < M / 2 ? 0.01 * (i - M / 4) : 0)
                                : 0.3 + 0.004 * noise_of((uint64_t)k);
        x[k][2] = 0.01 * (k / M);
    }
    cloth[0] = cloth[1] = d->cloth;
    cloth[0].x = (const double(*)[3])x;
    cloth[1].origin[0] = cloth[1].origin[2] = 0;
    cloth[1].width = cloth[1].height = 0.01 * (M - 1);
    cloth[1].origin[1] = how == ANOTHER ? 0.3 : 0.7;
    if (how == SLAB) {
        cloth[0] = cloth[1];
        cloth[0].origin[1] = 0.05;
    }
    d->def.cloths = cloth;
    d->def.n_cloths = 2;
}

/* A start that intersects is refused, unless allow_intersecting is set, or only
 * cloths cross and self_collision is off. */
static const char *check_start(enum crossing how)
{
    struct slab d;
    drape_world *world;
    drape_error error;
    long long told = -1;
    make_crossing(&d, how);
    d.def.allow_intersecting = 1;
    EXPECT(drape_create(&d.def, &world, &error) == DRAPE_OK);
    int64_t found = scene_audit(world, 2);
    drape_destroy(world);
    EXPECT(found > (how == ANOTHER ? 1024 : 0));
    d.def.allow_intersecting = 0;
    EXPECT(drape_create(&d.def, &world, &error) == DRAPE_ESTART && !world);
    const char *more = strstr(error.text, "(first of ");
    EXPECT((more ? sscanf(more, "(first of %lld pairs)", &told) : found == 1) ==
           1);
    EXPECT(!more || told == found);
    d.def.self_collision = 0;
    int status = drape_create(&d.def, &world, &error);
    EXPECT(status == (how == SLAB ? DRAPE_ESTART : DRAPE_OK));
    drape_destroy(world);
    ran(1);
    return NULL;
}

const char *test_world_start(void)
{
    const char *failed = NULL;
    for (int how = 0; how < CROSSINGS && !failed; how++)
        failed = check_start((enum crossing)how);
    return failed;
}
