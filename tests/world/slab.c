/* SPDX-License-Identifier: Apache-2.0 */
/* A sheet above a slab, the small scene of many tests. */
#include "tests/world/slab.h"

#include <stdio.h>

#include "ref/world/state.h"

static const double slab_x[8][3] = {
    {-.1, .0, -.1}, {.1, .0, -.1}, {-.1, .0, .1}, {.1, .0, .1},
    {-.1, .1, -.1}, {.1, .1, -.1}, {-.1, .1, .1}, {.1, .1, .1}};
static const int32_t slab_tri[12][3] = {
    {0, 1, 2}, {1, 3, 2}, {4, 6, 5}, {5, 6, 7}, {0, 4, 1}, {1, 4, 5},
    {2, 3, 6}, {3, 7, 6}, {0, 2, 4}, {2, 6, 4}, {1, 5, 3}, {3, 5, 7}};
static const double times[2] = {0, 1};
static const double way[2][3] = {{0, 0, 0}, {0.2, 0, 0}};

void slab_make(struct slab *d, int integrator)
{
    drape_default(&d->def);
    drape_default_cloth(&d->cloth);
    drape_default_obstacle(&d->obstacle);
    d->motion = (drape_motion){.keys = 2, .time = times, .position = way};
    d->cloth.m = d->cloth.n = 24;
    d->cloth.width = d->cloth.height = 0.46;
    d->cloth.origin[0] = d->cloth.origin[2] = -0.23;
    d->cloth.origin[1] = 0.12;
    d->cloth.material.thickness = 0.004;
    d->obstacle.n_vertices = 8;
    d->obstacle.n_triangles = 12;
    d->obstacle.x = slab_x;
    d->obstacle.tri = slab_tri;
    d->obstacle.motion = 0;
    d->def.precision = REAL_BITS;
    d->def.integrator = integrator;
    d->def.cloths = &d->cloth;
    d->def.n_cloths = 1;
    d->def.obstacles = &d->obstacle;
    d->def.n_obstacles = 1;
    d->def.motions = &d->motion;
    d->def.n_motions = 1;
}

drape_world *slab_world(const struct slab *d)
{
    drape_error error;
    drape_world *world;
    if (drape_create(&d->def, &world, &error) != DRAPE_OK)
        printf("%s\n", error.text);
    return world;
}

void slab_small(struct slab *d, int integrator, double y)
{
    slab_make(d, integrator);
    d->cloth.m = d->cloth.n = SLAB_SMALL;
    d->cloth.width = d->cloth.height = (SLAB_SMALL - 1) / 64.0;
    d->cloth.origin[0] = d->cloth.origin[2] = -0.0625;
    d->cloth.origin[1] = y;
    d->def.dt = integrator < DRAPE_BW ? 0x1p-10 : 0x1p-6;
}

struct world *slab_inner(const drape_def *def, struct arena *arena)
{
    struct world *w;
    drape_error error;
    arena_init(arena, &def->allocator);
    return world_make(def, arena, &w, &error) == DRAPE_OK ? w : NULL;
}
