/* SPDX-License-Identifier: Apache-2.0 */
/* Turns contacts into forces and matrix blocks of the implicit solve.
 * spec/contact/penalty.md */
#include "ref/contact/penalty.h"

#include "ref/contact/incidence.h"

/* §1.4: the least κ' of a contact, in masses 1/y₁ that it moves alone. */
static const real LEAST = R(30.0);
/* §1.2: a contact is let go whose spring pulls more than so many times what the
 * contact gave. */
static const real PULL = R(4.0);

static int check(const struct penalty *s)
{
    bool solved = s->n_dv == s->nv && s->dv;
    if (!(s->dt > 0 && s->tau > 0 && s->stiffness > 0 && s->give > 0 &&
          s->slip > 0 && s->far > 0) ||
        s->nv1 != s->nv + 1 || s->n4 != 4 * s->n || s->n4 > INT32_MAX ||
        (s->follows && s->first) || (s->n_dv != 0 && !solved))
        return DRAPE_EARG;
    for (int64_t k = 0; k < s->n; k++)
        if (!pair_valid(s->contact[k].v, s->nv))
            return DRAPE_EARG;
    return DRAPE_OK;
}

/* §3: w_i of vertex j: the smallest inverse mass of its side's free vertices.
 */
static real side_of(const struct penalty *s, const struct contact *c, int j)
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
static real excess_of(const struct contact *c, const vec *u)
{
    return c->target - vec_dot(c->n, pair_sum(c->v, c->c, u));
}

/* §1: the impulse of contact c's spring at velocities u, N·s; < 0: it pulls. */
static real spring_impulse(const struct penalty *s, const struct contact *c,
                           const vec *u)
{
    return c->along * (s->dt / s->tau) * excess_of(c, u);
}

/* §3: S of contact k. */
static void find_share(struct penalty *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    real share = 0;
    for (int j = 0; j < 4; j++)
        if (s->w[c->v[j]] > 0)
            share += real_abs(c->c[j]) * side_of(s, c, j);
    s->share[k] = share;
}

/* §3: S/w_j·|c_j|, the factor of contact k in the hold of its vertex j. */
static real part_of(const struct penalty *s, int64_t k, int j)
{
    const struct contact *c = &s->contact[k];
    return s->share[k] / side_of(s, c, j) * real_abs(c->c[j]);
}

/* §1.2: the impulse along n, N·s, that contact c has given so far. Each
 * vertex's part of g is divided among its contacts in proportion to their holds
 * in the turn before. staying: among those that stay held. load: what the
 * vertices got. */
static real given_impulse(const struct penalty *s, int64_t k, bool staying,
                          real load[4])
{
    const struct contact *c = &s->contact[k];
    real push = 0, all = 0;
    for (int j = 0; j < 4 && c->along > 0; j++) {
        int32_t i = c->v[j];
        if (!(s->w[i] > 0) || c->c[j] == 0)
            continue;
        real along = part_of(s, k, j) * c->along;
        real hold = vec_dot(c->n, sym_apply(s->hold[i], c->n));
        real took = along / hold * vec_dot(c->n, s->g[i]);
        took = staying ? s->more[i] * took : took;
        load[j] = c->c[j] < 0 ? -took : took;
        push += load[j];
        all += real_abs(c->c[j]);
    }
    return all > 0 ? real_max(push / all, 0) : 0;
}

real penalty_load(struct penalty *s, int64_t k, real load[4])
{
    find_share(s, k);
    return given_impulse(s, k, false, load);
}

/* §2.4: in which parts the friction of contact k goes to its vertices: as these
 * bear it, each side by itself. */
static void find_rub(const struct penalty *s, int64_t k, const real load[4])
{
    const struct contact *c = &s->contact[k];
    int split = c->kind == CONTACT_VF ? 1 : 2;
    for (int j = 0; j < 4; j++) {
        int from = j < split ? 0 : split, to = j < split ? split : 4;
        real sum = 0, side = j < split ? R(1.0) : R(-1.0);
        bool moves = true;
        for (int i = from; i < to; i++) {
            sum += real_max(load[i], 0);
            moves &= c->c[i] == 0 || s->w[c->v[i]] > 0;
        }
        s->rub[4 * k + j] =
            moves && sum > 0 ? side * (real_max(load[j], 0) / sum) : c->c[j];
    }
}

/* §1.1: the velocity of vertex i without the push that the slice began with.
 */
static void find_guess(struct penalty *s, int64_t i)
{
    real w = s->w[i] * (s->tau / s->dt);
    bool pushed = s->first && w > 0;
    s->guess[i] = pushed ? vec_axpy(s->u[i], -w, s->g[i]) : s->u[i];
}

/* §3.2: whether one vertex of contact c is free, so that the contact's matrix
 * is a block. */
