/* SPDX-License-Identifier: Apache-2.0 */
/* The audit of wrong meshes on the device. spec/narrow/audit.md */
#include "gpu/run/gpu.h"
#include "tests/base/harness.h"
#include "tests/base/stages.h"

enum { NV = 300, NT = 100 };

/* Copies n items to the device, or only allocates them if host is NULL. */
static void *put(struct gpu *g, const void *host, int64_t n, size_t size)
{
    void *p = gpu_take(g, ARENA_OTHER, n, size);
    if (p && host)
        gpu_up(g, p, host, (size_t)n * size);
    return p;
}

/* The status of an audit of this mesh on the device. */
static int judge(const vec *x, const int32_t (*tri)[3])
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    struct audit s = {.nv = NV, .nt = NT, .cap = NT};
    s.n_nodes = ref_audit_nodes(NT);
    s.x = put(g, x, NV, sizeof *x);
    s.tri = put(g, tri, NT, sizeof *tri);
    for (int k = 0; k < 2; k++) {
        s.key[k] = put(g, NULL, NT, sizeof **s.key);
        s.order[k] = put(g, NULL, NT, sizeof **s.order);
    }
    s.node = put(g, NULL, s.n_nodes, sizeof *s.node);
    s.count = put(g, NULL, s.n_nodes, sizeof *s.count);
    s.pair = put(g, NULL, NT, sizeof *s.pair);
    s.degenerate = put(g, NULL, NT, 1);
    status = gpu_audit(g, &s);
    gpu_close(g);
    return status;
}

/* A vertex that the mesh does not have is refused and never looked up, however
 * far away it would be; so are coordinates that are no numbers. */
const char *test_audit_gpu_status(void)
{
    static const int32_t wrong[] = {-1, NV, INT32_MIN, INT32_MAX};
    static vec x[NV];
    static int32_t tri[NT][3];
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g)
        return skip("there is no device");
    gpu_close(g);
    for (int k = 0; k < NV; k++) {
        x[k] = vec_make((real)(k % 3 == 1), (real)(k % 3 == 2), (real)(k / 3));
        tri[k / 3][k % 3] = k;
    }
    EXPECT(judge(x, (const int32_t(*)[3])tri) == DRAPE_OK);
    for (int k = 0; k < 12; k++) {
        int32_t *v = &tri[33 * (k / 3)][k % 3], right = *v;
        *v = wrong[k / 3];
        EXPECT(judge(x, (const int32_t(*)[3])tri) == DRAPE_EARG);
        *v = right;
        ran(1);
    }
    for (int k = 0; k < 3; k++) {
        real *p = &(&x[100 * k].x)[k], right = *p;
        *p = k ? 2 * REAL_BIG : (real)NAN;
        EXPECT(judge(x, (const int32_t(*)[3])tri) == DRAPE_EDATA);
        *p = right;
        ran(1);
    }
    return NULL;
}
