/* SPDX-License-Identifier: Apache-2.0 */
/* Stage ahead: generator and properties. spec/contact/ahead.md */
#include "ref/contact/proximity.h"

#include "tests/base/choices.h"

const struct field fields_ahead[] = {IN(ahead, w, nv, 1),
                                     IN(ahead, skin.of, nv, 1),
                                     IN(ahead, u, nv, 1),
                                     IN(ahead, skin.surface, skin.n, 1),
                                     IN(ahead, met, nv, 1),
                                     IN(ahead, before, n, 1),
                                     IN(ahead, after, n_new, 1),
                                     SCRATCH(ahead, start, nv1, 1),
                                     SCRATCH(ahead, item, n4, 1),
                                     SCRATCH(ahead, vertex, n4, 1),
                                     SCRATCH(ahead, height, nv, 1),
                                     SCRATCH(ahead, at, n_all, 1),
                                     OUT_USED(ahead, contact, n_all, 1, found),
                                     OUT_VALUE(ahead, found),
                                     FIELD_END};

/* Contacts of random vertices, as proximity makes them. */
static struct contact *pick_contacts(struct bytes *b, int64_t nv, int64_t n)
{
    struct contact *list = take(b, n, sizeof *list);
    for (int64_t k = 0; k < n; k++) {
        struct contact *c = &list[k];
        pick_four(b, nv, c->v);
        c->kind = (int32_t)pick(b, 2);
        int split = c->kind == CONTACT_VF ? 1 : 2;
        real a = (real)pick(b, 5) / 4, d = (real)pick(b, 3) / 4;
        c->c[0] = split == 1 ? 1 : a;
        c->c[1] = split == 1 ? -a / 2 : 1 - a;
        c->c[2] = split == 1 ? -d / 2 : -d;
        c->c[3] = split == 1 ? a / 2 + d / 2 - 1 : d - 1;
        c->n = pick(b, 2) ? vec_make(0, 1, 0)
                          : vec_make(R(0.6), 0, pick(b, 2) ? R(0.8) : R(-0.8));
        c->gap = pick_uniform(b, 0, R(0.01));
        c->target = pick_uniform(b, 0, R(0.1));
        c->friction = R(0.5);
        c->held = (int32_t)pick(b, 3);
        c->along = c->slide = c->impulse = (real)pick(b, 3);
        c->tangent = pick_vec(b, 1);
    }
    return list;
}

void gen_ahead(struct bytes *b, struct ahead *s)
{
    s->n = for_bench(b) ? 1 << 16 : pick_size(b);
    s->n_new = for_bench(b) ? 1 << 16 : pick_size(b);
    s->nv = for_bench(b) ? 1 << 16 : 4 + (s->n + s->n_new) / 2;
    s->nv1 = s->nv + 1;
    s->n4 = 4 * s->n;
    s->n_all = s->n + s->n_new;
    s->dt = R(1.0) / 60;
    s->skin.n = 2;
    real *w = take(b, s->nv, sizeof *w);
    uint16_t *of = take(b, s->nv, sizeof *of);
    uint8_t *met = take(b, s->nv, 1);
    vec *u = take(b, s->nv, sizeof *u);
    struct surface *surface = take(b, 2, sizeof *surface);
    surface[0] = (struct surface){R(0.01), R(0.5)};
    surface[1] = (struct surface){R(0.005), R(0.5)};
    for (int64_t i = 0; i < s->nv; i++) {
        w[i] = pick(b, 2) ? real_abs(pick_real(b, 1000)) : 0;
        of[i] = (uint16_t)pick(b, 2);
        met[i] = pick(b, 8) == 0;
        u[i] = pick_vec(b, 1);
    }
    s->w = w;
    s->skin.of = of;
    s->skin.surface = surface;
    s->met = met;
    s->u = u;
    s->before = pick_contacts(b, s->nv, s->n);
    s->after = pick_contacts(b, s->nv, s->n_new);
}

/* Whether the vertices of a contact from place `from` to `to` are led. */
static bool led_from(const struct ahead *s, const struct contact *c, int from,
                     int to)
{
    bool led = true;
    for (int j = from; j < to; j++)
        led &= !(s->w[c->v[j]] > 0);
    return led;
}

static bool is_led(const struct ahead *s, const struct contact *c)
{
    int split = c->kind == CONTACT_VF ? 1 : 2;
    return led_from(s, c, 0, split) || led_from(s, c, split, 4);
}

static bool has_met(const struct ahead *s, const struct contact *c)
{
    for (int j = 0; j < 4; j++)
        if (s->met[c->v[j]] && c->c[j] != 0)
            return true;
    return false;
}

/* §2: the height at which vertex i is to end, by looking at all contacts; < 0:
 * it is not known. */
static double height_of(const struct ahead *s, int32_t i)
{
    double sum = 0, all = 0;
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->before[k];
        for (int j = 0; j < 4 && is_led(s, c); j++)
            if (c->v[j] == i && s->w[i] > 0) {
                double part = fabs((double)c->c[j]);
                sum +=
                    part * ((double)c->gap + (double)s->dt * (double)c->target);
                all += part;
            }
    }
    return all > 0 ? sum / all : -1;
}

/* §2: whether new contact c, made of `from`, ends as high as it should. */
static const char *check_end(const struct ahead *s, const struct contact *c,
                             const struct contact *from)
{
    double thick = (double)skin_pair(&s->skin, c->v).thickness;
    double sum = 0, all = 0, dt = (double)s->dt;
    for (int j = 0; j < 4; j++) {
        if (!(s->w[c->v[j]] > 0) || c->c[j] == 0)
            continue;
        double height = height_of(s, c->v[j]), part = fabs((double)c->c[j]);
        sum += part * (height < 0 ? thick : height);
        all += part;
    }
    double slip = (double)vec_dot(c->n, pair_sum(c->v, c->c, s->u));
    /* All terms are below 1/8 m; a sum of four, a product and two more sums err
     * by eight roundings of them. */
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    EXPECT(fabs((double)c->gap + dt * slip - (double)from->gap) < unit);
    double end = (double)c->gap + dt * (double)c->target;
    EXPECT(!(all > 0) || fabs(end - fmin(sum / all, thick)) < unit);
    return NULL;
}

const char *prop_ahead(const struct ahead *s)
{
    int64_t at = 0;
    for (int64_t k = 0; k < s->n_all && s->n_all < 300; k++) {
        const struct contact *from =
            k < s->n ? &s->before[k] : &s->after[k - s->n];
        bool moves = is_led(s, from) && !has_met(s, from);
        bool led = is_led(s, from);
        if (k < s->n ? led && moves : !moves)
            continue;
        EXPECT(at < s->found);
        const struct contact *c = &s->contact[at++];
        EXPECT(!memcmp(c->v, from->v, sizeof c->v) && c->kind == from->kind);
        EXPECT(!memcmp(c->c, from->c, sizeof c->c));
        EXPECT(c->held == 0 && c->along == 0 && c->slide == 0);
        EXPECT(c->impulse == 0 && vec_dot(c->tangent, c->tangent) == 0);
        if (k < s->n)
            EXPECT(c->gap == from->gap && c->target == from->target);
        const char *failed = k < s->n ? NULL : check_end(s, c, from);
        if (failed)
            return failed;
    }
    EXPECT(at == s->found || s->n_all >= 300);
    return NULL;
}
