/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the definition of a world whose bodies were changed, and hands over the
 * state. spec/control/control.md §9 */
#include "ref/control/edit.h"

#include "ref/base/change.h"
#include "ref/contact/kept.h"
#include "ref/control/control.h"
#include "ref/world/ending.h"
#include "ref/world/prescribe.h"
#include "ref/world/start.h"

/* §9.1: the definition. */

static int define_cloth(const struct world *w, int k, struct arena *arena,
                        drape_cloth *def)
{
    const struct sheet *h = &w->home->sheet[k];
    const struct cloth *c = &h->cloth;
    int64_t m = c->m, cells = (m - 1) * (c->n - 1), pins = h->pins.n;
    double(*x)[3] = arena_take(arena, ARENA_OTHER, c->count, sizeof *x);
    uint8_t *cut = arena_take(arena, ARENA_OTHER, cells, 1);
    drape_pin *pin = arena_take(arena, ARENA_OTHER, pins, sizeof *pin);
    if (!x || !cut || !pin)
        return DRAPE_ENOMEM;
    for (int64_t j = 0; j < c->n - 1; j++)
        for (int64_t i = 0; i < m - 1; i++)
            cut[i + (m - 1) * j] = !c->cell[i + m * j];
    for (int64_t i = 0; i < pins; i++) {
        int32_t p = h->pinned[i];
        pin[i] = (drape_pin){p % c->m, p / c->m, h->pins.motion[i]};
        memcpy(x[p], h->pins.rest + 3 * i, sizeof *x);
    }
    *def = w->sheet[k].made;
    def->material = w->sheet[k].defined;
    def->x = (const double(*)[3])x;
    def->cut = def->panel ? NULL : cut;
    def->pins = pin;
    def->n_pins = (int)pins;
    return DRAPE_OK;
}

static int define_obstacle(const struct world *w, int k, struct arena *arena,
                           drape_obstacle *def)
{
    const struct world *h = w->home;
    const struct prop *p = &h->prop[k];
    int body = w->def.n_cloths + k;
    int64_t first = state_first_triangle(w, body);
    int64_t n = state_first_triangle(w, body + 1) - first;
    int32_t(*tri)[3] = arena_take(arena, ARENA_OTHER, n, sizeof *tri);
    if (!tri)
        return DRAPE_ENOMEM;
    for (int64_t t = 0; t < n; t++)
        for (int i = 0; i < 3; i++)
            tri[t][i] = h->tri[first + t][i] - (int32_t)p->first;
    const double *x = p->frame ? p->frame : p->place.rest;
    *def = (drape_obstacle){.n_vertices = p->place.n,
                            .n_triangles = n,
                            .x = (const double(*)[3])x,
                            .tri = (const int32_t(*)[3])tri,
                            .friction = (double)h->surface[body].friction,
                            .motion = p->place.motion[0],
                            .frames = p->frames.count,
                            .between = p->frames.between,
                            .frame_dt = p->frames.dt,
                            .frame_time = p->frames.time,
                            .frame =
                                p->frame ? (const double(*)[3])p->frame : NULL};
    return DRAPE_OK;
}

/* Lists the bodies that stay and the new one, and sets their numbers. */
static void list_bodies(const struct world *old, const struct scene_edit *edit,
                        drape_def *def, struct edited *edited)
{
    int cloths = old->def.n_cloths, all = cloths + old->def.n_obstacles, n = 0;
    edited->added = -1;
    for (int k = 0; k < cloths; k++)
        if (k != edit->removed)
            edited->from[n++] = k;
    if (edit->cloth)
        edited->from[edited->added = n++] = -1;
    def->n_cloths = n;
    for (int k = cloths; k < all; k++)
        if (k != edit->removed)
            edited->from[n++] = k;
    if (edit->obstacle)
        edited->from[edited->added = n++] = -1;
    def->n_obstacles = n - def->n_cloths;
}

