/* SPDX-License-Identifier: Apache-2.0 */
/* The part of a checkpoint that holds the caller's changes of a world.
 * spec/control/control.md §6 */
#include "ref/base/change.h"
#include "ref/cloth/table.h"
#include "ref/control/control.h"
#include "ref/world/start.h"

/* The part is, for each cloth, its material, the number of pins or -1 where the
 * definition's pins hold, and the particle of each pin, filled up to whole
 * words; then a word for each obstacle, 1: it goes where the caller says. */
enum { WORD = 8 };

static int64_t words_of(int64_t pins)
{
    return pins > 0 ? (pins + 1) / 2 : 0;
}

static bool material_changed(const struct sheet *s)
{
    return memcmp(&s->made.material, &s->defined, sizeof s->defined) != 0;
}

static bool has_changes(const struct world *w)
{
    bool is = false;
    for (int k = 0; k < w->def.n_cloths; k++)
        is |= w->sheet[k].caller_pins.on || material_changed(&w->sheet[k]);
    for (int k = 0; k < w->def.n_obstacles; k++)
        is |= w->prop[k].targeted;
    return is;
}

/* Appends bytes to the part, or only counts them. */
static void append_bytes(uint8_t *out, int64_t *at, const void *data,
                         int64_t bytes)
{
    if (out)
        memcpy(out + *at, data, (size_t)bytes);
    *at += bytes;
}

int64_t control_pack(const struct world *w, uint8_t *out)
{
    int64_t at = 0;
    if (!has_changes(w))
        return 0;
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *s = &w->sheet[k];
        const struct caller_pins *h = &s->caller_pins;
        int64_t n = h->on ? h->n : -1;
        const int32_t none = 0;
        append_bytes(out, &at, &s->made.material, sizeof s->made.material);
        append_bytes(out, &at, &n, sizeof n);
        for (int64_t i = 0; i < 2 * words_of(n); i++)
            append_bytes(out, &at, i < n ? &h->list[i] : &none, sizeof none);
    }
    for (int k = 0; k < w->def.n_obstacles; k++) {
        uint64_t targeted = w->prop[k].targeted;
        append_bytes(out, &at, &targeted, sizeof targeted);
    }
    return at;
}

int64_t control_most(const struct world *w)
{
    int64_t most = WORD * (int64_t)w->def.n_obstacles;
    for (int k = 0; k < w->def.n_cloths; k++)
        most += (int64_t)sizeof(drape_material) + WORD +
                WORD * words_of(w->sheet[k].cloth.count);
    return most;
}

static bool is_within(double a, double lo, double hi)
{
    return a >= lo && a <= hi;
}

/* The ranges of drape.h. */
static bool good_material(const drape_material *m)
{
    const double big = (double)REAL_BIG;
    bool good = m->density > 0 && m->density <= big && m->stretch > 0 &&
                m->stretch <= big && is_within(m->shear, 0, m->stretch / 2) &&
                is_within(m->bend, 0, big) && is_within(m->damping, 0, 1e6) &&
                m->thickness > 0 && m->thickness <= big &&
                is_within(m->friction, 0, 1e6);
    for (int k = 0; k < 3; k++)
        good &= m->limit[k] == 0 || is_within(m->limit[k], 0.01, 10);
    for (int o = 0; o < DRAPE_TABLES; o++)
        good &= table_fault(m->table[o]) < 0;
    return good;
}

/* The changes of one cloth, as the part holds them. The list is where the part
 * has it, and may be unaligned. */
struct said {
    drape_material material;
    int64_t n;
    const uint8_t *list;
};

/* Reads a cloth of the part and moves *at behind it. False: the part is too
 * short, or a number is out of range. */
static bool read_cloth(const struct cloth *c, const uint8_t *in, int64_t bytes,
                       int64_t *at, struct said *said)
{
    int64_t head = (int64_t)(sizeof said->material + sizeof said->n);
    if (bytes - *at < head)
        return false;
    memcpy(&said->material, in + *at, sizeof said->material);
    memcpy(&said->n, in + *at + sizeof said->material, sizeof said->n);
    said->list = in + *at + head;
    if (said->n < -1 || said->n > c->count || !good_material(&said->material))
        return false;
    *at += head + WORD * words_of(said->n);
    return *at <= bytes;
}

static bool good_list(const struct cloth *c, const struct said *said)
{
    int32_t p;
    for (int64_t i = 0; i < 2 * words_of(said->n); i++) {
        memcpy(&p, said->list + i * (int64_t)sizeof p, sizeof p);
        if (i < said->n ? p < 0 || p >= c->count : p != 0)
            return false;
    }
    return true;
}

