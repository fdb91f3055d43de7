/* SPDX-License-Identifier: Apache-2.0 */
/* Stages coulomb and links: the impulses of contacts at given velocities, their
 * matrix, and this matrix times a vector. spec/contact/coulomb.md */
#include "ref/contact/coulomb.h"

#include "ref/contact/incidence.h"

static int check_input(const struct coulomb *s)
{
    if (!(s->dt > 0 && s->tau > 0 && s->give >= 0 && s->reach >= 0 &&
          s->stiffest > 0) ||
        s->nc > s->nv || s->nv1 != s->nv + 1 || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX || s->seams < 0 || s->seams > s->n || s->hinges < 0 ||
        s->hinges > s->seams)
        return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->contact[k].v, s->nv))
            return DRAPE_EARG;
    return DRAPE_OK;
}

/* A vector cut to the length `most`. */
static vec cut_length(vec a, real most)
{
    real size = vec_length(a);
    return size > most ? vec_scale(most / size, a) : a;
}

/* §1: the compliance of contact c, 1/kg. */
static real give_of(const struct coulomb *s, const struct contact *c)
{
    return s->give * real_min(real_max(c->gap, 0), s->reach);
}

/* §1: the normal impulse by multiplier lambda, where the contact lacks so much
 * of its target velocity. */
static real push_of(const struct coulomb *s, const struct contact *c,
                    real lambda, real lack)
{
    return real_max((lambda + c->kappa * lack) / (1 + c->kappa * give_of(s, c)),
                    0);
}

/* §2: z of contact c by multiplier lambda_t, without the part along n that
 * rounding left. */
static vec drag_of(const struct contact *c, vec lambda_t, vec slip)
{
    vec z = vec_axpy(lambda_t, -c->kappa, slip);
    return vec_axpy(z, -vec_dot(c->n, z), c->n);
}

/* §3.2: whether contact c moves one vertex alone, so that its matrix is a
 * block. */
static bool is_single(const struct coulomb *s, const struct contact *c)
{
    int moving = 0;
    for (int j = 0; j < 4; j++)
        moving += s->w[c->v[j]] > 0 && c->c[j] != 0;
    return moving == 1;
}

/* §2.3: the impulses that the call before found become the multipliers. Where λ
 * rises as much as before, κ is too small. */
static void renew_multipliers(const struct coulomb *s, struct contact *c)
{
    real rise = c->impulse - c->lambda;
    bool steady =
        c->lambda > 0 && c->rise > 0 && rise > COULOMB_STEADY * c->rise;
    if (steady && c->kappa < s->stiffest)
        c->kappa = real_min(COULOMB_GROWTH * c->kappa, s->stiffest);
    c->rise = rise;
    c->lambda = c->load = c->impulse;
    c->lambda_t = cut_length(c->tangent, c->friction * c->impulse);
}

/* seam.md §2, §6: pull and matrix of contact k, a point or a hinge of a seam.
 */
static void evaluate_seam(const struct coulomb *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    bool hinge = k >= s->n - s->hinges;
    if (s->renews && !hinge)
        c->lambda_t = c->tangent;
    vec lack =
        vec_scale(s->dt / s->tau, vec_sub(c->n, pair_sum(c->v, c->c, s->u)));
    vec z = vec_axpy(c->lambda_t, c->kappa, lack);
    real size = vec_length(z);
    bool yields = c->load > 0 && size > c->load;
    c->tangent = yields ? vec_scale(c->load / size, z) : z;
    c->stiffness_n = c->stiffness_t =
        yields ? c->kappa * (c->load / size) : c->kappa;
    c->way = yields ? vec_scale(1 / size, z) : vec_make(0, 0, 0);
    c->coupling = !(c->kappa > 0)   ? CONTACT_APART
                  : is_single(s, c) ? CONTACT_SINGLE
                                    : CONTACT_MUTUAL;
    vec next = hinge ? z : vec_axpy(c->tangent, c->kappa, lack);
    s->next[k] = c->load > 0 ? cut_length(next, c->load) : next;
}

/* §1, §2, §3.1: impulses and matrix of contact k. */
static void evaluate_contact(const struct coulomb *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    if (k >= s->n - s->seams) {
        evaluate_seam(s, k);
        return;
    }
    if (s->renews)
        renew_multipliers(s, c);
    vec v = vec_scale(s->dt / s->tau, pair_sum(c->v, c->c, s->u));
    real along = vec_dot(c->n, v);
    real lack = c->target * (s->dt / s->tau) - along;
    vec slip = vec_axpy(v, -along, c->n);
    vec z = drag_of(c, c->lambda_t, slip);
    c->impulse = push_of(s, c, c->lambda, lack);
    if (s->closes)
        c->load = c->impulse;
    real most = c->friction * c->load, size = vec_length(z);
    bool slides = size > most;
    c->tangent = slides ? vec_scale(most / size, z) : z;
    c->stiffness_n =
        c->impulse > 0 ? c->kappa / (1 + c->kappa * give_of(s, c)) : 0;
    c->stiffness_t = slides     ? c->kappa * (most / size)
                     : most > 0 ? c->kappa
                                : 0;
    c->way = slides ? vec_scale(1 / size, z) : vec_make(0, 0, 0);
    c->coupling = !(c->stiffness_n > 0 || c->stiffness_t > 0) ? CONTACT_APART
                  : is_single(s, c)                           ? CONTACT_SINGLE
                                                              : CONTACT_MUTUAL;
    /* §2.2: the impulse by renewed multipliers, for outer */
    real load = c->impulse, next = push_of(s, c, load, lack);
    vec drag = cut_length(c->tangent, c->friction * load);
    drag = cut_length(drag_of(c, drag, slip), c->friction * load);
    s->next[k] = vec_axpy(drag, next, c->n);
}