/* Lists the seams all of whose cloths stay. */
static void list_seams(const struct world *old, const drape_def *def,
                       struct edited *edited, drape_seam *seam)
{
    for (int k = 0; k < old->seams.count; k++) {
        drape_seam s = old->seams.made[k];
        int found = 0;
        for (int i = 0; i < 2; i++)
            for (int c = 0; c < def->n_cloths; c++)
                if (edited->from[c] == old->seams.cloth[k][i]) {
                    s.cloth[i] = c;
                    found++;
                    break;
                }
        if (found == 2) {
            edited->seam[edited->seams] = k;
            seam[edited->seams++] = s;
        }
    }
}

int edit_define(const struct world *old, const struct scene_edit *edit,
                struct arena *arena, drape_def *def, struct edited *edited)
{
    int cloths = old->def.n_cloths, most = cloths + old->def.n_obstacles + 1;
    drape_cloth *cloth = arena_take(arena, ARENA_OTHER, most, sizeof *cloth);
    drape_obstacle *obstacle =
        arena_take(arena, ARENA_OTHER, most, sizeof *obstacle);
    int seams = old->seams.count;
    drape_seam *seam = arena_take(arena, ARENA_OTHER, seams, sizeof *seam);
    edited->from = arena_take(arena, ARENA_OTHER, most, sizeof *edited->from);
    edited->seam = arena_take(arena, ARENA_OTHER, seams, sizeof *edited->seam);
    edited->seams = 0;
    if (arena->failed)
        return DRAPE_ENOMEM;
    edited->old = old;
    *def = old->def;
    memcpy(def->gravity, old->defined_gravity, sizeof def->gravity);
    def->wind = old->defined_wind;
    def->cloths = cloth;
    def->obstacles = obstacle;
    list_bodies(old, edit, def, edited);
    list_seams(old, def, edited, seam);
    def->seams = seam;
    def->n_seams = edited->seams;
    int status = DRAPE_OK, bodies = def->n_cloths + def->n_obstacles;
    for (int k = 0; k < bodies && status == DRAPE_OK; k++) {
        int from = edited->from[k], o = k - def->n_cloths;
        if (from >= 0)
            status = o < 0 ? define_cloth(old, from, arena, &cloth[k])
                           : define_obstacle(old, from - cloths, arena,
                                             &obstacle[o]);
        else if (o < 0)
            cloth[k] = *edit->cloth;
        else
            obstacle[o] = *edit->obstacle;
    }
    return status;
}

/* §9.2: the state. */

/* Copies a stream that was filled on the host to the backend's own. */
static void resend_vectors(struct world *w, vec *to, const vec *from, int64_t n)
{
    if (to != from)
        w->run->send(w->on, to, from, (size_t)n * sizeof *to);
}

/* Copies a body's part of the streams of the state from the old world. */
static void copy_body(struct world *w, int k, const struct world *old, int from)
{
    int64_t to = state_first_vertex(w, k), at = state_first_vertex(old, from);
    size_t bytes = (size_t)(state_first_vertex(w, k + 1) - to) * sizeof(vec);
    const struct state_list s = state_streams(w), was = state_streams(old);
    for (int i = 0; i < STATE_STREAMS; i++)
        /* a stream of cloth ends before the obstacles */
        if (to < s.of[i].n && !s.of[i].seams)
            w->run->copy(w->on, *s.of[i].at + to, *was.of[i].at + at, bytes);
    w->run->copy(w->on, w->x1 + to, old->x0 + at, bytes);
    if (k < w->def.n_cloths)
        memcpy(w->watch[k], old->watch[from], sizeof *w->watch);
}

/* Copies a seam's part of them. */
static void copy_seam(struct world *w, int k, const struct world *old, int from)
{
    int64_t to = w->seams.first[k], at = old->seams.first[from];
    size_t bytes = (size_t)(w->seams.first[k + 1] - to) * sizeof(vec);
    const struct state_list s = state_streams(w), was = state_streams(old);
    for (int i = 0; i < STATE_STREAMS; i++)
        if (s.of[i].seams)
            w->run->copy(w->on, *s.of[i].at + to, *was.of[i].at + at, bytes);
}

