/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the list of the last slice's contacts. The host makes it for both
 * backends, from what the solve and the rounds have left.
 * spec/control/control.md §8 */
#include "ref/control/list.h"

static int bodies_of(const struct world *w)
{
    return w->def.n_cloths + w->def.n_obstacles;
}

static void *take(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_OTHER, n, size);
}

/* Gives back *p and takes n items with a reserve. False: no memory. */
static bool grow(struct world *w, void **p, int64_t n, size_t size)
{
    arena_give(w->arena, *p);
    *p = take(w, n + n / 4 + 64, size);
    return *p != NULL;
}

/* Takes the host's memory for n contacts. */
static int make_room(struct world *w, int64_t n)
{
    struct list *l = &w->list;
    bool good = true;
    if (!l->at)
        l->at = take(w, w->nc, sizeof *l->at);
    if (!l->g)
        l->g = take(w, w->nc, sizeof *l->g);
    if (!l->body)
        l->body = take(w, bodies_of(w), sizeof *l->body);
    if (w->home != w && !l->given)
        l->given = take(w, w->nc, sizeof *l->given);
    if (w->home != w && !l->hold)
        l->hold = take(w, w->nv, sizeof *l->hold);
    if (w->home != w && !l->dv)
        l->dv = take(w, w->nv, sizeof *l->dv);
    good = l->at && l->g && l->body &&
           (w->home == w || (l->given && l->hold && l->dv));
    if (good && n > l->cap) {
        void *item = l->item, *raw = l->raw, *share = l->share;
        good = grow(w, &item, n, sizeof *l->item);
        good = good && grow(w, &share, n, sizeof *l->share);
        good = good && (w->home == w || grow(w, &raw, n, sizeof *l->raw));
        l->item = item;
        l->raw = raw;
        l->share = share;
        l->cap = good ? n + n / 4 + 64 : 0;
    }
    return good ? DRAPE_OK : DRAPE_ENOMEM;
}

/* What the solve and the rounds left, on the host. */
struct left {
    int64_t n;
    struct contact *contact; /* [n] */
    const vec *g;            /* [nc] N·s, of vertices */
    const vec *dv;           /* [nv] m/s, of a solve after that */
    struct penalty penalty;  /* what penalty_load reads */
};

/* §8.2: whether the contacts are as the solve left them. */
static bool is_of_solve(const struct world *w)
{
    const struct couple *c = &w->couple;
    return !w->response.contacts_solved && !c->penalty.settled &&
           c->joint.outcome != PCG_BREAKDOWN;
}

/* What the last slice's vertices got of their contacts. */
static void find_got(const struct world *w, const vec *g, const vec *r)
{
    for (int64_t i = 0; i < w->nc; i++)
        w->list.g[i] = vec_add(g[i], r[i]);
}

static int bring(struct world *w, struct left *s)
{
    struct list *l = &w->list;
    const struct response *c = &w->response;
    const struct couple *of = &w->couple;
    size_t cloth = (size_t)w->nc * sizeof(vec), all = (size_t)w->nv;
    s->contact = c->contact[c->side].data;
    s->g = l->g;
    s->dv = of->joint.dv;
    s->penalty = of->penalty;
    if (w->home == w) {
        find_got(w, of->g, of->joint.r);
        return DRAPE_OK;
    }
    w->run->fetch(w->on, l->g, of->g, cloth);
    w->run->fetch(w->on, l->given, of->joint.r, cloth);
    find_got(w, l->g, l->given);
    w->run->fetch(w->on, l->given, of->given, cloth);
    w->run->fetch(w->on, l->dv, s->dv, all * sizeof *l->dv);
    w->run->fetch(w->on, l->hold, s->penalty.hold, all * sizeof *l->hold);
    w->run->fetch(w->on, l->raw, s->contact, (size_t)s->n * sizeof *l->raw);
    s->contact = l->raw;
    s->dv = l->dv;
    s->penalty.g = l->given;
    s->penalty.hold = l->hold;
    s->penalty.w = w->home->w;
    return w->run->status(w->on);
}

static bool is_free(const struct world *w, int32_t i)
{
    return w->home->w[i] > 0;
}

