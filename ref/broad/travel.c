/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the largest relative motion of the two primitives of any candidate.
 * spec/broad/travel.md */
#include "ref/broad/travel.h"

/* §1: returns the largest squared relative motion of two vertices of candidate
 * k, one vertex of either primitive, in m². */
static real relative_motion(const struct travel *s, int64_t k)
{
    const int32_t *v = s->pair + 4 * k;
    int first = s->kind[k] == CONTACT_VF ? 1 : 2; /* first vertex of the
                                                     second primitive */
    real most = 0;
    vec d[4];
    for (int j = 0; j < 4; j++)
        d[j] = vec_sub(s->x1[v[j]], s->x0[v[j]]);
    for (int a = 0; a < first; a++)
        for (int b = first; b < 4; b++) {
            vec apart = vec_sub(d[a], d[b]);
            most = real_max(most, vec_dot(apart, apart));
        }
    return most;
}

int ref_travel(struct travel *s)
{
    real most = 0;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->pair + 4 * k, s->nv) || s->kind[k] > CONTACT_EE)
            return DRAPE_EARG;
#pragma omp parallel for schedule(static) reduction(max : most)
    for (int64_t k = 0; k < s->n; k++)
        most = real_max(most, relative_motion(s, k));
    s->most = most;
    return DRAPE_OK;
}
