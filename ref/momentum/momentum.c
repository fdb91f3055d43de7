/* SPDX-License-Identifier: Apache-2.0 */
/* Sums mass and momentum, finds what touches, and rotates bodies.
 * spec/momentum/momentum.md */
#include "ref/momentum/momentum.h"

#include "ref/base/sum.h"

static void put_vector(real *item, vec a)
{
    item[0] = a.x;
    item[SUM_CHUNK] = a.y;
    item[2 * SUM_CHUNK] = a.z;
}

/* §1: the items of particle p, one in each of MOMENTS chunks. */
static void find_items(const struct moments *s, int64_t p, real *item)
{
    real m = s->w[p] > 0 ? 1 / s->w[p] : 0;
    vec d = vec_sub(s->x[p], s->at), e = vec_sub(s->v[p], s->speed);
    vec md = vec_scale(m, d);
    item[MOMENT_MASS * SUM_CHUNK] = m;
    put_vector(item + MOMENT_PLACE * SUM_CHUNK, md);
    put_vector(item + MOMENT_SPEED * SUM_CHUNK, vec_scale(m, e));
    put_vector(item + MOMENT_SPIN * SUM_CHUNK, vec_cross(md, e));
    put_vector(item + MOMENT_SPREAD * SUM_CHUNK, vec_scale(md.x, d));
    put_vector(item + (MOMENT_SPREAD + 3) * SUM_CHUNK,
               vec_make(md.y * d.y, md.y * d.z, md.z * d.z));
    item[MOMENT_SQUARE * SUM_CHUNK] = m * vec_dot(e, e);
}

static void sum_chunk(const struct moments *s, int64_t k)
{
    real item[MOMENTS][SUM_CHUNK] = {{0}};
    int64_t start = k * SUM_CHUNK, end = start + SUM_CHUNK;
    for (int64_t p = start; p < end && p < s->count; p++)
        find_items(s, p, &item[0][p - start]);
    for (int e = 0; e < MOMENTS; e++)
        s->chunk[e * s->n_chunks + k] = sum_tree(item[e]);
}

int ref_moments(struct moments *s)
{
    s->at = s->x[s->count / 2];
    s->speed = s->v[s->count / 2];
    EACH_ITEM
    for (int64_t k = 0; k < s->n_chunks; k++)
        sum_chunk(s, k);
    for (int e = 0; e < MOMENTS; e++)
        s->value[e] = ref_sum_finish(s->n_chunks, s->chunk + e * s->n_chunks);
    return DRAPE_OK;
}

/* §2: the first body, as far as known, of the island of body k. Halves the way
 * there. */
static int32_t root_of(int32_t *label, int32_t k)
{
    while (label[k] != k)
        k = label[k] = label[label[k]];
    return k;
}

int ref_islands(struct islands *s)
{
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->contact[k].v, s->nv))
            return DRAPE_EARG;
    for (int64_t k = 0; k < s->bodies; k++)
        s->label[k] = (int32_t)k;
    for (int64_t k = 0; k < s->n; k++) {
        const int32_t *v = s->contact[k].v; /* v[0] is of side A, v[3] of B */
        if (s->body[v[0]] >= s->bodies || s->body[v[3]] >= s->bodies)
            continue;
        int32_t a = root_of(s->label, s->body[v[0]]);
        int32_t b = root_of(s->label, s->body[v[3]]);
        s->label[a > b ? a : b] = a > b ? b : a;
    }
    for (int32_t k = 0; k < s->bodies; k++)
        s->label[k] = root_of(s->label, k);
    return DRAPE_OK;
}

int ref_spin(struct spin *s)
{
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        vec rotation = vec_cross(s->dw, vec_sub(s->x[p], s->centre));
        vec gain = vec_add(s->dv, rotation);
        vec to = vec_add(vec_scale(s->keep, s->v[p]), gain);
        s->to[p] = s->w[p] > 0 ? to : s->v[p];
    }
    return DRAPE_OK;
}
