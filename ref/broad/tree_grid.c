/* SPDX-License-Identifier: Apache-2.0 */
/* Builds the quadtree over the cells of a cloth's grid. spec/broad/tree.md
 * §2 */
#include "ref/broad/tree_plan.h"

/* Returns the cell that holds a triangle, or -1 where the triangle's corners do
 * not lie in one cell. */
static int32_t cell_of(const struct tree_mesh *g, const int32_t f[3])
{
    int32_t i0 = g->m, j0 = g->n, i1 = -1, j1 = -1;
    for (int k = 0; k < 3; k++) {
        int32_t v = f[k] - g->base, i = v % g->m, j = v / g->m;
        if (v < 0 || j >= g->n)
            return -1;
        i0 = i < i0 ? i : i0;
        j0 = j < j0 ? j : j0;
        i1 = i > i1 ? i : i1;
        j1 = j > j1 ? j : j1;
    }
    return i1 - i0 == 1 && j1 - j0 == 1 ? i0 + (g->m - 1) * j0 : -1;
}

/* Fills level 0 of the lookup table: the first triangle of each cell, or -1.
 * Returns DRAPE_EARG where the triangles do not follow the cells. */
static int mark_cells(const struct tree_plan *p, const struct tree_mesh *g,
                      int32_t *at)
{
    int32_t last = -1;
    for (int32_t t = g->first_tri; t < g->first_tri + g->tris; t++) {
        int32_t c = cell_of(g, p->scene->tri[t]);
        if (c < last || (c == last && at[c] != t - 1))
            return DRAPE_EARG;
        if (c != last)
            at[c] = t;
        last = c;
    }
    return DRAPE_OK;
}

int tree_grid_levels(const struct tree_mesh *g)
{
    int l = 0;
    while (tree_side(g->m - 1, l) > 1 || tree_side(g->n - 1, l) > 1)
        l++;
    return l + 1;
}

/* Fills a level of the lookup table from the level below: 0 where there will be
 * a node, -1 elsewhere. */
static void mark_level(const struct tree_plan *p, const struct tree_mesh *g,
                       const struct tree_grid *d, int l)
{
    const int32_t *below = p->at + d->at[l - 1];
    int32_t w = tree_side(g->m - 1, l), wb = tree_side(g->m - 1, l - 1);
    int32_t hb = tree_side(g->n - 1, l - 1);
    for (int32_t j = 0; j < hb; j++)
        for (int32_t i = 0; i < wb; i++)
            if (below[i + wb * j] >= 0)
                p->at[d->at[l] + (i >> 1) + w * (j >> 1)] = 0;
}

int tree_grid_mark(struct tree_plan *p, int32_t k, struct tree_run *run)
{
    const struct tree_mesh *g = &p->scene->mesh[k];
    struct tree_grid *d = &p->grid[k];
    d->base = g->base;
    d->m = g->m;
    d->n = g->n;
    for (int l = 0; l < tree_grid_levels(g); l++) {
        int32_t size = tree_side(g->m - 1, l) * tree_side(g->n - 1, l);
        d->at[l] = (int32_t)p->n_at;
        int32_t *at = p->at + p->n_at;
        p->n_at += size;
        for (int32_t c = 0; c < size; c++)
            at[c] = -1;
        if (l > 0)
            mark_level(p, g, d, l);
        else if (mark_cells(p, g, at) != DRAPE_OK)
            return DRAPE_EARG;
        for (int32_t c = 0; c < size; c++)
            run->nodes[l] += at[c] >= 0;
    }
    return DRAPE_OK;
}

/* Which corner of its cell a triangle lacks, as bits i, j (§2): the
 * exclusive or of the three that it has. */
static int missing_corner(const struct tree_mesh *g, const int32_t f[3])
{
    int32_t cell = cell_of(g, f), bits = 0;
    int32_t i = cell % (g->m - 1), j = cell / (g->m - 1);
    for (int k = 0; k < 3; k++) {
        int32_t v = f[k] - g->base;
        bits ^= (v % g->m - i) | (v / g->m - j) << 1;
    }
    return bits;
}

