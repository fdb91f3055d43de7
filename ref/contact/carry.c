/* SPDX-License-Identifier: Apache-2.0 */
/* Multipliers go on from slice to slice by the keys of pairs.
 * spec/contact/carry.md */
#include "ref/contact/carry.h"

#include "ref/contact/impulses.h"

static bool are_valid(int64_t nv, int64_t n, const struct contact *contact)
{
    for (int64_t k = 0; k < n; k++)
        if (!pair_valid(contact[k].v, nv))
            return false;
    return true;
}

const struct kept *carry_find(const struct kept *kept, int64_t n,
                              const struct contact *c)
{
    struct key key = impulses_key(c->v, c->kind, 0);
    int64_t from = 0, end = n;
    while (from < end) {
        int64_t middle = from + (end - from) / 2;
        const struct kept *k = &kept[middle];
        if (k->hi < key.hi || (k->hi == key.hi && k->lo < key.lo))
            from = middle + 1;
        else
            end = middle;
    }
    if (from == n || kept[from].hi != key.hi || kept[from].lo != key.lo)
        return NULL;
    return &kept[from];
}

/* §1: -1 where the pair names its edges in the other order than its key. */
static real order_of(const struct contact *c, struct key key)
{
    if (c->kind == CONTACT_VF)
        return 1;
    int32_t least = c->v[0] < c->v[1] ? c->v[0] : c->v[1];
    int32_t most = c->v[0] < c->v[1] ? c->v[1] : c->v[0];
    uint64_t a = (uint64_t)(uint32_t)least << 32 | (uint32_t)most;
    return (key.hi & ~(UINT64_C(1) << 63)) == a ? 1 : -1;
}

/* §1: the multipliers of a new contact. */
static void take_over(const struct carry *s, struct contact *c)
{
    struct key key = impulses_key(c->v, c->kind, 0);
    const struct kept *k = carry_find(s->kept, s->n_kept, c);
    if (k) {
        vec t = vec_scale(order_of(c, key), k->lambda_t);
        c->lambda = k->lambda;
        c->lambda_t = vec_axpy(t, -vec_dot(c->n, t), c->n);
    }
    c->load = c->lambda;
}

/* §1.2 */
static real kappa_of(const struct carry *s, const struct contact *c,
                     real thickness)
{
    real y = 0;
    for (int j = 0; j < 4; j++)
        y += c->c[j] * c->c[j] * s->w[c->v[j]];
    real wanted =
        c->lambda > 0 ? c->lambda * s->tau / (CONTACT_GIVE * thickness) : 0;
    return y > 0 ? real_max(CARRY_KAPPA / y, real_min(wanted, s->stiffest)) : 0;
}

int ref_carry(struct carry *s)
{
    if (!(s->dt > 0 && s->tau > 0 && s->stiffest > 0) || s->n_kept < 0 ||
        !are_valid(s->nv, s->n, s->contact))
        return DRAPE_EARG;
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++) {
        struct contact *c = &s->contact[k];
        real thickness = surfaces_pair(&s->surfaces, c->v).thickness;
        real overlap = thickness - c->gap;
        c->target = (overlap > 0 ? CARRY_RISE * overlap : overlap) / s->dt;
        if (c->kappa > 0)
            continue;
        take_over(s, c);
        c->kappa = kappa_of(s, c, thickness);
    }
    return DRAPE_OK;
}

bool carry_struck(const struct retain *s, const struct contact *c)
{
    for (int side = SIDE_A; side < SIDES; side++) {
        int end = side_start((int)c->kind, side + 1);
        bool moves = false;
        real jump = 0;
        for (int j = side_start((int)c->kind, side); j < end; j++) {
            int32_t i = c->v[j];
            moves |= s->w[i] > 0;
            jump += c->c[j] * vec_dot(c->n, vec_sub(s->u[i], s->v[i]));
        }
        if (moves && real_abs(jump) > s->most)
            return true;
    }
    return false;
}

int ref_retain(struct retain *s)
{
    if (!(s->most >= 0) || !are_valid(s->nv, s->n, s->contact))
        return DRAPE_EARG;
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        struct key key = impulses_key(c->v, c->kind, 0);
        struct kept r = {key.hi, key.lo, 0, vec_make(0, 0, 0)};
        if (c->impulse > 0 && !carry_struck(s, c)) {
            r.lambda = c->impulse;
            r.lambda_t = vec_scale(order_of(c, key), c->tangent);
        }
        s->kept[k] = r;
    }
    return DRAPE_OK;
}
