/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the lists of a panel, and corrects the streams of its cloth.
 * spec/panel/panel.md §1, §3 */
#include "ref/panel/panel.h"

#include "ref/base/cells.h"
#include "ref/base/sum.h"
#include "ref/cloth/triple.h"
#include "ref/panel/fibres.h"
#include "ref/panel/stars.h"

/* A panel under construction. */
struct making {
    const drape_cloth *def;
    struct cloth *cloth;
    struct arena *arena;
    struct panel *to;
    const uint8_t *hinged; /* as in struct star_grid */
    double *area;   /* [count] m², of particles that have odd cells, else 0 */
    double *ease;   /* [SPRINGS·count] what the edge in direction o of p is
                       eased by, 0: it is not; NULL: none is */
    uint8_t *tied;  /* [SPRINGS·count] 1: stars join the pair in direction o of
                       p */
    uint8_t *pairs; /* [count] bits of the pairs that are joined */
    int32_t *at;    /* [SPRINGS·count] number of the pair; [count] of the
                       particle in the list */
};

static void *take_stream(const struct making *a, int64_t n, size_t size)
{
    return arena_take(a->arena, ARENA_CLOTH, n, size);
}

/* Returns the forward direction of the pair p, q, and sets its first particle.
 */
static int direction_of(int32_t m, int64_t p, int64_t q, int64_t *first)
{
    int64_t di = q % m - p % m, dj = q / m - p / m;
    for (int o = 0; o < SPRINGS; o++) {
        *first = p;
        if (di == spring_di[o] && dj == spring_dj[o])
            return o;
        *first = q;
        if (di == -spring_di[o] && dj == -spring_dj[o])
            return o;
    }
    return -1;
}

/* Where the block of the pair p, q is: direction · count + first particle. */
static int64_t slot_of(const struct making *a, int64_t p, int64_t q)
{
    int64_t first;
    int o = direction_of(a->cloth->m, p, q, &first);
    return o < 0 ? -1 : o * a->cloth->count + first;
}

/* Calls visit for each odd cell, ascending; number: how many there were before.
 */
static void each_odd_cell(struct making *a,
                          void (*visit)(struct making *, int64_t number,
                                        const int64_t at[4], int corners))
{
    const drape_cloth *d = a->def;
    int64_t number = 0, at[4];
    for (int64_t j = 0; j < d->n - 1; j++)
        for (int64_t i = 0; i < d->m - 1; i++) {
            int kind = cell_kind(d, i, j);
            if (cell_is_odd(kind))
                visit(a, number++, at,
                      cell_corners(kind, i + d->m * j, d->m, at));
        }
}

static void count_cell(struct making *a, int64_t number, const int64_t at[4],
                       int corners)
{
    (void)at;
    (void)corners;
    a->to->n_cells = number + 1;
}

/* §2.2: shortens the edges of a cell that are eased, about their middles. */
static void ease_cell(const struct making *a, const int64_t at[4], int corners,
                      double x[4][2])
{
    double by[4][2] = {{0}};
    for (int k = 0; k < corners && a->ease; k++) {
        int next = (k + 1) % corners;
        int64_t slot = slot_of(a, at[k], at[next]);
        double part = a->ease[slot] > 0 ? (1 - a->ease[slot]) / 2 : 0;
        for (int i = 0; i < 2; i++) {
            by[k][i] += part * (x[next][i] - x[k][i]);
            by[next][i] -= part * (x[next][i] - x[k][i]);
        }
    }
    for (int k = 0; k < corners; k++)
        for (int i = 0; i < 2; i++)
            x[k][i] += by[k][i];
}

