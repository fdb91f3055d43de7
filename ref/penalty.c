/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts as the implicit system feels them. spec/38_penalty.md */
#include "ref/penalty.h"

#include "ref/incidence.h"

static int check(const struct penalty *s)
{
    if (!(s->dt > 0 && s->tau > 0 && s->stiffness > 0 && s->slip > 0) ||
        s->nv1 != s->nv + 1 || s->n4 != 4 * s->n || s->n4 > INT32_MAX)
        return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->contact[k].v, s->nv))
            return DRAPE_EARG;
    return DRAPE_OK;
}

/* §3: the weight of the side that vertex j of a contact is on. */
static real side_of(const struct penalty *s, const struct contact *c, int j)
{
    int split = c->kind == CONTACT_VF ? 1 : 2;
    int from = j < split ? 0 : split, to = j < split ? split : 4;
    real least = 0;
    for (int i = from; i < to; i++) {
        real w = s->w[c->v[i]];
        if (w > 0 && (least == 0 || w < least))
            least = w;
    }
    return least;
}

/* §1, §2: the impulse of one contact at velocities u. */
static void press(struct penalty *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    vec u = pair_sum(c->v, c->c, s->u);
    real vn = vec_dot(c->n, u);
    vec across = vec_axpy(u, -vn, c->n);
    real give = s->stiffness * s->dt * s->tau;
    c->impulse = real_max(give * (c->target - vn), 0);
    s->slide[k] =
        c->friction * c->impulse / real_max(vec_length(across), s->slip);
    c->tangent = vec_scale(-s->slide[k], across);
    real share = 0;
    for (int j = 0; j < 4; j++)
        if (s->w[c->v[j]] > 0)
            share += real_abs(c->c[j]) * side_of(s, c, j);
    s->share[k] = share;
}

/* §3: what contact k adds to the hold of its vertex j. */
static sym hold_of(const struct penalty *s, int64_t k, int j)
{
    const struct contact *a = &s->contact[k];
    real part = s->share[k] / side_of(s, a, j) * real_abs(a->c[j]);
    real along = a->impulse > 0 ? part * s->stiffness * s->tau * s->tau : 0;
    real across = part * s->slide[k] * (s->tau / s->dt);
    real d = along - across;
    vec n = a->n;
    sym r = {d * n.x * n.x + across, d * n.x * n.y, d * n.x * n.z,
             d * n.y * n.y + across, d * n.y * n.z, d * n.z * n.z + across};
    return r;
}

static void gather(const struct penalty *s, int32_t i)
{
    vec force = vec_make(0, 0, 0);
    sym hold = {0, 0, 0, 0, 0, 0};
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        int64_t at = s->item[k] / 4;
        const struct contact *c = &s->contact[at];
        real weight = c->c[s->item[k] % 4];
        vec push = vec_axpy(c->tangent, c->impulse, c->n);
        force = vec_axpy(force, weight, push);
        hold = sym_add(hold, hold_of(s, at, s->item[k] % 4));
    }
    s->force[i] = force;
    s->hold[i] = hold;
}

int ref_penalty(struct penalty *s)
{
    int status = check(s);
    if (status != DRAPE_OK)
        return status;
    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    ref_incidence(&by);
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        press(s, k);
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        gather(s, (int32_t)i);
    return DRAPE_OK;
}
