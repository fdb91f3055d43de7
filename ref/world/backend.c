/* SPDX-License-Identifier: Apache-2.0 */
/* The reference as a backend: its table of functions, which finish their work
 * before they return. ref/base/backend.h */
#include "ref/base/backend.h"

#include "ref/base/stages.h"
#include "ref/cloth/motion.h"
#include "ref/contact/unknowns.h"
#include "ref/sleep/wake.h"
#include "ref/world/prescribed.h"

static void *take(void *on, enum arena_part part, int64_t n, size_t size)
{
    return arena_take(on, part, n, size);
}

static int grow(void *on, struct pool *pool, int64_t need, size_t size,
                bool kept)
{
    (void)kept;
    need += need / 4 + 64;
    void *p = arena_take(on, ARENA_RESPONSE, need, size);
    if (!p)
        return DRAPE_ENOMEM;
    arena_give(on, pool->data);
    pool->data = p;
    pool->cap = need;
    return DRAPE_OK;
}

static void give(void *on, void *p)
{
    arena_give(on, p);
}

static void copy(void *on, void *to, const void *from, size_t bytes)
{
    (void)on;
    if (bytes && to != from)
        memcpy(to, from, bytes);
}

static void clear(void *on, void *p, size_t bytes)
{
    (void)on;
    if (bytes)
        memset(p, 0, bytes);
}

static void begin(void *on)
{
    ((struct arena *)on)->failed = false;
}

static void wait(void *on)
{
    (void)on;
}

