/* SPDX-License-Identifier: Apache-2.0 */
/* Joins pairs that still touch into zones and moves each zone as a rigid body
 * (Provot 1997, Bridson 2002 §7.3). spec/contact/zones.md */
#include "ref/contact/zones.h"

static bool is_free(const struct zones *s, int32_t i)
{
    return s->w[i] > 0;
}

/* §1: components */

/* The smallest label among the free vertices of pair k, or -1 if it has none.
 */
static int32_t least_label(const struct zones *s, int64_t k)
{
    int32_t least = -1;
    for (int j = 0; j < 4; j++) {
        int32_t i = s->pair[4 * k + j];
        if (is_free(s, i) && (least < 0 || s->label[i] < least))
            least = s->label[i];
    }
    return least;
}

/* Lowers *label to `to`. True: it was larger. */
static bool lower_label(int32_t *label, int32_t to)
{
    bool lowers = to < *label;
    if (lowers)
        *label = to;
    return lowers;
}

/* One iteration of labels: each free vertex, and the vertex that its label
 * names, take the pair's smallest label; then each vertex takes its label's
 * label. True: a label changed. */
static bool spread_labels(struct zones *s)
{
    bool changed = false;
    for (int64_t k = 0; k < s->n4; k++) {
        int32_t i = s->pair[k];
        if (!is_free(s, i))
            continue;
        int32_t least = least_label(s, k / 4);
        changed |= lower_label(&s->label[s->label[i]], least);
        changed |= lower_label(&s->label[i], least);
    }
    for (int64_t k = 0; k < s->n4; k++) {
        int32_t i = s->pair[k];
        if (is_free(s, i))
            changed |= lower_label(&s->label[i], s->label[s->label[i]]);
    }
    return changed;
}

static void label_vertices(struct zones *s)
{
    for (int64_t k = 0; k < s->n4; k++)
        s->label[s->pair[k]] = s->pair[k];
    while (spread_labels(s))
        continue;
}

/* Lists the members of all zones, sorted by zone and vertex, each once. */
static int64_t list_members(struct zones *s, struct key **members)
{
    int64_t n = 0;
    for (int64_t k = 0; k < s->n4; k++) {
        int32_t label = least_label(s, k / 4);
        if (label >= 0)
            s->key[n++] =
                (struct key){(uint32_t)label, (uint32_t)s->pair[k], 0};
    }
    struct key *key = keys_sort(n, s->key, s->spare);
    int64_t m = 0;
    for (int64_t k = 0; k < n; k++)
        if (m == 0 || key[m - 1].hi != key[k].hi || key[m - 1].lo != key[k].lo)
            key[m++] = key[k];
    *members = key;
    return m;
}

/* §2: sums */

static struct zone_sum sum_add(const struct zone_sum *p,
                               const struct zone_sum *q)
{
    struct zone_sum r = {p->m + q->m, vec_add(p->a, q->a), vec_add(p->b, q->b),
                         sym_add(p->i, q->i)};
    return r;
}

/* Sums n members pairwise, as a tree whose shape depends on n alone. */
static struct zone_sum sum_members(struct zone_sum *sum, int64_t n)
{
    for (int64_t step = 1; step < n; step *= 2)
        for (int64_t k = 0; k + step < n; k += 2 * step)
            sum[k] = sum_add(&sum[k], &sum[k + step]);
    return sum[0];
}

/* The mass with which vertex i counts in zone z: prescribed vertices alone
 * where the zone has any. */
static real mass_of(const struct zones *s, const struct zone *z, int32_t i)
{
    if (z->prescribed)
        return is_free(s, i) ? 0 : 1;
    return 1 / s->w[i];
}

/* The share of vertex i in the sums of centre and velocity. */
static struct zone_sum linear_part(const struct zones *s, const struct zone *z,
                                   int32_t i)
{
    real m = mass_of(s, z, i);
    struct zone_sum r = {m,
                         vec_scale(m, vec_sub(s->x0[i], z->base)),
                         vec_scale(m, s->u[i]),
                         {0, 0, 0, 0, 0, 0}};
    return r;
}

/* The position of vertex i relative to the centre of zone z. */
static vec arm_of(const struct zones *s, const struct zone *z, int32_t i)
{
    return vec_sub(vec_sub(s->x0[i], z->base), z->centre);
}

