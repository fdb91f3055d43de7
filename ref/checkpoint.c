/* SPDX-License-Identifier: Apache-2.0 */
/* Checkpoints: the state, and a fingerprint of the definition that it belongs
 * to. Everything else is made again from the definition. */
#include "ref/checkpoint.h"

#include "ref/hash.h"

struct header {
    char magic[8]; /* "drape" and the format's number */
    uint32_t bits, resting;
    uint64_t fingerprint, check; /* check: of all bytes but its own */
    int64_t step, vertices, intersecting;
    double time;
    uint16_t asleep, near;
    uint32_t past;
    uint16_t level, again, calm, far, blind; /* struct caution */
    uint16_t pressed;
    drape_wind wind;
};
static const char magic[8] = "drape-7";

static uint64_t mix_if(uint64_t hash, const void *data, size_t bytes)
{
    return data ? hash_mix(hash, data, bytes) : hash_mix(hash, "-", 1);
}

static uint64_t mix_cloth(uint64_t h, const drape_cloth *c)
{
    size_t n = (size_t)c->m * (size_t)c->n;
    size_t cells = (size_t)(c->m - 1) * (size_t)(c->n - 1);
    const int size[3] = {c->m, c->n, c->n_pins};
    h = hash_mix(h, size, sizeof size);
    h = hash_mix(h, &c->width, sizeof c->width);
    h = hash_mix(h, &c->height, sizeof c->height);
    h = hash_mix(h, &c->material, sizeof c->material);
    h = hash_mix(h, c->origin, sizeof c->origin);
    h = hash_mix(h, c->u, sizeof c->u);
    h = hash_mix(h, c->v, sizeof c->v);
    h = mix_if(h, c->x, n * sizeof *c->x);
    h = mix_if(h, c->velocity, n * sizeof *c->velocity);
    h = mix_if(h, c->hole, n);
    h = mix_if(h, c->cut, cells);
    return mix_if(h, c->pins, (size_t)c->n_pins * sizeof *c->pins);
}

static uint64_t mix_obstacle(uint64_t h, const drape_obstacle *o)
{
    size_t nv = (size_t)o->n_vertices, nt = (size_t)o->n_triangles;
    h = hash_mix(h, &o->n_vertices, sizeof o->n_vertices);
    h = hash_mix(h, &o->friction, sizeof o->friction);
    h = hash_mix(h, &o->motion, sizeof o->motion);
    h = hash_mix(h, &o->frame_dt, sizeof o->frame_dt);
    h = hash_mix(h, o->x, nv * sizeof *o->x);
    h = hash_mix(h, o->tri, nt * sizeof *o->tri);
    return mix_if(h, o->frames ? o->frame : NULL,
                  (size_t)o->frames * nv * sizeof *o->frame);
}

static uint64_t mix_motion(uint64_t h, const drape_motion *m)
{
    size_t n = (size_t)m->keys;
    h = hash_mix(h, m->time, n * sizeof *m->time);
    h = hash_mix(h, m->position, n * sizeof *m->position);
    h = hash_mix(h, m->pivot, sizeof m->pivot);
    return mix_if(h, m->rotation, n * sizeof *m->rotation);
}

uint64_t checkpoint_fingerprint(const drape_def *d)
{
    /* Not: backend, threads, block, stream, allocators, log, trace. They leave
     * the bits alone. */
    const int choice[] = {d->precision,      d->integrator,  d->max_substeps,
                          d->precond,        d->matrix,      d->max_iterations,
                          d->self_collision, d->max_rounds,  d->sleep,
                          d->n_cloths,       d->n_obstacles, d->n_motions,
                          d->solver,         d->max_slices};
    uint64_t h = hash_mix(HASH_SEED, choice, sizeof choice);
    h = hash_mix(h, &d->dt, sizeof d->dt);
    h = hash_mix(h, d->gravity, sizeof d->gravity);
    h = hash_mix(h, &d->wind, sizeof d->wind);
    h = hash_mix(h, &d->tolerance, sizeof d->tolerance);
    for (int k = 0; k < d->n_cloths; k++)
        h = mix_cloth(h, &d->cloths[k]);
    for (int k = 0; k < d->n_obstacles; k++)
        h = mix_obstacle(h, &d->obstacles[k]);
    for (int k = 0; k < d->n_motions; k++)
        h = mix_motion(h, &d->motions[k]);
    return h;
}

