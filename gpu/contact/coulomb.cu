/* SPDX-License-Identifier: Apache-2.0 */
/* The impulses of contacts at given velocities, and their matrix, on the
 * device: one kernel evaluates each contact, one writes what each item of a
 * vertex adds to its sums, and one gathers these sums. spec/contact/coulomb.md
 */
#include "gpu/contact/incidence.cuh"
#include "gpu/contact/lists.cuh"

extern "C" {
#include "gpu/contact/queue.h"
#include "ref/contact/coulomb.h"
}

/* An item adds PARTS numbers to its vertex: PUSHES of force, as many of the
 * force by renewed multipliers, and BOUND_NUMBERS of bound, which are also
 * those of single where the contact is CONTACT_SINGLE. In the gather a block
 * owns GROUP vertices, a warp one number of each of them. */
enum {
    PUSHES = 3,
    BOUND_NUMBERS = 6,
    PARTS = 2 * PUSHES + BOUND_NUMBERS,
    GROUP = 32
};
enum { GROUP_BLOCK = PARTS * GROUP };

/* A vector cut to the length `most`. */
static __device__ vec cut_length(vec a, real most)
{
    real size = length(a);
    return size > most ? scale(most / size, a) : a;
}

/* §1: the compliance of contact c, 1/kg. */
static __device__ real give_of(const struct coulomb *s, const struct contact *c)
{
    return s->give * min_of(max_of(c->gap, R(0.0)), s->reach);
}

/* §1: the normal impulse by multiplier lambda of contact c, which lacks so much
 * of its target velocity. */
static __device__ real push_of(const struct coulomb *s, const struct contact *c,
                               real lambda, real lack)
{
    real push = (lambda + c->kappa * lack) / (1 + c->kappa * give_of(s, c));
    return max_of(push, R(0.0));
}

/* §2: z of contact c by multiplier lambda_t, without the part along n that
 * rounding left. */
static __device__ vec drag_of(const struct contact *c, vec lambda_t, vec slip)
{
    vec z = axpy(lambda_t, -c->kappa, slip);
    return axpy(z, -dot(c->n, z), c->n);
}

/* §3.2: whether contact c moves one vertex alone. */
static __device__ bool is_single(const struct coulomb *s,
                                 const struct contact *c)
{
    int moving = 0;
    for (int j = 0; j < 4; j++)
        moving += s->w[c->v[j]] > 0 && c->c[j] != 0;
    return moving == 1;
}

/* §2.3: the impulses that the call before found become the multipliers. */
static __device__ void renew_multipliers(const struct coulomb *s,
                                         struct contact *c)
{
    real rise = c->impulse - c->lambda;
    bool steady =
        c->lambda > 0 && c->rise > 0 && rise > COULOMB_STEADY * c->rise;
    if (steady && c->kappa < s->stiffest)
        c->kappa = min_of(COULOMB_GROWTH * c->kappa, s->stiffest);
    c->rise = rise;
    c->lambda = c->load = c->impulse;
    c->lambda_t = cut_length(c->tangent, c->friction * c->impulse);
}

/* seam.md §2, §6: pull and matrix of contact k, a point or a hinge of a seam,
 * and next[k]. */
static __device__ void evaluate_seam(const struct coulomb *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    bool hinge = k >= s->n - s->hinges;
    if (s->renews && !hinge)
        c->lambda_t = c->tangent;
    vec lack = scale(s->dt / s->tau, sub(c->n, pair_sum(c, s->u)));
    vec z = axpy(c->lambda_t, c->kappa, lack);
    real size = length(z);
    bool yields = c->load > 0 && size > c->load;
    c->tangent = yields ? scale(c->load / size, z) : z;
    c->stiffness_n = c->stiffness_t =
        yields ? c->kappa * (c->load / size) : c->kappa;
    c->way = yields ? scale(1 / size, z) : make(0, 0, 0);
    c->coupling = !(c->kappa > 0)   ? CONTACT_APART
                  : is_single(s, c) ? CONTACT_SINGLE
                                    : CONTACT_MUTUAL;
    vec next = hinge ? z : axpy(c->tangent, c->kappa, lack);
    s->next[k] = c->load > 0 ? cut_length(next, c->load) : next;
}

