/* SPDX-License-Identifier: Apache-2.0 */
/* The rounds of collision response, on either backend: the host's decisions
 * from the counts that its stages give. spec/contact/response.md */
#include "ref/contact/response.h"

#include "ref/contact/contacts.h"
#include "ref/contact/impacts.h"
#include "ref/contact/impulses.h"
#include "ref/contact/proximity.h"
#include "ref/narrow/narrow.h"

int response_start(struct response *s)
{
    if (!(s->dt > 0 && s->dt <= REAL_BIG && s->margin >= 0 && s->range > 0) ||
        !(s->stiffness >= 0) || s->iterations < 0 || s->max_rounds < 0 ||
        s->zone_rounds < 0 || s->roll_rounds < 0)
        return DRAPE_EARG;
    response_reset(s);
    s->run->clear(s->on, s->rolled, (size_t)s->nv);
    s->run->rounds_start(s->on, s);
    return s->run->status(s->on);
}

/* Solves the contacts in contact[side] and moves their vertices. */
static int solve_contacts(struct response *s, int64_t n, int warm)
{
    struct pool_need pool_need[] = {
        {&s->item, 4 * n, sizeof(int32_t)},
        {&s->parts, 2 * s->nv, sizeof(int32_t)},
        {&s->lack, 2 * n, sizeof(real)},
        {&s->push, s->run->pushes * n, sizeof(vec)},
        {&s->vertex, 4 * n, sizeof(int32_t)},
        {&s->moved, 4 * n, sizeof(uint8_t)},
        {&s->contact_awake, n + s->nv, sizeof(uint8_t)}};
    int status = response_grow(s, 7, pool_need);
    if (status != DRAPE_OK)
        return status;
    vec *push = s->push.data;
    struct contacts c = {.nv = s->nv,
                         .n = n,
                         .w = s->w,
                         .iterations = response_iterations(s),
                         .warm = warm,
                         .contact = s->contact[s->side].data,
                         .u = s->u,
                         .v = s->v,
                         .nv1 = s->nv + 1,
                         .n4 = 4 * n,
                         .start = s->start,
                         .item = s->item.data,
                         .parts = s->parts.data,
                         .lack = s->lack.data,
                         .push = push,
                         .before = push + (s->run->pushes - 1) * n,
                         .vertex = s->vertex.data,
                         .moved = s->moved.data,
                         .contact_awake = s->contact_awake.data};
    c.acting = c.parts + s->nv;
    c.lookahead = c.lack + n;
    c.vertex_awake = c.contact_awake + n;
    status = s->run->contacts(s->on, &c);
    s->run->trace(s->on, s->trace, "contacts", s->u,
                  (size_t)s->nv * sizeof *s->u);
    if (status == DRAPE_OK)
        s->run->rounds_advance(s->on, s, c.vertices, c.vertex, c.moved, false);
    return status;
}

/* The contacts: the implicit solve reads them. */
static int grow_contacts(const struct response *s, struct pool *p, int64_t need)
{
    return s->run->grow(s->on, p, ARENA_RESPONSE, need, sizeof(struct contact),
                        true);
}

/* §3 */

static int find_times(struct response *s, const struct pairs *p)
{
    struct narrow n = {.n = p->n,
                       .pair = p->pair,
                       .kind = p->kind,
                       .x0 = s->x0,
                       .x1 = s->x1,
                       .nv = (int32_t)s->nv};
    struct pool_need pool_need[] = {{&s->toi, p->n, sizeof *n.toi},
                                    {&s->tier, p->n, sizeof *n.tier},
                                    {&s->at, p->n, sizeof(int32_t)}};
    int status = response_grow(s, 3, pool_need);
    if (status != DRAPE_OK)
        return status;
    n.toi = s->toi.data;
    n.tier = s->tier.data;
    s->candidates += p->n;
    s->narrow++;
    status = s->run->narrow(s->on, &n);
    s->run->trace(s->on, s->trace, "narrow", n.toi,
                  (size_t)n.n * sizeof *n.toi);
    return status;
}

static int grow_hits(struct response *s, int64_t n)
{
    struct pool_need pool_need[] = {{&s->hit, 4 * n, sizeof(int32_t)},
                                    {&s->hit_kind, n, sizeof(uint8_t)},
                                    {&s->hit_toi, n, sizeof(uint32_t)}};
    return response_grow(s, 3, pool_need);
}

