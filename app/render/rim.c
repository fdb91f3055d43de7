/* SPDX-License-Identifier: Apache-2.0 */
/* Rounds the rims of holes in pictures, where the grid makes stairs of them. */
#include "app/render/rim.h"
#include "app/base/app.h"

#include <stdlib.h>
#include <string.h>

enum { PASSES = 3 };

static int ascending(const void *a, const void *b)
{
    uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

/* The rim through a vertex: its neighbours there, and how many. */
struct rim {
    uint32_t next[2];
    uint8_t count;
};

static void join(struct rim *rim, uint32_t neighbour)
{
    if (rim->count < 2)
        rim->next[rim->count] = neighbour;
    rim->count += rim->count < 3;
}

/* Finds the edges of one triangle only: those are the rims. */
static void find(const uint64_t *edge, int64_t edges, const struct grid *c,
                 struct rim *rim)
{
    for (int64_t k = 0; k < edges; k++) {
        bool single = (k == 0 || edge[k - 1] != edge[k]) &&
                      (k + 1 == edges || edge[k + 1] != edge[k]);
        uint32_t a = (uint32_t)(edge[k] >> 32), b = (uint32_t)edge[k];
        if (!single)
            continue;
        join(&rim[a - c->first], b);
        join(&rim[b - c->first], a);
    }
}

/* Moves each vertex of a rim by half of the way to the middle of its two
 * neighbours there. from: the positions before, [m·n]. */
static void smooth(struct model *model, const struct grid *c,
                   const struct rim *rim, float (*from)[3])
{
    int64_t count = (int64_t)c->m * c->n;
    memcpy(from, model->x + c->first, (size_t)count * sizeof *from);
    for (int64_t p = 0; p < count; p++) {
        int64_t i = p % c->m, j = p / c->m;
        bool edge = i == 0 || j == 0 || i == c->m - 1 || j == c->n - 1;
        if (edge || rim[p].count != 2)
            continue;
        const float *a = from[rim[p].next[0] - c->first];
        const float *b = from[rim[p].next[1] - c->first];
        for (int d = 0; d < 3; d++)
            model->x[c->first + p][d] = from[p][d] / 2 + (a[d] + b[d]) / 4;
    }
}

/* The cloth's triangles are from first to end. */
static int64_t list(const struct model *model, const struct grid *c,
                    int64_t triangles, uint64_t *edge)
{
    uint64_t lo = (uint64_t)c->first, hi = lo + (uint64_t)c->m * (uint64_t)c->n;
    int64_t edges = 0;
    for (int64_t k = 0; k < triangles; k++) {
        const uint32_t *t = model->tri[k];
        for (int i = 0; i < 3 && t[0] >= lo && t[0] < hi; i++) {
            uint64_t a = t[i], b = t[(i + 1) % 3];
            if (a < lo || b < lo || a >= hi || b >= hi)
                continue; /* no run's frame has it */
            edge[edges++] = a < b ? a << 32 | b : b << 32 | a;
        }
    }
    return edges;
}

int rim_round(struct pool *pool, struct model *model, const struct grid *c,
              int64_t triangles)
{
    int64_t count = (int64_t)c->m * c->n, here = 0;
    if (c->first + count > model->nv)
        return APP_OK;
    for (int64_t k = 0; k < triangles; k++)
        here +=
            model->tri[k][0] >= c->first && model->tri[k][0] < c->first + count;
    if (here == 2 * (int64_t)(c->m - 1) * (c->n - 1))
        return APP_OK; /* it has no hole */
    uint64_t *edge = pool_take(pool, 3 * (size_t)here + 1, sizeof *edge);
    struct rim *rim = pool_take(pool, (size_t)count, sizeof *rim);
    float(*from)[3] = pool_take(pool, (size_t)count, sizeof *from);
    if (!edge || !rim || !from)
        return complain(APP_FAILED, "render: out of memory");
    int64_t edges = list(model, c, triangles, edge);
    qsort(edge, (size_t)edges, sizeof *edge, ascending);
    find(edge, edges, c, rim);
    for (int k = 0; k < PASSES; k++)
        smooth(model, c, rim, from);
    return APP_OK;
}
