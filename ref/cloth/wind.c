/* SPDX-License-Identifier: Apache-2.0 */
/* Drag, lift and resistance of each triangle, gathered by its corners.
 * spec/cloth/wind.md */
#include "ref/cloth/wind.h"

/* The load of a cell on one of its corners: a third of a triangle's. */
struct corner_load {
    vec force; /* N */
    real rate; /* kg/s */
};

/* §1, §3: the share of a corner in the force on an area vector and in its
 * resistance. sum: of the velocities of all corners. */
static struct corner_load load_of_share(const struct wind *s, real share,
                                        vec area, vec sum)
{
    struct corner_load none = {vec_make(0, 0, 0), 0};
    vec u = vec_sub(s->air, vec_scale(share, sum));
    real flow = vec_dot(area, u), square = vec_dot(u, u);
    real size = vec_length(area) * real_sqrt(square);
    if (!(size > 0))
        return none;
    real through = real_abs(flow);
    vec across = vec_axpy(vec_scale(square, area), -flow, u);
    vec f = vec_scale(s->drag * through, u);
    f = vec_axpy(f, s->lift * (flow / size), across);
    return (struct corner_load){vec_scale(share, f),
                                share * ((s->drag + s->lift) * through)};
}

/* A third of the load of triangle abc. */
static struct corner_load third_of_load(const struct wind *s, int64_t a,
                                        int64_t b, int64_t c)
{
    vec ab = vec_sub(s->x[b], s->x[a]), ac = vec_sub(s->x[c], s->x[a]);
    vec area = vec_scale(R(0.5), vec_cross(ab, ac));
    vec sum = vec_add(vec_add(s->v[a], s->v[b]), s->v[c]);
    return load_of_share(s, R(1.0 / 3), area, sum);
}

/* §4: stores what each corner of odd cell k gets. */
static void store_odd_load(const struct wind *s, int64_t k)
{
    const int32_t *at = s->corner[k];
    bool triangle = at[3] == at[0];
    vec across = vec_sub(s->x[at[2]], s->x[at[0]]);
    vec other = vec_sub(s->x[at[3]], s->x[at[1]]);
    vec area = vec_scale(R(0.5), vec_cross(across, other));
    vec sum = vec_add(vec_add(s->v[at[0]], s->v[at[1]]), s->v[at[2]]);
    if (!triangle)
        sum = vec_add(sum, s->v[at[3]]);
    struct corner_load a =
        load_of_share(s, triangle ? R(1.0 / 3) : R(0.25), area, sum);
    s->load[k][0] = a.force;
    s->load[k][1] = vec_make(a.rate, 0, 0);
}

/* §4: adds to a particle's force and inertia what its odd cells have. */
static void add_odd_loads(const struct wind *s, int64_t k)
{
    int32_t p = s->owner[k];
    vec f = s->force[p];
    real rate = 0;
    for (int q = 0; q < 4; q++) {
        int32_t at = s->push[k][q];
        if (at < 0)
            continue;
        const vec *load = s->load[(uint32_t)at >> 2]; /* of its cell, at / 4 */
        f = vec_add(f, load[0]);
        rate += load[1].x;
    }
    s->force[p] = f;
    if (s->n_inertia)
        s->inertia[p] += s->tau * rate;
}

/* §2: adds the shares of p in the triangles around it, in ascending order of
 * their cells. */
static vec gather_corners(const struct wind *s, int64_t p, int32_t i, int32_t j)
{
    const vec *part = s->part;
    int64_t m = s->m;
    vec f = vec_make(0, 0, 0);
    if (i > 0 && j > 0) {
        f = vec_add(f, part[2 * (p - m - 1)]);
        f = vec_add(f, part[2 * (p - m - 1) + 1]);
    }
    if (j > 0)
        f = vec_add(f, part[2 * (p - m) + 1]);
    if (i > 0)
        f = vec_add(f, part[2 * (p - 1)]);
    f = vec_add(f, part[2 * p]);
    return vec_add(f, part[2 * p + 1]);
}

/* §3: the same of the resistance. */
static real add_resistance(const struct wind *s, int64_t p, int32_t i,
                           int32_t j)
{
    const real *rate = s->rate;
    int64_t m = s->m;
    real sum = 0;
    if (i > 0 && j > 0) {
        sum += rate[2 * (p - m - 1)];
        sum += rate[2 * (p - m - 1) + 1];
    }
    if (j > 0)
        sum += rate[2 * (p - m) + 1];
    if (i > 0)
        sum += rate[2 * (p - 1)];
    sum += rate[2 * p];
    return sum + rate[2 * p + 1];
}

/* Stores the load that triangle k puts on each of its corners; cell p has the
 * triangles 2·p and 2·p + 1. */
static void store_load(const struct wind *s, int64_t k, struct corner_load a)
{
    s->part[k] = a.force;
    if (s->n_inertia)
        s->rate[k] = a.rate;
}

int ref_wind(struct wind *s)
{
    int64_t m = s->m;
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        struct corner_load none = {vec_make(0, 0, 0), 0};
        bool is = s->cell[p];
        store_load(s, 2 * p, is ? third_of_load(s, p, p + 1, p + m + 1) : none);
        store_load(s, 2 * p + 1,
                   is ? third_of_load(s, p, p + m + 1, p + m) : none);
    }
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        int32_t j = cloth_row(p, s->m), i = (int32_t)(p - j * m);
        s->force[p] = gather_corners(s, p, i, j);
        if (s->n_inertia)
            s->inertia[p] = s->mass[p] + s->tau * add_resistance(s, p, i, j);
    }
    EACH_MANY(s->n_cells)
    for (int64_t k = 0; k < s->n_cells; k++)
        store_odd_load(s, k);
    EACH_MANY(s->n_parts)
    for (int64_t k = 0; k < s->n_parts; k++)
        add_odd_loads(s, k);
    return DRAPE_OK;
}
