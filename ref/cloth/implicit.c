/* SPDX-License-Identifier: Apache-2.0 */
/* The stages before and after the linear solve of an implicit step.
 * spec/cloth/implicit.md */
#include "ref/cloth/implicit.h"

/* (x - xp) / 3: the share of the step before in the second-order method. */
static vec past_drift(vec x, vec xp)
{
    return vec_scale(R(1.0 / 3), vec_sub(x, xp));
}

int ref_predict(struct predict *s)
{
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        vec star = s->v[p], move = vec_make(0, 0, 0);
        if (s->n_past) {
            move = past_drift(s->x[p], s->xp[p]);
            star = vec_add(star, past_drift(star, s->vp[p]));
        }
        if (s->fixed[p] == CLOTH_PINNED) {
            vec d = vec_sub(vec_sub(s->to[p], s->x[p]), move);
            star = vec_scale(1 / s->tau, d);
        }
        s->star[p] = star;
        if (s->n_past) {
            s->back[p] = vec_scale(-1 / s->tau, move);
            s->q[p] = vec_sub(star, s->back[p]);
        }
    }
    return DRAPE_OK;
}

/* §2: Σ block·(q_p − q_other) over the springs of p, for each direction the
 * forward, then the backward spring. */
static vec sum_pulls(const struct rhs *s, int64_t p, int32_t i, int32_t j)
{
    vec f = vec_make(0, 0, 0), here = s->q[p];
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s->block + o * s->count;
        int32_t di = spring_di[o], dj = spring_dj[o];
        int64_t step = di + (int64_t)dj * s->m;
        if (s->springs[p] >> o & 1)
            f = vec_add(f, sym_apply(block[p], vec_sub(here, s->q[p + step])));
        if (i - di < 0 || i - di >= s->m || j < dj)
            continue;
        int64_t other = p - step;
        if (s->springs[other] >> o & 1)
            f = vec_add(f, sym_apply(block[other], vec_sub(here, s->q[other])));
    }
    return f;
}

int ref_rhs(struct rhs *s)
{
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        int32_t j = cloth_row(p, s->m), i = (int32_t)(p - (int64_t)j * s->m);
        vec b = vec_make(0, 0, 0);
        if (!s->fixed[p])
            b = vec_sub(vec_scale(s->tau, s->force[p]), sum_pulls(s, p, i, j));
        s->b[p] = b;
    }
    return DRAPE_OK;
}

int ref_update(struct update *s)
{
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        vec x = s->x[p], v = vec_make(0, 0, 0);
        if (s->fixed[p] == 0) {
            v = vec_axpy(s->star[p], s->part, s->dv[p]);
            if (s->n_past)
                x = vec_add(x, past_drift(x, s->xp[p]));
            x = vec_axpy(x, s->tau, v);
        } else if (s->fixed[p] == CLOTH_PINNED) {
            v = vec_scale(1 / s->dt, vec_sub(s->to[p], x));
            x = s->to[p];
        }
        s->x1[p] = x;
        s->v1[p] = v;
    }
    return DRAPE_OK;
}

int ref_imbalance(struct imbalance *s)
{
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        vec b = vec_make(0, 0, 0);
        if (!s->fixed[p]) {
            vec gained = vec_sub(s->v[p], s->star[p]);
            b = vec_axpy(vec_scale(s->tau, s->force[p]), -s->mass[p], gained);
        }
        s->b[p] = b;
    }
    return DRAPE_OK;
}

static bool is_same(vec a, vec b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

int ref_history(struct history *s)
{
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        vec x = s->x[p], v = s->v[p], xp = s->x0[p], vp = s->v0[p];
        if (s->n_jump)
            vp = vec_axpy(vp, s->part, s->jump[p]);
        if (!is_same(x, s->x1[p]) || !is_same(v, s->v1[p])) {
            vp = vec_add(vp, vec_sub(v, s->v1[p]));
            xp = vec_axpy(x, R(-0.5) * s->dt, vec_add(v, vp));
        }
        s->xp[p] = xp;
        s->vp[p] = vp;
    }
    return DRAPE_OK;
}