static int64_t hits_cap(const struct response *s)
{
    int64_t cap = s->hit.cap / 4;
    if (s->hit_kind.cap < cap)
        cap = s->hit_kind.cap;
    return s->hit_toi.cap < cap ? s->hit_toi.cap : cap;
}

/* Fills hit with the pairs that touch, among those with a touched vertex. all:
 * out: the pairs that broad found. */
static int detect_hits(struct response *s, const uint8_t *touched,
                       struct pairs *all)
{
    int status = s->broad(s->user, touched, all);
    struct pairs p = *all;
    s->hits = 0;
    if (!touched)
        s->started = s->prescribed = 0;
    if (status != DRAPE_OK || !p.n)
        return status;
    s->later += touched ? p.n : 0;
    status = find_times(s, &p);
    if (status != DRAPE_OK)
        return status;
    struct impacts m = {.nv = s->nv,
                        .n = p.n,
                        .pair = p.pair,
                        .kind = p.kind,
                        .toi = s->toi.data,
                        .x0 = s->x0,
                        .w = s->w,
                        .at = s->at.data};
    do {
        m.cap = hits_cap(s);
        m.hit = s->hit.data;
        m.hit_kind = s->hit_kind.data;
        m.hit_toi = s->hit_toi.data;
        status = s->run->impacts(s->on, &m);
    } while (status == DRAPE_EFULL &&
             (status = grow_hits(s, m.found)) == DRAPE_OK);
    s->hits = m.found;
    if (status == DRAPE_OK)
        s->run->trace(s->on, s->trace, "impacts", m.hit,
                      (size_t)m.found * 4 * sizeof *m.hit);
    s->impacts += m.found;
    if (!touched) {
        s->started = m.started;
        s->prescribed = m.prescribed;
    }
    return status;
}

/* The number of the pool of contacts that is neither the active set's nor
 * `other`. */
static int spare_side(const struct response *s, int other)
{
    int side = 0;
    while (side == s->side || side == other)
        side++;
    return side;
}

/* §4. Pairs that touch join the n contacts of a pool: the active set,
 * contact[side]. The set that the solve left stays, for the list of contacts.
 */
static int find_impulses(struct response *s, int pool, int64_t n, int side)
{
    struct pool *from = &s->contact[pool], *to = &s->contact[side];
    struct impulses m = {.nv = s->nv,
                         .n = s->hits,
                         .pair = s->hit.data,
                         .kind = s->hit_kind.data,
                         .toi = s->hit_toi.data,
                         .w = s->w,
                         .x0 = s->x0,
                         .x1 = s->x1,
                         .surfaces = s->surfaces,
                         .one_rings = s->one_rings,
                         .dt = s->dt,
                         .margin = s->margin,
                         .stiffest = s->stiffest,
                         .n_active = n,
                         .active = from->data,
                         .first = s->first};
    m.n_all = m.n + m.n_active;
    struct pool_need pool_need[] = {{&s->key[0], m.n_all, sizeof *m.key},
                                    {&s->key[1], m.n_all, sizeof *m.key}};
    int status = response_grow(s, 2, pool_need);
    if (status != DRAPE_OK)
        return status;
    m.key = s->key[0].data;
    m.spare = s->key[1].data;
    do {
        m.cap = to->cap > s->seams ? to->cap - s->seams : 0;
        m.contact = to->data;
        status = s->run->impulses(s->on, &m);
    } while (status == DRAPE_EFULL &&
             (status = grow_contacts(s, to, m.found + s->seams)) == DRAPE_OK);
    if (status != DRAPE_OK)
        return status;
    s->side = side;
    s->active = m.found;
    s->run->trace(s->on, s->trace, "impulses", m.contact,
                  (size_t)m.found * sizeof *m.contact);
    return DRAPE_OK;
}

static int join_hits(struct response *s)
{
    return find_impulses(s, s->side, s->active, spare_side(s, s->solved));
}

static struct proximity proximity_of(const struct response *s,
                                     const struct pairs *close, const vec *x)
{
    return (struct proximity){.nv = s->nv,
                              .n = close->n,
                              .pair = close->pair,
                              .kind = close->kind,
                              .x = x,
                              .w = s->w,
                              .surfaces = s->surfaces,
                              .one_rings = s->one_rings,
                              .dt = s->dt,
                              .stiffness = s->stiffness,
                              .range = s->range};
}

