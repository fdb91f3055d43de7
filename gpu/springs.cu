/* SPDX-License-Identifier: Apache-2.0 */
/* The force on each particle. spec/04_springs.md */
#include "gpu/cloth.cuh"

/* §1: the pull on p of a spring to q. */
static __device__ vec pull(const struct springs *s, const struct law *a,
                           int64_t p, int64_t q)
{
    vec d = sub(s->x[q], s->x[p]);
    real l = length(d);
    if (!(l > 0))
        return make(0, 0, 0);
    vec u = scale(1 / l, d);
    real f = spring_tension(a, l);
    if (s->n_v)
        f += a->damp * dot(sub(s->v[q], s->v[p]), u);
    return scale(f, u);
}

/* Thread p owns particle p: reads it and its sixteen neighbours, writes
 * force[p]. §2: forward and backward spring of each direction in turn. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    springs_kernel(struct springs s)
{
    ITEM(p, s.count);
    int32_t j = (int32_t)(p / s.m), i = (int32_t)(p - (int64_t)j * s.m);
    vec f = make(0, 0, 0);
    for (int o = 0; o < SPRINGS; o++) {
        int di = forward_i(o), dj = forward_j(o);
        int64_t step = di + (int64_t)dj * s.m;
        if (s.springs[p] >> o & 1)
            f = add(f, pull(&s, &s.law[o], p, p + step));
        bool inside = i >= di && i - di < s.m && j >= dj;
        if (inside && s.springs[p - step] >> o & 1)
            f = add(f, pull(&s, &s.law[o], p, p - step));
    }
    if (s.n_wind)
        f = add(f, s.wind[p]);
    s.force[p] = axpy(f, s.mass[p], s.gravity);
}

int gpu_springs(struct gpu *g, struct springs *s)
{
    LAUNCH(g, s->count, springs_kernel, *s);
    return gpu_status(g);
}
