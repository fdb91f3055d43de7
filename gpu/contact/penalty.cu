/* SPDX-License-Identifier: Apache-2.0 */
/* Turns contacts into forces and matrix blocks of the implicit solve.
 * spec/contact/penalty.md */
#include "gpu/contact/incidence.cuh"
#include "gpu/contact/lists.cuh"

/* An item adds PARTS numbers to its vertex: PUSHES of force, HOLDS of hold
 * without walls, and HOLDS of wall. In the gather a block owns GROUP vertices
 * at a time, a thread one number of force or hold of a vertex. GROUPS: the
 * largest number of blocks. */
enum { PUSHES = 3, HOLDS = 6, PARTS = PUSHES + 2 * HOLDS, GROUP = 32 };
enum { GROUP_BLOCK = (PUSHES + HOLDS) * GROUP };
enum { GROUPS = 1024 };

/* §1.4: the least κ' of a contact, in masses 1/y₁ that it moves alone. */
#define LEAST R(30.0)
/* §1.2: a contact is let go whose spring pulls more than so many times what the
 * contact gave. */
#define PULL R(4.0)

/* §3: w_i of vertex j: the smallest inverse mass of its side's free vertices.
 */
static __device__ real side_of(const struct penalty *s, const struct contact *c,
                               int j)
{
    int split = c->kind == CONTACT_VF ? 1 : 2;
    int from = j < split ? 0 : split, to = j < split ? split : 4;
    real least = 0;
    for (int i = from; i < to; i++) {
        real w = s->w[c->v[i]];
        if (w > 0 && (least == 0 || w < least))
            least = w;
    }
    return least;
}

/* §1: a - s at velocities u, by which contact c approaches too fast, m/s. */
static __device__ real excess_of(const struct contact *c, const vec *u)
{
    return c->target - dot(c->n, pair_sum(c, u));
}

/* §1: the impulse of contact c's spring at velocities u, N·s; < 0: it pulls. */
static __device__ real spring_impulse(const struct penalty *s,
                                      const struct contact *c, const vec *u)
{
    return c->along * (s->dt / s->tau) * excess_of(c, u);
}

/* §3: S/w_j·|c_j|, the factor of contact c in the hold of its vertex j; share
 * is S. */
static __device__ real part_of(const struct penalty *s, const struct contact *c,
                               real share, int j)
{
    return share / side_of(s, c, j) * magnitude(c->c[j]);
}

/* §1.2: the impulse along n, N·s, that contact c has given so far. Each
 * vertex's part of g is divided among its contacts in proportion to their holds
 * in the turn before. staying: among those that stay held. load: what the
 * vertices got. */
static __device__ real given_impulse(const struct penalty *s,
                                     const struct contact *c, real share,
                                     bool staying, real load[4])
{
    real push = 0, all = 0;
    for (int j = 0; j < 4 && c->along > 0; j++) {
        int32_t i = c->v[j];
        if (!(s->w[i] > 0) || c->c[j] == 0)
            continue;
        real along = part_of(s, c, share, j) * c->along;
        real hold = dot(c->n, apply(s->hold[i], c->n));
        real took = along / hold * dot(c->n, s->g[i]);
        took = staying ? s->more[i] * took : took;
        load[j] = c->c[j] < 0 ? -took : took;
        push += load[j];
        all += magnitude(c->c[j]);
    }
    return all > 0 ? max_of(push / all, R(0.0)) : R(0.0);
}

/* §2.4: in which parts the friction of contact c goes to its vertices: as these
 * bear it, each side by itself. */
static __device__ void find_rub(const struct penalty *s,
                                const struct contact *c, const real load[4],
                                real rub[4])
{
    int split = c->kind == CONTACT_VF ? 1 : 2;
    for (int j = 0; j < 4; j++) {
        int from = j < split ? 0 : split, to = j < split ? split : 4;
        real sum = 0, side = j < split ? R(1.0) : R(-1.0);
        bool moves = true;
        for (int i = from; i < to; i++) {
            sum += max_of(load[i], R(0.0));
            moves = moves && (c->c[i] == 0 || s->w[c->v[i]] > 0);
        }
        rub[j] =
            moves && sum > 0 ? side * (max_of(load[j], R(0.0)) / sum) : c->c[j];
    }
}

