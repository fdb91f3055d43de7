/* SPDX-License-Identifier: Apache-2.0 */
/* Panels for tests. tests/panel/cutting.h */
#include "tests/panel/cutting.h"

#include <stdlib.h>

#include "ref/base/backend.h"
#include "ref/base/sum.h"
#include "ref/cloth/blocks.h"
#include "ref/cloth/dynamics.h"
#include "ref/cloth/energy.h"
#include "ref/cloth/motion.h"
#include "ref/cloth/springs.h"
#include "ref/panel/fibres.h"
#include "tests/cloth/sheet.h"

static bool cut_outline(struct cutting *c, int edges, double h)
{
    double at[2];
    if (!outline_make(&c->outline, c->edge, edges, 1e-3 * h, h) ||
        cut_make(&c->cut, &c->outline, h, at) != CUT_OK)
        return false;
    const struct cut *cut = &c->cut;
    int64_t n = (int64_t)cut->m * cut->n;
    c->rest = malloc((size_t)n * sizeof *c->rest);
    if (!c->rest)
        return false;
    for (int64_t p = 0; p < n; p++)
        for (int k = 0; k < 2; k++)
            c->rest[p][k] = cut->x[p][k] - cut->at[k];
    c->panel.rest = (const double(*)[2])c->rest;
    c->panel.cell = cut->cell;
    c->cloth = sheet_default(cut->m, cut->n);
    c->cloth.width = h * (cut->m - 1);
    c->cloth.height = h * (cut->n - 1);
    c->cloth.panel = &c->panel;
    return true;
}

bool cutting_strip(struct cutting *c, double length, double width, double turn,
                   double h)
{
    double s = sin(turn), t = cos(turn);
    const double along[4] = {0, length, length, 0};
    const double across[4] = {0, 0, width, width};
    *c = (struct cutting){0};
    for (int k = 0; k < 4; k++) {
        int next = (k + 1) % 4;
        c->edge[k].type = CURVE_LINE;
        c->edge[k].a[0] = t * along[k] - s * across[k];
        c->edge[k].a[1] = s * along[k] + t * across[k];
        c->edge[k].b[0] = t * along[next] - s * across[next];
        c->edge[k].b[1] = s * along[next] + t * across[next];
    }
    return cut_outline(c, 4, h);
}

bool cutting_disc(struct cutting *c, double radius, double h)
{
    *c = (struct cutting){0};
    for (int k = 0; k < 2; k++) {
        c->edge[k].type = CURVE_ARC;
        c->edge[k].a[0] = k ? -radius : radius;
        c->edge[k].b[0] = k ? radius : -radius;
        c->edge[k].a[1] = c->edge[k].b[1] = 0;
        if (!curve_arc(&c->edge[k], radius, false, true))
            return false;
    }
    return cut_outline(c, 2, h);
}

void cutting_free(struct cutting *c)
{
    outline_free(&c->outline);
    cut_free(&c->cut);
    free(c->rest);
}

static void *take_stream(struct model *s, int64_t n, size_t size)
{
    return arena_take(&s->arena, ARENA_OTHER, n, size);
}

int model_make(struct model *s, const struct cutting *c)
{
    const drape_allocator none = {0};
    *s = (struct model){.rest = c->rest};
    arena_init(&s->arena, &none);
    int status = ref_cloth_size(&c->cloth, &s->c);
    if (status != DRAPE_OK)
        return status;
    int64_t n = s->c.count;
    s->c.cell = take_stream(s, n, 1);
    s->c.springs = take_stream(s, n, 1);
    s->c.beside = take_stream(s, n, 1);
    s->c.fixed = take_stream(s, n, 1);
    s->c.mass = take_stream(s, n, sizeof(real));
    s->c.tri = take_stream(s, s->c.n_triangles, sizeof *s->c.tri);
    s->x = take_stream(s, n, sizeof *s->x);
    s->v = take_stream(s, n, sizeof *s->v);
    s->f = take_stream(s, n, sizeof *s->f);
    s->block = take_stream(s, SPRINGS * n, sizeof *s->block);
    s->chunk = take_stream(s, 3 * sum_chunks(n), sizeof *s->chunk);
    if (s->arena.failed)
        return DRAPE_ENOMEM;
    status = ref_cloth_fill(&c->cloth, &s->c, 0);
    if (status == DRAPE_OK)
        status = panel_make(&c->cloth, &s->c, c->hinged, &s->arena);
    if (status == DRAPE_OK)
        status = ref_cloth_start(&c->cloth, s->x, s->v);
    return status;
}