bool control_fits(const struct world *w, const uint8_t *in, int64_t bytes)
{
    int64_t at = 0;
    struct said said;
    for (int k = 0; k < w->def.n_cloths; k++)
        if (!read_cloth(&w->sheet[k].cloth, in, bytes, &at, &said) ||
            !good_list(&w->sheet[k].cloth, &said))
            return false;
    for (int k = 0; k < w->def.n_obstacles; k++, at += WORD) {
        uint64_t targeted;
        if (bytes - at < WORD)
            return false;
        memcpy(&targeted, in + at, sizeof targeted);
        if (targeted > 1)
            return false;
    }
    return at == bytes;
}

bool control_is_targeted(const struct world *w, const uint8_t *in,
                         int64_t bytes, int obstacle)
{
    uint64_t targeted;
    memcpy(&targeted,
           in + bytes - WORD * (int64_t)(w->def.n_obstacles - obstacle),
           sizeof targeted);
    return targeted;
}

/* A cloth as it will be after the changes. */
struct next {
    drape_material material;
    struct caller_pins caller_pins; /* its streams are taken */
    uint8_t *fixed;                 /* [count] */
};

/* The pins of the definition, which may name a particle twice. */
static void mark_defined(const struct sheet *home, uint8_t *fixed)
{
    const struct cloth *c = &home->cloth;
    for (int64_t p = 0; p < c->count; p++)
        fixed[p] = c->fixed[p] == CLOTH_ABSENT ? CLOTH_ABSENT : 0;
    for (int64_t i = 0; i < home->pins.n; i++)
        fixed[home->pinned[i]] = CLOTH_PINNED;
}

/* DRAPE_EDATA if the material does not go with the cloth or its pins. */
static int try_cloth(struct world *w, int k, const struct next *next)
{
    struct cloth c = w->home->sheet[k].cloth;
    drape_cloth def = w->sheet[k].made;
    def.material = next->material;
    c.fixed = next->fixed;
    c.mass = arena_take(w->arena, ARENA_OTHER, c.count, sizeof *c.mass);
    if (!c.mass)
        return DRAPE_ENOMEM;
    int status = ref_cloth_laws(&def, &c) == DRAPE_OK ? DRAPE_OK : DRAPE_EDATA;
    if (status == DRAPE_OK)
        ref_cloth_weigh(&c);
    if (status == DRAPE_OK && start_too_stiff(w, &c))
        status = DRAPE_EDATA;
    arena_give(w->arena, c.mass);
    return status;
}

/* Takes the memory of cloth k as it will be; said: NULL: all as defined. */
static int prepare_cloth(struct world *w, int k, const struct said *said,
                         struct next *next)
{
    const struct sheet *home = &w->home->sheet[k];
    const struct cloth *c = &home->cloth;
    int64_t n = said ? said->n : -1;
    int status = DRAPE_OK;
    next->material = said ? said->material : w->sheet[k].defined;
    next->fixed = arena_take(w->arena, ARENA_OTHER, c->count, 1);
    int32_t *list = arena_take(w->arena, ARENA_OTHER, n, sizeof *list);
    if (!next->fixed || !list)
        status = DRAPE_ENOMEM;
    if (status == DRAPE_OK && n < 0)
        mark_defined(home, next->fixed);
    if (status == DRAPE_OK && n >= 0) {
        memcpy(list, said->list, (size_t)n * sizeof *list);
        if (control_mark(c, n, list, next->fixed) != DRAPE_OK)
            status = DRAPE_EDATA;
        else
            status = control_make_pins(w, n, list, &next->caller_pins);
    }
    arena_give(w->arena, list);
    return status == DRAPE_OK ? try_cloth(w, k, next) : status;
}

/* Makes cloth k as it will be; `next` gets the memory that is to be given back.
 */
static void commit_cloth(struct world *w, int k, struct next *next)
{
    struct sheet *s = &w->sheet[k];
    struct cloth *c = &w->home->sheet[k].cloth;
    drape_cloth def = s->made;
    struct caller_pins old = s->caller_pins;
    def.material = s->made.material = next->material;
    ref_cloth_laws(&def, c);
    memcpy(c->fixed, next->fixed, (size_t)c->count);
    c->n_pinned = 0;
    for (int64_t p = 0; p < c->count; p++)
        c->n_pinned += c->fixed[p] == CLOTH_PINNED;
    ref_cloth_weigh(c);
    s->caller_pins = next->caller_pins;
    next->caller_pins = old;
    control_tell_cloth(w, k);
}

/* Makes the caller's flags of obstacles as the words `in` [n_obstacles] say, or
 * 0 where in is NULL, and the settings that follow from them. */
static void commit_obstacles(struct world *w, const uint8_t *in)
{
    uint64_t targeted = 0;
    w->plan.prescribed = w->targets.planned;
    w->broad.apart.able = w->targets.able;
    for (int k = 0; k < w->def.n_cloths; k++)
        w->plan.prescribed |= w->sheet[k].caller_pins.on;
    for (int k = 0; k < w->def.n_obstacles; k++) {
        struct prop *p = &w->prop[k];
        if (in)
            memcpy(&targeted, in + WORD * (int64_t)k, sizeof targeted);
        p->targeted = targeted;
        w->plan.prescribed |= p->targeted;
        w->broad.apart.able &= !p->targeted || p->moves;
    }
    w->broad.started = false;
    w->targets.stirred = false;
}

