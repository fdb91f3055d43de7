/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of the reference for waking cloths. spec/sleep/sleep.md */
#include "ref/sleep/wake.h"

void ref_wake_find(struct gpu *on, const struct wake *s)
{
    (void)on;
    for (int64_t k = 0; k < s->n; k++) {
        uint16_t a = s->body[s->pair[k][0]], b = s->body[s->pair[k][3]];
        if (s->active[a] && !s->active[b])
            s->disturbed[b] = 1;
        if (s->active[b] && !s->active[a])
            s->disturbed[a] = 1;
    }
}

void ref_wake_mask(struct gpu *on, int64_t n, const uint16_t *body,
                   const uint8_t *awake, uint8_t *mask)
{
    (void)on;
    EACH_ITEM
    for (int64_t i = 0; i < n; i++)
        mask[i] = awake[body[i]];
}

void ref_wake_displacements(struct gpu *on, int64_t n, const uint16_t *body,
                            const vec *x0, const vec *x1, int bodies,
                            real *most)
{
    (void)on;
    memset(most, 0, (size_t)bodies * sizeof *most);
    for (int64_t i = 0; i < n; i++) {
        vec d = vec_sub(x1[i], x0[i]);
        most[body[i]] = real_max(most[body[i]], vec_dot(d, d));
    }
}