void model_free(struct model *s)
{
    arena_free(&s->arena);
}

void model_force(struct model *s, const vec *v)
{
    const struct cloth *c = &s->c;
    struct dynamics d = {.cloth = c};
    struct springs a = {.m = c->m,
                        .n = c->n,
                        .count = c->count,
                        .laws = SPRINGS,
                        .law = c->law,
                        .pieces = c->pieces,
                        .piece = c->piece,
                        .springs = c->springs,
                        .triples = c->triples,
                        .triple = c->triple,
                        .n_beside = c->count,
                        .beside = c->beside,
                        .mass = c->mass,
                        .x = s->x,
                        .n_v = v ? c->count : 0,
                        .v = v,
                        .force = s->f};
    ref_springs(&a);
    ref_panel_pull(NULL, &d, &a);
}

double model_energy(struct model *s)
{
    const struct cloth *c = &s->c;
    struct energy e = {.count = c->count,
                       .m = c->m,
                       .laws = SPRINGS,
                       .law = c->law,
                       .pieces = c->pieces,
                       .piece = c->piece,
                       .springs = c->springs,
                       .triples = c->triples,
                       .triple = c->triple,
                       .n_beside = c->count,
                       .beside = c->beside,
                       .mass = c->mass,
                       .x = s->x,
                       .v = s->v,
                       .n_chunks = sum_chunks(c->count),
                       .chunk = s->chunk};
    ref_energy(&e);
    return (double)e.value[1] + (double)panel_energy(c->panel, &e);
}

void model_blocks(struct model *s, double tau)
{
    const struct cloth *c = &s->c;
    struct dynamics d = {.cloth = c};
    struct blocks b = {.count = c->count,
                       .m = c->m,
                       .laws = SPRINGS,
                       .law = c->law,
                       .pieces = c->pieces,
                       .piece = c->piece,
                       .springs = c->springs,
                       .triples = c->triples,
                       .triple = c->triple,
                       .n_beside = c->count,
                       .beside = c->beside,
                       .x = s->x,
                       .tau = (real)tau,
                       .block = s->block};
    ref_blocks(&b);
    ref_panel_joins(NULL, &d, &b);
}

/* Cell `cell` as a polygon at rest. Returns its corners. */
static int polygon_of(const struct cutting *c, int64_t cell, int32_t at[4],
                      double x[4][2])
{
    int n = cut_corners(&c->cut, cell, at);
    for (int k = 0; k < n; k++)
        memcpy(x[k], c->rest[at[k]], sizeof x[k]);
    return n;
}

double model_area(const struct cutting *c)
{
    int64_t cells = (int64_t)(c->cut.m - 1) * (c->cut.n - 1);
    double sum = 0, x[4][2];
    int32_t at[4];
    for (int64_t k = 0; k < cells; k++) {
        int n = polygon_of(c, k, at, x);
        if (n)
            sum += cell_area((const double(*)[2])x, n);
    }
    return sum;
}

bool model_is_inner(const struct cutting *c, int64_t p)
{
    /* the angles at p add up to a whole turn */
    double turn = 0, x[4][2];
    int64_t i = p % c->cut.m, j = p / c->cut.m;
    for (int k = 0; k < 4; k++) {
        int64_t a = i - k % 2, b = j - k / 2;
        int32_t at[4];
        if (a < 0 || b < 0 || a >= c->cut.m - 1 || b >= c->cut.n - 1)
            continue;
        int n = polygon_of(c, a + (c->cut.m - 1) * b, at, x);
        for (int q = 0; q < n; q++) {
            if (at[q] != p)
                continue;
            const double *y = x[(q + 1) % n], *z = x[(q + n - 1) % n];
            double u[2] = {y[0] - x[q][0], y[1] - x[q][1]};
            double w[2] = {z[0] - x[q][0], z[1] - x[q][1]};
            turn += atan2(u[0] * w[1] - u[1] * w[0], u[0] * w[0] + u[1] * w[1]);
        }
    }
    return turn > 2 * 3.1415926535897932 - 1e-6;
}