/* §2: the corners and fibres of a cell, and its part of their areas. */
static void make_cell(struct making *a, int64_t number, const int64_t at[4],
                      int corners)
{
    double x[4][2];
    for (int k = 0; k < corners; k++)
        memcpy(x[k], a->def->panel->rest[at[k]], sizeof x[k]);
    double hu = a->def->width / (a->def->m - 1);
    double hv = a->def->height / (a->def->n - 1);
    double share = cell_area((const double(*)[2])x, corners) / corners;
    ease_cell(a, at, corners, x);
    make_fibres((const double(*)[2])x, corners, hu, hv, a->to->fibre[number]);
    for (int k = 0; k < CORNERS; k++)
        a->to->corner[number][k] = (int32_t)at[k % corners];
    for (int k = 0; k < corners; k++)
        a->area[at[k]] += share;
    for (int k = 0; k < CELL_PAIRS; k++) {
        int p = pair_ends[k][0], q = pair_ends[k][1];
        if (p >= corners || q >= corners)
            continue;
        int64_t slot = slot_of(a, at[p], at[q]), count = a->cloth->count;
        a->pairs[slot % count] |= (uint8_t)(1 << slot / count);
    }
}

/* §3.2: adds what the regular cells of a particle of an odd cell give to its
 * area, and marks it. */
static void measure_particles(struct making *a)
{
    struct cloth *c = a->cloth;
    double cell = a->def->width / (c->m - 1) * (a->def->height / (c->n - 1));
    for (int64_t p = 0; p < c->count; p++) {
        unsigned b = c->beside[p];
        if (!(a->area[p] > 0))
            continue;
        for (int k = 0; k < 4; k++)
            a->area[p] += b >> k & 1 ? cell / 4 : 0;
        c->beside[p] = (uint8_t)(b | BESIDE_STARS);
    }
}

/* The weights of a star on its five particles. */
static void star_weights(const struct star *s, double c[5])
{
    c[0] = 0;
    for (int k = 1; k < 5; k++) {
        c[k] = (double)s->c[k - 1];
        c[0] -= c[k];
    }
}

/* Whether a star joins its particles p and q. */
static bool star_joins(const struct star *s, const double c[5], int p, int q)
{
    return c[p] != 0 && c[q] != 0 && s->at[p] != s->at[q];
}

/* §4.3: the pairs that the stars join. */
static void join_stars(struct making *a)
{
    int64_t count = a->cloth->count;
    for (int64_t i = 0; i < a->to->n_stars; i++) {
        const struct star *s = &a->to->star[i];
        double c[5];
        star_weights(s, c);
        for (int p = 0; p < 5; p++)
            for (int q = p + 1; q < 5; q++) {
                if (!star_joins(s, c, p, q))
                    continue;
                int64_t slot = slot_of(a, s->at[p], s->at[q]);
                a->tied[slot] = 1;
                a->pairs[slot % count] |= (uint8_t)(1 << slot / count);
            }
    }
}

/* §3.3: lists the pairs. */
static void list_pairs(struct making *a)
{
    struct panel *to = a->to;
    struct cloth *c = a->cloth;
    for (int64_t p = 0; p < c->count; p++)
        for (int o = 0; o < SPRINGS; o++) {
            int64_t slot = o * c->count + p, k = to->n_pairs;
            if (!(a->pairs[p] >> o & 1))
                continue;
            to->first[k] = (int32_t)p;
            to->way[k] = (uint8_t)o;
            to->from[k][0] = to->from[k][1] = -1;
            a->at[slot] = (int32_t)to->n_pairs++;
        }
    for (int64_t p = 0; p < c->count; p++)
        c->pairs[p] = (uint8_t)(c->springs[p] | a->pairs[p]);
}

static void add_to_list(int32_t *list, int n, int32_t entry)
{
    int k = 0;
    while (k < n - 1 && list[k] >= 0)
        k++;
    list[k] = entry;
}

