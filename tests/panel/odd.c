/* SPDX-License-Identifier: Apache-2.0 */
/* Random odd cells and their lists, found in another way than ref/panel finds
 * them. tests/panel/odd.h */
#include "tests/panel/odd.h"

/* The forms of a regular cell: its edges along u and v, and its diagonals. */
static const struct fibre plain[FIBRES] = {
    {{1, 0, 0}, R(0.5)},  {{0, 1, -1}, R(0.5)}, {{0, 0, 1}, R(0.5)},
    {{-1, 1, 0}, R(0.5)}, {{0, 1, 0}, 1},       {{-1, 0, 1}, 1}};

static void pick_fibres(struct bytes *b, bool triangle, struct fibre fibre[6])
{
    memcpy(fibre, plain, sizeof plain);
    for (int f = 0; f < FIBRES && !for_bench(b); f++) {
        bool none = triangle ? f == 1 || f == 3 : !pick(b, 8);
        fibre[f].weight = none ? 0 : pick_uniform(b, R(0.01), 2);
        for (int k = 0; k < 3; k++)
            if (pick(b, 3))
                fibre[f].c[k] = pick(b, 4) ? pick_uniform(b, -2, 2) : 0;
        if (triangle)
            fibre[f].c[2] = 0;
    }
}

/* Makes the cell whose corner 0 of the grid is p an odd one: all of its
 * corners, or a triangle without one. */
static void add_cell(struct bytes *b, struct odd *s, int64_t p)
{
    const int32_t m = s->grid.m, a = (int32_t)p;
    const int32_t all[4] = {a, a + 1, a + m + 1, a + m};
    bool triangle = pick(b, 3) == 0;
    int first = triangle ? (int)pick(b, 4) : 0;
    int32_t *at = s->panel.corner[s->panel.n_cells];
    for (int k = 0; k < 4; k++)
        at[k] = all[(first + k) % 4];
    if (triangle)
        at[3] = at[0];
    pick_fibres(b, triangle, s->panel.fibre[s->panel.n_cells++]);
}

static void pick_cells(struct bytes *b, struct odd *s)
{
    uint32_t each = for_bench(b) ? 50 : 1 + pick(b, 9);
    s->panel.corner = take(b, s->grid.count, sizeof *s->panel.corner);
    s->panel.fibre = take(b, s->grid.count, sizeof *s->panel.fibre);
    for (int64_t p = 0; p < s->grid.count; p++)
        if (p % s->grid.m + 1 < s->grid.m && p / s->grid.m + 1 < s->grid.n &&
            !pick(b, each))
            add_cell(b, s, p);
}

/* The place of the pair of particles p and q in a list of all forward springs
 * of all particles. */
static int64_t slot_of(const struct odd *s, int32_t p, int32_t q)
{
    int32_t start = p < q ? p : q, m = s->grid.m;
    for (int o = 0; o < SPRINGS; o++)
        if (start + spring_step(m, o) == (p < q ? q : p) &&
            spring_inside(m, s->grid.n, start % m, start / m, o, 1))
            return SPRINGS * (int64_t)start + o;
    return -1;
}

static bool is_pair(const int32_t at[4], int k)
{
    return at[3] != at[0] || k == 0 || k == 1 || k == 4;
}

/* Random pairs that stars join, and stars that need not be theirs. */
static void pick_stars(struct bytes *b, struct odd *s, real *bend)
{
    uint32_t each = for_bench(b) ? 100 : 1 + pick(b, 20);
    const struct grid *g = &s->grid;
    s->panel.star = take(b, g->count, sizeof *s->panel.star);
    for (int64_t p = 0; p < g->count; p++) {
        int32_t i = (int32_t)(p % g->m), j = (int32_t)(p / g->m);
        int o = (int)pick(b, SPRINGS);
        if (spring_inside(g->m, g->n, i, j, o, 1) && !pick(b, each))
            bend[SPRINGS * p + o] = pick_uniform(b, -5, 5);
        if (pick(b, each))
            continue;
        struct star *t = &s->panel.star[s->panel.n_stars++];
        t->k = pick_uniform(b, R(0.01), 10);
        for (int k = 0; k < 5; k++)
            t->at[k] = (int32_t)(pick(b, 4) ? pick(b, (uint32_t)g->count) : p);
        for (int k = 0; k < 4; k++)
            t->c[k] = pick(b, 4) ? pick_uniform(b, -2, 2) : 0;
    }
}

/* Lists the pairs, and what of them the odd cells have. of: of each spring of
 * the grid, the number of its pair. */
