/* SPDX-License-Identifier: Apache-2.0 */
/* Mass-splitting projected Jacobi (Tonge et al. 2012). spec/34_contacts.md */
#include "ref/contacts.h"

#include "ref/incidence.h"

/* §2: into how many parts vertex i is split: its contacts that act now. */
static void split(struct contacts *s, int32_t i)
{
    int32_t parts = 0;
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++)
        parts += s->lack[s->item[k] / 4] != 0;
    s->parts[i] = parts;
}

/* §2: the mass that contact k moves when its vertices are split. */
static real effective_mass(const struct contacts *s, const struct contact *c)
{
    real sum = 0, most = 0;
    for (int k = 0; k < 4; k++) {
        int32_t i = c->v[k];
        if (c->c[k] == 0 || !(s->w[i] > 0))
            continue;
        real w = (real)s->parts[i] * s->w[i];
        sum += c->c[k] * c->c[k] * w;
        most = real_max(w, most);
    }
    sum = real_max(sum, R(0x1p-12) * most);
    return sum > 0 ? 1 / sum : 0;
}

/* §3: what contact k lacks, or has too much of and can give back. */
static void find_lack(struct contacts *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    real lack = c->target - vec_dot(c->n, pair_sum(c->v, c->c, s->u));
    s->lack[k] = lack > 0 || c->impulse > 0 ? lack : 0;
}

/* §3: the normal part of one iteration. */
static void push_normal(struct contacts *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    s->push[k] = vec_make(0, 0, 0);
    if (s->lack[k] == 0)
        return;
    real next = real_max(c->impulse + effective_mass(s, c) * s->lack[k], 0);
    s->push[k] = vec_scale(next - c->impulse, c->n);
    c->impulse = next;
}

/* §4: who can have friction acts, the same ones in all iterations. */
static void find_friction(struct contacts *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    s->lack[k] = c->impulse > 0 || vec_dot(c->tangent, c->tangent) > 0;
}

/* §4: the tangential part, within the cone. */
static void push_tangent(struct contacts *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    s->push[k] = vec_make(0, 0, 0);
    if (s->lack[k] == 0)
        return;
    vec u = pair_sum(c->v, c->c, s->u);
    u = vec_axpy(u, -vec_dot(c->n, u), c->n);
    vec next = vec_axpy(c->tangent, -effective_mass(s, c), u);
    real most = c->friction * c->impulse, length = vec_length(next);
    if (length > most)
        next = vec_scale(most / length, next);
    s->push[k] = vec_sub(next, c->tangent);
    c->tangent = next;
}

static vec total(const struct contact *c)
{
    return vec_axpy(c->tangent, c->impulse, c->n);
}

/* Σ c · push of the contacts of a vertex, in their order. */
static vec gather(const struct contacts *s, int32_t i)
{
    vec sum = vec_make(0, 0, 0);
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        int32_t item = s->item[k];
        sum =
            vec_axpy(sum, s->contact[item / 4].c[item % 4], s->push[item / 4]);
    }
    return sum;
}

static void apply(const struct contacts *s, vec *u)
{
    EACH_ITEM
    for (int64_t k = 0; k < s->vertices; k++) {
        int32_t i = s->vertex[k];
        u[i] = vec_axpy(u[i], s->w[i], gather(s, i));
    }
}

static void each_contact(struct contacts *s,
                         void act(struct contacts *, int64_t))
{
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        act(s, k);
}

static void split_all(struct contacts *s)
{
    EACH_ITEM
    for (int64_t k = 0; k < s->vertices; k++)
        split(s, s->vertex[k]);
}

static void begin(struct contacts *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    if (!s->warm) {
        c->impulse = 0;
        c->tangent = vec_make(0, 0, 0);
    }
    s->before[k] = total(c);
}

static void end(struct contacts *s, int64_t k)
{
    s->push[k] = vec_sub(total(&s->contact[k]), s->before[k]);
}

int ref_contacts(struct contacts *s)
{
    if (s->iterations < 0 || s->nv1 != s->nv + 1 || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX)
        return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->contact[k].v, s->nv))
            return DRAPE_EARG;

    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    ref_incidence(&by); /* §1 */
    s->vertices = by.vertices;
    each_contact(s, begin);
    for (int t = 0; t < s->iterations; t++) {
        each_contact(s, find_lack);
        split_all(s);
        each_contact(s, push_normal);
        apply(s, s->u);
    }
    each_contact(s, find_friction);
    split_all(s);
    for (int t = 0; t < s->iterations; t++) {
        each_contact(s, push_tangent);
        apply(s, s->u);
    }
    each_contact(s, end); /* the same impulses, all at once, on v */
    apply(s, s->v);
    return DRAPE_OK;
}
