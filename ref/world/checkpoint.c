/* SPDX-License-Identifier: Apache-2.0 */
/* Saves and loads checkpoints. A checkpoint holds the state of a world and a
 * fingerprint of the world's definition. Everything else in a world follows
 * from the definition, so it is not saved. */
#include "ref/world/checkpoint.h"

#include <float.h>

#include "ref/base/hash.h"
#include "ref/cloth/table.h"
#include "ref/contact/kept.h"
#include "ref/control/control.h"
#include "ref/sleep/sleep.h"
#include "ref/world/air.h"

struct header {
    char magic[8]; /* "drape-" and the number of this format */
    uint64_t bits;
    uint64_t fingerprint, check; /* check: a hash of all other bytes */
    int64_t step, vertices, intersecting;
    double time;
    uint32_t nearness, past;
    int64_t kept; /* of struct kept, behind the streams */
    drape_wind wind;
};
static const char magic[8] = "drape-a";
/* A world that its caller has changed has another magic, and after the header
 * what follows from the changes: control.md §6. This part holds materials, so
 * its number is also that of the layout of drape_material. */
static const char changed[8] = "drape+a";
struct changes {
    int64_t bytes;  /* of control_pack; 0 */
    uint64_t armed; /* 1: the targets of the next step follow the streams */
    double gravity[3];
};

/* Mixes an array of n items into the hash, with its length first: so no item
 * can move from the end of one array to the start of the next unnoticed. A
 * missing array has length -1, which differs from an empty one. */
static uint64_t mix_array(uint64_t hash, const void *data, int64_t n,
                          size_t size)
{
    n = data ? n : -1;
    hash = hash_mix(hash, &n, sizeof n);
    return n > 0 ? hash_mix(hash, data, (size_t)n * size) : hash;
}

/* Of tables only their points: a material without one has the hash that it had
 * before there were tables, and old checkpoints of its world stay valid. */
static uint64_t mix_material(uint64_t h, const drape_material *m)
{
    h = hash_mix(h, m, offsetof(drape_material, table));
    for (int o = 0; o < DRAPE_TABLES; o++) {
        int64_t n = table_points(m->table[o]);
        if (n > 0) {
            h = hash_mix(h, &o, sizeof o);
            h = mix_array(h, m->table[o], n, sizeof *m->table[o]);
        }
    }
    return h;
}

static uint64_t print_cloth(const drape_cloth *c)
{
    uint64_t h = HASH_SEED;
    int64_t n = (int64_t)c->m * c->n, cells = (int64_t)(c->m - 1) * (c->n - 1);
    const int size[2] = {c->m, c->n};
    h = hash_mix(h, size, sizeof size);
    h = hash_mix(h, &c->width, sizeof c->width);
    h = hash_mix(h, &c->height, sizeof c->height);
    h = mix_material(h, &c->material);
    h = hash_mix(h, &c->bending, sizeof c->bending);
    h = hash_mix(h, c->origin, sizeof c->origin);
    h = hash_mix(h, c->u, sizeof c->u);
    h = hash_mix(h, c->v, sizeof c->v);
    h = mix_array(h, c->x, n, sizeof *c->x);
    h = mix_array(h, c->velocity, n, sizeof *c->velocity);
    h = mix_array(h, c->hole, n, sizeof *c->hole);
    h = mix_array(h, c->cut, cells, sizeof *c->cut);
    if (c->panel) {
        h = mix_array(h, c->panel->rest, n, sizeof *c->panel->rest);
        h = mix_array(h, c->panel->cell, cells, sizeof *c->panel->cell);
        for (int k = 0; k < c->panel->n_eases; k++) {
            const drape_ease *e = &c->panel->eases[k];
            h = hash_mix(h, e->end, sizeof e->end);
            h = hash_mix(h, &e->ratio, sizeof e->ratio);
        }
    }
    return mix_array(h, c->pins, c->n_pins, sizeof *c->pins);
}

