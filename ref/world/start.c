/* SPDX-License-Identifier: Apache-2.0 */
/* Checks whether a scene may start in the state that its definition gives. */
#include "ref/world/start.h"

#include <stdio.h>

#include "ref/cloth/advance.h"
#include "ref/narrow/audit.h"
#include "ref/narrow/sliver.h"
#include "ref/seam/seam.h"

static void *take_array(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_OTHER, n, size);
}

static int take_audit(struct world *w, struct audit *s)
{
    int32_t *group = take_array(w, w->nt, sizeof *group);
    s->n_nodes = ref_audit_nodes(s->nt);
    for (int k = 0; k < 2; k++) {
        s->key[k] = take_array(w, s->nt, sizeof **s->key);
        s->order[k] = take_array(w, s->nt, sizeof **s->order);
    }
    s->node = take_array(w, s->n_nodes, sizeof *s->node);
    s->count = take_array(w, s->n_nodes, sizeof *s->count);
    s->degenerate = take_array(w, s->nt, 1);
    s->pair = take_array(w, s->cap, sizeof *s->pair);
    s->group = group;
    for (int64_t k = 0; k < w->nt && group; k++)
        group[k] = k < w->ntc;
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

static void give_audit(struct world *w, struct audit *s)
{
    for (int k = 0; k < 2; k++) {
        arena_give(w->arena, s->key[k]);
        arena_give(w->arena, s->order[k]);
    }
    arena_give(w->arena, s->node);
    arena_give(w->arena, s->count);
    arena_give(w->arena, s->degenerate);
    arena_give(w->arena, s->pair);
    arena_give(w->arena, (void *)s->group);
}

/* The intersecting pairs of a state, without pairs that the simulation need not
 * keep apart. */
struct start_pairs {
    int32_t from, to; /* of each pair one triangle is from … to - 1: the
 others are not wanted */
    int64_t all;      /* pairs of triangles with area, whatever `from` and
 `to` are, that no seam joins */
    int64_t found;    /* pairs of triangles with area; if there is none, 1 if
                         a triangle without area touches another triangle */
    int32_t first[2]; /* the first pair, ascending; triangles of the scene */
    bool sliver;      /* a triangle of `first` has no area */
};

/* Whether the simulation must keep triangles a and b of the scene apart: never
 * two of obstacles, and two of cloths only with self-collision. */
static bool is_counted(const struct world *w, int32_t a, int32_t b)
{
    bool cloth_a = a < w->ntc, cloth_b = b < w->ntc;
    return w->plan.self ? cloth_a || cloth_b : cloth_a != cloth_b;
}

static bool is_within(const struct start_pairs *p, int32_t a, int32_t b)
{
    return (a >= p->from && a < p->to) || (b >= p->from && b < p->to);
}

static int find_pairs(struct world *w, struct audit *s, struct start_pairs *p)
{
    int status = ref_audit(s);
    if (status == DRAPE_EFULL) {
        arena_give(w->arena, s->pair);
        s->cap = s->found;
        s->pair = take_array(w, s->cap, sizeof *s->pair);
        status = s->pair ? ref_audit(s) : DRAPE_ENOMEM;
    }
    for (int64_t k = 0; k < s->found && status == DRAPE_OK; k++) {
        if (sew_joins(w, s->pair[k][0], s->pair[k][1]))
            continue;
        p->all++;
        if (is_within(p, s->pair[k][0], s->pair[k][1]) && !p->found++)
            memcpy(p->first, s->pair[k], sizeof p->first);
    }
    return status;
}

/* A search for a triangle that touches the triangle t, which has no area:
 * spec/narrow/audit.md §5. */
struct sliver {
    const struct world *w;
    const struct audit *s;
    const struct start_pairs *p;
    struct face face;
    int32_t t, other; /* other: out: the triangle that was tested last */
};

static bool note_touch(void *user, int32_t other)
{
    struct sliver *r = user;
    r->other = other;
    if (!is_counted(r->w, r->t, other) || !is_within(r->p, r->t, other) ||
        sew_joins(r->w, r->t, other))
        return false;
    struct face face = ref_audit_face(r->s, other);
    return ref_sliver(&r->face, &face);
}

/* Finds the first triangle without area that touches another one. Not all are
 * listed, since many triangles in one point would make too many pairs. */
static void find_sliver(const struct world *w, const struct audit *s,
                        struct start_pairs *p)
{
    for (int32_t t = 0; t < s->nt && p->found == 0; t++) {
        struct sliver r = {.w = w, .s = s, .p = p, .t = t};
        if (!s->degenerate[t])
            continue;
        r.face = ref_audit_face(s, t);
        if (!ref_audit_any(s, t, note_touch, &r))
            continue;
        p->found = 1;
        p->sliver = true;
        p->first[0] = t < r.other ? t : r.other;
        p->first[1] = t < r.other ? r.other : t;
    }
}

/* Finds the pairs, with their vertices at x. DRAPE_OK, also if there are pairs,
 * or an error. */
static int audit_at(struct world *w, const vec *x, struct start_pairs *p)
{
    struct audit s = {.nv = w->nv, .nt = w->nt, .x = x, .cap = 1024};
    s.tri = (const int32_t(*)[3])w->tri;
    s.across = !w->plan.self;
    int status = take_audit(w, &s);
    if (status == DRAPE_OK)
        status = find_pairs(w, &s, p);
    if (status == DRAPE_OK && s.n_degenerate > 0)
        find_sliver(w, &s, p);
    give_audit(w, &s);
    return status;
}

static void write_name(const struct world *w, int32_t t, char *text,
                       size_t size)
{
    int body = 0, last = w->def.n_cloths + w->def.n_obstacles - 1;
    while (body < last && state_first_triangle(w, body + 1) <= t)
        body++;
    bool cloth = body < w->def.n_cloths;
    snprintf(text, size, "%s %d triangle %d", cloth ? "cloth" : "obstacle",
             cloth ? body : body - w->def.n_cloths,
             (int)(t - state_first_triangle(w, body)));
}

/* Writes to the error which bodies intersect, and the first pair. */
static void explain_pairs(const struct world *w, const struct start_pairs *p,
                          drape_error *error)
{
    char a[64], b[64], more[64] = "";
    write_name(w, p->first[0], a, sizeof a);
    write_name(w, p->first[1], b, sizeof b);
    if (p->found > 1)
        snprintf(more, sizeof more, " (first of %lld pairs)",
                 (long long)p->found);
    snprintf(error->text, sizeof error->text,
             "the start state is intersecting: %s and %s%s%s", a, b, more,
             p->sliver ? ", one of them without area" : "");
}

int start_audit_at(struct world *w, const vec *x, int body, int64_t *found,
                   drape_error *error)
{
    struct start_pairs p = {.from = 0, .to = (int32_t)w->nt};
    if (body >= 0) {
        p.from = (int32_t)state_first_triangle(w, body);
        p.to = (int32_t)state_first_triangle(w, body + 1);
    }
    int status = audit_at(w, x, &p);
    *found = p.all;
    if (status != DRAPE_OK || p.found == 0)
        return status;
    if (w->def.allow_intersecting)
        return DRAPE_OK;
    if (error)
        explain_pairs(w, &p, error);
    return DRAPE_ESTART;
}

int start_audit(struct world *w, drape_error *error)
{
    return start_audit_at(w, w->x0, -1, &w->intersecting, error);
}

bool start_too_stiff(const struct world *w, const struct cloth *cloth)
{
    return !w->plan.implicit &&
           advance_substeps_of(w->def.integrator, w->def.dt, cloth) >
               w->def.max_substeps;
}

int start_substeps(const struct world *w, drape_error *error)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct cloth *c = &w->sheet[k].cloth;
        if (!start_too_stiff(w, c))
            continue;
        int32_t n = advance_substeps_of(w->def.integrator, w->def.dt, c);
        if (error)
            snprintf(error->text, sizeof error->text,
                     "cloth %d: stable from %d substeps on, max_substeps is "
                     "%d",
                     k, (int)n, w->def.max_substeps);
        return DRAPE_ELIMIT;
    }
    return DRAPE_OK;
}