static int status(void *on)
{
    return ((struct arena *)on)->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

static void trace(void *on, struct trace *t, const char *stage, const void *out,
                  size_t bytes)
{
    (void)on;
    trace_stage(t, stage, out, bytes);
}

/* STAGE(name) wraps ref_name as a function of the table. */
#define STAGE(name)                                                            \
    static int name(void *on, struct name *s)                                  \
    {                                                                          \
        (void)on;                                                              \
        return ref_##name(s);                                                  \
    }
STAGE(dot)
STAGE(kinematics)
STAGE(moments)
STAGE(islands)
STAGE(spin)
STAGE(history)
STAGE(travel)
STAGE(narrow)
STAGE(audit)
STAGE(proximity)
STAGE(impacts)
STAGE(impulses)
STAGE(contacts)
STAGE(zones)
STAGE(rollback)
STAGE(coulomb)
STAGE(carry)
STAGE(retain)

static int motion(void *on, struct sheet *s)
{
    (void)on;
    return ref_motion(&s->dynamics);
}

static int motion_part(void *on, struct sheet *s, int part)
{
    (void)on;
    return ref_motion_part(&s->dynamics, (enum motion_part)part);
}

static void energy(void *on, struct sheet *s, const vec *x, const vec *v,
                   double value[3])
{
    (void)on;
    motion_energy(&s->dynamics, x, v, value);
}

static int ask(void *on, struct broad *b, const vec *x0, const vec *x1, real r,
               bool *apart)
{
    (void)on;
    return broad_meshes_apart(b, x0, x1, r, apart);
}

static int query(void *on, struct broad *b, const vec *x0, const vec *x1,
                 real r, const uint8_t *moved)
{
    (void)on;
    return broad_query(b, x0, x1, r, moved);
}

static void start(void *on, struct response *s)
{
    (void)on;
    rounds_start(s);
}

static void advance(void *on, struct response *s, int64_t n,
                    const int32_t *vertex, const uint8_t *moved, bool stop)
{
    (void)on;
    rounds_advance(s, n, vertex, moved, stop);
}

static void touch(void *on, const struct response *s)
{
    (void)on;
    rounds_touch(s);
}

static void cap_targets(void *on, const struct response *s,
                        struct contact *contact)
{
    (void)on;
    rounds_settle(s, contact);
}

static void shift(void *on, const struct shift *s)
{
    (void)on;
    unknowns_shift(s);
}

static void jump(void *on, const struct jumps *s)
{
    (void)on;
    unknowns_jump(s);
}

static void lessen(void *on, int64_t n, real part, const vec *q, vec *r)
{
    (void)on;
    unknowns_lessen(n, part, q, r);
}

static void pin(void *on, int64_t n, const int32_t *pinned, const vec *x,
                vec *to)
{
    (void)on;
    prescribed_pin(n, pinned, x, to);
}

static void blend(void *on, const struct blend *s)
{
    (void)on;
    prescribed_blend(s);
}

static void keep(void *on, int64_t n, const uint8_t *fixed, const vec *old,
                 vec *a)
{
    (void)on;
    prescribed_keep(n, fixed, old, a);
}

static bool sane(void *on, int64_t n, const vec *a)
{
    (void)on;
    return prescribed_sane(n, a);
}

static void laws(void *on, struct sheet *s)
{
    (void)on; /* the stages read them in struct cloth */
    (void)s;
}

static bool differs(void *on, int64_t n, const int32_t *at, const vec *x0,
                    const vec *x1)
{
    (void)on;
    return prescribed_differs(n, at, x0, x1);
}

static void find_disturbed(void *on, struct wake *s)
{
    (void)on;
    wake_find(s);
}

static void set_mask(void *on, int64_t n, const uint16_t *body,
                     const uint8_t *awake, uint8_t *to)
{
    (void)on;
    wake_mask(n, body, awake, to);
}

static void find_displacements(void *on, int64_t n, const uint16_t *body,
                               const vec *x0, const vec *x1, int bodies,
                               real *most)
{
    (void)on;
    wake_displacements(n, body, x0, x1, bodies, most);
}

static void velocities(void *on, int64_t n, const vec *x0, const vec *x1,
                       real dt, vec *v)
{
    (void)on;
    prescribed_velocities(n, x0, x1, dt, v);
}

static real furthest(void *on, int64_t n, const vec *x0, const vec *x1)
{
    (void)on;
    return prescribed_furthest(n, x0, x1);
}

static int ending_streams(void *on, struct audit *s, int64_t nt, int64_t cloths)
{
    int32_t *group = (int32_t *)s->group;
    if (!s->count)
        s->count = arena_take(on, ARENA_RESPONSE, s->n_nodes, sizeof *s->count);
    for (int64_t k = 0; k < nt; k++)
        group[k] = k < cloths;
    return s->count ? DRAPE_OK : DRAPE_ENOMEM;
}

const struct backend backend_ref = {.take = take,
                                    .grow = grow,
                                    .give = give,
                                    .copy = copy,
                                    .clear = clear,
                                    .send = copy,
                                    .pushes = 2,
                                    .begin = begin,
                                    .wait = wait,
                                    .status = status,
                                    .trace = trace,
                                    .dot = dot,
                                    .kinematics = kinematics,
                                    .moments = moments,
                                    .islands = islands,
                                    .spin = spin,
                                    .history = history,
                                    .travel = travel,
                                    .narrow = narrow,
                                    .audit = audit,
                                    .proximity = proximity,
                                    .impacts = impacts,
                                    .impulses = impulses,
                                    .contacts = contacts,
                                    .zones = zones,
                                    .rollback = rollback,
                                    .coulomb = coulomb,
                                    .carry = carry,
                                    .retain = retain,
                                    .motion = motion,
                                    .motion_part = motion_part,
                                    .energy = energy,
                                    .joint_set_up = joint_set_up,
                                    .joint_measure = joint_measure,
                                    .joint = joint_solve,
                                    .broad_meshes_apart = ask,
                                    .broad_query = query,
                                    .start = start,
                                    .advance = advance,
                                    .touch = touch,
                                    .cap_targets = cap_targets,
                                    .slice_room = unknowns_room,
                                    .shift = shift,
                                    .jump = jump,
                                    .lessen = lessen,
                                    .pin = pin,
                                    .blend = blend,
                                    .keep = keep,
                                    .sane = sane,
                                    .fetch = copy,
                                    .laws = laws,
                                    .moves = prescribed_moves,
                                    .differs = differs,
                                    .wake_find = find_disturbed,
                                    .wake_mask = set_mask,
                                    .wake_displacements = find_displacements,
                                    .velocities = velocities,
                                    .furthest = furthest,
                                    .ending_streams = ending_streams};
