/* SPDX-License-Identifier: Apache-2.0 */
/* Lists what the seams of a world are on the grids of multigrid.
 * spec/solve/sewn.md §1 */
#include "ref/seam/seam.h"
#include "ref/solve/coarsen.h"
#include "ref/solve/sewn.h"

/* MOST_TERMS: of a link, four particles for each of a contact. LEAST_LINKS: of
 * a seam, on each grid, if it has so many points. */
enum { MOST_TERMS = 16, LEAST_LINKS = 4 };

/* One grid of a cloth: which particles are there, and how they interpolate
 * from the next grid. */
struct shape {
    int32_t m, n;
    uint8_t *there, *rule;
};

/* The lists under way. */
struct maker {
    struct world *w;
    struct sewn *s;
    int grid;            /* whose links are made */
    struct shape *shape; /* [cloths][LEVELS] */
    int32_t *row_of;     /* [nc] 1 + the row of a particle on this grid */
    struct sewn_link *link;
    struct sewn_row *row;
    struct sewn_term *of_link, *of_row;
};

/* One particle of a link. */
struct entry {
    int32_t cloth, particle;
    double c;
};

static void *take_array(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_OTHER, n, size);
}

static struct shape *shape_of(const struct maker *a, int cloth, int grid)
{
    return &a->shape[cloth * LEVELS + grid];
}

/* The rule of particle (i, j), by which neighbours are there. */
static uint8_t rule_of(const struct shape *s, int32_t i, int32_t j)
{
    const uint8_t *at = s->there + (i + (int64_t)s->m * j);
    int rule = 0;
    if (i % 2 && i + 1 < s->m && at[-1] != at[1])
        rule |= at[1] ? ONLY_RIGHT : ONLY_LEFT;
    if (j % 2 && j + 1 < s->n && at[-s->m] != at[s->m])
        rule |= at[s->m] ? ONLY_UP : ONLY_DOWN;
    return (uint8_t)rule;
}

/* The particles of the next grid from which particle p interpolates, and four
 * times their weights. Returns how many: at most four. */
static int interpolate(const struct shape *s, int32_t p, int32_t to[4],
                       int weight[4])
{
    int32_t i = p % s->m, j = p / s->m;
    int n = 0;
    for (int32_t y = j / 2; y <= (j + 1) / 2; y++)
        for (int32_t x = i / 2; x <= (i + 1) / 2; x++) {
            to[n] = x + coarse_size(s->m) * y;
            weight[n] = weight_of(s->rule[p], i - 2 * x, j - 2 * y);
            n += weight[n] != 0;
        }
    return n;
}

/* Finds which particles of a cloth's grid are there: on the finest those that
 * the outline leaves, on a coarser one those from which any interpolates. */
static void fill_shape(const struct maker *a, int cloth, int grid)
{
    const struct sheet *sheet = &a->w->sheet[cloth];
    struct shape *s = shape_of(a, cloth, grid);
    int64_t count = (int64_t)s->m * s->n;
    for (int64_t p = 0; p < count && grid == 0; p++)
        s->there[p] = sheet->cloth.fixed[p] != CLOTH_ABSENT;
    for (int64_t p = 0; grid > 0 && p < (int64_t)s[-1].m * s[-1].n; p++) {
        int32_t to[4];
        int weight[4], n = s[-1].there[p]
                               ? interpolate(&s[-1], (int32_t)p, to, weight)
                               : 0;
        for (int k = 0; k < n; k++)
            s->there[to[k]] = 1;
    }
    for (int32_t j = 0; j < s->n; j++)
        for (int32_t i = 0; i < s->m; i++)
            s->rule[i + (int64_t)s->m * j] = rule_of(s, i, j);
}

static int make_shapes(struct maker *a)
{
    for (int k = 0; k < a->s->cloths; k++) {
        int32_t m = a->w->sheet[k].cloth.m, n = a->w->sheet[k].cloth.n;
        for (int grid = 0; grid <= a->s->depth; grid++) {
            struct shape *s = shape_of(a, k, grid);
            s->m = m;
            s->n = n;
            s->there = take_array(a->w, (int64_t)m * n, 1);
            s->rule = take_array(a->w, (int64_t)m * n, 1);
            if (!s->there || !s->rule)
                return DRAPE_ENOMEM;
            fill_shape(a, k, grid);
            m = coarse_size(m);
            n = coarse_size(n);
        }
    }
    return DRAPE_OK;
}

/* Adds a particle to the n of a link, where it may be already. */
static int add_entry(struct entry *e, int n, struct entry one)
{
    int k = 0;
    while (k < n && (e[k].cloth != one.cloth || e[k].particle != one.particle))
        k++;
    if (k == n)
        e[n++] = (struct entry){one.cloth, one.particle, 0};
    e[k].c += one.c;
    return n;
}