/* The targets: those set for the next step, or where things are. */
static void commit_targets(struct world *w, const vec *to, const vec *x)
{
    size_t bytes = (size_t)w->nv * sizeof *x;
    w->targets.armed = to != NULL;
    if (!w->targets.to)
        return;
    w->run->send(w->on, w->targets.to, to ? to : x, bytes);
}

/* Makes the world as `said` [n_cloths] and the words `targeted` [n_obstacles]
 * say, or, where said is NULL, as it was defined. */
static int apply_changes(struct world *w, const struct said *said,
                         const uint8_t *targeted)
{
    int n = w->def.n_cloths, status = DRAPE_OK;
    struct next *next = arena_take(w->arena, ARENA_OTHER, n, sizeof *next);
    w->run->begin(w->on);
    if (!next)
        status = DRAPE_ENOMEM;
    if (status == DRAPE_OK && said)
        status = control_take_targets(w);
    for (int k = 0; k < n && status == DRAPE_OK; k++)
        status = prepare_cloth(w, k, said ? &said[k] : NULL, &next[k]);
    for (int k = 0; k < n && status == DRAPE_OK; k++)
        commit_cloth(w, k, &next[k]);
    if (status == DRAPE_OK)
        commit_obstacles(w, targeted);
    for (int k = 0; k < n && next; k++) {
        control_drop_pins(w, &next[k].caller_pins);
        arena_give(w->arena, next[k].fixed);
    }
    arena_give(w->arena, next);
    return status;
}

int control_unpack(struct world *w, const uint8_t *in, int64_t bytes,
                   const vec *to, const vec *x)
{
    int64_t at = 0;
    if (bytes == 0 && !has_changes(w))
        return DRAPE_OK;
    int n = w->def.n_cloths;
    struct said *said = arena_take(w->arena, ARENA_OTHER, n, sizeof *said);
    if (!said)
        return DRAPE_ENOMEM;
    for (int k = 0; k < n && bytes > 0; k++)
        read_cloth(&w->sheet[k].cloth, in, bytes, &at, &said[k]);
    int status =
        apply_changes(w, bytes > 0 ? said : NULL, bytes > 0 ? in + at : NULL);
    if (status == DRAPE_OK)
        commit_targets(w, to, x);
    arena_give(w->arena, said);
    return status;
}

/* The targets that the old world has for the next step. */
static void inherit_targets(struct world *w, const struct edited *edited)
{
    const struct targets *old = &edited->old->targets;
    size_t bytes = (size_t)w->nv * sizeof *w->x0;
    int bodies = w->def.n_cloths + w->def.n_obstacles;
    w->targets.armed = old->armed && has_changes(w);
    w->run->copy(w->on, w->targets.to, w->x0, bytes);
    for (int k = 0; k < bodies && w->targets.armed; k++) {
        if (edited->from[k] < 0)
            continue;
        int64_t to = state_first_vertex(w, k);
        int64_t n = state_first_vertex(w, k + 1) - to;
        int64_t from = state_first_vertex(edited->old, edited->from[k]);
        w->run->copy(w->on, w->targets.to + to, old->to + from,
                     (size_t)n * sizeof *w->x0);
    }
}

int control_inherit(struct world *w, const struct edited *edited)
{
    const struct world *old = edited->old;
    int n = w->def.n_cloths, m = w->def.n_obstacles;
    if (!has_changes(old))
        return DRAPE_OK;
    struct said *said = arena_take(w->arena, ARENA_OTHER, n, sizeof *said);
    uint64_t *targeted = arena_take(w->arena, ARENA_OTHER, m, sizeof *targeted);
    int status = said && targeted ? DRAPE_OK : DRAPE_ENOMEM;
    for (int k = 0; k < n && status == DRAPE_OK; k++) {
        int from = edited->from[k];
        const struct sheet *s = from < 0 ? &w->sheet[k] : &old->sheet[from];
        said[k].material = s->made.material;
        said[k].n = s->caller_pins.on ? s->caller_pins.n : -1;
        said[k].list = (const uint8_t *)s->caller_pins.list;
    }
    for (int k = 0; k < m && status == DRAPE_OK; k++) {
        int from = edited->from[n + k];
        targeted[k] = from >= 0 && old->prop[from - old->def.n_cloths].targeted;
    }
    if (status == DRAPE_OK)
        status = apply_changes(w, said, (const uint8_t *)targeted);
    if (status == DRAPE_OK)
        inherit_targets(w, edited);
    arena_give(w->arena, targeted);
    arena_give(w->arena, said);
    return status;
}
