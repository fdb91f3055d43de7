/* SPDX-License-Identifier: Apache-2.0 */
/* The update of the explicit methods, and the number of substeps that is
 * stable. spec/cloth/advance.md */
#include "ref/cloth/advance.h"

int ref_advance(struct advance *s)
{
    EACH_ITEM
    for (int64_t p = 0; p < s->count; p++) {
        vec x = s->x[p], v = s->v[p];
        if (s->fixed[p] == 0) {
            v = vec_axpy(v, s->b / s->mass[p], s->force[p]);
            x = vec_axpy(x, s->a, s->symplectic ? v : s->rate[p]);
        } else if (s->fixed[p] == CLOTH_PINNED) {
            vec d = vec_sub(s->to[p], s->from[p]);
            x = s->at < 1 ? vec_axpy(s->from[p], s->at, d) : s->to[p];
            v = vec_scale(1 / s->dt, d);
        }
        s->x1[p] = x;
        s->v1[p] = v;
    }
    return DRAPE_OK;
}

bool advance_stable(int method, double dt, int64_t substeps, double bound,
                    double beta)
{
    double h = dt / (double)substeps;
    double stiff = h * h * bound, damp = h * beta * bound;
    if (method == DRAPE_MIDPOINT) {
        double e = h - beta;
        return damp <= 2 && h * bound * (e * e + beta * beta) <= 4 * beta;
    }
    if (method == DRAPE_RK4)
        return damp <= RK4_RADIUS && stiff <= RK4_RADIUS * RK4_RADIUS;
    return stiff + 2 * damp < 4;
}

int32_t advance_substeps(int method, double dt, double bound, double beta)
{
    int64_t hi = 1;
    while (hi < INT32_MAX && !advance_stable(method, dt, hi, bound, beta))
        hi *= 2;
    if (hi > INT32_MAX)
        return INT32_MAX;
    int64_t lo = hi / 2; /* hi is stable; lo is not, or is 0 */
    while (hi - lo > 1) {
        int64_t mid = lo + (hi - lo) / 2;
        if (advance_stable(method, dt, mid, bound, beta))
            hi = mid;
        else
            lo = mid;
    }
    return (int32_t)hi;
}

int32_t advance_substeps_of(int method, double dt, const struct cloth *c)
{
    double beta = (double)c->beta;
    if (!(c->damped < c->bound))
        return advance_substeps(method, dt, c->bound, beta);
    int32_t slack = advance_substeps(method, dt, c->damped, beta);
    int32_t taut =
        advance_substeps(method, dt, c->bound, beta * (c->damped / c->bound));
    return taut > slack ? taut : slack;
}