/* The same link on the next grid. */
static int coarsen_entries(const struct maker *a, int grid, int n,
                           struct entry *e)
{
    struct entry next[MOST_TERMS];
    int found = 0;
    for (int k = 0; k < n; k++) {
        int32_t to[4];
        int weight[4];
        int many = interpolate(shape_of(a, e[k].cloth, grid), e[k].particle, to,
                               weight);
        for (int j = 0; j < many; j++)
            found = add_entry(
                next, found,
                (struct entry){e[k].cloth, to[j], e[k].c * weight[j] / 4});
    }
    memcpy(e, next, (size_t)found * sizeof *e);
    return found;
}

/* The particles of contact `source` of the seams on the grid under way. */
static int find_entries(const struct maker *a, int64_t source, struct entry *e)
{
    const struct seams *s = &a->w->seams;
    bool hinge = source >= s->n;
    const struct seam_point *p = hinge ? NULL : &s->point[source];
    const struct seam_hinge *h = hinge ? &s->hinge[source - s->n] : NULL;
    int n = 0;
    for (int j = 0; j < (hinge ? 4 : 3); j++) {
        int32_t v = hinge ? h->v[j] : p->v[j], cloth = a->w->body[v];
        const struct sheet *sheet = &a->w->sheet[cloth];
        double c = hinge ? (double)h->c[j] : j ? -(double)p->c[j - 1] : 1;
        int32_t particle = v - (int32_t)sheet->first;
        if (c != 0 && !sheet->cloth.fixed[particle])
            n = add_entry(e, n, (struct entry){cloth, particle, c});
    }
    for (int k = 0; k < a->grid; k++)
        n = coarsen_entries(a, k, n, e);
    return n;
}

/* The row of a particle on the grid under way, which may be a new one: rows of
 * the grids before have lower numbers. */
static int32_t row_of(struct maker *a, const struct entry *e)
{
    int32_t *at = &a->row_of[a->w->sheet[e->cloth].first + e->particle];
    if (*at <= a->s->row_at[a->grid]) {
        a->row[a->s->rows++] = (struct sewn_row){e->cloth, e->particle, 0, 0};
        *at = (int32_t)a->s->rows;
    }
    return *at - 1;
}

static void add_link(struct maker *a, int64_t source, double times)
{
    struct entry e[MOST_TERMS];
    int n = find_entries(a, source, e);
    struct sewn_link *l = &a->link[a->s->links++];
    *l = (struct sewn_link){(int32_t)source, (real)times, (int32_t)a->s->terms,
                            0};
    for (int k = 0; k < n; k++)
        a->of_link[a->s->terms++] =
            (struct sewn_term){row_of(a, &e[k]), (real)e[k].c};
    l->end = (int32_t)a->s->terms;
}

/* §1: how many links n contacts of a seam are on a grid: on grid k one of
 * 2^(k-1), but at least four. */
static int64_t links_of(int64_t n, int grid)
{
    int64_t each = grid > 1 ? (int64_t)1 << (grid - 1) : 1;
    int64_t least = n < LEAST_LINKS ? n : LEAST_LINKS;
    int64_t kept = (n + each - 1) / each;
    return kept < least ? least : kept;
}

/* The links of n contacts of one seam, from `first` on. */
static void add_links(struct maker *a, int64_t first, int64_t n)
{
    int64_t kept = links_of(n, a->grid);
    for (int64_t i = 0; i < kept; i++)
        add_link(a, first + (2 * i + 1) * n / (2 * kept),
                 (double)n / (double)kept);
}

static void add_grid(struct maker *a)
{
    const struct seams *s = &a->w->seams;
    int64_t hinge = 0;
    for (int k = 0; k < s->count; k++)
        add_links(a, s->first[k], s->first[k + 1] - s->first[k]);
    for (int k = 0; k < s->count; k++) {
        int64_t first = hinge;
        while (hinge < s->n_hinges && s->hinge[hinge].point < s->first[k + 1])
            hinge++;
        add_links(a, s->n + first, hinge - first);
    }
}

/* The terms of each row, by link. */
static void list_rows(struct maker *a)
{
    struct sewn *s = a->s;
    for (int64_t t = 0; t < s->terms; t++)
        a->row[a->of_link[t].at].end++;
    for (int64_t i = 0, at = 0; i < s->rows; i++) {
        a->row[i].first = (int32_t)at;
        at += a->row[i].end;
        a->row[i].end = a->row[i].first;
    }
    for (int64_t k = 0; k < s->links; k++)
        for (int32_t t = a->link[k].first; t < a->link[k].end; t++)
            a->of_row[a->row[a->of_link[t].at].end++] =
                (struct sewn_term){(int32_t)k, a->of_link[t].c};
}