/* The contacts of p in a pool that has room for `more` behind them. */
static int find_contacts(struct response *s, struct proximity *p,
                         struct pool *out, int64_t more)
{
    int status =
        response_grow(s, 1, &(struct pool_need){&s->at, p->n, sizeof *p->at});
    if (status != DRAPE_OK)
        return status;
    p->at = s->at.data;
    do {
        p->cap = out->cap > more ? out->cap - more : 0;
        p->contact = out->data;
        status = s->run->proximity(s->on, p);
    } while (status == DRAPE_EFULL &&
             (status = grow_contacts(s, out, p->found + more)) == DRAPE_OK);
    if (status == DRAPE_OK)
        s->run->trace(s->on, s->trace, "proximity", p->contact,
                      (size_t)p->found * sizeof *p->contact);
    return status;
}

/* The pairs near at x0, as contacts of the active set's pool. */
static int find_at_start(struct response *s, const struct pairs *close)
{
    struct proximity p = proximity_of(s, close, s->x0);
    int status = find_contacts(s, &p, &s->contact[s->side], 0);
    s->contacts = p.found;
    return status;
}

/* Puts the pairs that arrive into a spare pool, and the active set behind them:
 * where a pair is in both, the latter stays. */
static int find_arrivals(struct response *s, const struct pairs *all)
{
    int side = spare_side(s, s->solved);
    struct proximity p = proximity_of(s, all, s->x1);
    p.n_from = s->nv;
    p.from = s->x0;
    int status = find_contacts(s, &p, &s->contact[side], s->active);
    if (status != DRAPE_OK || !p.found)
        return status;
    s->run->copy(s->on, p.contact + p.found, s->contact[s->side].data,
                 (size_t)s->active * sizeof *p.contact);
    s->arrived = side;
    s->arrivals = p.found;
    return DRAPE_OK;
}

int response_detect(struct response *s, real reach)
{
    struct pairs all;
    s->arrivals = 0;
    s->reach = reach;
    int status = detect_hits(s, NULL, &all);
    s->reach = 0;
    return status == DRAPE_OK && reach > 0 && all.n ? find_arrivals(s, &all)
                                                    : status;
}

int response_join(struct response *s)
{
    if (!s->arrivals)
        return join_hits(s);
    return find_impulses(s, s->arrived, s->arrivals + s->active, s->side);
}

int response_find_close(struct response *s, const struct pairs *close)
{
    s->close = close->n;
    s->hits = 0;
    if (!close->n)
        return DRAPE_OK;
    int status = find_at_start(s, close);
    s->active = s->contacts;
    /* without impacts this orders them */
    return status == DRAPE_OK && s->active ? join_hits(s) : status;
}

int response_repel(struct response *s, const struct pairs *close)
{
    s->close = close->n;
    if (!close->n)
        return DRAPE_OK;
    int status = find_at_start(s, close);
    return status == DRAPE_OK && s->contacts ? solve_contacts(s, s->contacts, 0)
                                             : status;
}

/* §4 */

static int push_hits(struct response *s)
{
    int status = join_hits(s);
    if (status != DRAPE_OK)
        return status;
    struct contact *contact = s->contact[s->side].data;
    /* only impulses that contacts gave can it withdraw */
    bool warm = s->contacts_solved;
    if (!warm)
        s->run->rounds_settle(s->on, s, contact);
    s->contacts_solved = true;
    return solve_contacts(s, s->active, warm);
}

static int resolve_round(struct response *s, int round)
{
    int rolls = round - s->max_rounds - s->zone_rounds;
    if (rolls >= 0)
        return failsafe_rollback(s, rolls);
    s->run->clear(s->on, s->touched, (size_t)s->nv);
    s->run->rounds_touch(s->on, s);
    return round < s->max_rounds ? push_hits(s) : failsafe_zones(s);
}

int response_penetrate(struct response *s)
{
    if (!s->solves)
        s->active = 0; /* the contacts of repulsion are not used again */
    s->solved = s->side;
    s->n_solved = s->active;
    s->rounds = 1;
    struct pairs p;
    int status = s->done ? DRAPE_OK : detect_hits(s, NULL, &p);
    s->hits = s->done ? 0 : s->hits;
    for (int round = 0; status == DRAPE_OK && s->hits > 0; round++) {
        if (s->stop_before_zones && round >= s->max_rounds) {
            s->outcome |= DRAPE_ZONES;
            break;
        }
        status = resolve_round(s, round);
        if (status != DRAPE_OK || s->hits == 0)
            break;
        status = detect_hits(s, s->touched, &p);
        s->rounds++;
    }
    if (s->started || s->prescribed)
        s->outcome |= DRAPE_TRAPPED;
    return status;
}
