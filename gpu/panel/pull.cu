/* SPDX-License-Identifier: Apache-2.0 */
/* Adds to the force on each particle what the fibres of odd cells and the stars
 * of a panel pull. spec/panel/pull.md */
#include "gpu/panel/cell.cuh"

extern "C" {
#include "ref/panel/pull.h"
}

/* From particle p to q (springs.md §6). */
static __device__ vec way_of(const struct pull *s, int p, int q)
{
    vec d = sub(s->x[q], s->x[p]);
    return s->n_u ? axpy(d, s->span, sub(s->u[q], s->u[p])) : d;
}

/* §1: the tension of a fibre, as a vector. d, v: of its cell. */
static __device__ vec tension_of(const struct pull *s, const struct fibre *a,
                                 const struct law *law, const struct beyond *d,
                                 const struct beyond *v)
{
    vec way = form_at(a, d);
    real l = length(way);
    if (!(l > 0))
        return make(0, 0, 0);
    vec along = scale(1 / l, way);
    real f = spring_tension(law, s->piece, l);
    if (s->n_v)
        f += law->damp * dot(form_at(a, v), along);
    return scale(a->weight * f, along);
}

/* §1. Thread k owns odd cell k: reads its corners and its forms, and writes
 * the push on each of its four corners. */
KERNEL pull_cells_kernel(const struct pull &s)
{
    ITEM(k, s.n_cells);
    const int32_t *corner = s.corner[k];
    struct beyond d = beyond_of(s.x, corner), v = {};
    if (s.n_u) {
        struct beyond u = beyond_of(s.u, corner);
        UNROLL
        for (int e = 0; e < 3; e++)
            d.of[e] = axpy(d.of[e], s.span, u.of[e]);
    }
    if (s.n_v)
        v = beyond_of(s.v, corner);
    vec push[3] = {};
    for (int f = 0; f < FIBRES; f++) {
        struct fibre a = s.fibre[k][f];
        if (!(a.weight > 0))
            continue;
        vec t = tension_of(&s, &a, &s.law[law_at(f)], &d, &v);
        UNROLL
        for (int e = 0; e < 3; e++)
            push[e] = axpy(push[e], -a.c[e], t);
    }
    vec *to = s.pushes + CORNERS * k;
    to[0] = sub(make(0, 0, 0), add(add(push[0], push[1]), push[2]));
    UNROLL
    for (int e = 0; e < 3; e++)
        to[e + 1] = push[e];
}

/* §2. Thread k owns particle part[k], which belongs to odd cells or stars:
 * adds to its force what they pull, in ascending order. The pushes must be
 * complete. */
KERNEL pull_kernel(const struct pull &s)
{
    ITEM(k, s.n_parts);
    int p = s.part[k];
    vec f = s.force[p];
    UNROLL
    for (int e = 0; e < 4; e++) {
        int at = s.push[k][e];
        if (at >= 0)
            f = add(f, s.pushes[at]);
    }
    UNROLL
    for (int o = 0; o < 2 * SPRINGS; o++) {
        int at = s.tie[k][o], step = forward_i(o / 2) + forward_j(o / 2) * s.m;
        if (at >= 0)
            f = axpy(f, s.bend[at], way_of(&s, p, o % 2 ? p - step : p + step));
    }
    s.force[p] = f;
}

int gpu_pull(struct gpu *g, struct pull *s)
{
    LAUNCH(g, s->n_cells, pull_cells_kernel, *s);
    LAUNCH(g, s->n_parts, pull_kernel, *s);
    return gpu_status(g);
}
