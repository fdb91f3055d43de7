/* SPDX-License-Identifier: Apache-2.0 */
/* Multiplies the matrix of the contacts that are CONTACT_MUTUAL with a vector.
 * spec/contact/coulomb.md §3 */
#include "ref/contact/coulomb.h"

/* The impulse of contact c in answer to the velocities x. */
static vec answer(const struct links *s, const struct contact *c)
{
    vec v = pair_sum(c->v, c->c, s->x);
    real a = c->along, b = c->slide;
    vec y = vec_axpy(vec_scale(b, v), (a - b) * vec_dot(c->n, v), c->n);
    return vec_axpy(y, -b * vec_dot(c->way, v), c->way);
}

int ref_links(struct links *s)
{
    if (s->nv1 != s->nv + 1 || s->n4 != 4 * s->n || s->n4 > INT32_MAX)
        return DRAPE_EARG;
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        s->push[k] = s->contact[k].held == CONTACT_MUTUAL
                         ? answer(s, &s->contact[k])
                         : vec_make(0, 0, 0);
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
            int32_t at = s->item[k] / 4, j = s->item[k] % 4;
            s->y[i] = vec_axpy(s->y[i], s->contact[at].c[j], s->push[at]);
        }
    return DRAPE_OK;
}
