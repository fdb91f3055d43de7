/* SPDX-License-Identifier: Apache-2.0 */
/* The reference as a backend: its table of functions, which finish their work
 * before they return. ref/base/backend.h */
#include "ref/base/backend.h"

#include "ref/cloth/motion.h"
#include "ref/world/state.h"

struct gpu *backend_of(struct arena *arena)
{
    return (struct gpu *)arena;
}

static struct arena *arena_of(struct gpu *on)
{
    return (struct arena *)on;
}

static void *take_stream(struct gpu *on, enum arena_part part, int64_t n,
                         size_t size)
{
    return arena_take(arena_of(on), part, n, size);
}

static int grow_pool(struct gpu *on, struct pool *pool, enum arena_part part,
                     int64_t need, size_t size, bool kept)
{
    (void)kept;
    need += need / 4 + 64;
    void *p = arena_take(arena_of(on), part, need, size);
    if (!p)
        return DRAPE_ENOMEM;
    arena_give(arena_of(on), pool->data);
    pool->data = p;
    pool->cap = need;
    return DRAPE_OK;
}

static void give_stream(struct gpu *on, void *p)
{
    arena_give(arena_of(on), p);
}

static void copy_bytes(struct gpu *on, void *to, const void *from, size_t bytes)
{
    (void)on;
    if (bytes && to != from)
        memcpy(to, from, bytes);
}

static void clear_bytes(struct gpu *on, void *p, size_t bytes)
{
    (void)on;
    if (bytes)
        memset(p, 0, bytes);
}

static void begin_work(struct gpu *on)
{
    arena_of(on)->failed = false;
}

static void wait_for_work(struct gpu *on)
{
    (void)on;
}

static int get_status(struct gpu *on)
{
    return arena_of(on)->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

static void trace_output(struct gpu *on, struct trace *t, const char *stage,
                         const void *out, size_t bytes)
{
    (void)on;
    trace_stage(t, stage, out, bytes);
}

/* The stages have no device. */
#define STAGE(room, file, X, rule)                                             \
    int ref_##X(struct X *s);                                                  \
    static int run_##X(struct gpu *on, struct X *s)                            \
    {                                                                          \
        (void)on;                                                              \
        return ref_##X(s);                                                     \
    }
#include "spec/stages.def"
#undef STAGE

int ref_motion(struct gpu *on, struct sheet *s)
{
    (void)on;
    return motion_run(&s->dynamics);
}

int ref_motion_part(struct gpu *on, struct sheet *s, int part)
{
    (void)on;
    return motion_run_part(&s->dynamics, (enum motion_part)part);
}

void ref_motion_energy(struct gpu *on, struct sheet *s, const vec *x,
                       const vec *v, double value[3])
{
    (void)on;
    motion_energy(&s->dynamics, x, v, value);
}

void ref_motion_laws(struct gpu *on, struct sheet *s)
{
    (void)on; /* the stages read them in struct cloth */
    (void)s;
}

int ref_ending_streams(struct gpu *on, struct audit *s, int64_t nt,
                       int64_t cloths)
{
    int32_t *group = (int32_t *)s->group;
    if (!s->count)
        s->count = arena_take(arena_of(on), ARENA_RESPONSE, s->n_nodes,
                              sizeof *s->count);
    for (int64_t k = 0; k < nt; k++)
        group[k] = k < cloths;
    return s->count ? DRAPE_OK : DRAPE_ENOMEM;
}

/* Places are compared by bits. */
bool ref_prescribed_moves(const struct world *w)
{
    struct gpu *on = w->on;
    if (ref_prescribed_differs(on, w->nv - w->nc, NULL, w->x0 + w->nc,
                               w->x1 + w->nc))
        return true;
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct pins pins = sheet_pins(&w->sheet[k]);
        const vec *x0 = w->x0 + w->sheet[k].first;
        if (ref_prescribed_differs(on, pins.n, pins.at, x0, pins.x))
            return true;
    }
    return false;
}

const struct backend backend_ref = {
    .take = take_stream,
    .grow = grow_pool,
    .give = give_stream,
    .copy = copy_bytes,
    .clear = clear_bytes,
    .send = copy_bytes,
    .fetch = copy_bytes,
    .pushes = 2,
    .begin = begin_work,
    .wait = wait_for_work,
    .status = get_status,
    .trace = trace_output,
#define STAGE(room, file, X, rule) .X = run_##X,
#include "spec/stages.def"
#undef STAGE
#define CALL(result, name, ...) .name = ref_##name,
#include "ref/base/backend.def"
#undef CALL
};
