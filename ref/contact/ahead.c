/* SPDX-License-Identifier: Apache-2.0 */
/* Takes the contacts with led sides where the step ends, not where it starts.
 * spec/contact/ahead.md */
#include "ref/contact/incidence.h"
#include "ref/contact/proximity.h"

static bool all_valid(int64_t n, const struct contact *c, int64_t nv)
{
    for (int64_t k = 0; k < n; k++)
        if (!pair_valid(c[k].v, nv))
            return false;
    return true;
}

static int check(const struct ahead *s)
{
    bool fits = s->nv1 == s->nv + 1 && s->n4 == 4 * s->n &&
                s->n_all == s->n + s->n_new && s->n_all <= INT32_MAX / 4;
    return s->dt > 0 && fits && all_valid(s->n, s->before, s->nv) &&
                   all_valid(s->n_new, s->after, s->nv)
               ? DRAPE_OK
               : DRAPE_EARG;
}

static bool is_led(const struct ahead *s, const struct contact *c)
{
    return led_side((int)c->kind, c->v, s->w) < SIDES;
}

/* Whether a vertex that contact c moves met something on the way. */
static bool has_met(const struct ahead *s, const struct contact *c)
{
    bool met = false;
    for (int j = 0; j < 4; j++)
        met |= c->c[j] != 0 && s->met[c->v[j]];
    return met;
}

/* §2: how high over led surfaces vertex i is to end. */
static void find_height(struct ahead *s, int64_t i)
{
    real sum = 0, all = 0;
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        const struct contact *c = &s->before[s->item[k] / 4];
        bool led = is_led(s, c);
        real part = led ? real_abs(c->c[s->item[k] % 4]) : 0;
        sum += part * (c->gap + s->dt * c->target);
        all += part;
    }
    s->height[i] = all > 0 ? real_max(sum / all, 0) : -1;
}

/* §2: how far apart the sides of contact c are to end. */
static real height_of(const struct ahead *s, const struct contact *c)
{
    real thickness = skin_pair(&s->skin, c->v).thickness, sum = 0, all = 0;
    for (int j = 0; j < 4; j++) {
        int32_t i = c->v[j];
        if (!(s->w[i] > 0) || c->c[j] == 0)
            continue;
        real part = real_abs(c->c[j]);
        sum += part * (s->height[i] < 0 ? thickness : s->height[i]);
        all += part;
    }
    return real_min(sum / all, thickness);
}

/* §1: whether contact k of both lists stays; those at the start come first. */
static bool stays(const struct ahead *s, int64_t k)
{
    if (k < s->n)
        return !is_led(s, &s->before[k]) || has_met(s, &s->before[k]);
    return is_led(s, &s->after[k - s->n]) && !has_met(s, &s->after[k - s->n]);
}

/* §2: contact k, with its gap at the start and the target that it then has. */
static struct contact contact_of(const struct ahead *s, int64_t k)
{
    struct contact c = k < s->n ? s->before[k] : s->after[k - s->n];
    if (k >= s->n) {
        real way = s->dt * vec_dot(c.n, pair_sum(c.v, c.c, s->u));
        c.gap = c.gap - way;
        c.target = (height_of(s, &c) - c.gap) / s->dt;
    }
    c.held = 0;
    c.impulse = c.slide = c.along = 0;
    c.tangent = vec_make(0, 0, 0);
    return c;
}

int ref_ahead(struct ahead *s)
{
    int status = check(s);
    if (status != DRAPE_OK)
        return status;
    struct incidence by = {s->nv,    s->n,    s->w,      s->before,
                           s->start, s->item, s->vertex, 0};
    ref_incidence(&by);
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        find_height(s, i);
    s->found = 0;
    for (int64_t k = 0; k < s->n_all; k++)
        s->at[k] = stays(s, k) ? (int32_t)s->found++ : -1;
    EACH_ITEM
    for (int64_t k = 0; k < s->n_all; k++)
        if (s->at[k] >= 0)
            s->contact[s->at[k]] = contact_of(s, k);
    return DRAPE_OK;
}
