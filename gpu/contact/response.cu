/* SPDX-License-Identifier: Apache-2.0 */
/* The rounds of collision response: ref/contact/response.c again, with streams
 * that stay on the device. spec/contact/response.md */
#include "gpu/contact/response.cuh"

#include "gpu/contact/contact.cuh"
#include "gpu/contact/impulses.cuh"
#include "gpu/run/tape.cuh"

/* ---- Pools ---- */

typedef void *take(struct gpu *, enum arena_part, int64_t count, size_t size);

static void grow(struct gpu *g, struct room r, take *from)
{
    if (r.need <= r.pool->cap)
        return;
    int64_t cap = r.need + (g->tight ? 0 : r.need / 4 + 256);
    gpu_give(g, r.pool->data);
    r.pool->data = from(g, ARENA_RESPONSE, cap, r.size);
    r.pool->cap = r.pool->data ? cap : 0;
}

int gpu_response_grow(struct gpu *g, int n, const struct room *room)
{
    for (int k = 0; k < n; k++)
        grow(g, room[k], gpu_borrow);
    return gpu_status(g);
}

/* The contacts: s->solve solves with them. */
static int grow_contacts(struct gpu *g, struct pool *p, int64_t need)
{
    grow(g, {p, need, sizeof(struct contact)}, gpu_take);
    return gpu_status(g);
}

/* ---- §1 ---- */

/* Thread i owns vertex i: writes u[i]. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    response_start_kernel(struct response s)
{
    ITEM(i, s.nv);
    vec d = sub(s.x1[i], s.x0[i]);
    s.u[i] = make(d.x / s.dt, d.y / s.dt, d.z / s.dt);
}

int gpu_response_start(struct gpu *g, struct response *s)
{
    if (!(s->dt > 0 && s->dt <= REAL_BIG && s->margin >= 0) ||
        !(s->stiffness >= 0) || s->iterations < 0 || s->max_rounds < 0 ||
        s->zone_rounds < 0 || s->roll_rounds < 0)
        return DRAPE_EARG;
    response_reset(s);
    gpu_clear(g, s->rolled, (size_t)s->nv);
    LAUNCH(g, s->nv, response_start_kernel, *s);
    return gpu_status(g);
}

/* Thread k owns vertex[k]: writes its x1 and touched, and v where it stops. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    response_advance_kernel(struct response s, struct amount n,
                            const int32_t *vertex, const uint8_t *moved,
                            bool stop)
{
    ITEM(k, number(n));
    if (moved && !moved[k])
        return;
    int32_t i = vertex[k];
    s.x1[i] = axpy(s.x0[i], s.dt, s.u[i]);
    s.touched[i] = 1;
    if (stop)
        s.v[i] = s.u[i];
}

void gpu_response_advance(struct gpu *g, struct response *s, int64_t n,
                          const int32_t *vertex, const uint8_t *moved,
                          bool stop)
{
    struct amount all = {n, NULL};
    LAUNCH(g, n, response_advance_kernel, *s, all, vertex, moved, stop);
}

/* Solves the contacts in contact[side] and moves their vertices. */
static int solve_contacts(struct gpu *g, struct response *s, int64_t n,
                          int warm)
{
    struct amount some = gpu_amount(g, n), vertices;
    n = some.most;
    struct room room[] = {{&s->item, 4 * n, sizeof(int32_t)},
                          {&s->parts, 2 * s->nv, sizeof(int32_t)},
                          {&s->lack, 2 * n, sizeof(real)},
                          {&s->push, n, sizeof(vec)},
                          {&s->vertex, 4 * n, sizeof(int32_t)},
                          {&s->moved, 4 * n, sizeof(uint8_t)},
                          {&s->awake, n + s->nv, sizeof(uint8_t)}};
    int status = gpu_response_grow(g, 7, room);
    if (status != DRAPE_OK)
        return status;
    struct contacts c = {};
    c.nv = s->nv;
    c.n = n;
    c.w = s->w;
    c.iterations = response_iterations(s);
    c.warm = warm;
    c.contact = (struct contact *)s->contact[s->side].data;
    c.u = s->u;
    c.v = s->v;
    c.nv1 = s->nv + 1;
    c.n4 = 4 * n;
    c.start = s->start;
    c.item = (int32_t *)s->item.data;
    c.parts = (int32_t *)s->parts.data;
    c.acting = c.parts + s->nv;
    c.lack = (real *)s->lack.data;
    c.ahead = c.lack + n;
    c.before = (vec *)s->push.data; /* pushes lie by vertex there */
    c.vertex = (int32_t *)s->vertex.data;
    c.moved = (uint8_t *)s->moved.data;
    c.awake = (uint8_t *)s->awake.data;
    c.stirred = c.awake + n;
    status = gpu_contacts_of(g, &c, some, &vertices);
    if (!s->solve) /* a query is next, not of what moves alone */
        gpu_fence(g);
    gpu_trace(g, s->trace, "contacts", s->u, (size_t)s->nv * sizeof *s->u);
    if (status == DRAPE_OK)
        LAUNCH(g, vertices.most, response_advance_kernel, *s, vertices,
               c.vertex, c.moved, false);
    return status;
}

/* ---- §2 Repulsion ---- */