/* §1.1. Thread i owns vertex i: writes guess[i], and parts[i] as for a vertex
 * without contacts. */
KERNEL penalty_guess_kernel(const struct penalty &s)
{
    ITEM(i, s.nv);
    real w = s.w[i] * (s.tau / s.dt);
    s.guess[i] = s.first && w > 0 ? axpy(s.u[i], -w, s.g[i]) : s.u[i];
    s.parts[i] = 0;
}

/* §3: S of contact c. */
static __device__ real share_of(const struct penalty *s,
                                const struct contact *c)
{
    real share = 0;
    for (int j = 0; j < 4; j++)
        if (s->w[c->v[j]] > 0)
            share += magnitude(c->c[j]) * side_of(s, c, j);
    return share;
}

/* §2.5: whether contact c goes on as the turn before had it. */
static __device__ bool goes_on(const struct penalty *s, const struct contact *c)
{
    return s->follows && (c->along > 0 || !s->joins);
}

static __device__ vec across(const struct contact *c, const vec *u)
{
    vec v = pair_sum(c, u);
    return axpy(v, -dot(c->n, v), c->n);
}

/* §2.5: what contact k gives by the velocities that a solve has changed by dv;
 * its friction follows the load that it has now. */
static __device__ void follow(const struct penalty *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    s->gave[k] = 0;
    if (!c->held)
        return;
    vec d = s->n_dv ? pair_sum(c, s->dv) : make(0, 0, 0);
    real nearer = dot(c->n, d);
    real across_by = c->slide * (s->tau / s->dt);
    vec tangent = axpy(c->tangent, -across_by, axpy(d, -nearer, c->n));
    real load[4] = {0, 0, 0, 0};
    real gave = given_impulse(s, c, s->share[k], false, load);
    real limit = c->friction * gave, size = length(tangent);
    bool slides = c->slide == 0 && dot(across(c, s->u), tangent) < 0;
    s->gave[k] = gave;
    c->impulse -= c->along * nearer;
    if (size > limit || slides) {
        tangent = scale(size > 0 ? limit / size : R(0.0), tangent);
        c->slide = 0;
    }
    c->tangent = tangent;
    find_rub(s, c, load, &s->rub[4 * k]);
}

/* §1. Thread k owns contact k: reads guess, u, g, dv and hold of its vertices,
 * writes share[k] and whether it is held. */
KERNEL penalty_select_kernel(const struct penalty &s, const int64_t *words)
{
    ITEM(k, s.n);
    if (words[INCIDENCE_BAD])
        return;
    struct contact *c = &s.contact[k];
    real share = s.share[k] = share_of(&s, c);
    int moving = 0; /* §3.2: vertices that the contact moves */
    for (int j = 0; j < 4; j++)
        moving += s.w[c->v[j]] > 0 && c->c[j] != 0;
    if (goes_on(&s, c)) {
        follow(&s, k);
        return;
    }
    real load[4];
    real gave = s.first ? R(0.0) : given_impulse(&s, c, share, false, load);
    bool kept = gave > 0 && spring_impulse(&s, c, s.u) > -PULL * gave;
    bool held = excess_of(c, s.guess) > 0 || excess_of(c, s.u) > 0 || kept;
    c->held = !held         ? CONTACT_APART
              : moving == 1 ? CONTACT_WALL
                            : CONTACT_MUTUAL;
}

/* §1.2: what the contacts of a vertex gave in the turn before, x, and of it
 * those that stay held, y, as shares. */
struct penalty_stays {
    struct penalty s;
    const int32_t *start;
    __device__ int32_t end(int64_t i) const { return start[i + 1]; }
    __device__ vec value(int32_t at) const
    {
        int32_t item = s.item[at];
        const struct contact *c = &s.contact[item / 4];
        real along =
            c->along > 0
                ? part_of(&s, c, s.share[item / 4], item % 4) * c->along
                : R(0.0);
        return make(along, c->held ? along : R(0.0), 0);
    }
    __device__ vec first(int64_t) const { return make(0, 0, 0); }
    __device__ void done(int64_t i, vec sum) const
    {
        s.more[i] = sum.y > 0 ? sum.x / sum.y : R(1.0);
    }
};