static uint64_t print_obstacle(const drape_obstacle *o)
{
    uint64_t h = HASH_SEED;
    int64_t shown = o->frames * o->n_vertices;
    h = hash_mix(h, &o->friction, sizeof o->friction);
    h = hash_mix(h, &o->motion, sizeof o->motion);
    h = hash_mix(h, &o->frames, sizeof o->frames);
    h = hash_mix(h, &o->frame_dt, sizeof o->frame_dt);
    /* of what is not set nothing: old checkpoints stay valid */
    if (o->between)
        h = hash_mix(h, &o->between, sizeof o->between);
    if (shown && o->frame_time)
        h = mix_array(h, o->frame_time, o->frames, sizeof *o->frame_time);
    h = mix_array(h, o->x, o->n_vertices, sizeof *o->x);
    h = mix_array(h, o->tri, o->n_triangles, sizeof *o->tri);
    return mix_array(h, shown ? o->frame : NULL, shown, sizeof *o->frame);
}

static uint64_t mix_motion(uint64_t h, const drape_motion *m)
{
    h = hash_mix(h, m->pivot, sizeof m->pivot);
    h = mix_array(h, m->time, m->keys, sizeof *m->time);
    h = mix_array(h, m->position, m->keys, sizeof *m->position);
    return mix_array(h, m->rotation, m->keys, sizeof *m->rotation);
}

static uint64_t mix_seam(uint64_t h, const drape_seam *s)
{
    h = hash_mix(h, s->cloth, sizeof s->cloth);
    h = mix_array(h, s->particle, s->n, sizeof *s->particle);
    h = mix_array(h, s->onto, s->n, sizeof *s->onto);
    h = mix_array(h, s->part, s->n, sizeof *s->part);
    return hash_mix(h, &s->strength, sizeof s->strength);
}

uint64_t checkpoint_fingerprint(const drape_def *d, uint64_t *print)
{
    /* Backend, threads, block, stream, allocators, log and trace are left out:
     * they change no bit of a result. */
    const int choice[] = {
        d->precision, d->integrator,     d->max_substeps,       d->precond,
        d->matrix,    d->max_iterations, d->self_collision,     d->max_rounds,
        d->sleep,     d->n_cloths,       d->n_obstacles,        d->n_motions,
        d->solver,    d->max_slices,     d->allow_intersecting, d->newton,
        d->response};
    uint64_t h = hash_mix(HASH_SEED, choice, sizeof choice);
    h = hash_mix(h, &d->dt, sizeof d->dt);
    h = hash_mix(h, d->gravity, sizeof d->gravity);
    h = hash_mix(h, &d->wind, sizeof d->wind);
    h = hash_mix(h, &d->tolerance, sizeof d->tolerance);
    int bodies = d->n_cloths + d->n_obstacles;
    for (int k = 0; k < bodies; k++)
        if (!print[k])
            print[k] = k < d->n_cloths
                           ? print_cloth(&d->cloths[k])
                           : print_obstacle(&d->obstacles[k - d->n_cloths]);
    h = hash_mix(h, print, (size_t)bodies * sizeof *print);
    for (int k = 0; k < d->n_motions; k++)
        h = mix_motion(h, &d->motions[k]);
    for (int k = 0; k < d->n_seams; k++)
        h = mix_seam(h, &d->seams[k]);
    return h;
}

/* Lists the streams that are part of a checkpoint: those of the state, of which
 * x0 and v0 come first, then watch and rest. A stream that the scene does not
 * have has 0 bytes. */
enum { PLACE, SPEED, WATCH, REST, STREAMS = STATE_STREAMS + 2 };
enum { FROM = STREAMS - 2 }; /* and the last: targets of seams, m */
static void list_streams(const struct world *w, void *stream[STREAMS],
                         size_t bytes[STREAMS])
{
    const struct state_list state = state_streams(w);
    for (int k = 0; k < STATE_STREAMS; k++) {
        int at = k < WATCH ? k : k + 2;
        stream[at] = *state.of[k].at;
        bytes[at] = (size_t)state.of[k].n * sizeof(vec);
    }
    stream[WATCH] = w->watch;
    stream[REST] = w->sleep->rest;
    bytes[WATCH] = (size_t)w->def.n_cloths * sizeof *w->watch;
    bytes[REST] = (size_t)w->def.n_cloths * sizeof *w->sleep->rest;
}

