/* SPDX-License-Identifier: Apache-2.0 */
/* Stages of contacts on the device with vertices that do not exist: they are
 * refused as on the reference. spec/contact/coulomb.md, spec/contact/carry.md
 */
#include <string.h>

#include "gpu/run/gpu.h"
#include "ref/contact/carry.h"
#include "ref/contact/coulomb.h"
#include "tests/base/harness.h"

enum { NV = 4, FAR = 1 << 29 };

/* Four vertices that do not exist. */
static const struct contact bad = {.v = {NV, NV + 1, -1, FAR},
                                   .c = {1, R(-0.25), R(-0.25), R(-0.5)},
                                   .n = {0, 1, 0},
                                   .kappa = 1,
                                   .friction = 1};

/* Returns a copy on the device of n items. */
static void *copy_of(struct gpu *g, const void *from, int64_t n, size_t size)
{
    void *p = gpu_take(g, ARENA_OTHER, n, size);
    if (p && from)
        gpu_up(g, p, from, (size_t)n * size);
    return p;
}

/* The lists of the vertices name one that is far outside all streams: nothing
 * may follow them. */
static void make_law(struct gpu *g, struct coulomb *s)
{
    static const real w[NV] = {1, 1, 1, 1};
    static const vec u[NV];
    int32_t vertex[NV];
    for (int k = 0; k < NV; k++)
        vertex[k] = FAR;
    *s = (struct coulomb){.nv = NV, .nc = NV, .n = 1, .nv1 = NV + 1, .n4 = 4};
    s->stiffest = 1;
    s->dt = s->tau = R(0.01);
    s->lists = 1;
    s->w = copy_of(g, w, NV, sizeof *w);
    s->u = copy_of(g, u, NV, sizeof *u);
    s->rest = copy_of(g, u, NV, sizeof *u);
    s->contact = copy_of(g, &bad, 1, sizeof bad);
    s->vertex = copy_of(g, vertex, NV, sizeof *vertex);
    s->start = copy_of(g, NULL, NV + 1, sizeof *s->start);
    s->item = copy_of(g, NULL, 4, sizeof *s->item);
    s->next = copy_of(g, NULL, 1, sizeof *s->next);
    s->force = copy_of(g, NULL, NV, sizeof *s->force);
    s->inner = copy_of(g, NULL, NV, sizeof *s->inner);
    s->outer = copy_of(g, NULL, NV, sizeof *s->outer);
    s->single = copy_of(g, NULL, NV, sizeof *s->single);
    s->bound = copy_of(g, NULL, NV, sizeof *s->bound);
}

/* What a stage returned, or what it left for the next look at the device's
 * status, which then is good again. */
static bool is_refused(struct gpu *g, int status)
{
    int later = gpu_status(g);
    status = status == DRAPE_OK ? later : status;
    return status == DRAPE_EARG && gpu_status(g) == DRAPE_OK;
}

const char *test_coulomb_refused(void)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    static const uint16_t of[NV];
    static const struct surface surface = {R(0.01), 0};
    struct coulomb law;
    if (!g)
        return skip("there is no device");
    make_law(g, &law);
    struct carry c = {.nv = NV,
                      .n = 1,
                      .w = law.w,
                      .dt = 1,
                      .tau = 1,
                      .stiffest = 1,
                      .contact = law.contact};
    c.surfaces = (struct surfaces){1, copy_of(g, of, NV, sizeof *of),
                                   copy_of(g, &surface, 1, sizeof surface)};
    struct retain r = {.nv = NV,
                       .n = 1,
                       .w = law.w,
                       .u = law.u,
                       .v = law.u,
                       .contact = law.contact,
                       .kept = copy_of(g, NULL, 1, sizeof *r.kept)};
    status = gpu_status(g);
    bool refused = status == DRAPE_OK;
    refused = refused && is_refused(g, gpu_coulomb(g, &law));
    refused = refused && is_refused(g, gpu_carry(g, &c));
    refused = refused && is_refused(g, gpu_retain(g, &r));
    gpu_close(g);
    EXPECT(refused);
    ran(3);
    return NULL;
}