static void list_pairs(struct bytes *b, struct odd *s, const real *bend,
                       int32_t *of)
{
    struct panel *l = &s->panel;
    int64_t all = SPRINGS * s->grid.count;
    for (int64_t k = 0; k < all; k++)
        of[k] = bend[k] != 0 ? 0 : -1;
    for (int64_t k = 0; k < CELL_PAIRS * l->n_cells; k++) {
        const int32_t *at = l->corner[k / CELL_PAIRS];
        const int8_t *end = pair_ends[k % CELL_PAIRS];
        if (is_pair(at, (int)(k % CELL_PAIRS)))
            of[slot_of(s, at[end[0]], at[end[1]])] = 0;
    }
    for (int64_t k = 0; k < all; k++)
        of[k] = of[k] ? -1 : (int32_t)l->n_pairs++;
    l->first = take(b, l->n_pairs, sizeof *l->first);
    l->way = take(b, l->n_pairs, 1);
    l->bend = take(b, l->n_pairs, sizeof *l->bend);
    l->from = take(b, l->n_pairs, sizeof *l->from);
    for (int64_t k = 0; k < all; k++) {
        if (of[k] < 0)
            continue;
        l->first[of[k]] = (int32_t)(k / SPRINGS);
        l->way[of[k]] = (uint8_t)(k % SPRINGS);
        l->bend[of[k]] = bend[k];
        l->from[of[k]][0] = l->from[of[k]][1] = -1;
    }
    for (int64_t k = 0; k < CELL_PAIRS * l->n_cells; k++) {
        const int32_t *at = l->corner[k / CELL_PAIRS];
        const int8_t *end = pair_ends[k % CELL_PAIRS];
        if (!is_pair(at, (int)(k % CELL_PAIRS)))
            continue;
        int32_t *from = l->from[of[slot_of(s, at[end[0]], at[end[1]])]];
        from[from[0] < 0 ? 0 : 1] = (int32_t)k;
    }
}

/* Lists the particles of pairs, and what they gather. of: scratch. */
static void list_parts(struct bytes *b, struct odd *s, int32_t *of)
{
    struct panel *l = &s->panel;
    for (int64_t p = 0; p < s->grid.count; p++)
        of[p] = -1;
    for (int64_t k = 0; k < l->n_pairs; k++) {
        of[l->first[k]] = 0;
        of[l->first[k] + spring_step(s->grid.m, l->way[k])] = 0;
    }
    l->part = take(b, s->grid.count, sizeof *l->part);
    l->push = take(b, s->grid.count, sizeof *l->push);
    l->tie = take(b, s->grid.count, sizeof *l->tie);
    memset(l->push, -1, (size_t)s->grid.count * sizeof *l->push);
    memset(l->tie, -1, (size_t)s->grid.count * sizeof *l->tie);
    for (int64_t p = 0; p < s->grid.count; p++)
        if (of[p] == 0) {
            l->part[l->n_parts] = (int32_t)p;
            of[p] = (int32_t)l->n_parts++;
        }
    for (int64_t k = 0; k < CORNERS * l->n_cells; k++) {
        const int32_t *at = l->corner[k / CORNERS];
        int32_t *push = l->push[of[at[k % CORNERS]]];
        int n = 0;
        while (n < 3 && push[n] >= 0)
            n++;
        if (k % CORNERS < 3 || at[3] != at[0])
            push[n] = (int32_t)k;
    }
    for (int64_t k = 0; k < l->n_pairs; k++) {
        int64_t p = l->first[k], o = l->way[k];
        if (l->bend[k] == 0)
            continue;
        l->tie[of[p]][2 * o] = (int32_t)k;
        l->tie[of[p + spring_step(s->grid.m, (int)o)]][2 * o + 1] = (int32_t)k;
    }
}

struct odd pick_odd(struct bytes *b)
{
    struct odd s = {.grid = pick_bent_grid(b)};
    s.x = pick_state(b, &s.grid);
    real *bend = take(b, SPRINGS * s.grid.count, sizeof *bend);
    int32_t *of = take(b, SPRINGS * s.grid.count, sizeof *of);
    pick_cells(b, &s);
    pick_stars(b, &s, bend);
    list_pairs(b, &s, bend, of);
    list_parts(b, &s, of);
    return s;
}

real odd_before(int64_t k)
{
    return (real)((uint32_t)k * 2654435761u >> 16) * R(0x1p-16) - R(0.5);
}

void odd_form(const struct fibre *f, const int32_t at[4], const vec *a,
              double d[3], double *size)
{
    *size = 0;
    for (int e = 0; e < 3; e++) {
        d[e] = 0;
        for (int k = 0; k < 3; k++) {
            double from = (double)(&a[at[0]].x)[e];
            double to = (double)(&a[at[k + 1]].x)[e];
            d[e] += (double)f->c[k] * (to - from);
            *size += fabs((double)f->c[k] * (to - from));
        }
    }
}