/* The number of vertices in contact; 0 if a contact is bad. */
static __device__ int64_t vertices(const int64_t *words)
{
    return words[INCIDENCE_BAD] ? 0 : words[INCIDENCE_VERTICES];
}

/* §1.2. Thread k owns vertex[k]: writes its more. */
KERNEL penalty_more_kernel(const struct penalty &s, const int64_t *words)
{
    int64_t k = own_list(vertices(words));
    sum_list(penalty_stays{s, s.start}, k < 0 ? -1 : (int64_t)s.vertex[k]);
}

/* §1.2, §2.4. Thread k owns contact k: reads g, hold and more of its vertices,
 * writes gave[k] and its rub. */
KERNEL penalty_given_kernel(const struct penalty &s, const int64_t *words)
{
    ITEM(k, s.n);
    if (words[INCIDENCE_BAD])
        return;
    const struct contact *c = &s.contact[k];
    real load[4] = {0, 0, 0, 0}, gave = 0;
    if (goes_on(&s, c))
        return;
    if (!s.first && c->held)
        gave = given_impulse(&s, c, s.share[k], true, load);
    find_rub(&s, c, load, &s.rub[4 * k]);
    s.gave[k] = gave;
}

/* The held contacts of a vertex. */
struct penalty_parts {
    struct penalty s;
    const int32_t *start;
    __device__ int32_t end(int64_t i) const { return start[i + 1]; }
    __device__ int32_t value(int32_t at) const
    {
        return s.contact[s.item[at] / 4].held != CONTACT_APART;
    }
    __device__ int32_t first(int64_t) const { return 0; }
    __device__ void done(int64_t i, int32_t sum) const
    {
        s.parts[i] = (real)sum;
    }
};

/* §2.1. Thread k owns vertex[k]: counts its held contacts into its parts. */
KERNEL penalty_parts_kernel(const struct penalty &s, const int64_t *words)
{
    int64_t k = own_list(vertices(words));
    sum_list(penalty_parts{s, s.start}, k < 0 ? -1 : (int64_t)s.vertex[k]);
}

/* §2.1: Σ c² d w, by which a unit impulse changes the velocity of the parts of
 * contact c, 1/kg. */
static __device__ real yield_of(const struct penalty *s,
                                const struct contact *c)
{
    real sum = 0;
    for (int j = 0; j < 4; j++)
        sum += c->c[j] * c->c[j] * (s->parts[c->v[j]] * s->w[c->v[j]]);
    return sum;
}

/* §1.4: the largest κ', kg. */
static __device__ real most_of(const struct penalty *s)
{
    return s->stiffness * s->tau * s->tau;
}

/* §1.4: κ' of contact c, kg: its spring is `give` short under the load that a
 * rigid contact would bear. */
static __device__ real along_of(const struct penalty *s,
                                const struct contact *c, real gave)
{
    real yield = 0;
    for (int j = 0; j < 4; j++)
        yield += c->c[j] * c->c[j] * s->w[c->v[j]];
    real excess = max_of(excess_of(c, s->guess), R(0.0));
    real load = gave + excess / (yield * (s->tau / s->dt));
    real wanted = load * s->tau / s->give;
    return min_of(max_of(wanted, LEAST / yield), most_of(s));
}

/* §1.5: the push of held contact c at velocities u, N·s. */
static __device__ real push_of(const struct penalty *s, const struct contact *c,
                               real gave, const vec *u)
{
    real part = c->along / most_of(s);
    real push = (1 - part) * gave + spring_impulse(s, c, u);
    return s->first ? push : max_of(push, -gave);
}

/* §2.1: N, the impulse along n that contact c is expected to give, N·s. */
static __device__ real expected_impulse(const struct penalty *s,
                                        const struct contact *c, real gave,
                                        real yield)
{
    real push = push_of(s, c, gave, s->guess);
    return max_of(gave + (push - gave) / (1 + c->along * yield), R(0.0));
}

/* §3. Thread k owns place k of all lists: reads its item's contact; writes
 * number o of the item to part[o·n4 + k], 0 if the contact is not held. */
