/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the list of the last slice's contacts. The host makes it for both
 * backends, from the contacts that the solve and the rounds have left.
 * spec/control/control.md §8 */
#include "ref/control/list.h"

#include "ref/contact/impulses.h"
#include "ref/contact/kept.h"

static int bodies_of(const struct world *w)
{
    return w->def.n_cloths + w->def.n_obstacles;
}

static void *take_array(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_OTHER, n, size);
}

/* Gives back *p and takes n items with a reserve. False: no memory. */
static bool grow_array(struct world *w, void **p, int64_t n, size_t size)
{
    arena_give(w->arena, *p);
    *p = take_array(w, n + n / 4 + 64, size);
    return *p != NULL;
}

/* Takes the host's memory for n contacts. */
static int make_room(struct world *w, int64_t n)
{
    struct list *l = &w->list;
    if (!l->body)
        l->body = take_array(w, bodies_of(w), sizeof *l->body);
    bool good = l->body != NULL;
    if (good && n > l->cap) {
        void *item = l->item, *raw = l->raw, *key = l->key, *spare = l->spare;
        good = grow_array(w, &item, n, sizeof *l->item);
        good = good && grow_array(w, &key, n, sizeof *l->key);
        good = good && grow_array(w, &spare, n, sizeof *l->spare);
        good = good && (w->home == w || grow_array(w, &raw, n, sizeof *l->raw));
        l->item = item;
        l->raw = raw;
        l->key = key;
        l->spare = spare;
        l->cap = good ? n + n / 4 + 64 : 0;
    }
    return good ? DRAPE_OK : DRAPE_ENOMEM;
}

/* The contacts that the solve and the rounds left, on the host. */
struct left {
    int64_t n, n_pushed;
    const struct contact *contact; /* [n] as the solve left them */
    const struct contact *pushed;  /* [n_pushed] as the rounds did, by key */
    double span; /* of an impulse of the solve, which acts for tau: dt / tau */
    struct kept *kept; /* [n_kept] of the arena, by key: the multipliers */
    int64_t n_kept;
};

/* Brings the contacts of a device. */
static int fetch_contacts(struct world *w, struct left *s)
{
    struct list *l = &w->list;
    const struct response *c = &w->response;
    const struct coulomb *law = &w->lagrange.law;
    s->contact = c->contact[c->solved].data;
    s->pushed = c->contact[c->side].data;
    s->span = (double)law->dt / (double)law->tau;
    if (w->home == w || s->n + s->n_pushed == 0)
        return DRAPE_OK;
    struct contact *pushed = l->raw + s->n;
    size_t bytes = sizeof *l->raw;
    w->run->fetch(w->on, l->raw, s->contact, (size_t)s->n * bytes);
    w->run->fetch(w->on, pushed, s->pushed, (size_t)s->n_pushed * bytes);
    s->contact = l->raw;
    s->pushed = pushed;
    return w->run->status(w->on);
}

/* The number of vertices of side A. */
static int count_side_a(const struct contact *c)
{
    return c->kind == CONTACT_VF ? 1 : 2;
}

static void add_scaled(double to[3], double a, vec b)
{
    to[0] += a * (double)b.x;
    to[1] += a * (double)b.y;
    to[2] += a * (double)b.z;
}

/* §8.1: the impulse on side A. */
static vec push_of(const struct contact *c)
{
    return vec_axpy(c->tangent, c->impulse, c->n);
}

/* Fills the row of contact c but for its impulse. */
static void describe_contact(const struct world *w, const struct contact *c,
                             drape_contact *to)
{
    const uint16_t *body = w->home->body;
    memset(to, 0, sizeof *to);
    to->kind = c->kind;
    to->body[0] = body[c->v[0]];
    to->body[1] = body[c->v[count_side_a(c)]];
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

static bool comes_before(const struct key *a, const struct key *b)
{
    return a->hi < b->hi || (a->hi == b->hi && a->lo < b->lo);
}

/* §8.1: adds the impulses of the rounds: to the solve's contacts, and as
 * contacts of their own. Returns how many the list has then. */
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
        while (at < s->n && comes_before(&key[at], &mine))
            at++;
        bool known = at < s->n && !comes_before(&mine, &key[at]) &&
                     is_same(&s->contact[key[at].item], c);
        int64_t to = known ? key[at].item : n++;
        if (!known)
            describe_contact(w, c, &l->item[to]);
        add_scaled(l->item[to].impulse, 1, push_of(c));
    }
    return n;
}

/* §8.3: sums the impulses of the list on each body. */
static void sum_impulses(struct world *w, int64_t n)
{
    double(*body)[3] = w->list.body;
    for (int64_t k = 0; k < n; k++) {
        const drape_contact *c = &w->list.item[k];
        for (int i = 0; i < 3; i++) {
            body[c->body[0]][i] += c->impulse[i];
            body[c->body[1]][i] -= c->impulse[i];
        }
    }
}

/* §8.2: the part of a contact's impulse in the solve that the slice got. An
 * impact after a slice with a past is a jump at the slice's start, which the
 * solve makes 3/2 of its size (lagrange.md §5). */
static double part_of(const struct left *s, const struct contact *c)
{
    bool lasts =
        s->span == 1 || !(c->impulse > 0) || carry_find(s->kept, s->n_kept, c);
    return lasts ? s->span : 1 / s->span;
}

/* Makes the list of the contacts that the slice left. Returns how many contacts
 * it has. */
static int64_t make_list(struct world *w, struct left *s)
{
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        describe_contact(w, c, &w->list.item[k]);
        add_scaled(w->list.item[k].impulse, part_of(s, c), push_of(c));
    }
    int64_t n = add_rounds(w, s);
    sum_impulses(w, n);
    return n;
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
    struct left s = {.n = met && w->lagrange.solved ? c->n_solved : 0,
                     .n_pushed = met && c->contacts_solved ? c->active : 0};
    if (!w->plan.implicit)
        return DRAPE_EARG;
    w->run->begin(w->on);
    int status = make_room(w, s.n + s.n_pushed);
    list->n = 0;
    if (status == DRAPE_OK)
        memset(w->list.body, 0, (size_t)bodies_of(w) * sizeof *w->list.body);
    if (status == DRAPE_OK && met)
        status = fetch_contacts(w, &s);
    if (status == DRAPE_OK && s.n > 0 && s.span != 1)
        status = kept_gather(w, &s.kept, &s.n_kept);
    if (status == DRAPE_OK && met)
        list->n = make_list(w, &s);
    arena_give(w->arena, s.kept);
    list->contact = w->list.item;
    list->impulse = (const double(*)[3])w->list.body;
    list->dt = w->dt;
    return status == DRAPE_OK && there ? lend_there(w, list->n, list) : status;
}
