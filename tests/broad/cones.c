/* SPDX-License-Identifier: Apache-2.0 */
/* The generator and the properties of stage cones. spec/broad/cones.md */
#include <stdlib.h>

#include "ref/broad/cones.h"
#include "ref/broad/refit.h"
#include "tests/broad/fabric.h"

const struct field fields_cones[] = {FABRIC_TREE(cones, tree),
                                     IN(cones, map.grid, map.n_grid, 1),
                                     IN(cones, map.at, map.n_at, 1),
                                     IN(cones, map.full, tree.n_cloth, 1),
                                     IN(cones, x0, nv, 1),
                                     IN(cones, x1, nv, 1),
                                     IN(cones, stir, tree.n_cloth, 1),
                                     INOUT(cones, tangents, n_inner, 1),
                                     INOUT(cones, clear, tree.n_cloth, 1),
                                     FIELD_END};

/* Makes the kept inputs of a later query: tangents and bits from before some
 * vertices moved. */
static void move_some(struct bytes *b, struct cones *s, struct fabric *f)
{
    uint8_t *moved = take(b, s->nv, 1);
    vec *then = take(b, s->nv, sizeof *then);
    struct refit fit = {.tree = s->tree,
                        .nv = s->nv,
                        .x0 = s->x0,
                        .x1 = s->x1,
                        .n_moved = s->nv,
                        .moved = moved,
                        .stir = (uint8_t *)s->stir};
    const vec *now = s->x1;
    uint32_t few = 2 + pick(b, 200);
    for (int64_t v = 0; v < s->nv; v++) {
        moved[v] = pick(b, few) == 0;
        then[v] = moved[v] ? pick_vec(b, 1) : s->x1[v];
    }
    s->x1 = then;
    if (ref_cones(s) != DRAPE_OK)
        abort();
    s->x1 = now;
    fit.box = fabric_boxes(b, f, &s->tree, (uint8_t *)s->stir);
    if (ref_refit(&fit) != DRAPE_OK)
        abort();
}

void gen_cones(struct bytes *b, struct cones *s)
{
    struct fabric f;
    fabric_choose(b, &f, &s->tree, &s->map);
    s->nv = f.scene.vertices;
    s->x0 = f.x0;
    s->x1 = pick(b, 3) ? f.x1 : f.x0;
    s->r = pick(b, 2) ? 0 : real_abs(pick_real(b, R(0.02)));
    s->n_inner = tree_inner(&s->tree);
    s->tangents = take(b, s->n_inner, sizeof *s->tangents);
    s->clear = take(b, s->tree.n_cloth, 1);
    uint8_t *stir = take(b, s->tree.n, 1);
    memset(stir, 1, (size_t)s->tree.n);
    s->stir = stir;
    if (pick(b, 2))
        move_some(b, s, &f);
}

/* Returns the squared distance of two vertices at time t, in binary64. */
static double distance2(const struct cones *s, int32_t v, int32_t w, double t)
{
    double d[6] = {
        (double)s->x0[v].x - (double)s->x0[w].x,
        (double)s->x0[v].y - (double)s->x0[w].y,
        (double)s->x0[v].z - (double)s->x0[w].z,
        (double)s->x1[v].x - (double)s->x1[w].x,
        (double)s->x1[v].y - (double)s->x1[w].y,
        (double)s->x1[v].z - (double)s->x1[w].z,
    };
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double e = d[k] + t * (d[k + 3] - d[k]);
        sum += e * e;
    }
    return sum;
}

/* §3 at three times: vertices of a patch that are more than a cell apart at
 * rest stay more than r apart. The patch has the cells (i, j) to (i + wide, j +
 * high). */
static const char *check_patch(const struct cones *s, const struct tree_grid *g,
                               const int32_t at[4])
{
    for (int32_t p = 0; p < 64; p++) {
        int32_t vi = at[0] + p % 8 * at[2] / 7, vj = at[1] + p / 8 * at[3] / 7;
        for (int32_t q = 0; q < 64; q++) {
            int32_t wi = at[0] + q % 8 * at[2] / 7;
            int32_t wj = at[1] + q / 8 * at[3] / 7;
            if (vi == wi && vj == wj)
                continue;
            int32_t v = g->base + vi + g->m * vj, w = g->base + wi + g->m * wj;
            for (int t = 0; t <= 2; t++)
                EXPECT(distance2(s, v, w, 0.5 * t) >
                       (double)s->r * (double)s->r);
        }
    }
    return NULL;
}

/* Returns the corner and the size of node a in cells, cut off at the grid's
 * end. */
static void extent(const struct cones *s, int32_t a, int32_t at[4])
{
    const struct tree_grid *g = &s->map.grid[s->tree.mesh[a]];
    int32_t unit = 1 << s->tree.level[a];
    at[0] = (s->tree.place[a] & 0xffff) * unit;
    at[1] = (s->tree.place[a] >> 16) * unit;
    at[2] = at[0] + unit < g->m - 1 ? unit : g->m - 1 - at[0];
    at[3] = at[1] + unit < g->n - 1 ? unit : g->n - 1 - at[1];
}

/* §3 holds for clear nodes, including kept bits; §5: what is clear is clear at
 * all levels below. */
const char *prop_cones(const struct cones *s)
{
    for (int32_t a = 0; a < s->tree.n_cloth; a++) {
        int32_t at[4], up = s->tree.parent[a];
        if (up >= 0 && s->stir[a] && s->clear[up] & 1)
            EXPECT(s->clear[a] & 1);
        if (!(s->clear[a] & 1))
            continue;
        EXPECT(s->map.full[a]);
        extent(s, a, at);
        const char *failed = check_patch(s, &s->map.grid[s->tree.mesh[a]], at);
        if (failed)
            return failed;
    }
    return NULL;
}