KERNEL penalty_item_kernel(const struct penalty &s, real *part,
                           const int64_t *words)
{
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= s.start[s.nv])
        return;
    int32_t item = s.item[k], j = item % 4;
    const struct contact *c = &s.contact[item / 4];
    vec n = c->n, push = make(0, 0, 0);
    real a = 0, b = 0;
    if (c->held) {
        real share = part_of(&s, c, s.share[item / 4], j);
        a = share * c->along;
        b = share * c->slide * (s.tau / s.dt);
        a = a - b;
        real rub = c->slide > 0 ? c->c[j] : s.rub[item];
        push = axpy(scale(c->c[j] * c->impulse, n), rub, c->tangent);
    } else {
        n = push;
    }
    real all[PUSHES + HOLDS] = {push.x,
                                push.y,
                                push.z,
                                a * n.x * n.x + b,
                                a * n.x * n.y,
                                a * n.x * n.z,
                                a * n.y * n.y + b,
                                a * n.y * n.z,
                                a * n.z * n.z + b};
    bool wall = c->held == CONTACT_WALL;
    UNROLL
    for (int o = 0; o < PUSHES + HOLDS; o++) {
        real to[2] = {all[o], 0};
        if (o < PUSHES) {
            part[o * s.n4 + k] = all[o];
            continue;
        }
        part[o * s.n4 + k] = to[wall];
        part[(o + HOLDS) * s.n4 + k] = to[!wall];
    }
}

/* §2.2: whether contact c sticks, where friction is at most `most` and could
 * stop a slip of speed `stop`. */
static __device__ bool sticks(const struct penalty *s, const struct contact *c,
                              vec slip, real most, real stop)
{
    real speed = length(slip);
    bool late = !s->first;
    if (late && c->slide > 0)
        return c->slide * speed <= most;
    if (late && dot(c->tangent, c->tangent) > 0)
        return dot(slip, c->tangent) > 0;
    return speed <= stop && speed * s->dt <= s->far;
}

/* §2.3: f of contact c, which sticks, slips with this speed, and whose friction
 * is at most `limit`. */
static __device__ real damper_of(const struct penalty *s,
                                 const struct contact *c, real speed,
                                 real limit)
{
    real f = limit / s->slip;
    if (s->first)
        return f;
    if (c->slide > 0)
        return min_of(c->slide, f);
    bool slid = dot(c->tangent, c->tangent) > 0;
    return slid ? limit / max_of(speed, s->slip) : f;
}

/* §1, §2. Thread k owns contact k: reads guess, parts and u of its vertices and
 * gave[k], writes its slide, impulse and tangent. */
KERNEL penalty_push_kernel(const struct penalty &s, const int64_t *words)
{
    ITEM(k, s.n);
    if (words[INCIDENCE_BAD])
        return;
    struct contact *c = &s.contact[k];
    if (goes_on(&s, c))
        return;
    vec slip = across(c, s.u);
    real gave = s.gave[k], yield = yield_of(&s, c), limit = 0;
    c->along = c->held ? along_of(&s, c, gave) : R(0.0);
    if (c->held)
        limit = c->friction * expected_impulse(&s, c, gave, yield);
    bool stick = sticks(&s, c, slip, limit, yield * limit * (s.tau / s.dt));
    real speed = length(slip);
    real f =
        stick ? damper_of(&s, c, speed, limit) : limit / max_of(speed, s.slip);
    c->slide = stick ? f : R(0.0);
    c->tangent = scale(-f, slip);
    c->impulse = c->held ? push_of(&s, c, gave, s.u) : R(0.0);
}

/* One of the PARTS numbers of the items of all lists. */
struct penalty_number {
    const real *part;
    __device__ real value(int32_t at) const { return part[at]; }
};

template <bool BY_WARP>
static __device__ real total(const struct penalty *s, const real *part,
                             int32_t i, real *row)
{
    struct penalty_number list = {part};
    int32_t from = s->start[i], end = s->start[i + 1];
    return BY_WARP ? sum_by_warp(list, from, end, R(0.0), row)
                   : sum_by_thread(list, from, end, R(0.0));
}

/* Writes number o of vertex i to force or hold. row: a warp's, [WARP] in shared
 * memory, where it sums a long list. */