/* The number of vertices of side A. */
static int split(const struct contact *c)
{
    return c->kind == CONTACT_VF ? 1 : 2;
}

static void add(double to[3], double a, vec b)
{
    to[0] += a * (double)b.x;
    to[1] += a * (double)b.y;
    to[2] += a * (double)b.z;
}

/* §8.2: what contact k bears of its vertices, N·s along its own push. */
static void find_loads(struct left *s, int64_t k, real load[4])
{
    memset(load, 0, 4 * sizeof *load);
    if (s->contact[k].held)
        penalty_load(&s->penalty, k, load);
    for (int j = 0; j < 4; j++)
        load[j] = real_max(load[j], 0);
}

/* §8.2: the sums of a vertex over its held contacts, and what it got beside
 * their loads. */
static void sum_vertices(struct world *w, struct left *s)
{
    struct list_vertex *at = w->list.at;
    memset(at, 0, (size_t)w->nc * sizeof *at);
    for (int64_t i = 0; i < w->nc; i++)
        add(at[i].rest, 1, s->g[i]);
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        real load[4];
        find_loads(s, k, load);
        for (int j = 0; j < 4 && c->held; j++) {
            if (!is_free(w, c->v[j]))
                continue;
            struct list_vertex *v = &at[c->v[j]];
            v->weight += fabs((double)c->c[j]);
            v->grip += (double)(c->friction * load[j]);
            add(v->rest, c->c[j] < 0 ? load[j] : -load[j], c->n);
        }
    }
}

/* §8.2: the part of contact k in what its vertex j got beside loads. */
static double part_of(const struct list_vertex *v, const struct contact *c,
                      int j, real load)
{
    return v->grip > 0 ? (double)(c->friction * load) / v->grip
                       : fabs((double)c->c[j]) / v->weight;
}

/* §8.2: contact k's share of what its vertices got, as an impulse on A: its
 * loads, and its part of the rest, or of what of it is across n. */
static void share(const struct world *w, struct left *s, int64_t k, bool across,
                  double impulse[3])
{
    const struct contact *c = &s->contact[k];
    double n[3] = {0}, side[2][3] = {{0}}, along = 0;
    bool is[2] = {false, false};
    real load[4];
    find_loads(s, k, load);
    add(n, 1, c->n);
    for (int j = 0; j < 4 && c->held; j++) {
        int b = j >= split(c);
        if (!is_free(w, c->v[j]) || c->c[j] == 0)
            continue;
        const struct list_vertex *v = &w->list.at[c->v[j]];
        double part = (b ? -1 : 1) * part_of(v, c, j, load[j]);
        along = n[0] * v->rest[0] + n[1] * v->rest[1] + n[2] * v->rest[2];
        is[b] = true;
        add(side[b], (double)load[j], c->n);
        for (int i = 0; i < 3; i++)
            side[b][i] += part * (v->rest[i] - (across ? along * n[i] : 0));
    }
    double half = is[0] && is[1] ? 0.5 : 1;
    for (int i = 0; i < 3; i++)
        impulse[i] = half * (side[0][i] + side[1][i]);
}

/* §8.2: the friction of contact k by what the solve left. */
static vec rub(const struct world *w, const struct left *s,
               const struct contact *c)
{
    vec d = pair_sum(c->v, c->c, s->dv);
    real across = c->slide * (s->penalty.tau / s->penalty.dt);
    d = vec_axpy(d, -vec_dot(c->n, d), c->n);
    return w->couple.calm ? c->tangent : vec_axpy(c->tangent, -across, d);
}

/* §8.2: the impulse on A of contact k: its load and its friction. */
static void press(const struct world *w, struct left *s, int64_t k,
                  double impulse[3])
{
    const struct contact *c = &s->contact[k];
    real load[4] = {0, 0, 0, 0};
    if (!is_of_solve(w)) {
        share(w, s, k, true, impulse);
    } else if (c->held) {
        add(impulse, (double)penalty_load(&s->penalty, k, load), c->n);
        add(impulse, 1, rub(w, s, c));
    }
}