/* Hashes the header, with its field `check` set to 0, as the first part of the
 * checkpoint's hash. */
static uint64_t check_header(struct header *h)
{
    h->check = 0;
    return hash_mix(HASH_SEED, h, sizeof *h);
}

/* The header but for its magic and its hash. */
static struct header header_of(const struct world *w)
{
    struct header h;
    memset(&h, 0, sizeof h);
    h.bits = REAL_BITS;
    h.fingerprint = w->fingerprint;
    h.step = w->step;
    h.vertices = w->nv;
    h.intersecting = w->intersecting;
    h.time = w->time;
    h.nearness = (uint32_t)w->nearness;
    h.past = (uint32_t)w->past;
    h.wind = w->def.wind;
    return h;
}

/* The parts of a checkpoint behind its header: the changes, what control_pack
 * gives, the streams, what contacts carry on, the targets. */
enum { PARTS = 4 + STREAMS };
struct parts {
    const void *data[PARTS];
    size_t bytes[PARTS];
};

static void add_part(struct parts *p, int *n, const void *data, size_t bytes)
{
    p->data[*n] = data;
    p->bytes[(*n)++] = bytes;
}

static int write_parts(struct header *h, const struct parts *p, int n,
                       drape_write *write, void *user)
{
    uint64_t check = check_header(h);
    for (int k = 0; k < n; k++)
        check = hash_mix(check, p->data[k], p->bytes[k]);
    h->check = check;
    if (write(user, h, sizeof *h))
        return DRAPE_EIO;
    for (int k = 0; k < n; k++)
        if (p->bytes[k] && write(user, p->data[k], p->bytes[k]))
            return DRAPE_EIO;
    return DRAPE_OK;
}

static bool same_gravity(const struct world *w)
{
    return !memcmp(w->def.gravity, w->defined_gravity,
                   sizeof w->defined_gravity);
}

int checkpoint_save(const struct world *w, drape_write *write, void *user)
{
    struct header h = header_of(w);
    struct parts p;
    void *stream[STREAMS];
    size_t bytes[STREAMS];
    int n = 0;
    struct kept *kept = NULL;
    struct changes c = {.bytes = control_pack(w, NULL),
                        .armed = w->targets.armed};
    memcpy(c.gravity, w->def.gravity, sizeof c.gravity);
    bool plain = c.bytes == 0 && same_gravity(w);
    memcpy(h.magic, plain ? magic : changed, sizeof magic);
    uint8_t *pack = NULL;
    w->run->begin(w->on); /* memory may be available again */
    int status = kept_gather(w, &kept, &h.kept);
    if (status == DRAPE_OK && c.bytes > 0 &&
        !(pack = arena_take(w->arena, ARENA_OTHER, c.bytes, 1)))
        status = DRAPE_ENOMEM;
    if (status != DRAPE_OK) {
        arena_give(w->arena, kept);
        return status;
    }
    if (!plain) {
        if (pack)
            control_pack(w, pack);
        add_part(&p, &n, &c, sizeof c);
        add_part(&p, &n, pack, (size_t)c.bytes);
    }
    list_streams(w, stream, bytes);
    for (int k = 0; k < STREAMS; k++)
        add_part(&p, &n, stream[k], bytes[k]);
    add_part(&p, &n, kept, (size_t)h.kept * sizeof *kept);
    if (c.armed)
        add_part(&p, &n, w->targets.to, (size_t)w->nv * sizeof(vec));
    status = write_parts(&h, &p, n, write, user);
    arena_give(w->arena, pack);
    arena_give(w->arena, kept);
    return status;
}

static bool is_matching(const struct world *w, const struct header *h)
{
    bool known = !memcmp(h->magic, magic, sizeof magic) ||
                 !memcmp(h->magic, changed, sizeof changed);
    return known && h->bits == REAL_BITS && h->fingerprint == w->fingerprint &&
           h->vertices == w->nv;
}