int gpu_response_repel(struct gpu *g, struct response *s,
                       const struct pairs *near)
{
    s->near = near->n;
    if (!near->n)
        return DRAPE_OK;
    struct proximity p = {};
    struct pool *out = &s->contact[s->side];
    p.nv = s->nv;
    p.n = near->n;
    p.pair = near->pair;
    p.kind = near->kind;
    p.x = s->x0;
    p.w = s->w;
    p.skin = s->skin;
    p.dt = s->dt;
    p.stiffness = s->stiffness;
    struct room room = {&s->at, gpu_room(g, near->n), sizeof *p.at};
    int status = gpu_response_grow(g, 1, &room);
    if (status != DRAPE_OK)
        return status;
    p.at = (int32_t *)s->at.data;
    do {
        p.cap = out->cap;
        p.contact = (struct contact *)out->data;
        status = gpu_proximity(g, &p);
    } while (status == DRAPE_EFULL &&
             (status = grow_contacts(g, out, p.found)) == DRAPE_OK);
    if (status != DRAPE_OK)
        return status;
    s->contacts = p.found;
    gpu_keep_found(g, &s->active);
    gpu_trace(g, s->trace, "proximity", p.contact,
              (size_t)p.found * sizeof *p.contact);
    if (!p.found)
        return DRAPE_OK;
    if (!s->solve)
        return solve_contacts(g, s, p.found, 0);
    s->active = p.found; /* they go on through the rounds */
    return s->solve(s->user, p.found, p.contact);
}

/* ---- §4 Impulses ---- */

/* What touches joins the active set, contact[side]. */
static int find_impulses(struct gpu *g, struct response *s)
{
    struct pool *from = &s->contact[s->side], *to = &s->contact[!s->side];
    struct impulses m = {};
    m.nv = s->nv;
    m.n = s->hits;
    m.pair = (int32_t *)s->hit.data;
    m.kind = (uint8_t *)s->hit_kind.data;
    m.toi = (uint32_t *)s->hit_toi.data;
    m.x0 = s->x0;
    m.x1 = s->x1;
    m.skin = s->skin;
    m.dt = s->dt;
    m.margin = s->margin;
    m.n_active = s->active;
    m.active = (struct contact *)from->data;
    m.n_all = m.n + m.n_active;
    struct amount hits = gpu_amount(g, m.n);
    struct amount active =
        gpu_amount_at(g, m.n_active, gpu_recall(g, &s->active));
    int64_t most = hits.most + active.most;
    struct room room[] = {{&s->key[0], most, sizeof *m.key},
                          {&s->key[1], most, sizeof *m.key}};
    int status = gpu_response_grow(g, 2, room);
    if (status != DRAPE_OK)
        return status;
    m.key = (struct key *)s->key[0].data;
    m.spare = (struct key *)s->key[1].data;
    do {
        m.cap = to->cap;
        m.contact = (struct contact *)to->data;
        status = gpu_impulses_of(g, &m, hits, active);
    } while (status == DRAPE_EFULL &&
             (status = grow_contacts(g, to, m.found)) == DRAPE_OK);
    if (status != DRAPE_OK)
        return status;
    s->side = !s->side;
    s->active = m.found;
    gpu_keep_found(g, &s->active);
    gpu_trace(g, s->trace, "impulses", m.contact,
              (size_t)m.found * sizeof *m.contact);
    return DRAPE_OK;
}

/* Thread k owns contact k: what others ask for beside what touches: no more
 * than that does. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    response_settle_kernel(struct response s, struct amount n,
                           struct contact *contact)
{
    ITEM(k, number(n));
    struct contact *c = &contact[k];
    real keep = s.margin * surface_of(&s.skin, c->v).thickness;
    c->target = least(c->target, (keep - c->gap) / s.dt);
}

static int push(struct gpu *g, struct response *s, int round)
{
    int64_t held = s->active;
    int status = find_impulses(g, s);
    if (status != DRAPE_OK)
        return status;
    struct contact *contact = (struct contact *)s->contact[s->side].data;
    if (round == 0 && s->solve && s->active > held)
        return s->solve(s->user, s->active, contact);
    /* only impulses that contacts gave can it withdraw */
    bool warm = s->impelled;
    struct amount active = gpu_amount(g, s->active);
    if (!warm)
        LAUNCH(g, active.most, response_settle_kernel, *s, active, contact);
    s->impelled = true;
    return solve_contacts(g, s, s->active, warm);
}

/* Thread k owns corner k of the hits: marks its vertex where it is free. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    response_touch_kernel(struct response s, struct amount hits,
                          const int32_t *hit)
{
    ITEM(k, 4 * number(hits));
    s.touched[hit[k]] = s.w[hit[k]] > 0;
}

static int resolve(struct gpu *g, struct response *s, int round)
{
    int rolls = round - s->max_rounds - s->zone_rounds;
    if (rolls >= 0) {
        gpu_tape_end(g);
        return gpu_response_roll(g, s, rolls);
    }
    if (round >= s->max_rounds)
        gpu_tape_end(g);
    struct amount hits = gpu_amount(g, s->hits);
    gpu_clear(g, s->touched, (size_t)s->nv);
    LAUNCH(g, 4 * hits.most, response_touch_kernel, *s, hits,
           (const int32_t *)s->hit.data);
    return round < s->max_rounds ? push(g, s, round)
                                 : gpu_response_stiffen(g, s);
}

int gpu_response_penetrate(struct gpu *g, struct response *s)
{
    if (!s->solve)
        s->active = 0; /* what repulsion left there is done */
    int status = gpu_response_detect(g, s, NULL);
    s->rounds = 1;
    for (int round = 0; status == DRAPE_OK && s->hits > 0; round++) {
        if (s->brief && round >= s->max_rounds) {
            s->outcome |= DRAPE_ZONES;
            break;
        }
        status = resolve(g, s, round);
        if (status != DRAPE_OK || s->hits == 0)
            break;
        status = gpu_response_detect(g, s, s->touched);
        s->rounds++;
    }
    if (s->started || s->led)
        s->outcome |= DRAPE_TRAPPED;
    return status;
}
