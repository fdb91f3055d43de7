/* SPDX-License-Identifier: Apache-2.0 */
/* Loops of the reference over led vertices and over displacements.
 * spec/world/step.md §1, §6, §7 */
#include "ref/world/led.h"

void led_pin(int64_t n, const int32_t *pinned, const vec *x, vec *to)
{
    for (int64_t i = 0; i < n; i++)
        to[pinned[i]] = x[i];
}

bool led_moves(const struct world *w)
{
    for (int64_t i = w->nc; i < w->nv; i++)
        if (memcmp(&w->x0[i], &w->x1[i], sizeof *w->x0) != 0)
            return true;
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *s = &w->sheet[k];
        for (int64_t i = 0; i < s->pins.n; i++) {
            const vec *x = w->x0 + s->first + s->pinned[i];
            if (memcmp(x, &s->pins.x[i], sizeof *x) != 0)
                return true;
        }
    }
    return false;
}

void led_velocities(int64_t n, const vec *x0, const vec *x1, real dt, vec *v)
{
    EACH_ITEM
    for (int64_t i = 0; i < n; i++) {
        vec d = vec_sub(x1[i], x0[i]);
        v[i] = vec_make(d.x / dt, d.y / dt, d.z / dt);
    }
}

real led_furthest(int64_t n, const vec *x0, const vec *x1)
{
    real most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
    for (int64_t i = 0; i < n; i++) {
        vec d = vec_sub(x1[i], x0[i]);
        most = real_max(most, vec_dot(d, d));
    }
    return most;
}