/* §1, §2, §3.1. Thread k owns contact k: reads u of its vertices, writes its
 * impulses, its matrix and next[k]; with `renews` its multipliers, too. */
KERNEL coulomb_evaluate_kernel(const struct coulomb &s, int64_t *words)
{
    ITEM(k, s.n);
    struct contact *c = &s.contact[k];
    if (!in_range(c->v, s.nv))
        words[INCIDENCE_BAD] = 1;
    if (!in_range(c->v, s.nv) || (s.lists && words[INCIDENCE_BAD]))
        return;
    if (k >= s.n - s.seams) {
        evaluate_seam(&s, k);
        return;
    }
    if (s.renews)
        renew_multipliers(&s, c);
    vec n = c->n, v = scale(s.dt / s.tau, pair_sum(c, s.u));
    real along = dot(n, v), lack = c->target * (s.dt / s.tau) - along;
    vec slip = axpy(v, -along, n), z = drag_of(c, c->lambda_t, slip);
    c->impulse = push_of(&s, c, c->lambda, lack);
    if (s.closes)
        c->load = c->impulse;
    real most = c->friction * c->load, size = length(z);
    bool slides = size > most;
    c->tangent = slides ? scale(most / size, z) : z;
    c->stiffness_n =
        c->impulse > 0 ? c->kappa / (1 + c->kappa * give_of(&s, c)) : R(0.0);
    c->stiffness_t = slides     ? c->kappa * (most / size)
                     : most > 0 ? c->kappa
                                : R(0.0);
    c->way = slides ? scale(1 / size, z) : make(0, 0, 0);
    c->coupling = !(c->stiffness_n > 0 || c->stiffness_t > 0) ? CONTACT_APART
                  : is_single(&s, c)                          ? CONTACT_SINGLE
                                                              : CONTACT_MUTUAL;
    real load = c->impulse, next = push_of(&s, c, load, lack);
    vec drag = cut_length(c->tangent, c->friction * load);
    drag = cut_length(drag_of(c, drag, slip), c->friction * load);
    s.next[k] = axpy(drag, next, n);
}

/* §3.2: w_j of both sides: the smallest inverse masses of their free vertices;
 * 0: a side has none. */
static __device__ void find_sides(const struct coulomb *s,
                                  const struct contact *c, real side[SIDES])
{
    int split = c->kind == CONTACT_VF ? 1 : 2;
    side[SIDE_A] = side[SIDE_B] = 0;
    for (int i = 0; i < 4; i++) {
        real w = s->w[c->v[i]], *least = &side[i < split ? SIDE_A : SIDE_B];
        if (w > 0 && (*least == 0 || w < *least))
            *least = w;
    }
}

/* §3.2: S/w_j·|c_j|, the factor of contact c in the bound of its vertex j. */
static __device__ real part_of(const struct coulomb *s, const struct contact *c,
                               int j)
{
    int split = c->kind == CONTACT_VF ? 1 : 2;
    real side[SIDES], sum = 0;
    find_sides(s, c, side);
    for (int i = 0; i < 4; i++)
        if (s->w[c->v[i]] > 0)
            sum += magnitude(c->c[i]) * side[i < split ? SIDE_A : SIDE_B];
    return sum / side[j < split ? SIDE_A : SIDE_B] * magnitude(c->c[j]);
}

/* The numbers that an item adds to its vertex, and of what contact it is.
 * Number o of the item at place k is in part[o·n4 + k]. */
enum { IS_SINGLE = 1, IS_SEAM = 2 };
struct items {
    real *part;    /* [PARTS·n4] */
    uint8_t *what; /* [n4] IS_SINGLE and IS_SEAM */
};

/* §3.2: the part of contact c in the bound of its vertex j; 0 if it is apart,
 * or a seam's that multigrid knows. */
