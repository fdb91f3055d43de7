/* SPDX-License-Identifier: Apache-2.0 */
/* Lists the contacts of each free vertex by a stable counting sort.
 * spec/contact/contacts.md §1 */
#include "ref/contact/incidence.h"

/* Whether the item's contact can move the item's vertex. */
static bool can_push(const struct incidence *s, int64_t item)
{
    const struct contact *c = &s->contact[item / 4];
    return c->c[item % 4] != 0 && s->w[c->v[item % 4]] > 0;
}

void ref_incidence(struct incidence *s)
{
    int32_t *start = s->start, at = 0;
    memset(start, 0, (size_t)(s->nv + 1) * sizeof *start);
    for (int64_t k = 0; k < 4 * s->n; k++)
        if (can_push(s, k))
            start[s->contact[k / 4].v[k % 4]]++;
    s->vertices = 0;
    for (int64_t i = 0; i <= s->nv; i++) {
        int32_t count = start[i];
        if (count)
            s->vertex[s->vertices++] = (int32_t)i;
        start[i] = at;
        at += count;
    }
    for (int64_t k = 0; k < 4 * s->n; k++)
        if (can_push(s, k))
            s->item[start[s->contact[k / 4].v[k % 4]]++] = (int32_t)k;
    /* filling has moved each start to the start of the next vertex */
    for (int64_t i = s->nv; i > 0; i--)
        start[i] = start[i - 1];
    start[0] = 0;
}