/* The hash does not prove that a checkpoint is one that a world has saved, as
 * anybody can make a file with a valid hash. So each field is checked to have a
 * value that the steps of this world can give it. */

/* The level of the shortest slices of a step. */
static int deepest_level(const struct world *w)
{
    int level = 0;
    while (2 << level <= w->def.max_slices)
        level++;
    return level;
}

/* The ranges of drape.h. */
static bool good_wind(const drape_wind *wind)
{
    const double *v = wind->velocity, most = 1e6;
    bool good = wind->density >= 0 && wind->drag >= 0 && wind->lift >= 0;
    for (int k = 0; k < 3; k++)
        good &= v[k] >= -REAL_BIG && v[k] <= REAL_BIG;
    return good && wind->density <= REAL_BIG && wind->drag <= most &&
           wind->lift <= most;
}

/* Contacts of a world, at most: 4 n < 2^31. */
enum { MOST_KEPT = 1 << 29 };

/* The numbers that the last slice left. */
static bool good_last(const struct world *w, const struct header *h)
{
    int64_t pairs = w->plan.collides ? w->nt * (w->nt - 1) / 2 : 0;
    uint32_t most = w->plan.collides ? NEAR_CONTACTS : NEAR_NONE;
    int past = w->past_x ? 1 + deepest_level(w) : 0;
    return h->intersecting >= 0 && h->intersecting <= pairs &&
           h->nearness <= most && h->past <= (uint32_t)past &&
           (h->kept == 0 || w->plan.solves);
}

static bool good_header(const struct world *w, const struct header *h)
{
    const int64_t most = (int64_t)1 << 53; /* steps that a double counts */
    return h->step >= 0 && h->step <= most &&
           h->time == (double)h->step * w->def.dt && good_last(w, h) &&
           good_wind(&h->wind);
}

/* Whether n numbers are finite and at most `most` in size. They may be
 * unaligned. */
static bool good_reals(const uint8_t *at, size_t n, real most)
{
    for (real a; n > 0; n--, at += sizeof a) {
        memcpy(&a, at, sizeof a);
        if (!(a >= -most && a <= most))
            return false;
    }
    return true;
}

/* Whether the energies in `watch` are finite and not negative. */
static bool good_watch(const uint8_t *at, size_t bytes)
{
    for (double a; bytes > 0; bytes -= sizeof a, at += sizeof a) {
        memcpy(&a, at, sizeof a);
        if (!(a >= 0 && a <= DBL_MAX))
            return false;
    }
    return true;
}

static bool good_rests(const struct world *w, const uint8_t *at, size_t bytes)
{
    int32_t n = (int32_t)(bytes / sizeof(struct rest));
    int past = w->past_x ? 1 + deepest_level(w) : 0;
    int steps = w->def.sleep ? SLEEP_MOST : 0, asleep = w->def.sleep ? 1 : 0;
    for (struct rest r; bytes > 0; bytes -= sizeof r, at += sizeof r) {
        memcpy(&r, at, sizeof r);
        if (r.steps < 0 || r.steps > steps || r.asleep < 0 ||
            r.asleep > asleep || r.group < 0 || r.group >= n || r.past < 0 ||
            r.past > past || !(r.far >= 0 && r.far <= DBL_MAX))
            return false;
    }
    return true;
}

static bool good_stream(const struct world *w, int k, const uint8_t *at,
                        size_t bytes)
{
    if (k == WATCH)
        return good_watch(at, bytes);
    if (k == REST)
        return good_rests(w, at, bytes);
    return good_reals(at, bytes / sizeof(real),
                      k == PLACE || k >= FROM ? REAL_BIG : (real)FLT_MAX);
}

/* A checkpoint as it was read, and checked but for what only applying it can
 * tell. */
struct read {
    struct header h;
    struct changes c;
    uint8_t *pack;     /* [c.bytes] */
    uint8_t *aside;    /* the streams */
    struct kept *kept; /* [h.kept] */
    struct kept *part; /* [h.kept], of kept_room */
    vec *to;           /* [nv]; NULL: no target is set */
    size_t bytes[STREAMS];
    void *stream[STREAMS];
};