/* §3.3: tells the pairs of a cell where it writes their blocks. */
static void name_joins(struct making *a, int64_t number, const int64_t at[4],
                       int corners)
{
    for (int k = 0; k < CELL_PAIRS; k++) {
        int p = pair_ends[k][0], q = pair_ends[k][1];
        if (p < corners && q < corners)
            add_to_list(a->to->from[a->at[slot_of(a, at[p], at[q])]], 2,
                        (int32_t)(CELL_PAIRS * number + k));
    }
}

/* §3.4: tells the corners of a cell where it writes their forces. */
static void name_pushes(struct making *a, int64_t number, const int64_t at[4],
                        int corners)
{
    for (int k = 0; k < corners; k++)
        add_to_list(a->to->push[a->at[at[k]]], 4,
                    (int32_t)(CORNERS * number + k));
}

/* §3.4: lists the particles of pairs, and the pairs of each that bend. */
static void list_parts(struct making *a)
{
    struct panel *to = a->to;
    int64_t count = a->cloth->count;
    for (int64_t k = 0; k < to->n_pairs; k++) {
        int64_t p = to->first[k], step = spring_step(a->cloth->m, to->way[k]);
        a->pairs[p] = a->pairs[p + step] = 1;
        to->n_parts += 2;
    }
    to->n_parts = to->n_parts < count ? to->n_parts : count;
    to->part = take_stream(a, to->n_parts, sizeof *to->part);
    to->push = take_stream(a, to->n_parts, sizeof *to->push);
    to->tie = take_stream(a, to->n_parts, sizeof *to->tie);
    to->area = take_stream(a, to->n_parts, sizeof *to->area);
    if (a->arena->failed)
        return;
    memset(to->push, -1, (size_t)to->n_parts * sizeof *to->push);
    memset(to->tie, -1, (size_t)to->n_parts * sizeof *to->tie);
    to->n_parts = 0;
    for (int64_t p = 0; p < count; p++)
        if (a->pairs[p]) {
            to->part[to->n_parts] = (int32_t)p;
            to->area[to->n_parts] = a->area[p];
            a->at[p] = (int32_t)to->n_parts++;
        }
    for (int64_t k = 0; k < to->n_pairs; k++) {
        int64_t p = to->first[k], o = to->way[k];
        int64_t q = p + spring_step(a->cloth->m, (int)o);
        if (a->tied[o * count + p]) {
            to->tie[a->at[p]][2 * o] = (int32_t)k;
            to->tie[a->at[q]][2 * o + 1] = (int32_t)k;
        }
    }
}

static int64_t count_pairs(const struct making *a)
{
    int64_t n = 0;
    for (int64_t p = 0; p < a->cloth->count; p++)
        for (int o = 0; o < SPRINGS; o++)
            n += a->pairs[p] >> o & 1;
    return n;
}

static int make_cells(struct making *a)
{
    struct panel *to = a->to;
    each_odd_cell(a, count_cell);
    to->corner = take_stream(a, to->n_cells, sizeof *to->corner);
    to->fibre = take_stream(a, to->n_cells, sizeof *to->fibre);
    to->pushes = take_stream(a, CORNERS * to->n_cells, sizeof *to->pushes);
    to->joins = take_stream(a, CELL_PAIRS * to->n_cells, sizeof *to->joins);
    if (a->arena->failed)
        return DRAPE_ENOMEM;
    each_odd_cell(a, make_cell);
    measure_particles(a);
    struct star_grid grid = {a->def, a->cloth, a->area, a->hinged, a->arena};
    return make_stars(&grid, to);
}