template <bool BY_WARP>
static __device__ void put_number(const struct penalty *s, const real *part,
                                  int32_t i, int o, real *row)
{
    real sum = total<BY_WARP>(s, part + o * s->n4, i, row);
    if (o < PUSHES) {
        ((real *)&s->force[i])[o] = sum;
        return;
    }
    real wall = total<BY_WARP>(s, part + (o + HOLDS) * s->n4, i, row);
    ((real *)&s->wall[i])[o - PUSHES] = wall;
    ((real *)&s->hold[i])[o - PUSHES] = sum + wall;
}

/* §3. A block owns GROUP vertices in contact at a time, warp o their number o:
 * writes their force and hold, which are 0 elsewhere. */
KERNEL penalty_gather_kernel(const struct penalty &s, const real *part,
                             const int64_t *words)
{
    static_assert((int)GROUP == (int)WARP, "a warp sums a long list");
    __shared__ int32_t longer[GROUP];
    __shared__ real row[GROUP_BLOCK / WARP][WARP];
    __shared__ int n;
    int t = (int)threadIdx.x, o = t / GROUP;
    int64_t touched = vertices(words);
    for (int64_t first = (int64_t)blockIdx.x * GROUP; first < touched;
         first += (int64_t)gridDim.x * GROUP) {
        int64_t k = first + t % GROUP;
        int32_t i = k < touched ? s.vertex[k] : -1;
        if (t == 0)
            n = 0;
        __syncthreads();
        if (i >= 0 && s.start[i + 1] - s.start[i] <= LIST_SHORT)
            put_number<false>(&s, part, i, o, NULL);
        else if (i >= 0 && o == 0)
            longer[atomicAdd(&n, 1)] = i;
        __syncthreads();
        for (int l = 0; l < n; l++)
            put_number<true>(&s, part, longer[l], o, row[o]);
        __syncthreads(); /* n and longer are written again */
    }
}

/* §1 and §2, but for §2.5; touched: the most vertices in contact. */
static void find_pushes(struct gpu *g, const struct penalty *s, int64_t touched,
                        const int64_t *words)
{
    LAUNCH(g, s->nv, penalty_guess_kernel, *s);
    LAUNCH(g, s->n, penalty_select_kernel, *s, words);
    if (!s->first && !s->follows)
        LAUNCH_LISTS(g, touched, penalty_more_kernel, *s, words);
    LAUNCH(g, s->n, penalty_given_kernel, *s, words);
    LAUNCH_LISTS(g, touched, penalty_parts_kernel, *s, words);
    LAUNCH(g, s->n, penalty_push_kernel, *s, words);
}

int gpu_penalty_queue(struct gpu *g, struct penalty *s, int64_t *words)
{
    bool solved = s->n_dv == s->nv && s->dv;
    if (!(s->dt > 0 && s->tau > 0 && s->stiffness > 0 && s->give > 0 &&
          s->slip > 0 && s->far > 0) ||
        s->nv1 != s->nv + 1 || s->n4 != 4 * s->n || s->n4 > INT32_MAX ||
        (s->follows && s->first) || (s->n_dv != 0 && !solved))
        return DRAPE_EARG;
    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    gpu_incidence(g, &by, words);
    real *part =
        (real *)gpu_scratch(g, SLOT_STAGE, PARTS * s->n4, sizeof *part);
    int64_t touched = s->nv < s->n4 ? s->nv : s->n4;
    int64_t groups = (s->nv + GROUP - 1) / GROUP;
    int64_t blocks = groups < GROUPS ? groups : (int64_t)GROUPS;
    gpu_clear(g, s->force, (size_t)s->nv * sizeof *s->force);
    find_pushes(g, s, touched, words);
    gpu_clear(g, s->hold, (size_t)s->nv * sizeof *s->hold);
    gpu_clear(g, s->wall, (size_t)s->nv * sizeof *s->wall);
    LAUNCH(g, s->n4, penalty_item_kernel, *s, part, words);
    LAUNCH_BLOCKS(g, blocks, GROUP_BLOCK, penalty_gather_kernel, *s, part,
                  words);
    return gpu_status(g);
}

int gpu_penalty(struct gpu *g, struct penalty *s)
{
    int status = gpu_penalty_queue(g, s, gpu_words(g));
    if (status != DRAPE_OK)
        return status;
    const int64_t *seen = gpu_read_back(g, INCIDENCE_WORDS);
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