static bool good_changes(const struct world *w, const struct changes *c)
{
    bool good = c->bytes >= 0 && c->bytes <= control_most(w) && c->armed <= 1 &&
                (c->bytes > 0 || !c->armed);
    for (int k = 0; k < 3; k++)
        good &= c->gravity[k] >= -REAL_BIG && c->gravity[k] <= REAL_BIG;
    return good;
}

/* Reads bytes to new memory and mixes them into the hash. */
static int read_part(struct world *w, drape_read_bytes *read, void *user,
                     size_t bytes, void *to, uint64_t *check)
{
    void *p = arena_take(w->arena, ARENA_OTHER, (int64_t)bytes, 1);
    if (!p)
        return DRAPE_ENOMEM;
    memcpy(to, &p, sizeof p);
    if (bytes && read(user, p, bytes))
        return DRAPE_EIO;
    *check = hash_mix(*check, p, bytes);
    return DRAPE_OK;
}

static int read_changes(struct world *w, drape_read_bytes *read, void *user,
                        struct read *r, uint64_t *check)
{
    memcpy(r->c.gravity, w->defined_gravity, sizeof r->c.gravity);
    if (!memcmp(r->h.magic, magic, sizeof magic))
        return DRAPE_OK;
    if (read(user, &r->c, sizeof r->c))
        return DRAPE_EIO;
    if (!good_changes(w, &r->c))
        return DRAPE_EMATCH; /* the rest cannot be read */
    *check = hash_mix(*check, &r->c, sizeof r->c);
    return read_part(w, read, user, (size_t)r->c.bytes, &r->pack, check);
}

/* Reads the multipliers that contacts carry on. Their number may be anything in
 * a file that somebody made, so that memory is taken as bytes arrive. */
static int read_kept(struct world *w, drape_read_bytes *read, void *user,
                     struct read *r, uint64_t *check)
{
    int64_t n = 0, cap = 0, all = r->h.kept;
    const size_t size = sizeof *r->kept;
    while (n < all) {
        cap = cap < 1024 ? 1024 : 2 * cap;
        cap = cap < all ? cap : all;
        struct kept *wide = arena_take(w->arena, ARENA_OTHER, cap, size);
        if (!wide)
            return DRAPE_ENOMEM;
        if (n > 0)
            memcpy(wide, r->kept, (size_t)n * size);
        arena_give(w->arena, r->kept);
        r->kept = wide;
        if (read(user, wide + n, (size_t)(cap - n) * size))
            return DRAPE_EIO;
        n = cap;
    }
    if (n > 0)
        *check = hash_mix(*check, r->kept, (size_t)n * size);
    return DRAPE_OK;
}

static int read_streams(struct world *w, drape_read_bytes *read, void *user,
                        struct read *r, uint64_t *check)
{
    size_t all = 0, at = 0;
    uint64_t unused = 0;
    for (int k = 0; k < STREAMS; k++)
        all += r->bytes[k];
    int status = read_part(w, read, user, all, &r->aside, &unused);
    for (int k = 0; k < STREAMS && status == DRAPE_OK; at += r->bytes[k++])
        *check = hash_mix(*check, r->aside + at, r->bytes[k]);
    if (status == DRAPE_OK)
        status = read_kept(w, read, user, r, check);
    if (status == DRAPE_OK && r->c.armed)
        status = read_part(w, read, user, (size_t)w->nv * sizeof *r->to, &r->to,
                           check);
    return status;
}

/* Whether obstacle k is where the definition has it and at rest, or may move.
 * The boxes of an obstacle that never moves are made once, for this place. */
