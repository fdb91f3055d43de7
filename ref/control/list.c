/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the list of the last slice's contacts. The host makes it for both
 * backends, from what the solve and the rounds have left.
 * spec/control/control.md §8 */
#include "ref/control/list.h"

#include "ref/contact/impulses.h"

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
        void *key = l->key, *spare = l->spare, *gave = l->gave;
        good = grow(w, &item, n, sizeof *l->item);
        good = good && grow(w, &share, n, sizeof *l->share);
        good = good && grow(w, &key, n, sizeof *l->key);
        good = good && grow(w, &spare, n, sizeof *l->spare);
        good = good && (w->home == w || grow(w, &raw, n, sizeof *l->raw));
        good = good && (w->home == w || grow(w, &gave, n, sizeof *l->gave));
        l->item = item;
        l->raw = raw;
        l->share = share;
        l->key = key;
        l->spare = spare;
        l->gave = gave;
        l->cap = good ? n + n / 4 + 64 : 0;
    }
    return good ? DRAPE_OK : DRAPE_ENOMEM;
}

/* What the solve and the rounds left, on the host. */
struct left {
    int64_t n, n_pushed;
    const struct contact *contact; /* [n] as the solve left them */
    const struct contact *pushed;  /* [n_pushed] as the rounds did, by key */
    const vec *g;                  /* [nc] N·s, of vertices, by the solve */
    const vec *dv;                 /* [nv] m/s, of its last one */
    struct penalty penalty;        /* what penalty_load reads, and gave */
};

/* What the last slice's vertices got of their contacts. */
static void find_got(const struct world *w, const vec *g, const vec *r)
{
    for (int64_t i = 0; i < w->nc; i++)
        w->list.g[i] = vec_add(g[i], r[i]);
}

/* Brings the contacts of a device. */
static void bring_contacts(struct world *w, struct left *s)
{
    struct list *l = &w->list;
    struct contact *pushed = l->raw + s->n;
    size_t bytes = sizeof *l->raw;
    w->run->fetch(w->on, l->raw, s->contact, (size_t)s->n * bytes);
    w->run->fetch(w->on, pushed, s->pushed, (size_t)s->n_pushed * bytes);
    w->run->fetch(w->on, l->gave, s->penalty.gave,
                  (size_t)s->n * sizeof *l->gave);
    s->contact = l->raw;
    s->pushed = pushed;
    s->penalty.gave = l->gave;
}

