/* SPDX-License-Identifier: Apache-2.0 */
/* A small scene and counting allocators; see tests/api/guest.h. */
#include "tests/api/guest.h"

#include <stdlib.h>

#include "gpu/run/gpu.h"

static void *pay(void *user, size_t bytes)
{
    struct counting_allocator *p = user;
    if (p->calls++ >= p->most)
        return NULL;
    void *q = p->from ? p->from->allocate(p->from->user, bytes)
                      : aligned_alloc(64, (bytes + 63) / 64 * 64);
    p->held += q ? bytes : 0;
    return q;
}

static void give(void *user, void *q, size_t bytes)
{
    struct counting_allocator *p = user;
    p->held -= bytes;
    if (p->from)
        p->from->release(p->from->user, q, bytes);
    else
        free(q);
}

static const double plate_x[4][3] = {
    {-.05, 0, -.06}, {.05, 0, -.06}, {-.05, 0, .06}, {.05, 0, .06}};
static const int32_t plate_tri[2][3] = {{0, 2, 1}, {1, 2, 3}};

void guest_make(struct guest *s, int backend)
{
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    drape_default_cloth(&s->cloth);
    drape_default_obstacle(&s->plate);
    s->cloth.m = 7;
    s->cloth.n = 6;
    s->cloth.width = s->cloth.height = 0.2;
    s->cloth.origin[0] = s->cloth.origin[2] = -0.1;
    s->cloth.origin[1] = 0.003;
    s->cloth.material.damping = 0.01;
    s->plate.n_vertices = 4;
    s->plate.n_triangles = 2;
    s->plate.x = plate_x;
    s->plate.tri = plate_tri;
    s->def.backend = backend;
    s->def.precision = REAL_BITS;
    s->def.sleep = 0;
    s->def.cloths = &s->cloth;
    s->def.n_cloths = 1;
    s->def.obstacles = &s->plate;
    s->def.n_obstacles = 1;
    s->device.from = gpu_native();
    s->host.most = s->device.most = INT64_MAX;
    s->def.allocator = (drape_allocator){pay, give, &s->host};
    s->def.device_allocator = (drape_allocator){pay, give, &s->device};
}

int guest_go(drape_world *world, int steps)
{
    int status = DRAPE_OK;
    for (int k = 0; k < steps && status == DRAPE_OK; k++)
        status = drape_step(world, NULL);
    return status;
}
