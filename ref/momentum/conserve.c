/* SPDX-License-Identifier: Apache-2.0 */
/* Gives cloths in empty space the momentum back that a slice has lost, on
 * either backend. spec/momentum/momentum.md §3 */
#include "ref/momentum/conserve.h"

#include <math.h>

#include "ref/base/sum.h"
#include "ref/momentum/tally.h"
#include "ref/world/state.h"

bool conserve_applies(const struct world *w)
{
    int64_t pinned = 0;
    for (int k = 0; k < w->def.n_cloths; k++)
        pinned += w->sheet[k].cloth.n_pinned;
    return w->plan.implicit && !w->plan.wind && pinned == 0 &&
           w->def.n_obstacles == 0;
}

/* Whether the targets of seams move in this step: what gives energy is not as
 * empty space. */
static bool targets_move(const struct world *w)
{
    const struct seams *s = &w->seams;
    return s->n > 0 &&
           w->run->prescribed_differs(w->on, s->n, NULL, s->from, s->to);
}

static int64_t largest_cloth(const struct world *w)
{
    int64_t most = 0;
    for (int k = 0; k < w->def.n_cloths; k++)
        most = most > w->sheet[k].cloth.count ? most : w->sheet[k].cloth.count;
    return most;
}

static int make_room(struct world *w)
{
    struct conserve *c = &w->conserve;
    int64_t n = w->def.n_cloths;
    int64_t chunks = MOMENTS * sum_chunks(largest_cloth(w));
    if (!c->chunk)
        c->chunk = w->run->take(w->on, ARENA_OTHER, chunks, sizeof *c->chunk);
    if (!c->label)
        c->label = w->run->take(w->on, ARENA_OTHER, n, sizeof *c->label);
    if (!c->of)
        c->of = arena_take(w->arena, ARENA_OTHER, n, sizeof *c->of);
    if (!c->part)
        c->part = arena_take(w->arena, ARENA_OTHER, 2 * n, sizeof *c->part);
    if (!c->island)
        c->island = arena_take(w->arena, ARENA_OTHER, 2 * n, sizeof *c->island);
    bool good = c->chunk && c->label && c->of && c->part && c->island;
    return good ? DRAPE_OK : DRAPE_ENOMEM;
}

/* §3.1: measures all cloths in the state x, v, but for their springs. */
static int measure_cloths(struct world *w, const vec *x, const vec *v,
                          struct tally *part)
{
    int status = DRAPE_OK;
    for (int k = 0; k < w->def.n_cloths && status == DRAPE_OK; k++) {
        const struct sheet *s = &w->sheet[k];
        struct moments m = {.count = s->cloth.count,
                            .w = w->w + s->first,
                            .x = x + s->first,
                            .v = v + s->first,
                            .n_chunks = sum_chunks(s->cloth.count),
                            .chunk = w->conserve.chunk};
        status = w->run->moments(w->on, &m);
        part[k] = tally_of(&m);
    }
    return status;
}

/* §3.4: the elastic energies of all cloths at the start and the end of the
 * slice. */
static void find_energies(struct world *w, struct tally *part)
{
    int n = w->def.n_cloths;
    for (int k = 0; k < n; k++) {
        struct sheet *s = &w->sheet[k];
        double met[3], *after = w->met ? met : s->dynamics.energy;
        part[k].elastic = s->dynamics.before[1];
        if (w->met)
            w->run->motion_energy(w->on, s, w->x1 + s->first, w->v1 + s->first,
                                  met);
        part[n + k].elastic = after[1];
    }
}

/* What is sewn together is one island. */
static void join_sewn(const struct world *w, int32_t *of)
{
    for (int k = 0; k < w->seams.count; k++) {
        int32_t a = of[w->seams.cloth[k][0]], b = of[w->seams.cloth[k][1]];
        int32_t least = a < b ? a : b;
        for (int j = 0; j < w->def.n_cloths && a != b; j++)
            if (of[j] == a || of[j] == b)
                of[j] = least;
    }
}

int conserve_find_islands(struct world *w, bool one, int32_t *label,
                          int32_t *of)
{
    const struct response *r = &w->response;
    int cloths = w->def.n_cloths;
    struct islands s = {.nv = w->nv,
                        .n = r->active,
                        .body = w->body,
                        .contact = r->contact[r->side].data,
                        .bodies = cloths,
                        .label = label};
    one |= cloths == 1;
    for (int k = 0; k < cloths; k++)
        of[k] = one ? 0 : k;
    int status = DRAPE_OK;
    if (!one && w->met) {
        status = w->run->islands(w->on, &s);
        w->run->fetch(w->on, of, label, (size_t)cloths * sizeof *of);
    }
    join_sewn(w, of);
    return status;
}

static vec vec_of(const double a[3])
{
    return vec_make((real)a[0], (real)a[1], (real)a[2]);
}

/* False where masses or lengths are so small that sums are 0 or no numbers. */
static bool is_finite(const struct gain *g)
{
    double sum = g->keep;
    for (int i = 0; i < 3; i++)
        sum += fabs(g->centre[i]) + fabs(g->dv[i]) + fabs(g->dw[i]);
    return sum - sum == 0;
}

/* §3: gives cloth k the gain of its island. Its energies of the motion are
 * those of what it then has. */
static int give_gain(struct world *w, int k)
{
    const struct tally *before = &w->conserve.island[w->conserve.of[k]];
    const struct tally *after = before + w->def.n_cloths;
    struct sheet *s = &w->sheet[k];
    double p[3];
    for (int i = 0; i < 3; i++)
        p[i] = before->p[i] + before->mass * w->def.gravity[i] * w->dt;
    struct gain g = tally_gain(before, after, p);
    if (!is_finite(&g))
        return DRAPE_OK;
    struct spin spin = {.count = s->cloth.count,
                        .w = w->w + s->first,
                        .x = w->x1 + s->first,
                        .keep = (real)g.keep,
                        .centre = vec_of(g.centre),
                        .dv = vec_of(g.dv),
                        .dw = vec_of(g.dw),
                        .v = w->v1 + s->first,
                        .to = w->v1 + s->first};
    int status = w->run->spin(w->on, &spin);
    w->run->trace(w->on, w->tracing, "spin", spin.to,
                  (size_t)spin.count * sizeof *spin.to);
    if (!w->met)
        w->run->motion_energy(w->on, s, spin.x, spin.v, s->dynamics.energy);
    if (status == DRAPE_OK && w->plan.history && w->plan.collides) {
        spin.v = spin.to = w->free_v + s->first; /* it is no jump of contacts */
        status = w->run->spin(w->on, &spin);
    }
    return status;
}

int conserve_momentum(struct world *w, int outcome)
{
    struct conserve *c = &w->conserve;
    int n = w->def.n_cloths;
    if (!conserve_applies(w) || targets_move(w))
        return DRAPE_OK;
    int status = make_room(w);
    if (status == DRAPE_OK)
        status = measure_cloths(w, w->x0, w->v0, c->part);
    if (status == DRAPE_OK)
        status = measure_cloths(w, w->x1, w->v1, c->part + n);
    bool one = slice_failed(outcome); /* zones join cloths without a contact */
    if (status == DRAPE_OK)
        status = conserve_find_islands(w, one, c->label, c->of);
    if (status != DRAPE_OK)
        return status;
    find_energies(w, c->part);
    tally_join(n, c->of, c->part, c->island);
    tally_join(n, c->of, c->part + n, c->island + n);
    for (int k = 0; k < n && status == DRAPE_OK; k++)
        status = give_gain(w, k);
    return status;
}