/* §3.2: the smallest inverse mass of the free vertices of vertex j's side. */
static real side_of(const struct coulomb *s, const struct contact *c, int j)
{
    int split = side_start((int)c->kind, SIDE_B);
    int from = j < split ? 0 : split, end = j < split ? split : 4;
    real least = 0;
    for (int i = from; i < end; i++) {
        real w = s->w[c->v[i]];
        if (w > 0 && (least == 0 || w < least))
            least = w;
    }
    return least;
}

/* §3.2: S/w_j·|c_j|, the factor of contact c in the bound of its vertex j. */
static real part_of(const struct coulomb *s, const struct contact *c, int j)
{
    real sum = 0;
    for (int i = 0; i < 4; i++)
        if (s->w[c->v[i]] > 0)
            sum += real_abs(c->c[i]) * side_of(s, c, i);
    return sum / side_of(s, c, j) * real_abs(c->c[j]);
}

/* §3.2: the part of contact c in the bound of its vertex j. */
static sym bound_of(const struct coulomb *s, const struct contact *c, int j)
{
    real part = part_of(s, c, j);
    real across = part * c->stiffness_t, d = part * c->stiffness_n - across;
    vec n = c->n, z = c->way;
    sym r = {d * n.x * n.x + across - across * z.x * z.x,
             d * n.x * n.y - across * z.x * z.y,
             d * n.x * n.z - across * z.x * z.z,
             d * n.y * n.y + across - across * z.y * z.y,
             d * n.y * n.z - across * z.y * z.z,
             d * n.z * n.z + across - across * z.z * z.z};
    return r;
}

/* The sums over the contacts of vertex i. */
static void gather_vertex(const struct coulomb *s, int64_t i)
{
    vec force = vec_make(0, 0, 0), all = force, next = force, none = force;
    int64_t contacts = s->n - s->seams;
    sym sum[2] = {{0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 0}};
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        int64_t at = s->item[k] / 4;
        const struct contact *c = &s->contact[at];
        int j = s->item[k] % 4;
        vec push = vec_axpy(c->tangent, c->impulse, c->n);
        all = vec_axpy(all, c->c[j], push);
        if (at < contacts)
            force = vec_axpy(force, c->c[j], push);
        next = vec_axpy(next, c->c[j], s->next[at]);
        bool knit = at >= contacts && s->knits;
        if (!c->coupling || (knit && c->coupling == CONTACT_MUTUAL))
            continue;
        sym *to = &sum[c->coupling == CONTACT_SINGLE];
        *to = sym_add(*to, bound_of(s, c, j));
    }
    s->force[i] = force;
    s->single[i] = sum[1];
    s->bound[i] = sym_add(sum[0], sum[1]);
    if (i >= s->nc)
        return;
    bool free = s->w[i] > 0;
    s->inner[i] = free ? vec_add(s->rest[i], all) : none;
    s->outer[i] = free ? vec_add(s->rest[i], next) : none;
}

int ref_coulomb(struct coulomb *s)
{
    int status = check_input(s);
    if (status != DRAPE_OK)
        return status;
    struct incidence by = {.nv = s->nv,
                           .n = s->n,
                           .w = s->w,
                           .contact = s->contact,
                           .start = s->start,
                           .item = s->item,
                           .vertex = s->vertex};
    if (s->lists)
        ref_incidence(&by);
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        evaluate_contact(s, k);
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        gather_vertex(s, i);
    return DRAPE_OK;
}

/* §3.1: the impulse of contact c in answer to the velocities x. */
static vec answer_velocities(const struct links *s, const struct contact *c)
{
    vec v = pair_sum(c->v, c->c, s->x);
    real a = c->stiffness_n, b = c->stiffness_t;
    vec y = vec_axpy(vec_scale(b, v), (a - b) * vec_dot(c->n, v), c->n);
    return vec_axpy(y, -b * vec_dot(c->way, v), c->way);
}

int ref_links(struct links *s)
{
    if (s->nv1 != s->nv + 1 || s->n4 != 4 * s->n || s->n4 > INT32_MAX)
        return DRAPE_EARG;
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        s->push[k] = s->contact[k].coupling == CONTACT_MUTUAL
                         ? answer_velocities(s, &s->contact[k])
                         : vec_make(0, 0, 0);
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
            int32_t at = s->item[k] / 4, j = s->item[k] % 4;
            s->y[i] = vec_axpy(s->y[i], s->contact[at].c[j], s->push[at]);
        }
    return DRAPE_OK;
}
