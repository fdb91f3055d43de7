/* SPDX-License-Identifier: Apache-2.0 */
/* The unknowns of a slice with contacts. spec/contact/lagrange.md */
#include "ref/contact/unknowns.h"

#include "ref/base/sum.h"
#include "ref/world/state.h"

static void *take_stream(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_RESPONSE, n, size);
}

static void make_joint(struct world *w, struct joint *s)
{
    s->nc = w->nc;
    s->r = take_stream(w, w->nv, sizeof *s->r);
    s->q = take_stream(w, w->nv, sizeof *s->q);
    s->p = take_stream(w, w->nv, sizeof *s->p);
    s->dv = take_stream(w, w->nv, sizeof *s->dv);
    s->n_chunks = sum_chunks(w->nc);
    s->chunk = take_stream(w, 3 * s->n_chunks, sizeof *s->chunk);
}

int unknowns_make(struct world *w)
{
    struct lagrange *a = &w->lagrange;
    struct coulomb *s = &a->law;
    s->nv = w->nv;
    s->nc = w->nc;
    s->nv1 = w->nv + 1;
    s->w = w->w;
    s->u = w->response.u;
    s->start = w->response.start;
    s->force = take_stream(w, w->nv, sizeof *s->force);
    s->inner = take_stream(w, w->nc, sizeof *s->inner);
    s->outer = take_stream(w, w->nc, sizeof *s->outer);
    s->single = take_stream(w, w->nv, sizeof *s->single);
    a->rest = take_stream(w, w->nc, sizeof *a->rest);
    for (int k = 0; k < 2; k++)
        a->bound[k] = take_stream(w, w->nv, sizeof *a->bound[k]);
    if (w->plan.history) {
        a->jump = take_stream(w, w->nc, sizeof *a->jump);
        a->bare = take_stream(w, w->nv, sizeof *a->bare);
        a->none = take_stream(w, w->nv + 1, sizeof *a->none);
    }
    make_joint(w, &a->joint);
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

int ref_unknowns_room(struct world *w, int64_t n)
{
    struct lagrange *a = &w->lagrange;
    struct coulomb *s = &a->law;
    if (n <= a->cap)
        return DRAPE_OK;
    arena_give(w->arena, s->item);
    arena_give(w->arena, s->vertex);
    arena_give(w->arena, s->next);
    arena_give(w->arena, a->joint.links.push);
    int64_t cap = n + n / 4 + 64;
    s->item = take_stream(w, 4 * cap, sizeof *s->item);
    s->vertex = take_stream(w, 4 * cap, sizeof *s->vertex);
    s->next = take_stream(w, cap, sizeof *s->next);
    a->joint.links.push = take_stream(w, cap, sizeof(vec));
    a->cap = w->arena->failed ? 0 : cap;
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

void ref_unknowns_shift(struct gpu *on, const struct shift *s)
{
    (void)on;
    EACH_ITEM
    for (int64_t i = 0; i < s->count; i++) {
        if (!(s->w[i] > 0))
            continue;
        s->u[i] = vec_axpy(s->u[i], s->span * s->part, s->dv[i]);
        s->v[i] = vec_axpy(s->v[i], s->part, s->dv[i]);
        s->x1[i] = vec_axpy(s->x0[i], s->dt, s->u[i]);
        s->touched[i] = 1;
    }
}

/* What contacts push a particle: those that struck it, and all; and the sizes
 * of these pushes. */
struct struck {
    vec push, all;
    real part, whole;
};

static struct struck sum_struck(const struct jumps *s, int64_t i)
{
    struct struck sum = {{0, 0, 0}, {0, 0, 0}, 0, 0};
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        int64_t at = s->item[k] / 4;
        const struct contact *c = &s->contact[at];
        real weight = c->c[s->item[k] % 4];
        vec push = vec_scale(weight, vec_axpy(c->tangent, c->impulse, c->n));
        sum.all = vec_add(sum.all, push);
        if (!(c->impulse > 0))
            continue;
        real size = real_abs(weight) * c->impulse;
        sum.whole += size;
        if (s->kept[at].lambda != 0)
            continue;
        sum.part += size;
        sum.push = vec_add(sum.push, push);
    }
    return sum;
}

void ref_unknowns_jump(struct gpu *on, const struct jumps *s)
{
    (void)on;
    EACH_ITEM
    for (int64_t i = 0; i < s->count; i++) {
        struct struck sum = sum_struck(s, i);
        vec undone = vec_add(s->rest[i], sum.all);
        real part = sum.part > 0 ? sum.part / sum.whole : 0;
        s->push[i] = s->w[i] > 0 && part > 0 ? vec_axpy(sum.push, -part, undone)
                                             : vec_make(0, 0, 0);
    }
}

void ref_unknowns_lessen(struct gpu *on, int64_t n, real part, const vec *q,
                         vec *r)
{
    (void)on;
    EACH_ITEM
    for (int64_t i = 0; i < n; i++)
        r[i] = vec_axpy(r[i], -part, q[i]);
}
