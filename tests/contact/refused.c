/* SPDX-License-Identifier: Apache-2.0 */
/* Stage penalty on the device with contacts of vertices that do not exist: it
 * is refused as on the reference. spec/contact/penalty.md */
#include <string.h>

#include "gpu/run/gpu.h"
#include "ref/contact/penalty.h"
#include "tests/base/harness.h"

enum { NV = 4, FAR = 1 << 29 };

/* Returns a copy on the device of n items. */
static void *copy_of(struct gpu *g, const void *from, int64_t n, size_t size)
{
    void *p = gpu_take(g, ARENA_OTHER, n, size);
    if (p && from)
        gpu_up(g, p, from, (size_t)n * size);
    return p;
}

/* One contact, of four vertices that do not exist. The lists of the vertices
 * name one that is far outside all streams: nothing may follow them. */
static void make(struct gpu *g, struct penalty *p)
{
    static const struct contact c = {.v = {NV, NV + 1, -1, FAR},
                                     .c = {1, R(-0.25), R(-0.25), R(-0.5)},
                                     .n = {0, 1, 0}};
    static const real w[NV] = {1, 1, 1, 1};
    static const vec u[NV];
    int32_t vertex[NV];
    for (int k = 0; k < NV; k++)
        vertex[k] = FAR;
    *p = (struct penalty){.nv = NV, .n = 1, .nv1 = NV + 1, .n4 = 4};
    p->stiffness = 1;
    p->dt = p->tau = R(0.01);
    p->slip = R(1e-3);
    p->first = 1;
    p->w = copy_of(g, w, NV, sizeof *w);
    p->u = copy_of(g, u, NV, sizeof *u);
    p->g = copy_of(g, u, NV, sizeof *u);
    p->contact = copy_of(g, &c, 1, sizeof c);
    p->vertex = copy_of(g, vertex, NV, sizeof *vertex);
    p->start = copy_of(g, NULL, NV + 1, sizeof *p->start);
    p->item = copy_of(g, NULL, 4, sizeof *p->item);
    p->share = copy_of(g, NULL, 1, sizeof *p->share);
    p->gave = copy_of(g, NULL, 1, sizeof *p->gave);
    p->rub = copy_of(g, NULL, 4, sizeof *p->rub);
    p->guess = copy_of(g, NULL, NV, sizeof *p->guess);
    p->parts = copy_of(g, NULL, NV, sizeof *p->parts);
    p->force = copy_of(g, NULL, NV, sizeof *p->force);
    p->hold = copy_of(g, NULL, NV, sizeof *p->hold);
    p->wall = copy_of(g, NULL, NV, sizeof *p->wall);
}

const char *test_penalty_refused(void)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    struct penalty p;
    if (!g)
        return skip("there is no device");
    make(g, &p);
    status = gpu_status(g);
    int refused = status == DRAPE_OK ? gpu_penalty(g, &p) : status;
    int after = gpu_status(g);
    gpu_close(g);
    EXPECT(status == DRAPE_OK);
    EXPECT(refused == DRAPE_EARG);
    EXPECT(after == DRAPE_OK);
    ran(1);
    return NULL;
}
