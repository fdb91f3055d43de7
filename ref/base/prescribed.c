/* SPDX-License-Identifier: Apache-2.0 */
/* Loops of the reference over prescribed vertices and over displacements.
 * spec/world/step.md §1, §6, §7 */
#include "ref/base/prescribed.h"

void ref_prescribed_pin(struct gpu *on, int64_t n, const int32_t *pinned,
                        const vec *x, vec *to)
{
    (void)on;
    for (int64_t i = 0; i < n; i++)
        to[pinned[i]] = x[i];
}

bool ref_prescribed_differs(struct gpu *on, int64_t n, const int32_t *at,
                            const vec *x0, const vec *x1)
{
    (void)on;
    for (int64_t i = 0; i < n; i++)
        if (memcmp(&x0[at ? at[i] : i], &x1[i], sizeof *x0) != 0)
            return true;
    return false;
}

static real interpolate(real a, real b, double part)
{
    double from = (double)a;
    return (real)(from + part * ((double)b - from));
}

void ref_prescribed_blend(struct gpu *on, const struct blend *s)
{
    (void)on;
    EACH_ITEM
    for (int64_t i = 0; i < s->n; i++) {
        int64_t k = s->at ? s->at[i] : i;
        vec a = s->from[k], b = s->to[k];
        s->x[i] = s->part < 1 ? vec_make(interpolate(a.x, b.x, s->part),
                                         interpolate(a.y, b.y, s->part),
                                         interpolate(a.z, b.z, s->part))
                              : b;
    }
}

void ref_prescribed_keep(struct gpu *on, int64_t n, const uint8_t *fixed,
                         const vec *old, vec *a)
{
    (void)on;
    EACH_ITEM
    for (int64_t i = 0; i < n; i++)
        if (fixed[i])
            a[i] = old[i];
}

bool ref_prescribed_sane(struct gpu *on, int64_t n, const vec *a)
{
    (void)on;
    int bad = 0;
#pragma omp parallel for schedule(static) reduction(| : bad)
    for (int64_t i = 0; i < n; i++)
        bad |= !vec_sane(a[i]);
    return !bad;
}

void ref_prescribed_velocities(struct gpu *on, int64_t n, const vec *x0,
                               const vec *x1, real dt, vec *v)
{
    (void)on;
    EACH_ITEM
    for (int64_t i = 0; i < n; i++) {
        vec d = vec_sub(x1[i], x0[i]);
        v[i] = vec_make(d.x / dt, d.y / dt, d.z / dt);
    }
}

real ref_prescribed_furthest(struct gpu *on, int64_t n, const vec *x0,
                             const vec *x1)
{
    (void)on;
    real most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
    for (int64_t i = 0; i < n; i++) {
        vec d = vec_sub(x1[i], x0[i]);
        most = real_max(most, vec_dot(d, d));
    }
    return most;
}