/* Fills the leaf of a cell with its one or two triangles, which follow each
 * other. */
static void fill_leaf(struct tree_plan *p, const struct tree_mesh *g,
                      int32_t node, int32_t *at_order)
{
    const int32_t(*tri)[3] = p->scene->tri;
    int32_t i = p->place[node] & 0xffff, j = p->place[node] >> 16;
    int32_t *cell = p->at + p->grid[p->mesh[node]].at[0] + i + (g->m - 1) * j;
    int32_t t = *cell, mine = cell_of(g, tri[t]);
    *cell = node;
    p->first[node] = *at_order;
    p->full[node] = 0;
    p->count[node] = 1;
    p->order[(*at_order)++] = t;
    if (t + 1 < g->first_tri + g->tris && cell_of(g, tri[t + 1]) == mine) {
        int lack = missing_corner(g, tri[t]) ^ missing_corner(g, tri[t + 1]);
        p->full[node] = lack == 3;
        p->count[node] = 2;
        p->order[(*at_order)++] = t + 1;
    }
}

/* Numbers the children of a node; *next is the next free number. */
static void fill_inner(struct tree_plan *p, const struct tree_mesh *g,
                       int32_t node, int32_t *next)
{
    int l = p->level[node] - 1;
    int32_t w = tree_side(g->m - 1, l), h = tree_side(g->n - 1, l);
    int32_t x = 2 * (p->place[node] & 0xffff), y = 2 * (p->place[node] >> 16);
    int32_t *at = p->at + p->grid[p->mesh[node]].at[l];
    p->first[node] = *next;
    for (int q = 0; q < 4; q++) {
        int32_t i = x + (q & 1), j = y + (q >> 1);
        if (i >= w || j >= h || at[i + w * j] < 0)
            continue;
        int32_t child = (*next)++;
        p->parent[child] = node;
        p->place[child] = i | j << 16;
        if (l > 0)
            at[i + w * j] = child;
        p->count[node]++;
    }
}

/* A node is full if all the child positions inside the grid have a node and
 * these nodes are full. */
static void fill_full(struct tree_plan *p, const struct tree_mesh *g,
                      int32_t node)
{
    int l = p->level[node] - 1;
    int32_t x = 2 * (p->place[node] & 0xffff), y = 2 * (p->place[node] >> 16);
    int wide = x + 1 < tree_side(g->m - 1, l) ? 2 : 1;
    int high = y + 1 < tree_side(g->n - 1, l) ? 2 : 1;
    bool full = p->count[node] == wide * high;
    for (int c = 0; c < p->count[node]; c++)
        full = full && p->full[p->first[node] + c];
    p->full[node] = full;
}

void tree_grid_fill(struct tree_plan *p, int32_t k, const struct tree_run *run)
{
    const struct tree_mesh *g = &p->scene->mesh[k];
    int levels = tree_grid_levels(g);
    int32_t at_order = g->first_tri, root = run->first[levels - 1];
    if (!g->tris)
        return;
    p->parent[root] = -1;
    p->place[root] = 0;
    if (levels > 1)
        p->at[p->grid[k].at[levels - 1]] = root;
    for (int l = levels - 1; l >= 0; l--) {
        int32_t next = l ? run->first[l - 1] : 0;
        for (int32_t i = 0; i < run->nodes[l]; i++) {
            int32_t a = run->first[l] + i;
            p->mesh[a] = (uint16_t)k;
            p->level[a] = (uint8_t)l;
            p->count[a] = 0;
            if (l == 0)
                fill_leaf(p, g, a, &at_order);
            else
                fill_inner(p, g, a, &next);
        }
    }
    for (int l = 1; l < levels; l++)
        for (int32_t i = 0; i < run->nodes[l]; i++)
            fill_full(p, g, run->first[l] + i);
}