static bool is_wall(const struct penalty *s, const struct contact *c)
{
    int moving = 0;
    for (int j = 0; j < 4; j++)
        moving += s->w[c->v[j]] > 0 && c->c[j] != 0;
    return moving == 1;
}

/* §2.5: whether contact c goes on as the turn before had it. */
static bool goes_on(const struct penalty *s, const struct contact *c)
{
    return s->follows && (c->along > 0 || !s->joins);
}

/* The part of Σ c u across the normal. */
static vec across(const struct contact *c, const vec *u)
{
    vec v = pair_sum(c->v, c->c, u);
    return vec_axpy(v, -vec_dot(c->n, v), c->n);
}

/* §2.5: what contact k gives by the velocities that a solve has changed by dv;
 * its friction follows the load that it has now. */
static void follow(struct penalty *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    s->gave[k] = 0;
    if (!c->held)
        return;
    vec d = s->n_dv ? pair_sum(c->v, c->c, s->dv) : vec_make(0, 0, 0);
    real nearer = vec_dot(c->n, d);
    real across_by = c->slide * (s->tau / s->dt);
    c->impulse -= c->along * nearer;
    c->tangent = vec_axpy(c->tangent, -across_by, vec_axpy(d, -nearer, c->n));
    real load[4] = {0, 0, 0, 0};
    s->gave[k] = given_impulse(s, k, false, load);
    real most = c->friction * s->gave[k];
    real size = vec_length(c->tangent);
    bool slides = c->slide == 0 && vec_dot(across(c, s->u), c->tangent) < 0;
    if (size > most || slides) {
        c->tangent = vec_scale(size > 0 ? most / size : 0, c->tangent);
        c->slide = 0;
    }
    find_rub(s, k, load);
}

/* §1: selects the held contacts: those that approach at u or at the guess, and
 * those that gave an impulse in the turn before and do not pull much more. */
static void select_held(struct penalty *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    find_share(s, k);
    if (goes_on(s, c)) {
        follow(s, k);
        return;
    }
    real load[4];
    real gave = s->first ? 0 : given_impulse(s, k, false, load);
    bool kept = gave > 0 && spring_impulse(s, c, s->u) > -PULL * gave;
    bool held = excess_of(c, s->guess) > 0 || excess_of(c, s->u) > 0 || kept;
    c->held = !held           ? CONTACT_APART
              : is_wall(s, c) ? CONTACT_WALL
                              : CONTACT_MUTUAL;
}

/* §1.2: how many times as much of what vertex i got its contacts gave that stay
 * held, as those that are let go give none of it. */
static real more_of(const struct penalty *s, int64_t i)
{
    real all = 0, stays = 0;
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        int64_t at = s->item[k] / 4;
        const struct contact *c = &s->contact[at];
        real along =
            c->along > 0 ? part_of(s, at, s->item[k] % 4) * c->along : 0;
        all += along;
        stays += c->held ? along : 0;
    }
    return stays > 0 ? all / stays : 1;
}

static void find_more(struct penalty *s)
{
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        s->more[i] = more_of(s, i);
}

/* §1.2, §2.4: what contact k has given, and how its friction is divided. */
static void find_given(struct penalty *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    real load[4] = {0, 0, 0, 0}, gave = 0;
    if (goes_on(s, c))
        return;
    if (!s->first && c->held)
        gave = given_impulse(s, k, true, load);
    find_rub(s, k, load);
    s->gave[k] = gave;
}

/* §3: what contact k adds to the hold of its vertex j. */
static sym hold_of(const struct penalty *s, int64_t k, int j, real slide)
{
    const struct contact *a = &s->contact[k];
    real part = part_of(s, k, j);
    real along = part * a->along;
    real across = part * slide * (s->tau / s->dt);
    real d = along - across;
    vec n = a->n;
    sym r = {d * n.x * n.x + across, d * n.x * n.y, d * n.x * n.z,
             d * n.y * n.y + across, d * n.y * n.z, d * n.z * n.z + across};
    return r;
}

/* §2.1: the number of parts of vertex i, one for each held contact. */
static void count_parts(struct penalty *s, int64_t i)
{
    int32_t parts = 0;
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++)
        parts += s->contact[s->item[k] / 4].held != CONTACT_APART;
    s->parts[i] = (real)parts;
}

/* §2.1: Σ c² d w, by which a unit impulse changes the velocity of the parts of
 * contact c, 1/kg. */
static real yield_of(const struct penalty *s, const struct contact *c)
{
    real sum = 0;
    for (int j = 0; j < 4; j++)
        sum += c->c[j] * c->c[j] * (s->parts[c->v[j]] * s->w[c->v[j]]);
    return sum;
}

/* §1.4: the largest κ', kg. */
static real most_of(const struct penalty *s)
{
    return s->stiffness * s->tau * s->tau;
}

/* §1.4: κ' of contact k, kg: its spring is `give` short under the load that a
 * rigid contact would bear. */
