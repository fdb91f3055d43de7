/* SPDX-License-Identifier: Apache-2.0 */
/* Live control of gravity, materials, positions and velocities, for either
 * backend. spec/control/control.md §1, §2 */
#include "ref/control/control.h"

#include "ref/base/change.h"
#include "ref/panel/panel.h"
#include "ref/seam/seam.h"
#include "ref/sleep/sleep.h"
#include "ref/world/air.h"
#include "ref/world/ending.h"
#include "ref/world/start.h"

/* Copies a stream that changed on the host to the backend's own. */
static void resend_stream(struct world *w, void *to, const void *from,
                          size_t bytes)
{
    if (to != from)
        w->run->send(w->on, to, from, bytes);
}

void control_gravity(struct world *w, const double gravity[3])
{
    for (int i = 0; i < 3; i++)
        w->def.gravity[i] = gravity[i];
    for (int k = 0; k < w->def.n_cloths; k++)
        w->sheet[k].dynamics.gravity =
            vec_make((real)gravity[0], (real)gravity[1], (real)gravity[2]);
    sleep_wake(w);
}

int control_wind(struct world *w, const drape_wind *wind)
{
    w->run->begin(w->on);
    int status = plan_windy(wind) ? air_take(w) : DRAPE_OK;
    if (status != DRAPE_OK)
        return status;
    air_set(w, wind);
    sleep_wake(w);
    return DRAPE_OK;
}

/* Sets the numbers of the scene that depend on all cloths, as fill.c and
 * connect.c do. */
static void derive_from_cloths(struct world *w)
{
    const struct world *h = w->home;
    w->reach = w->response.stiffness = 0;
    w->mass = 0;
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct cloth *c = &h->sheet[k].cloth;
        const drape_material *m = &w->sheet[k].made.material;
        real thickness = h->surface[k].thickness;
        w->reach = real_max(w->reach, thickness);
        w->thinnest = k ? real_min(w->thinnest, thickness) : thickness;
        w->response.stiffness =
            real_max(w->response.stiffness, RESPONSE_SOFT * (real)m->stretch);
        for (int64_t p = 0; p < c->count; p++)
            w->mass += (double)c->mass[p];
    }
}

/* Gives the panel of cloth k its material. */
static void resend_panel(struct world *w, int k)
{
    const struct cloth *c = &w->home->sheet[k].cloth;
    const struct panel *to = w->sheet[k].cloth.panel;
    struct panel *a = c->panel;
    panel_set_material(a, c, w->sheet[k].made.material.density);
    resend_stream(w, to->bend, a->bend, (size_t)a->n_pairs * sizeof *a->bend);
    resend_stream(w, to->star, a->star, (size_t)a->n_stars * sizeof *a->star);
}

void control_tell_cloth(struct world *w, int k)
{
    struct world *h = w->home;
    struct sheet *s = &w->sheet[k];
    const struct cloth *c = &h->sheet[k].cloth;
    const drape_material *m = &s->made.material;
    size_t n = (size_t)c->count;
    real most = R(0.5) * real_min(c->hu, c->hv);
    h->surface[k] =
        (struct surface){real_min((real)m->thickness, most), (real)m->friction};
    if (&s->cloth != c) {
        struct cloth own = s->cloth;
        s->cloth = *c;
        s->cloth.cell = own.cell;
        s->cloth.springs = own.springs;
        s->cloth.beside = own.beside;
        s->cloth.fixed = own.fixed;
        s->cloth.mass = own.mass;
        s->cloth.tri = own.tri;
        s->cloth.panel = own.panel;
        s->cloth.pairs = own.pairs;
    }
    if (c->panel)
        resend_panel(w, k);
    resend_stream(w, s->cloth.fixed, c->fixed, n * sizeof *c->fixed);
    resend_stream(w, s->cloth.mass, c->mass, n * sizeof *c->mass);
    sleep_weigh(w, k);
    resend_stream(w, w->surface + k, h->surface + k, sizeof *w->surface);
    w->run->motion_laws(w->on, s);
    derive_from_cloths(w);
    sew_stiffen(w);
}

int control_material(struct world *w, int cloth, const drape_material *m)
{
    struct sheet *s = &w->sheet[cloth];
    struct cloth *c = &w->home->sheet[cloth].cloth, was = *c;
    drape_cloth def = s->made;
    def.material = *m;
    w->run->begin(w->on);
    int status = ref_cloth_laws(&def, c);
    if (status == DRAPE_OK) {
        ref_cloth_weigh(c);
        status = start_too_stiff(w, c) ? DRAPE_ELIMIT : DRAPE_OK;
    }
    if (status != DRAPE_OK) {
        *c = was;
        ref_cloth_weigh(c);
        return status;
    }
    s->made.material = *m;
    control_tell_cloth(w, cloth);
    sleep_wake(w);
    return w->run->status(w->on);
}

