/* SPDX-License-Identifier: Apache-2.0 */
/* The generator and the properties of stage extent, and scenes that its bounds
 * settle. spec/broad/extent.md */
#include "ref/broad/extent.h"
#include "tests/broad/fabric.h"

const struct field fields_extent[] = {
    IN(extent, grid, n_grid, 1), IN(extent, x0, nv, 1), IN(extent, x1, nv, 1),
    OUT(extent, bounds, n_grid, 1), FIELD_END};

void gen_extent(struct bytes *b, struct extent *s)
{
    struct fabric f;
    struct tree tree;
    struct tree_map map;
    fabric_choose(b, &f, &tree, &map);
    s->nv = f.scene.vertices;
    s->n_grid = map.n_grid;
    s->grid = map.grid;
    s->x0 = f.x0;
    s->x1 = pick(b, 3) ? f.x1 : f.x0;
    if (s->nv && pick(b, 32) == 0)
        f.x1[pick(b, (uint32_t)s->nv)].y = R(NAN);
}

static bool within(vec a, vec lo, vec hi)
{
    return a.x >= lo.x && a.y >= lo.y && a.z >= lo.z && a.x <= hi.x &&
           a.y <= hi.y && a.z <= hi.z;
}

/* Notes which sides of a box the value a lies on: a tight box has a value on
 * each side. */
static void meet(vec a, vec lo, vec hi, int *met)
{
    *met |= (a.x == lo.x) | (a.y == lo.y) << 1 | (a.z == lo.z) << 2;
    *met |= (a.x == hi.x) << 3 | (a.y == hi.y) << 4 | (a.z == hi.z) << 5;
}

/* Checks §1 for one grid at one end of the step. */
static const char *check(const struct tree_grid *g, const vec *x,
                         const struct mesh_bounds *w, vec lo, vec hi,
                         int met[3])
{
    for (int32_t j = 0; j < g->n; j++)
        for (int32_t i = 0; i < g->m; i++) {
            const vec *p = x + g->base + i + g->m * j;
            EXPECT(within(*p, lo, hi));
            meet(*p, lo, hi, &met[0]);
            if (i + 1 < g->m) {
                vec u = vec_sub(p[1], p[0]);
                EXPECT(within(u, w->tangents.ulo, w->tangents.uhi));
                meet(u, w->tangents.ulo, w->tangents.uhi, &met[1]);
            }
            if (j + 1 < g->n) {
                vec v = vec_sub(p[g->m], p[0]);
                EXPECT(within(v, w->tangents.vlo, w->tangents.vhi));
                meet(v, w->tangents.vlo, w->tangents.vhi, &met[2]);
            }
        }
    EXPECT(met[0] == 63);
    met[0] = 0;
    return NULL;
}

const char *prop_extent(const struct extent *s)
{
    for (int64_t k = 0; k < s->n_grid; k++) {
        const struct mesh_bounds *w = &s->bounds[k];
        int met[3] = {0};
        const char *failed =
            check(&s->grid[k], s->x0, w, w->box.lo0, w->box.hi0, met);
        if (!failed)
            failed = check(&s->grid[k], s->x1, w, w->box.lo1, w->box.hi1, met);
        if (failed)
            return failed;
        EXPECT(met[1] == 63 && met[2] == 63);
    }
    return NULL;
}

/* Makes one or two cloths over a ball. */
static void scene(struct fabric *f, int k, int ball)
{
    enum fabric_shape shape = (enum fabric_shape)(k % FABRIC_SHAPES);
    fabric_make(f, 2000, 4000, (uint64_t)k);
    fabric_cloth(f, 9 + k % 7, 8 + k % 5, shape, k % 4 == 3);
    if (k % 3 == 2)
        fabric_cloth(f, 5, 4, FABRIC_FLAT, 0);
    fabric_sphere(f, ball, 4, vec_make(R(0.5), R(-0.2) * (real)(k % 8), 0),
                  R(0.1));
    fabric_move(f, vec_make(0, R(-0.1) * (real)(k % 6), 0), R(0.001));
    const struct tree_mesh *m = &f->mesh[f->scene.meshes - 1];
    for (int32_t v = m->base; v < f->scene.vertices && ball == TREE_STATIC; v++)
        f->x1[v] = f->x0[v];
}

/* §2: where whole meshes are apart, the full query finds nothing. told[] counts
 * both answers. */
static const char *compare(const struct fabric *f, struct broad *b, real r,
                           int told[2])
{
    bool apart;
    EXPECT(broad_meshes_apart(b, f->x0, f->x1, r, &apart) == DRAPE_OK);
    EXPECT(!apart || (b->n == 0 && b->n_both == 0 && b->queries == 1));
    EXPECT(broad_query(b, f->x0, f->x1, r, NULL) == DRAPE_OK);
    EXPECT(!apart || (b->n == 0 && b->n_both == 0));
    told[apart]++;
    ran(1);
    return NULL;
}

const char *test_broad_ask(void)
{
    int told[2] = {0}, moving[2] = {0};
    const char *failed = NULL;
    for (int k = 0; k < 240 && !failed; k++) {
        struct fabric f;
        struct broad b;
        bool still = k % 5;
        scene(&f, k / 2, still ? TREE_STATIC : TREE_MOVING);
        if (broad_make(&b, &f.scene, k % 2, &f.arena) != DRAPE_OK)
            failed = "no room";
        if (!failed)
            failed =
                compare(&f, &b, k % 3 ? R(0.01) : 0, still ? told : moving);
        f.x1[k % 64].z = R(NAN);
        bool apart;
        if (!failed && still && b.apart.able &&
            broad_meshes_apart(&b, f.x0, f.x1, 0, &apart) != DRAPE_EDATA)
            failed = "§1: a NaN was not met";
        fabric_free(&f);
    }
    if (failed)
        return failed;
    EXPECT(told[0] > 20 && told[1] > 20 && moving[1] == 0);
    return NULL;
}
