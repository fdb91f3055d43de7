/* SPDX-License-Identifier: Apache-2.0 */
/* Solves contacts with friction by projected Jacobi with mass splitting (Tonge
 * et al. 2012) and momentum (Nesterov 1983). spec/contact/contacts.md */
#include "ref/contact/contacts.h"

#include "ref/contact/incidence.h"

/* §1: waking. A sleeping contact would do nothing, so it is skipped. */

/* Wakes contact k and its vertices. */
static void wake_contact(struct contacts *s, int64_t k)
{
    const int32_t *v = s->contact[k].v;
    s->contact_awake[k] = AWAKE;
    for (int j = 0; j < 4; j++)
        if (s->vertex_awake[v[j]] == ASLEEP)
            s->vertex_awake[v[j]] = AWAKE;
}

/* Wakes the contacts that act. */
static void wake_acting(struct contacts *s)
{
    for (int64_t k = 0; k < s->n; k++)
        if (s->lack[k] != 0 && !s->contact_awake[k])
            wake_contact(s, k);
}

/* Wakes all contacts of vertex i. */
static void wake_around(struct contacts *s, int32_t i)
{
    s->vertex_awake[i] = SPREAD;
    for (int32_t j = s->start[i]; j < s->start[i + 1]; j++)
        if (!s->contact_awake[s->item[j] / 4])
            wake_contact(s, s->item[j] / 4);
}

/* Wakes all contacts of the vertices pushed so far. */
static void spread_waking(struct contacts *s)
{
    for (int64_t k = 0; k < s->vertices; k++)
        if (s->moved[k] && s->vertex_awake[s->vertex[k]] != SPREAD)
            wake_around(s, s->vertex[k]);
}

/* Work of one contact */

/* §2: the mass that contact c feels: 1/a, of its vertices' parts. */
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

static vec total_impulse(const struct contact *c)
{
    return vec_axpy(c->tangent, c->impulse, c->n);
}

/* §3: lack of contact k where it acts: it lacks speed, or has a surplus and an
 * impulse that it can reduce. Else 0. */
static void find_lack(struct contacts *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    real lack = c->target - vec_dot(c->n, pair_sum(c->v, c->c, s->u));
    s->lack[k] = lack > 0 || s->lookahead[k] > 0 ? lack : 0;
}

static void begin_contact(struct contacts *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    if (!s->warm) {
        c->impulse = 0;
        c->tangent = vec_make(0, 0, 0);
    }
    s->contact_awake[k] = ASLEEP;
    s->lookahead[k] = c->impulse;
    s->before[k] = total_impulse(c);
    s->push[k] = vec_make(0, 0, 0);
    find_lack(s, k);
}

/* §3: changes y of contact k, and records the push that takes u along. */
static void set_lookahead(struct contacts *s, int64_t k, real y)
{
    s->push[k] = vec_scale(y - s->lookahead[k], s->contact[k].n);
    s->lookahead[k] = y;
}

/* §3: the normal part of one iteration. */
static void push_normal(struct contacts *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    real y = s->lookahead[k], was = c->impulse;
    c->impulse = y;
    if (s->lack[k] != 0)
        c->impulse = real_max(y + effective_mass(s, c) * s->lack[k], 0);
    set_lookahead(s, k, real_max(c->impulse + s->keep * (c->impulse - was), 0));
}

/* §3: a void iteration: y is moved back towards λ. */
static void shrink_lookahead(struct contacts *s, int64_t k)
{
    real now = s->contact[k].impulse;
    set_lookahead(s, k, now + s->keep * (s->lookahead[k] - now));
}

/* §4: marks the contacts that can have friction; they act in all iterations. */
static void find_friction(struct contacts *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    s->lack[k] = c->impulse > 0 || vec_dot(c->tangent, c->tangent) > 0;
}

/* §4: the tangential part of one iteration, within the friction cone. */
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

/* §4: the push of this whole call, for v. */
static void find_total(struct contacts *s, int64_t k)
{
    s->push[k] = vec_sub(total_impulse(&s->contact[k]), s->before[k]);
}

/* Work of one vertex */

/* §3: the first d: 0, as no contact acts yet; 1 for a vertex of one contact. */
static void first_parts(struct contacts *s, int32_t i)
{
    s->parts[i] = s->start[i + 1] - s->start[i] == 1;
}

/* §3: counts the contacts that act on vertex i. True if they are so many that
 * the iteration is void. */