/* §9.3: a new cloth has moved with its velocity until now. */
static void begin_cloth(struct world *w, int k)
{
    struct world *h = w->home;
    int64_t first = w->sheet[k].first, n = w->sheet[k].cloth.count;
    if (!w->past_x || !w->past)
        return;
    real dt = (real)(w->def.dt / (1 << (w->past - 1)));
    for (int64_t p = first; p < first + n; p++) {
        h->past_v[p] = h->v0[p];
        h->past_x[p] = vec_axpy(h->x0[p], -dt, h->v0[p]);
    }
    resend_vectors(w, w->past_x + first, h->past_x + first, n);
    resend_vectors(w, w->past_v + first, h->past_v + first, n);
}

/* §9.3: a new obstacle is where its motion or its frames have it now. */
static int begin_obstacle(struct world *w, int k)
{
    struct world *h = w->home;
    struct prop *p = &h->prop[k];
    if (!p->moves)
        return DRAPE_OK;
    for (int i = 0; i < h->def.n_motions; i++)
        h->pose[i] = kinematics_pose(&h->def.motions[i], w->time);
    if (p->frame)
        kinematics_frame(&p->frames, p->frame, w->time, &p->place);
    p->place.x = h->x0 + p->first;
    int status = ref_kinematics(&p->place);
    resend_vectors(w, w->x0 + p->first, p->place.x, p->place.n);
    w->run->copy(w->on, w->x1 + p->first, w->x0 + p->first,
                 (size_t)p->place.n * sizeof *w->x1);
    return status;
}

/* Copies the numbers of the state that are not of a body. DRAPE_OK, or the
 * status that control_wind returned. */
static int copy_numbers(struct world *w, const struct world *old)
{
    w->step = old->step;
    w->time = old->time;
    w->past = w->past_x ? old->past : 0;
    w->nearness = w->plan.collides ? old->nearness : NEAR_NONE;
    control_gravity(w, old->def.gravity);
    return control_wind(w, &old->def.wind);
}

/* §9.4: refuses pairs of the new body, and counts all. The host looks where the
 * pairs may have to be named, or a triangle has no area. */
static int admit_body(struct world *w, const struct edited *edited,
                      drape_error *error)
{
    int64_t before = edited->old->intersecting, found = before;
    if (!w->plan.collides || (edited->added < 0 && before == 0))
        return DRAPE_OK;
    int status = ending_count(w, w->x0, &found);
    w->intersecting = found;
    if (status != DRAPE_OK || edited->added < 0 ||
        (found == before && w->ending.n_degenerate == 0))
        return status;
    vec *x = w->home->x1;
    w->run->fetch(w->on, x, w->x0, (size_t)w->nv * sizeof *x);
    status = w->run->status(w->on);
    return status == DRAPE_OK
               ? start_audit_at(w->home, x, edited->added, &found, error)
               : status;
}

int edit_inherit(struct world *w, const struct edited *edited,
                 drape_error *error)
{
    const struct world *old = edited->old;
    int bodies = w->def.n_cloths + w->def.n_obstacles;
    old->run->wait(old->on);
    w->run->begin(w->on);
    int status = copy_numbers(w, old);
    for (int k = 0; k < bodies && status == DRAPE_OK; k++)
        if (edited->from[k] >= 0)
            copy_body(w, k, old, edited->from[k]);
        else if (k < w->def.n_cloths)
            begin_cloth(w, k);
        else
            status = begin_obstacle(w, k - w->def.n_cloths);
    for (int k = 0; k < edited->seams; k++)
        copy_seam(w, k, old, edited->seam[k]);
    if (status == DRAPE_OK)
        status = control_inherit(w, edited);
    if (status == DRAPE_OK)
        status = kept_inherit(w, edited);
    if (status == DRAPE_OK)
        status = admit_body(w, edited, error);
    return status == DRAPE_OK ? w->run->status(w->on) : status;
}