static int make_lists(struct making *a)
{
    struct panel *to = a->to;
    join_stars(a);
    int64_t n = count_pairs(a);
    to->first = take_stream(a, n, sizeof *to->first);
    to->way = take_stream(a, n, sizeof *to->way);
    to->bend = take_stream(a, n, sizeof *to->bend);
    to->from = take_stream(a, n, sizeof *to->from);
    to->sum = take_stream(a, n, sizeof *to->sum);
    to->chunk = take_stream(a, sum_chunks(to->n_cells + to->n_stars),
                            sizeof *to->chunk);
    if (a->arena->failed)
        return DRAPE_ENOMEM;
    list_pairs(a);
    each_odd_cell(a, name_joins);
    list_parts(a);
    if (!a->arena->failed)
        each_odd_cell(a, name_pushes);
    return a->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

/* The number of the pair of particles p and q. */
static int64_t find_pair(const struct panel *a, int32_t m, int32_t p, int32_t q)
{
    int64_t first, low = 0, high = a->n_pairs;
    int o = direction_of(m, p, q, &first);
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (a->first[middle] < first)
            low = middle + 1;
        else
            high = middle;
    }
    while (a->way[low] != o)
        low++;
    return low;
}

/* §4.3: what the stars of the panel are to its pairs. As Σ c = 0, |Σ c x|² is
 * -Σ c_p c_q |x_p - x_q|² over them. */
static void bend_pairs(struct panel *a, int32_t m)
{
    for (int64_t k = 0; k < a->n_pairs; k++)
        a->sum[k] = 0;
    for (int64_t i = 0; i < a->n_stars; i++) {
        const struct star *s = &a->star[i];
        double c[5];
        star_weights(s, c);
        for (int p = 0; p < 5; p++)
            for (int q = p + 1; q < 5; q++)
                if (star_joins(s, c, p, q))
                    a->sum[find_pair(a, m, s->at[p], s->at[q])] -=
                        (double)s->k * c[p] * c[q];
    }
    for (int64_t k = 0; k < a->n_pairs; k++)
        a->bend[k] = (real)a->sum[k];
}

void panel_set_material(struct panel *a, const struct cloth *c, double density)
{
    double cell = (double)c->hu * (double)c->hv;
    for (int64_t k = 0; k < a->n_parts; k++)
        if (a->area[k] > 0)
            c->mass[a->part[k]] = (real)(density * a->area[k]);
    for (int64_t k = 0; k < a->n_stars; k++) {
        double whole = (double)triple_constant(c->triple, a->star_way[k], 15);
        a->star[k].k = (real)(whole * a->share[k] / cell);
    }
    bend_pairs(a, c->m);
}

/* Notes which edges are eased. */
static void take_eases(struct making *a)
{
    const drape_panel *panel = a->def->panel;
    if (panel->n_eases == 0)
        return;
    a->ease = arena_take(a->arena, ARENA_OTHER, SPRINGS * a->cloth->count,
                         sizeof *a->ease);
    for (int k = 0; k < panel->n_eases && !a->arena->failed; k++) {
        const drape_ease *e = &panel->eases[k];
        a->ease[slot_of(a, e->end[0], e->end[1])] = e->ratio;
    }
}

int panel_make(const drape_cloth *d, struct cloth *c, const uint8_t *hinged,
               struct arena *arena)
{
    struct making a = {.def = d, .cloth = c, .hinged = hinged, .arena = arena};
    int64_t slots = SPRINGS * c->count;
    a.to = take_stream(&a, 1, sizeof *a.to);
    c->pairs = take_stream(&a, c->count, 1);
    a.area = arena_take(arena, ARENA_OTHER, c->count, sizeof *a.area);
    a.tied = arena_take(arena, ARENA_OTHER, slots, 1);
    a.pairs = arena_take(arena, ARENA_OTHER, c->count, 1);
    a.at = arena_take(arena, ARENA_OTHER, slots, sizeof *a.at);
    take_eases(&a);
    c->panel = a.to;
    int status = arena->failed ? DRAPE_ENOMEM : make_cells(&a);
    if (status == DRAPE_OK)
        status = make_lists(&a);
    if (status == DRAPE_OK)
        panel_set_material(a.to, c, d->material.density);
    arena_give(arena, a.area);
    arena_give(arena, a.ease);
    arena_give(arena, a.tied);
    arena_give(arena, a.pairs);
    arena_give(arena, a.at);
    return status;
}
