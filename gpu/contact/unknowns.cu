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

/* The impulses of the contacts of a vertex that struck it. */
struct unknowns_struck {
    struct jumps s;
    const int32_t *start;
    __device__ int32_t end(int64_t i) const { return start[i + 1]; }
    __device__ vec value(int32_t at) const
    {
        int32_t item = s.item[at];
        const struct contact *c = &s.contact[item / 4];
        bool struck = c->impulse > 0 && s.kept[item / 4].lambda == 0;
        vec push = axpy(c->tangent, c->impulse, c->n);
        return struck ? scale(c->c[item % 4], push) : make(0, 0, 0);
    }
    __device__ vec first(int64_t) const { return make(0, 0, 0); }
    __device__ void done(int64_t i, vec sum) const
    {
        s.push[i] = s.w[i] > 0 ? sum : make(0, 0, 0);
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