/* §8.1: the impulse of the rounds. */
static vec pushed(const struct world *w, const struct contact *c)
{
    if (!w->response.contacts_solved)
        return vec_make(0, 0, 0);
    return vec_axpy(c->tangent, c->impulse, c->n);
}

static void fill(const struct world *w, struct left *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    drape_contact *to = &w->list.item[k];
    const uint16_t *body = w->home->body;
    memset(to, 0, sizeof *to);
    to->kind = c->kind;
    to->body[0] = body[c->v[0]];
    to->body[1] = body[c->v[split(c)]];
    for (int j = 0; j < 4; j++) {
        to->vertex[j] = c->v[j];
        to->weight[j] = (double)c->c[j];
    }
    to->normal[0] = (double)c->n.x;
    to->normal[1] = (double)c->n.y;
    to->normal[2] = (double)c->n.z;
    to->gap = (double)c->gap;
    press(w, s, k, to->impulse);
    add(to->impulse, 1, pushed(w, c));
}

/* §8.3: what each body got: a cloth by what its vertices got, an obstacle by
 * the contacts. */
static void sum(struct world *w, struct left *s)
{
    double(*body)[3] = w->list.body;
    const uint16_t *of = w->home->body;
    memset(body, 0, (size_t)bodies_of(w) * sizeof *body);
    for (int64_t i = 0; i < w->nc && w->met; i++)
        if (is_free(w, (int32_t)i))
            add(body[of[i]], 1, s->g[i]);
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        const drape_contact *a = &w->list.item[k];
        for (int j = 0; j < 4; j++)
            if (is_free(w, c->v[j]))
                add(body[of[c->v[j]]], (double)c->c[j], pushed(w, c));
        double got[3] = {0, 0, 0};
        share(w, s, k, false, got);
        add(got, 1, pushed(w, c));
        for (int b = 0; b < 2; b++)
            for (int i = 0; i < 3 && a->body[b] >= w->def.n_cloths; i++)
                body[a->body[b]][i] += b ? -got[i] : got[i];
    }
}

/* Brings the list to the backend's memory. */
static int lend_there(struct world *w, int64_t n, drape_contact_list *list)
{
    struct list *l = &w->list;
    size_t bodies = (size_t)bodies_of(w);
    if (w->home == w)
        return DRAPE_OK;
    if (!l->body_there)
        l->body_there = w->run->take(w->on, ARENA_OTHER, (int64_t)bodies,
                                     sizeof *l->body_there);
    if (n > l->cap_there) {
        w->run->give(w->on, l->there);
        l->cap_there = 0;
        l->there = w->run->take(w->on, ARENA_OTHER, l->cap, sizeof *l->there);
        l->cap_there = l->there ? l->cap : 0;
    }
    if (!l->body_there || n > l->cap_there)
        return w->run->status(w->on);
    w->run->send(w->on, l->there, l->item, (size_t)n * sizeof *l->item);
    w->run->send(w->on, l->body_there, l->body, bodies * sizeof *l->body);
    list->contact = l->there;
    list->impulse = (const double(*)[3])l->body_there;
    return w->run->status(w->on);
}

int list_contacts(struct world *w, bool there, drape_contact_list *list)
{
    struct left s = {.n = w->list.known && w->met ? w->response.active : 0};
    if (!w->plan.implicit)
        return DRAPE_EARG;
    w->run->begin(w->on);
    int status = make_room(w, s.n);
    if (status == DRAPE_OK && w->plan.collides && w->list.known && w->met) {
        status = bring(w, &s);
        if (status == DRAPE_OK) {
            s.penalty.contact = s.contact;
            s.penalty.share = w->list.share;
            sum_vertices(w, &s);
        }
        for (int64_t k = 0; k < s.n && status == DRAPE_OK; k++)
            fill(w, &s, k);
        if (status == DRAPE_OK)
            sum(w, &s);
    } else if (status == DRAPE_OK)
        memset(w->list.body, 0, (size_t)bodies_of(w) * sizeof *w->list.body);
    list->n = s.n;
    list->contact = w->list.item;
    list->impulse = (const double(*)[3])w->list.body;
    list->dt = w->dt;
    return status == DRAPE_OK && there ? lend_there(w, s.n, list) : status;
}