/* The share of vertex i in the sums of angular momentum and inertia. */
static struct zone_sum angular_part(const struct zones *s, const struct zone *z,
                                    int32_t i)
{
    real m = mass_of(s, z, i);
    vec r = arm_of(s, z, i), d = vec_sub(s->u[i], z->velocity);
    if (z->prescribed) /* §3.4: the middle of the chord */
        r = vec_axpy(r, R(0.5) * s->dt, d);
    vec mr = vec_scale(m, r), l = vec_cross(mr, d);
    struct zone_sum sum = {m,
                           l,
                           l,
                           {mr.y * r.y + mr.z * r.z, -(mr.x * r.y),
                            -(mr.x * r.z), mr.x * r.x + mr.z * r.z,
                            -(mr.y * r.z), mr.x * r.x + mr.y * r.y}};
    return sum;
}

/* §3: motion */

/* The angular velocity i⁻¹ l, by the adjugate; 0 where the members lie too
 * close to a line. */
static vec spin_of(sym i, vec l)
{
    vec none = vec_make(0, 0, 0);
    real trace = i.xx + i.yy + i.zz;
    if (!(trace > 0))
        return none;
    real f = 1 / trace;
    sym j = {f * i.xx, f * i.xy, f * i.xz, f * i.yy, f * i.yz, f * i.zz};
    sym a = {j.yy * j.zz - j.yz * j.yz, j.xz * j.yz - j.xy * j.zz,
             j.xy * j.yz - j.xz * j.yy, j.xx * j.zz - j.xz * j.xz,
             j.xy * j.xz - j.xx * j.yz, j.xx * j.yy - j.xy * j.xy};
    real det = j.xx * a.xx + j.xy * a.xy + j.xz * a.xz;
    if (!(det > R(0x1p-16)))
        return none;
    return vec_scale(1 / det, sym_apply(a, vec_scale(f, l)));
}

/* Finds the rigid motion of zone z from its members. */
static void find_motion(struct zones *s, struct zone *z,
                        const struct key *member)
{
    struct zone_sum *sum = s->sum + z->first;
    int64_t n = z->end - z->first;
    z->prescribed = false;
    z->base = s->x0[member[0].lo];
    for (int64_t k = 0; k < n; k++)
        z->prescribed |= !is_free(s, (int32_t)member[k].lo);
    for (int64_t k = 0; k < n; k++)
        sum[k] = linear_part(s, z, (int32_t)member[k].lo);
    struct zone_sum all = sum_members(sum, n);
    z->centre = vec_scale(1 / all.m, all.a);
    z->velocity = vec_scale(1 / all.m, all.b);
    for (int64_t k = 0; k < n; k++)
        sum[k] = angular_part(s, z, (int32_t)member[k].lo);
    all = sum_members(sum, n);
    z->spin = spin_of(all.i, all.a);
    /* §3.2: at most a quarter turn */
    vec half = vec_scale(R(0.5) * s->dt, z->spin);
    real rotation = vec_dot(half, half);
    if (rotation > 1)
        z->spin = vec_scale(1 / real_sqrt(rotation), z->spin);
}

/* The mean velocity that moves vertex i with zone z through the step. */
static vec rigid_velocity(const struct zones *s, const struct zone *z,
                          int32_t i)
{
    vec half = vec_scale(R(0.5) * s->dt, z->spin);
    vec rotation = vec_cross(z->spin, arm_of(s, z, i));
    rotation = vec_add(rotation, vec_cross(half, rotation));
    return vec_axpy(z->velocity, 1 / (1 + vec_dot(half, half)), rotation);
}

int ref_zones(struct zones *s)
{
    if (!(s->dt > 0 && s->dt <= REAL_BIG) || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX)
        return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->pair + 4 * k, s->nv))
            return DRAPE_EARG;

    struct key *member;
    label_vertices(s);
    int64_t members = list_members(s, &member);
    s->found = s->vertices = 0;
    for (int64_t k = 0; k < members; k++) {
        if (k == 0 || member[k].hi != member[k - 1].hi)
            s->zone[s->found++].first = k;
        s->zone[s->found - 1].end = k + 1;
        if (is_free(s, (int32_t)member[k].lo))
            s->vertex[s->vertices++] = (int32_t)member[k].lo;
    }
    EACH_ITEM
    for (int64_t k = 0; k < s->found; k++)
        find_motion(s, &s->zone[k], member + s->zone[k].first);
    EACH_ITEM
    for (int64_t k = 0; k < s->found; k++)
        for (int64_t j = s->zone[k].first; j < s->zone[k].end; j++)
            if (is_free(s, (int32_t)member[j].lo))
                s->u[member[j].lo] =
                    rigid_velocity(s, &s->zone[k], (int32_t)member[j].lo);
    return DRAPE_OK;
}