static int make_lists(struct maker *a)
{
    struct sewn *s = a->s;
    const struct seams *seams = &a->w->seams;
    int64_t most = 0;
    for (int k = 0; k <= s->depth; k++)
        for (int c = 0; c < seams->count; c++)
            most += 2 * links_of(seams->first[c + 1] - seams->first[c], k);
    a->row_of = take_array(a->w, a->w->nc, sizeof *a->row_of);
    s->link = a->link = take_array(a->w, most, sizeof *a->link);
    s->row = a->row = take_array(a->w, MOST_TERMS * most, sizeof *a->row);
    s->of_link = a->of_link =
        take_array(a->w, MOST_TERMS * most, sizeof *a->of_link);
    s->of_row = a->of_row =
        take_array(a->w, MOST_TERMS * most, sizeof *a->of_row);
    if (a->w->arena->failed)
        return DRAPE_ENOMEM;
    for (a->grid = 0; a->grid <= s->depth; a->grid++) {
        s->link_at[a->grid] = s->links;
        s->row_at[a->grid] = s->rows;
        add_grid(a);
        int64_t rows = s->rows - s->row_at[a->grid];
        s->most = rows > s->most ? rows : s->most;
    }
    s->link_at[a->grid] = s->links;
    s->row_at[a->grid] = s->rows;
    list_rows(a);
    return DRAPE_OK;
}

/* §4: which cloths are sewn together, and where their unknowns are. */
static int make_groups(struct maker *a)
{
    struct sewn *s = a->s;
    const struct seams *seams = &a->w->seams;
    struct sewn_place *place = take_array(a->w, s->cloths, sizeof *place);
    struct sewn_group *group = take_array(a->w, s->cloths, sizeof *group);
    if (!place || !group)
        return DRAPE_ENOMEM;
    s->place = place;
    s->group = group;
    for (int k = 0; k < s->cloths; k++)
        place[k].group = k;
    for (bool again = true; again;) {
        again = false;
        for (int k = 0; k < seams->count; k++) {
            int32_t *x = &place[seams->cloth[k][0]].group;
            int32_t *y = &place[seams->cloth[k][1]].group;
            again |= *x != *y;
            *x = *y = *x < *y ? *x : *y;
        }
    }
    for (int k = 0; k < s->cloths; k++) {
        int of = place[k].group;
        if (of == k)
            group[s->groups++].cloth = k;
        place[k].group = of == k ? s->groups - 1 : place[of].group;
        struct sewn_group *g = &group[place[k].group];
        const struct shape *last = shape_of(a, k, s->depth);
        place[k].first = g->n;
        g->n += 3 * last->m * last->n;
    }
    for (int k = 0; k < s->groups; k++) {
        group[k].first = (int32_t)s->unknowns;
        group[k].dense = s->n_dense;
        s->unknowns += group[k].n;
        s->n_dense += (int64_t)group[k].n * group[k].n;
    }
    return DRAPE_OK;
}

/* The reference's scratch; a device has its own. */
static int take_scratch(struct world *w)
{
    struct sewn *s = w->seams.grids;
    s->n = seams_contacts(&w->seams);
    if (w->def.backend != DRAPE_REF)
        return DRAPE_OK;
    s->kappa = arena_take(w->arena, ARENA_SOLVER, s->n, sizeof *s->kappa);
    s->answer = arena_take(w->arena, ARENA_SOLVER, s->most, sizeof *s->answer);
    s->dense = arena_take(w->arena, ARENA_SOLVER, s->n_dense, sizeof *s->dense);
    s->in = arena_take(w->arena, ARENA_SOLVER, 2 * s->unknowns, sizeof *s->in);
    s->out = s->in ? s->in + s->unknowns : NULL;
    s->cloth = arena_take(w->arena, ARENA_SOLVER, s->cloths, ref_sewn_bytes());
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

int sew_grids(struct world *w, const drape_def *def)
{
    if (sewn_depth(def) == 0)
        return DRAPE_OK;
    struct sewn *s = take_array(w, 1, sizeof *s);
    struct maker a = {.w = w, .s = s};
    if (!s)
        return DRAPE_ENOMEM;
    w->seams.grids = s;
    s->depth = sewn_depth(def);
    s->cloths = def->n_cloths;
    a.shape = take_array(w, (int64_t)s->cloths * LEVELS, sizeof *a.shape);
    int status = a.shape ? make_shapes(&a) : DRAPE_ENOMEM;
    if (status == DRAPE_OK)
        status = make_lists(&a);
    if (status == DRAPE_OK)
        status = make_groups(&a);
    if (status == DRAPE_OK)
        status = take_scratch(w);
    for (int k = 0; k < s->cloths * LEVELS && a.shape; k++) {
        arena_give(w->arena, a.shape[k].there);
        arena_give(w->arena, a.shape[k].rule);
    }
    arena_give(w->arena, a.shape);
    arena_give(w->arena, a.row_of);
    return status;
}