static __device__ void find_bound(const struct coulomb *s,
                                  const struct contact *c, int j, bool knit,
                                  real bound[BOUND_NUMBERS])
{
    bool held = c->coupling != CONTACT_APART &&
                !(knit && c->coupling == CONTACT_MUTUAL);
    real part = held ? part_of(s, c, j) : R(0.0);
    real across = part * c->stiffness_t, d = part * c->stiffness_n - across;
    vec n = c->n, z = c->way;
    real all[BOUND_NUMBERS] = {d * n.x * n.x + across - across * z.x * z.x,
                               d * n.x * n.y - across * z.x * z.y,
                               d * n.x * n.z - across * z.x * z.z,
                               d * n.y * n.y + across - across * z.y * z.y,
                               d * n.y * n.z - across * z.y * z.z,
                               d * n.z * n.z + across - across * z.z * z.z};
    for (int o = 0; o < BOUND_NUMBERS; o++)
        bound[o] = held ? all[o] : R(0.0);
}

/* Thread k owns place k of all lists: reads its item's contact, writes the
 * item's numbers. */
KERNEL coulomb_item_kernel(const struct coulomb &s, struct items to,
                           const int64_t *words)
{
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= s.start[s.nv])
        return;
    int32_t item = s.item[k], at = item / 4, j = item % 4;
    const struct contact *c = &s.contact[at];
    vec push = scale(c->c[j], axpy(c->tangent, c->impulse, c->n));
    vec next = scale(c->c[j], s.next[at]);
    real all[PARTS] = {push.x, push.y, push.z, next.x, next.y, next.z};
    bool seam = at >= s.n - s.seams;
    find_bound(&s, c, j, seam && s.knits, all + 2 * PUSHES);
    UNROLL
    for (int o = 0; o < PARTS; o++)
        to.part[o * s.n4 + k] = all[o];
    to.what[k] = (uint8_t)((c->coupling == CONTACT_SINGLE ? IS_SINGLE : 0) |
                           (seam ? IS_SEAM : 0));
}

/* A number of the items of all lists that is part of a force. */
struct coulomb_push {
    const real *part;
    __device__ real value(int32_t at) const { return part[at]; }
};

/* The same: x of all contacts, y of those that are no points of seams. */
struct coulomb_pushes {
    const real *part;
    const uint8_t *what;
    __device__ vec value(int32_t at) const
    {
        real a = part[at], none = 0;
        return make(a, what[at] & IS_SEAM ? none : a, 0);
    }
};

/* A number of a bound: x of MUTUAL contacts, y of SINGLE ones. No sum is -0, so
 * the zeros that the reference does not add change nothing. */
struct coulomb_bound {
    const real *part;
    const uint8_t *what;
    __device__ vec value(int32_t at) const
    {
        real a = part[at], none = 0;
        return what[at] & IS_SINGLE ? make(none, a, 0) : make(a, none, 0);
    }
};

/* The sum of list i, from `none` on. row: a warp's, [WARP] in shared memory,
 * where it sums a long list. */
template <bool BY_WARP, class LIST, class T>
static __device__ T sum_numbers(const struct coulomb *s, const LIST &list,
                                int32_t i, T none, T *row)
{
    int32_t from = s->start[i], end = s->start[i + 1];
    return BY_WARP ? sum_by_warp(list, from, end, none, row)
                   : sum_by_thread(list, from, end, none);
}

static __device__ real &number(vec *a, int64_t i, int o)
{
    return ((real *)&a[i])[o];
}

/* Writes number o of the forces of vertex i, and of inner and outer. force: the
 * part of the sum that is no seam's. */
static __device__ void put_push(const struct coulomb *s, int64_t i, int o,
                                real sum, real force)
{
    bool renewed = o >= PUSHES;
    int at = o % PUSHES;
    if (!renewed)
        number(s->force, i, at) = force;
    if (i >= s->nc)
        return;
    real rest = ((const real *)&s->rest[i])[at];
    number(renewed ? s->outer : s->inner, i, at) =
        s->w[i] > 0 ? rest + sum : R(0.0);
}