/* The streams that are state: what the next step reads. */
enum { STREAMS = 6 };
static void streams(const struct world *w, void *stream[STREAMS],
                    size_t bytes[STREAMS])
{
    size_t n = (size_t)w->nv * sizeof(vec);
    size_t past = w->past_x ? (size_t)w->nc * sizeof(vec) : 0;
    size_t press = w->press ? (size_t)w->nc * sizeof(vec) : 0;
    size_t watch = (size_t)w->def.n_cloths * sizeof *w->watch;
    void *s[STREAMS] = {w->x0, w->v0, w->watch, w->past_x, w->past_v, w->press};
    const size_t b[STREAMS] = {n, n, watch, past, past, press};
    memcpy(stream, s, sizeof s);
    memcpy(bytes, b, sizeof b);
}

/* Where the check begins; the header's own is 0 meanwhile. */
static uint64_t check_header(struct header *h)
{
    h->check = 0;
    return hash_mix(HASH_SEED, h, sizeof *h);
}

int checkpoint_save(const struct world *w, drape_write *write, void *user)
{
    struct header h;
    void *stream[STREAMS];
    size_t bytes[STREAMS];
    streams(w, stream, bytes);
    memset(&h, 0, sizeof h);
    memcpy(h.magic, magic, sizeof magic);
    h.bits = REAL_BITS;
    h.resting = (uint32_t)w->resting;
    h.fingerprint = w->fingerprint;
    h.step = w->step;
    h.vertices = w->nv;
    h.intersecting = w->intersecting;
    h.time = w->time;
    h.asleep = w->asleep;
    h.near = (uint16_t)w->near;
    h.past = (uint32_t)w->past;
    h.level = (uint16_t)w->caution.level;
    h.again = (uint16_t)w->caution.again;
    h.calm = (uint16_t)w->caution.calm;
    h.far = (uint16_t)w->caution.far;
    h.blind = (uint16_t)w->caution.blind;
    h.pressed = (uint16_t)w->pressed;
    h.wind = w->def.wind;
    uint64_t check = check_header(&h);
    for (int k = 0; k < STREAMS; k++)
        check = hash_mix(check, stream[k], bytes[k]);
    h.check = check;
    if (write(user, &h, sizeof h))
        return DRAPE_EIO;
    for (int k = 0; k < STREAMS; k++)
        if (write(user, stream[k], bytes[k]))
            return DRAPE_EIO;
    return DRAPE_OK;
}

static bool matches(const struct world *w, const struct header *h)
{
    return !memcmp(h->magic, magic, sizeof magic) && h->bits == REAL_BITS &&
           h->fingerprint == w->fingerprint && h->vertices == w->nv;
}

/* Reads everything aside first, so that a bad file changes nothing. */
int checkpoint_load(struct world *w, drape_read_bytes *read, void *user)
{
    struct header h;
    void *stream[STREAMS];
    size_t bytes[STREAMS], all = 0;
    streams(w, stream, bytes);
    if (read(user, &h, sizeof h))
        return DRAPE_EIO;
    if (!matches(w, &h))
        return DRAPE_EMATCH;
    for (int k = 0; k < STREAMS; k++)
        all += bytes[k];
    uint8_t *aside = arena_take(w->arena, ARENA_OTHER, (int64_t)all, 1);
    if (!aside)
        return DRAPE_ENOMEM;
    uint64_t want = h.check, check = check_header(&h);
    int status = read(user, aside, all) ? DRAPE_EIO : DRAPE_OK;
    size_t at = 0;
    for (int k = 0; k < STREAMS; at += bytes[k++])
        check = hash_mix(check, aside + at, bytes[k]);
    if (status == DRAPE_OK && check != want)
        status = DRAPE_EMATCH;
    at = 0;
    for (int k = 0; k < STREAMS && status == DRAPE_OK; at += bytes[k++])
        memcpy(stream[k], aside + at, bytes[k]);
    arena_give(w->arena, aside);
    if (status != DRAPE_OK)
        return status;
    w->step = h.step;
    w->intersecting = h.intersecting;
    w->time = h.time;
    world_set_wind(w, &h.wind);
    w->resting = (int)h.resting;
    w->asleep = h.asleep;
    w->near = (enum nearness)h.near;
    w->past = (int)h.past;
    w->pressed = h.pressed;
    w->caution = (struct caution){h.level, h.again, h.calm, h.far, h.blind};
    return DRAPE_OK;
}
