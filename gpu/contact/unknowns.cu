/* SPDX-License-Identifier: Apache-2.0 */
/* The unknowns of a slice with contacts on the device: ref/contact/unknowns.h.
 * Their memory is in gpu/world/systems.cu. spec/contact/lagrange.md */
#include "gpu/contact/lists.cuh"

extern "C" {
#include "gpu/run/backend.h"
#include "ref/contact/carry.h"
#include "ref/contact/unknowns.h"
}

/* Thread i owns particle i. */
KERNEL unknowns_shift_kernel(const struct shift &s)
{
    ITEM(i, s.count);
    if (!(s.w[i] > 0))
        return;
    vec dv = s.dv[i], u = axpy(s.u[i], s.span * s.part, dv);
    s.u[i] = u;
    s.v[i] = axpy(s.v[i], s.part, dv);
    s.x1[i] = axpy(s.x0[i], s.dt, u);
    s.touched[i] = 1;
}

void gpu_unknowns_shift(struct gpu *g, const struct shift *s)
{
    LAUNCH(g, s->count, unknowns_shift_kernel, *s);
}

/* What contacts push a particle: those that struck it, and all; and the sizes
 * of these pushes. */
struct struck {
    vec push, all;
    real part, whole;
};

static __device__ inline struck list_add(struck a, struck b)
{
    return {add(a.push, b.push), add(a.all, b.all), a.part + b.part,
            a.whole + b.whole};
}

static __device__ inline real *numbers(struck *a)
{
    return &a->push.x;
}

struct unknowns_struck {
    struct jumps s;
    const int32_t *start;
    __device__ int32_t end(int64_t i) const { return start[i + 1]; }
    __device__ struck value(int32_t at) const
    {
        int32_t item = s.item[at];
        const struct contact *c = &s.contact[item / 4];
        real weight = c->c[item % 4];
        vec none = make(0, 0, 0);
        vec push = scale(weight, axpy(c->tangent, c->impulse, c->n));
        real size = c->impulse > 0 ? magnitude(weight) * c->impulse : 0;
        bool is = c->impulse > 0 && s.kept[item / 4].lambda == 0;
        return {is ? push : none, push, is ? size : 0, size};
    }
    __device__ struck first(int64_t) const
    {
        return {make(0, 0, 0), make(0, 0, 0), 0, 0};
    }
    __device__ void done(int64_t i, struck sum) const
    {
        vec undone = add(s.rest[i], sum.all);
        real part = sum.part > 0 ? sum.part / sum.whole : 0;
        s.push[i] = s.w[i] > 0 && part > 0 ? axpy(sum.push, -part, undone)
                                           : make(0, 0, 0);
    }
};

/* Thread i owns particle i. */
KERNEL unknowns_jump_kernel(const struct jumps &s)
{
    sum_list(unknowns_struck{s, s.start}, own_list(s.count));
}

void gpu_unknowns_jump(struct gpu *g, const struct jumps *s)
{
    LAUNCH_LISTS(g, s->count, unknowns_jump_kernel, *s);
}

/* Thread k owns coordinate k of 3 n. */
KERNEL unknowns_lessen_kernel(int64_t n, real part, const real *q, real *r)
{
    ITEM(k, n);
    r[k] = r[k] + -part * q[k];
}

void gpu_unknowns_lessen(struct gpu *g, int64_t n, real part, const vec *q,
                         vec *r)
{
    LAUNCH(g, 3 * n, unknowns_lessen_kernel, 3 * n, part, &q->x, &r->x);
}