static real along_of(const struct penalty *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    real yield = 0;
    for (int j = 0; j < 4; j++)
        yield += c->c[j] * c->c[j] * s->w[c->v[j]];
    real excess = real_max(excess_of(c, s->guess), 0);
    real load = s->gave[k] + excess / (yield * (s->tau / s->dt));
    real wanted = load * s->tau / s->give;
    return real_min(real_max(wanted, LEAST / yield), most_of(s));
}

/* §1.5: the push of held contact k at velocities u, N·s. */
static real push_of(const struct penalty *s, int64_t k, const vec *u)
{
    const struct contact *c = &s->contact[k];
    real gave = s->gave[k], part = c->along / most_of(s);
    real push = (1 - part) * gave + spring_impulse(s, c, u);
    return s->first ? push : real_max(push, -gave);
}

/* §2.1: N, the impulse along n that contact k is expected to give, N·s. */
static real expected_impulse(const struct penalty *s, int64_t k, real yield)
{
    const struct contact *c = &s->contact[k];
    real gave = s->gave[k], push = push_of(s, k, s->guess);
    return real_max(gave + (push - gave) / (1 + c->along * yield), 0);
}

/* §2.2: whether contact c sticks, where friction is at most `most` and could
 * stop a slip of speed `stop`. */
static bool sticks(const struct penalty *s, const struct contact *c, vec slip,
                   real most, real stop)
{
    real speed = vec_length(slip);
    if (c->slide > 0 && !s->first)
        return c->slide * speed <= most;
    if (vec_dot(c->tangent, c->tangent) > 0 && !s->first)
        return vec_dot(slip, c->tangent) > 0;
    return speed <= stop && speed * s->dt <= s->far;
}

/* §2.3: f of contact c, which sticks, slips with this speed, and whose friction
 * is at most `most`. */
static real damper_of(const struct penalty *s, const struct contact *c,
                      real speed, real most)
{
    real f = most / s->slip;
    if (s->first)
        return f;
    if (c->slide > 0)
        return real_min(c->slide, f);
    bool slid = vec_dot(c->tangent, c->tangent) > 0;
    return slid ? most / real_max(speed, s->slip) : f;
}

/* §1, §2: the impulses of contact k. */
static void push(struct penalty *s, int64_t k)
{
    struct contact *c = &s->contact[k];
    if (goes_on(s, c))
        return;
    vec slip = across(c, s->u);
    real yield = yield_of(s, c), most = 0;
    c->along = c->held ? along_of(s, k) : 0;
    if (c->held)
        most = c->friction * expected_impulse(s, k, yield);
    bool stick = sticks(s, c, slip, most, yield * most * (s->tau / s->dt));
    real speed = vec_length(slip);
    real f =
        stick ? damper_of(s, c, speed, most) : most / real_max(speed, s->slip);
    c->slide = stick ? f : 0;
    c->tangent = vec_scale(-f, slip);
    c->impulse = c->held ? push_of(s, k, s->u) : 0;
}

/* §3: the sums of force, wall and hold over the held contacts of vertex i. */
static void gather(const struct penalty *s, int32_t i)
{
    vec force = vec_make(0, 0, 0);
    sym sum[2] = {{0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 0}};
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        int64_t at = s->item[k] / 4;
        const struct contact *c = &s->contact[at];
        if (!c->held)
            continue;
        int j = s->item[k] % 4;
        real rub = c->slide > 0 ? c->c[j] : s->rub[s->item[k]];
        vec push = vec_scale(c->c[j] * c->impulse, c->n);
        force = vec_add(force, vec_axpy(push, rub, c->tangent));
        sym *to = &sum[c->held == CONTACT_WALL];
        *to = sym_add(*to, hold_of(s, at, j, c->slide));
    }
    s->force[i] = force;
    s->wall[i] = sum[1];
    s->hold[i] = sym_add(sum[0], sum[1]);
}

/* §1 and §2. */
static void find_pushes(struct penalty *s)
{
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        find_guess(s, i);
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        select_held(s, k);
    if (!s->first && !s->follows)
        find_more(s);
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        find_given(s, k);
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        count_parts(s, i);
    EACH_ITEM
    for (int64_t k = 0; k < s->n; k++)
        push(s, k);
}

int ref_penalty(struct penalty *s)
{
    int status = check(s);
    if (status != DRAPE_OK)
        return status;
    struct incidence by = {.nv = s->nv,
                           .n = s->n,
                           .w = s->w,
                           .contact = s->contact,
                           .start = s->start,
                           .item = s->item,
                           .vertex = s->vertex};
    ref_incidence(&by);
    find_pushes(s);
    EACH_ITEM
    for (int64_t i = 0; i < s->nv; i++)
        gather(s, (int32_t)i);
    return DRAPE_OK;
}