static bool good_obstacle(const struct world *w, const struct read *r, int k)
{
    const struct prop *p = &w->prop[k];
    if (p->moves ||
        (r->c.bytes && control_is_targeted(w, r->pack, r->c.bytes, k)))
        return true;
    const double *rest = w->home->prop[k].place.rest;
    const uint8_t *at = r->aside + (size_t)p->first * sizeof(vec);
    const uint8_t *speed = at + r->bytes[PLACE];
    for (int64_t i = 0; i < 3 * p->place.n; i++) {
        real x, v;
        memcpy(&x, at + (size_t)i * sizeof x, sizeof x);
        memcpy(&v, speed + (size_t)i * sizeof v, sizeof v);
        if (x != (real)rest[i] || v != 0)
            return false;
    }
    return true;
}

static bool good_read(const struct world *w, const struct read *r)
{
    const uint8_t *at = r->aside;
    bool good = good_header(w, &r->h) &&
                (!r->c.bytes || control_fits(w, r->pack, r->c.bytes));
    for (int64_t k = 0; k < r->h.kept && good; k++)
        good = kept_good(w, &r->kept[k]) &&
               (k == 0 || r->kept[k - 1].hi < r->kept[k].hi ||
                (r->kept[k - 1].hi == r->kept[k].hi &&
                 r->kept[k - 1].lo < r->kept[k].lo));
    for (int k = 0; k < STREAMS && good; at += r->bytes[k++])
        good = good_stream(w, k, at, r->bytes[k]);
    for (int k = 0; k < w->def.n_obstacles && good; k++)
        good = good_obstacle(w, r, k);
    return good && (!r->to || good_reals((const uint8_t *)r->to,
                                         3 * (size_t)w->nv, REAL_BIG));
}

/* Reads the whole checkpoint and checks it, so that a bad one does not change
 * the world. */
static int read_all(struct world *w, drape_read_bytes *read, void *user,
                    struct read *r)
{
    if (read(user, &r->h, sizeof r->h))
        return DRAPE_EIO;
    if (!is_matching(w, &r->h) || r->h.kept < 0 || r->h.kept > MOST_KEPT)
        return DRAPE_EMATCH;
    uint64_t want = r->h.check, check = check_header(&r->h);
    int status = read_changes(w, read, user, r, &check);
    if (status == DRAPE_OK)
        status = read_streams(w, read, user, r, &check);
    if (status == DRAPE_OK && check != want)
        status = DRAPE_EMATCH;
    return status == DRAPE_OK && !good_read(w, r) ? DRAPE_EDATA : status;
}

static int apply_checkpoint(struct world *w, const struct read *r)
{
    const struct header *h = &r->h;
    size_t at = 0;
    control_gravity(w, r->c.gravity); /* this wakes all */
    air_set(w, &h->wind);
    for (int k = 0; k < STREAMS; at += r->bytes[k++])
        if (r->bytes[k])
            memcpy(r->stream[k], r->aside + at, r->bytes[k]);
    if (w->home == w) { /* no step writes these of a static obstacle */
        memcpy(w->x1, w->x0, (size_t)w->nv * sizeof *w->x1);
        memcpy(w->v1, w->v0, (size_t)w->nv * sizeof *w->v1);
    }
    w->list.known = false;
    w->step = h->step;
    w->intersecting = h->intersecting;
    w->time = h->time;
    sleep_forget(w);
    w->nearness = (enum nearness)h->nearness;
    w->past = (int)h->past;
    return kept_spread(w, r->kept, h->kept, r->part);
}

int checkpoint_load(struct world *w, drape_read_bytes *read, void *user)
{
    struct read r = {.pack = NULL};
    list_streams(w, r.stream, r.bytes);
    w->run->begin(w->on);
    int status = read_all(w, read, user, &r);
    if (status == DRAPE_OK && plan_windy(&r.h.wind))
        status = air_take(w);
    if (status == DRAPE_OK)
        status = kept_room(w, r.h.kept, &r.part);
    if (status == DRAPE_OK)
        status = control_unpack(w, r.pack, r.c.bytes, r.to,
                                (const vec *)(const void *)r.aside);
    if (status == DRAPE_OK)
        status = apply_checkpoint(w, &r);
    arena_give(w->arena, r.pack);
    arena_give(w->arena, r.aside);
    arena_give(w->arena, r.kept);
    arena_give(w->arena, r.part);
    arena_give(w->arena, r.to);
    return status;
}
