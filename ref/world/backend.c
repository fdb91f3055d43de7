/* SPDX-License-Identifier: Apache-2.0 */
/* The reference as a backend: its table of functions, which finish their work
 * before they return. ref/base/backend.h */
#include "ref/base/backend.h"

#include "ref/base/prescribed.h"
#include "ref/base/sum.h"
#include "ref/broad/travel.h"
#include "ref/cloth/implicit.h"
#include "ref/cloth/motion.h"
#include "ref/contact/carry.h"
#include "ref/contact/contacts.h"
#include "ref/contact/coulomb.h"
#include "ref/contact/impacts.h"
#include "ref/contact/impulses.h"
#include "ref/contact/proximity.h"
#include "ref/contact/rollback.h"
#include "ref/contact/unknowns.h"
#include "ref/contact/zones.h"
#include "ref/momentum/momentum.h"
#include "ref/narrow/audit.h"
#include "ref/narrow/narrow.h"
#include "ref/sleep/wake.h"
#include "ref/world/kinematics.h"
#include "ref/world/state.h"

static void *take_stream(void *on, enum arena_part part, int64_t n, size_t size)
{
    return arena_take(on, part, n, size);
}

static int grow_pool(void *on, struct pool *pool, int64_t need, size_t size,
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

static void give_stream(void *on, void *p)
{
    arena_give(on, p);
}

static void copy_bytes(void *on, void *to, const void *from, size_t bytes)
{
    (void)on;
    if (bytes && to != from)
        memcpy(to, from, bytes);
}

static void clear_bytes(void *on, void *p, size_t bytes)
{
    (void)on;
    if (bytes)
        memset(p, 0, bytes);
}

static void begin_work(void *on)
{
    ((struct arena *)on)->failed = false;
}

static void wait_for_work(void *on)
{
    (void)on;
}

static int get_status(void *on)
{
    return ((struct arena *)on)->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

static void trace_output(void *on, struct trace *t, const char *stage,
                         const void *out, size_t bytes)
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

static int run_motion(void *on, struct sheet *s)
{
    (void)on;
    return ref_motion(&s->dynamics);
}

static int motion_part(void *on, struct sheet *s, int part)
{
    (void)on;
    return ref_motion_part(&s->dynamics, (enum motion_part)part);
}

static void find_energy(void *on, struct sheet *s, const vec *x, const vec *v,
                        double value[3])
{
    (void)on;
    motion_energy(&s->dynamics, x, v, value);
}

static int ask_meshes_apart(void *on, struct broad *b, const vec *x0,
                            const vec *x1, real r, bool *apart)
{
    (void)on;
    return broad_meshes_apart(b, x0, x1, r, apart);
}

static int run_query(void *on, struct broad *b, const vec *x0, const vec *x1,
                     real r, const uint8_t *moved)
{
    (void)on;
    return broad_query(b, x0, x1, r, moved);
}

static void start_response(void *on, struct response *s)
{
    (void)on;
    rounds_start(s);
}

static void advance_vertices(void *on, struct response *s, int64_t n,
                             const int32_t *vertex, const uint8_t *moved,
                             bool stop)
{
    (void)on;
    rounds_advance(s, n, vertex, moved, stop);
}

static void touch_vertices(void *on, const struct response *s)
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

static void shift_state(void *on, const struct shift *s)
{
    (void)on;
    unknowns_shift(s);
}

static void find_jump(void *on, const struct jumps *s)
{
    (void)on;
    unknowns_jump(s);
}

static void subtract_part(void *on, int64_t n, real part, const vec *q, vec *r)
{
    (void)on;
    unknowns_lessen(n, part, q, r);
}

static void place_pins(void *on, int64_t n, const int32_t *pinned, const vec *x,
                       vec *to)
{
    (void)on;
    prescribed_pin(n, pinned, x, to);
}

static void blend_places(void *on, const struct blend *s)
{
    (void)on;
    prescribed_blend(s);
}

static void keep_fixed(void *on, int64_t n, const uint8_t *fixed,
                       const vec *old, vec *a)
{
    (void)on;
    prescribed_keep(n, fixed, old, a);
}

static bool are_sane(void *on, int64_t n, const vec *a)
{
    (void)on;
    return prescribed_sane(n, a);
}

static void renew_laws(void *on, struct sheet *s)
{
    (void)on; /* the stages read them in struct cloth */
    (void)s;
}

static bool find_difference(void *on, int64_t n, const int32_t *at,
                            const vec *x0, const vec *x1)
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

static void find_velocities(void *on, int64_t n, const vec *x0, const vec *x1,
                            real dt, vec *v)
{
    (void)on;
    prescribed_velocities(n, x0, x1, dt, v);
}

static real find_furthest(void *on, int64_t n, const vec *x0, const vec *x1)
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

/* Whether an obstacle or a pin has another place in x1 than in x0, compared by
 * bits. */
static bool any_moves(const struct world *w)
{
    if (prescribed_differs(w->nv - w->nc, NULL, w->x0 + w->nc, w->x1 + w->nc))
        return true;
    for (int k = 0; k < w->def.n_cloths; k++) {
        struct pins pins = sheet_pins(&w->sheet[k]);
        const vec *x0 = w->x0 + w->sheet[k].first;
        if (prescribed_differs(pins.n, pins.at, x0, pins.x))
            return true;
    }
    return false;
}

const struct backend backend_ref = {.take = take_stream,
                                    .grow = grow_pool,
                                    .give = give_stream,
                                    .copy = copy_bytes,
                                    .clear = clear_bytes,
                                    .send = copy_bytes,
                                    .pushes = 2,
                                    .begin = begin_work,
                                    .wait = wait_for_work,
                                    .status = get_status,
                                    .trace = trace_output,
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
                                    .motion = run_motion,
                                    .motion_part = motion_part,
                                    .energy = find_energy,
                                    .joint_set_up = joint_set_up,
                                    .joint_measure = joint_measure,
                                    .joint = joint_solve,
                                    .broad_meshes_apart = ask_meshes_apart,
                                    .broad_query = run_query,
                                    .start = start_response,
                                    .advance = advance_vertices,
                                    .touch = touch_vertices,
                                    .cap_targets = cap_targets,
                                    .slice_room = unknowns_room,
                                    .shift = shift_state,
                                    .jump = find_jump,
                                    .lessen = subtract_part,
                                    .pin = place_pins,
                                    .blend = blend_places,
                                    .keep = keep_fixed,
                                    .sane = are_sane,
                                    .fetch = copy_bytes,
                                    .laws = renew_laws,
                                    .moves = any_moves,
                                    .differs = find_difference,
                                    .wake_find = find_disturbed,
                                    .wake_mask = set_mask,
                                    .wake_displacements = find_displacements,
                                    .velocities = find_velocities,
                                    .furthest = find_furthest,
                                    .ending_streams = ending_streams};