/* §2 */

/* Makes the world forget all that follows from earlier steps, as if it were
 * made in the state that it has. */
static void forget_history(struct world *w)
{
    w->lagrange.n_kept[0] = w->lagrange.n_resting = 0;
    w->run->clear(w->on, w->seams.pull,
                  (size_t)w->seams.n * sizeof *w->seams.pull);
    w->past = 0;
    w->nearness = NEAR_NONE;
    w->list.known = false;
    sleep_wake(w);
}

int control_take(struct world *w, struct given a, int64_t n, vec *stage,
                 vec *to)
{
    size_t bytes = (size_t)n * sizeof *to;
    bool sane = true;
    if (a.there) {
        w->run->copy(w->on, to, a.there, bytes);
        sane = w->run->prescribed_sane(w->on, n, to);
        int status = w->run->status(w->on);
        return status == DRAPE_OK && !sane ? DRAPE_EDATA : status;
    }
    for (int64_t i = 0; i < n && sane; i++) {
        const double *p = a.here[i];
        stage[i] = vec_make((real)p[0], (real)p[1], (real)p[2]);
        sane = vec_sane(stage[i]);
    }
    if (!sane)
        return DRAPE_EDATA;
    resend_stream(w, to, stage, bytes);
    return DRAPE_OK;
}

/* Puts back the entries of a that the caller cannot set, within vertices first
 * … first + n - 1, of particles that are fixed. */
static void keep_fixed(struct world *w, int64_t first, int64_t n,
                       const vec *old, vec *a)
{
    for (int k = 0; k < w->def.n_cloths; k++) {
        const struct sheet *s = &w->sheet[k];
        int64_t end = s->first + s->cloth.count;
        int64_t from = first > s->first ? first : s->first;
        int64_t to = first + n < end ? first + n : end;
        if (from < to)
            w->run->prescribed_keep(w->on, to - from,
                                    s->cloth.fixed + (from - s->first),
                                    old + from, a + from);
    }
}

/* Counts the intersecting pairs with the vertices at x1. The host looks again
 * where the pairs have to be named, or a triangle has no area. */
static int count_pairs(struct world *w, int64_t *found, drape_error *error)
{
    *found = 0;
    if (!w->plan.collides)
        return DRAPE_OK;
    int status = ending_count(w, w->x1, found);
    bool again = w->ending.n_degenerate > 0 ||
                 (*found > 0 && !w->def.allow_intersecting);
    if (status != DRAPE_OK || !again)
        return status;
    vec *x = w->home->x1;
    if (x != w->x1)
        w->run->fetch(w->on, x, w->x1, (size_t)w->nv * sizeof *x);
    status = w->run->status(w->on);
    return status == DRAPE_OK ? start_audit_at(w->home, x, -1, found, error)
                              : status;
}

int control_positions(struct world *w, int64_t first, int64_t n, struct given x,
                      drape_error *error)
{
    int64_t end = first + n, found;
    w->run->begin(w->on);
    int status = control_take(w, x, n, w->home->x1 + first, w->x1 + first);
    if (status != DRAPE_OK)
        return status;
    w->run->copy(w->on, w->x1, w->x0, (size_t)first * sizeof *w->x1);
    w->run->copy(w->on, w->x1 + end, w->x0 + end,
                 (size_t)(w->nv - end) * sizeof *w->x1);
    keep_fixed(w, first, n, w->x0, w->x1);
    status = count_pairs(w, &found, error);
    if (status == DRAPE_OK)
        status = w->run->status(w->on);
    if (status != DRAPE_OK)
        return status;
    vec *old = w->x0;
    w->x0 = w->x1;
    w->x1 = old;
    w->intersecting = found;
    forget_history(w);
    return DRAPE_OK;
}

int control_velocities(struct world *w, int64_t first, int64_t n,
                       struct given v)
{
    w->run->begin(w->on);
    int status = control_take(w, v, n, w->home->v1 + first, w->v1 + first);
    if (status != DRAPE_OK)
        return status;
    keep_fixed(w, first, n, w->v0, w->v1);
    w->run->copy(w->on, w->v0 + first, w->v1 + first,
                 (size_t)n * sizeof *w->v0);
    forget_history(w);
    return w->run->status(w->on);
}

int control_fetch(struct world *w, void *host, const void *there, size_t bytes)
{
    w->run->begin(w->on);
    w->run->fetch(w->on, host, there, bytes);
    return w->run->status(w->on);
}