/* Writes number o of vertex i. */
template <bool BY_WARP, bool SEWN>
static __device__ void put_number(const struct coulomb *s, struct items from,
                                  int32_t i, int o, vec *row)
{
    const real *part = from.part + o * s->n4;
    if (o < 2 * PUSHES && SEWN) {
        vec sum = sum_numbers<BY_WARP>(s, coulomb_pushes{part, from.what}, i,
                                       make(0, 0, 0), row);
        put_push(s, i, o, sum.x, sum.y);
        return;
    }
    if (o < 2 * PUSHES) {
        real sum =
            sum_numbers<BY_WARP>(s, coulomb_push{part}, i, R(0.0), &row->x);
        put_push(s, i, o, sum, sum);
        return;
    }
    vec sum = sum_numbers<BY_WARP>(s, coulomb_bound{part, from.what}, i,
                                   make(0, 0, 0), row);
    ((real *)&s->single[i])[o - 2 * PUSHES] = sum.y;
    ((real *)&s->bound[i])[o - 2 * PUSHES] = sum.x + sum.y;
}

/* §3. A block owns GROUP vertices, warp o their number o: writes their force,
 * bound and single, which are 0 without contacts, inner and outer. */
template <bool SEWN>
KERNEL coulomb_gather_kernel(const struct coulomb &s, struct items from,
                             const int64_t *words)
{
    static_assert((int)GROUP == (int)WARP, "a warp sums a long list");
    __shared__ int32_t longer[GROUP];
    __shared__ vec row[PARTS][WARP];
    __shared__ int n;
    int t = (int)threadIdx.x, o = t / GROUP;
    int64_t i = (int64_t)blockIdx.x * GROUP + t % GROUP;
    bool good = i < s.nv && !words[INCIDENCE_BAD];
    if (t == 0)
        n = 0;
    __syncthreads();
    if (good && s.start[i + 1] - s.start[i] <= LIST_SHORT)
        put_number<false, SEWN>(&s, from, (int32_t)i, o, row[o]);
    else if (good && o == 0)
        longer[atomicAdd(&n, 1)] = (int32_t)i;
    __syncthreads();
    for (int l = 0; l < n; l++)
        put_number<true, SEWN>(&s, from, longer[l], o, row[o]);
}

static bool is_good(const struct coulomb *s)
{
    return s->dt > 0 && s->tau > 0 && s->give >= 0 && s->reach >= 0 &&
           s->stiffest > 0 && s->nc <= s->nv && s->nv1 == s->nv + 1 &&
           s->n4 == 4 * s->n && s->n4 <= INT32_MAX && s->seams >= 0 &&
           s->seams <= s->n && s->hinges >= 0 && s->hinges <= s->seams;
}

int gpu_coulomb_queue(struct gpu *g, struct coulomb *s, int64_t *words)
{
    if (!is_good(s))
        return DRAPE_EARG;
    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    if (s->lists)
        gpu_incidence(g, &by, words);
    struct items to = {};
    to.part = (real *)gpu_scratch(g, SLOT_STAGE, PARTS * s->n4, sizeof(real));
    to.what = (uint8_t *)gpu_scratch(g, SLOT_STAGE + 1, s->n4, 1);
    LAUNCH(g, s->n, coulomb_evaluate_kernel, *s, words);
    LAUNCH(g, s->n4, coulomb_item_kernel, *s, to, words);
    if (s->seams > 0)
        LAUNCH_PARTS(g, (s->nv + GROUP - 1) / GROUP, GROUP_BLOCK, 1,
                     coulomb_gather_kernel<true>, *s, to, words);
    else
        LAUNCH_PARTS(g, (s->nv + GROUP - 1) / GROUP, GROUP_BLOCK, 1,
                     coulomb_gather_kernel<false>, *s, to, words);
    return gpu_status(g);
}

int gpu_coulomb(struct gpu *g, struct coulomb *s)
{
    int status = gpu_coulomb_queue(g, s, gpu_words(g));
    if (status != DRAPE_OK)
        return status;
    const int64_t *seen = gpu_read_back(g, INCIDENCE_WORDS);
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