static bool count_acting(struct contacts *s, int32_t i, real beta)
{
    int32_t acting = 0;
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++)
        acting += s->lack[s->item[k] / 4] != 0;
    s->acting[i] = acting;
    return s->parts[i] > 0 && beta * beta * (real)acting > (real)s->parts[i];
}

/* §3: the number d of parts into which vertex i is split. */
static void split_vertex(struct contacts *s, int32_t i)
{
    int32_t acting = s->acting[i], d = s->parts[i];
    if (s->keep == 0 || (d > 0 && d < acting))
        s->parts[i] = acting;
    else if (d == 0 && acting > 0)
        s->parts[i] = acting + 1; /* a further contact may begin to act */
}

/* Σ c · push over the contacts of a vertex, in the order of its list. */
static vec gather_pushes(const struct contacts *s, int32_t i)
{
    vec sum = vec_make(0, 0, 0);
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        int32_t item = s->item[k];
        sum =
            vec_axpy(sum, s->contact[item / 4].c[item % 4], s->push[item / 4]);
    }
    return sum;
}

/* Passes over all contacts or all vertices */

static void each_contact(struct contacts *s,
                         void act(struct contacts *, int64_t))
{
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        act(s, k);
}

static void each_awake(struct contacts *s, void act(struct contacts *, int64_t))
{
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        if (s->contact_awake[k])
            act(s, k);
}

/* Counts acting contacts of all awake vertices. True: the iteration is void. */
static bool count_all(struct contacts *s, real beta)
{
    bool over = false;
#pragma omp parallel for schedule(static) reduction(| : over)
    for (int64_t k = 0; k < s->vertices; k++)
        if (s->vertex_awake[s->vertex[k]])
            over |= count_acting(s, s->vertex[k], beta);
    return over;
}

static void split_all(struct contacts *s)
{
    EACH_ITEM
    for (int64_t k = 0; k < s->vertices; k++)
        if (s->vertex_awake[s->vertex[k]])
            split_vertex(s, s->vertex[k]);
}

/* Adds the pushes to velocities u. A vertex that is not pushed keeps its bits.
 */
static void apply_pushes(const struct contacts *s, vec *u)
{
    EACH_ITEM
    for (int64_t k = 0; k < s->vertices; k++) {
        int32_t i = s->vertex[k];
        if (!s->vertex_awake[i])
            continue;
        vec sum = gather_pushes(s, i);
        if (sum.x == 0 && sum.y == 0 && sum.z == 0)
            continue;
        u[i] = vec_axpy(u[i], s->w[i], sum);
        s->moved[k] = 1;
    }
}

/* §3: β of the iteration that is `age` iterations old. */
static real momentum_factor(int age)
{
    return (real)age / ((real)age + 3);
}

static void solve_normal(struct contacts *s)
{
    for (int t = 0, age = 0; t < s->iterations; t++) {
        real beta = momentum_factor(age);
        bool over = count_all(s, beta);
        age = over ? age / 2 : age + 1;
        s->keep = t + 1 < s->iterations ? momentum_factor(age) : 0;
        if (over)
            s->keep /= beta;
        else
            split_all(s);
        each_awake(s, over ? shrink_lookahead : push_normal);
        apply_pushes(s, s->u);
        spread_waking(s);
        each_awake(s, find_lack);
    }
}

static void solve_tangent(struct contacts *s)
{
    each_contact(s, find_friction);
    wake_acting(s);
    count_all(s, 0);
    split_all(s);
    for (int t = 0; t < s->iterations; t++) {
        each_awake(s, push_tangent);
        apply_pushes(s, s->u);
    }
}

int ref_contacts(struct contacts *s)
{
    if (s->iterations < 0 || s->nv1 != s->nv + 1 || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX)
        return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->contact[k].v, s->nv))
            return DRAPE_EARG;

    struct incidence by = {.nv = s->nv,
                           .n = s->n,
                           .w = s->w,
                           .contact = s->contact,
                           .start = s->start,
                           .item = s->item,
                           .vertex = s->vertex};
    ref_incidence(&by); /* §1 */
    s->vertices = by.vertices;
    s->keep = 0;
    memset(s->moved, 0, (size_t)s->vertices);
    memset(s->vertex_awake, ASLEEP, (size_t)s->nv);
    for (int64_t k = 0; k < s->vertices; k++)
        first_parts(s, s->vertex[k]);
    each_contact(s, begin_contact);
    wake_acting(s);
    solve_normal(s);
    solve_tangent(s);
    each_awake(s, find_total); /* v gets all impulses at once */
    apply_pushes(s, s->v);
    return DRAPE_OK;
}