static int bring(struct world *w, struct left *s)
{
    struct list *l = &w->list;
    const struct response *c = &w->response;
    const struct couple *of = &w->couple;
    size_t cloth = (size_t)w->nc * sizeof(vec), all = (size_t)w->nv;
    s->contact = c->contact[c->solved].data;
    s->pushed = c->contact[c->side].data;
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
    bring_contacts(w, s);
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

/* §8.2: the impulse on A of contact k by the solve: its load and its friction.
 */
static void press(const struct world *w, struct left *s, int64_t k,
                  double impulse[3])
{
    const struct contact *c = &s->contact[k];
    real load[4] = {0, 0, 0, 0};
    if (w->couple.joint.outcome == PCG_BREAKDOWN) {
        share(w, s, k, true, impulse);
    } else if (c->held) {
        real all = w->couple.calm ? s->penalty.gave[k]
                                  : penalty_load(&s->penalty, k, load);
        add(impulse, (double)all, c->n);
        add(impulse, 1, rub(w, s, c));
    }
}

/* §8.1: the impulse of the rounds. */
static vec push_of(const struct contact *c)
{
    return vec_axpy(c->tangent, c->impulse, c->n);
}

/* What contact c is, without an impulse yet. */
static void describe(const struct world *w, const struct contact *c,
                     drape_contact *to)
{
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
}

/* Whether the rounds had contact a of the solve as their contact b: no impact
 * of its pair has replaced it. */
static bool is_same(const struct contact *a, const struct contact *b)
{
    return !memcmp(a->v, b->v, sizeof a->v) &&
           !memcmp(a->c, b->c, sizeof a->c) &&
           !memcmp(&a->n, &b->n, sizeof a->n) &&
           !memcmp(&a->gap, &b->gap, sizeof a->gap);
}

static bool precedes(const struct key *a, const struct key *b)
{
    return a->hi < b->hi || (a->hi == b->hi && a->lo < b->lo);
}

/* §8.1: adds what the rounds gave: to the solve's contacts, and as contacts of
 * their own. Returns how many the list has then. */
static int64_t add_rounds(struct world *w, const struct left *s)
{
    struct list *l = &w->list;
    int64_t n = s->n, at = 0;
    for (int64_t k = 0; k < s->n; k++)
        l->key[k] = impulses_key(s->contact[k].v, s->contact[k].kind, k);
    const struct key *key = keys_sort(s->n, l->key, l->spare);
    for (int64_t k = 0; k < s->n_pushed; k++) {
        const struct contact *c = &s->pushed[k];
        struct key mine = impulses_key(c->v, c->kind, k);
        while (at < s->n && precedes(&key[at], &mine))
            at++;
        bool known = at < s->n && !precedes(&mine, &key[at]) &&
                     is_same(&s->contact[key[at].item], c);
        int64_t to = known ? key[at].item : n++;
        if (!known)
            describe(w, c, &l->item[to]);
        add(l->item[to].impulse, 1, push_of(c));
    }
    return n;
}

/* §8.3: what each body got: a cloth by what its vertices got, an obstacle by
 * the contacts. */
static void sum(struct world *w, struct left *s)
{
    double(*body)[3] = w->list.body;
    const uint16_t *of = w->home->body;
    for (int64_t i = 0; i < w->nc; i++)
        if (is_free(w, (int32_t)i))
            add(body[of[i]], 1, s->g[i]);
    for (int64_t k = 0; k < s->n; k++) {
        const drape_contact *a = &w->list.item[k];
        double got[3] = {0, 0, 0};
        share(w, s, k, false, got);
        for (int b = 0; b < 2; b++)
            for (int i = 0; i < 3 && a->body[b] >= w->def.n_cloths; i++)
                body[a->body[b]][i] += b ? -got[i] : got[i];
    }
    for (int64_t k = 0; k < s->n_pushed; k++) {
        const struct contact *c = &s->pushed[k];
        for (int j = 0; j < 4; j++) {
            int b = of[c->v[j]];
            if (is_free(w, c->v[j]) || b >= w->def.n_cloths)
                add(body[b], (double)c->c[j], push_of(c));
        }
    }
}

/* Makes the list of what the slice left. Returns how many contacts it has. */
static int64_t make(struct world *w, struct left *s)
{
    s->penalty.contact = (struct contact *)s->contact;
    s->penalty.share = w->list.share;
    sum_vertices(w, s);
    for (int64_t k = 0; k < s->n; k++) {
        describe(w, &s->contact[k], &w->list.item[k]);
        press(w, s, k, w->list.item[k].impulse);
    }
    sum(w, s);
    return add_rounds(w, s);
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
    const struct response *c = &w->response;
    bool met = w->plan.collides && w->list.known && w->met;
    struct left s = {.n = met ? c->n_solved : 0,
                     .n_pushed = met && c->contacts_solved ? c->active : 0};
    if (!w->plan.implicit)
        return DRAPE_EARG;
    w->run->begin(w->on);
    int status = make_room(w, s.n + s.n_pushed);
    list->n = 0;
    if (status == DRAPE_OK)
        memset(w->list.body, 0, (size_t)bodies_of(w) * sizeof *w->list.body);
    if (status == DRAPE_OK && met)
        status = bring(w, &s);
    if (status == DRAPE_OK && met)
        list->n = make(w, &s);
    list->contact = w->list.item;
    list->impulse = (const double(*)[3])w->list.body;
    list->dt = w->dt;
    return status == DRAPE_OK && there ? lend_there(w, list->n, list) : status;
}
