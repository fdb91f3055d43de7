/* SPDX-License-Identifier: Apache-2.0 */
/* Draws a small valid world from choices. See fuzz/small.h. */
#include "fuzz/small.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int32_t ground_tri[2][3] = {{0, 2, 1}, {1, 2, 3}};
static const int32_t box_tri[12][3] = {
    {0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

void small_cloth(struct small *s, struct bytes *b, drape_cloth *c)
{
    int k = s->drawn++;
    drape_default_cloth(c);
    c->m = 3 + (int)pick(b, SMALL_SIDE - 2);
    c->n = 3 + (int)pick(b, SMALL_SIDE - 2);
    c->width = c->m * 0.02;
    c->height = c->n * 0.02;
    c->material.bend = pick(b, 2) ? 0 : 1e-4;
    c->material.friction = 0.25 * pick(b, 5);
    c->material.damping = pick(b, 3) ? 1e-3 : 0;
    c->origin[0] = -0.5 * c->width;
    c->origin[1] = 0.06 + 0.01 * pick(b, 5) + 0.1 * k;
    c->origin[2] = -0.5 * c->height;
    double speed = pick(b, 3);
    for (int p = 0; speed > 0 && p < c->m * c->n; p++)
        for (int i = 0; i < 3; i++)
            s->velocity[k][p][i] = draw_in(b, -speed, speed);
    if (speed > 0)
        c->velocity = (const double(*)[3])s->velocity[k];
    if (k == 0 && pick(b, 4) == 3) {
        for (int p = 0; p < c->m * c->n; p++)
            s->hole[p] = pick(b, 12) == 1, s->cut[p] = pick(b, 12) == 1;
        c->hole = s->hole;
        c->cut = s->cut;
    }
    c->n_pins = (int)pick(b, SMALL_PINS + 1);
    c->pins = s->pin[k];
    for (int p = 0; p < c->n_pins; p++)
        s->pin[k][p] =
            (drape_pin){(int)pick(b, (uint32_t)c->m),
                        (int)pick(b, (uint32_t)c->n), (int)pick(b, 2) - 1};
}

static void add_mesh(drape_obstacle *o, int64_t nv, const double (*x)[3],
                     int64_t nt, const int32_t (*tri)[3])
{
    drape_default_obstacle(o);
    o->n_vertices = nv;
    o->x = x;
    o->n_triangles = nt;
    o->tri = tri;
}

/* Draws the obstacles: the ground, a box that may move, a sheet that
 * deforms. */
static void draw_obstacles(struct bytes *b, struct small *s)
{
    double side = 0.02 + 0.01 * pick(b, 4);
    for (int k = 0; k < 8; k++) {
        s->box_x[k][0] = (k & 1 ? 0.5 : -0.5) * side;
        s->box_x[k][1] = 0.005 + (k & 4 ? side : 0);
        s->box_x[k][2] = (k & 2 ? 0.5 : -0.5) * side;
    }
    for (int k = 0; k < 4; k++) {
        s->ground_x[k][0] = k & 1 ? 2 : -2;
        s->ground_x[k][2] = k & 2 ? 2 : -2;
        for (int f = 0; f < 2; f++) {
            s->frame[f][k][0] = k & 1 ? 0.3 : 0.02;
            s->frame[f][k][1] = 0.001 + 0.02 * (f && k & 2);
            s->frame[f][k][2] = k & 2 ? 0.1 : -0.1;
        }
    }
    drape_obstacle *o = s->kind;
    add_mesh(&o[0], 4, (const double(*)[3])s->ground_x, 2, ground_tri);
    add_mesh(&o[1], 8, (const double(*)[3])s->box_x, 12, box_tri);
    add_mesh(&o[2], 4, (const double(*)[3])s->frame[0], 2, ground_tri);
    o[1].motion = (int)pick(b, 2) - 1;
    o[2].frames = 2;
    o[2].frame_dt = 0.03;
    o[2].frame = (const double(*)[3])s->frame;
    memcpy(s->obstacle, s->kind, sizeof s->kind);
}

static void draw_motion(struct bytes *b, struct small *s)
{
    for (int k = 0; k < SMALL_KEYS; k++) {
        s->time[k] = 0.05 * k;
        for (int i = 0; i < 3 && k; i++)
            s->position[k][i] = 0.02 * ((int)pick(b, 5) - 2);
        double turn = k ? 0.4 * pick(b, 4) : 0;
        s->rotation[k][0] = cos(turn);
        s->rotation[k][1 + k] = sin(turn);
    }
    s->motion = (drape_motion){SMALL_KEYS,
                               s->time,
                               (const double(*)[3])s->position,
                               (const double(*)[4])s->rotation,
                               {0, 0, 0}};
}

/* Draws the settings. Explicit steps are short, so that they have few
 * substeps. */
static void draw_choices(struct bytes *b, drape_def *d)
{
    d->precision = pick(b, 2) ? 64 : 32;
    d->integrator = (DRAPE_BW + (int)pick(b, 7)) % (DRAPE_BDF2 + 1);
    d->dt = d->integrator < DRAPE_BW ? 2e-4 : 1.0 / 60;
    d->threads = 1 + (int)pick(b, 2);
    d->block = 32 * (int)pick(b, 3);
    d->precond = DRAPE_MULTIGRID - (int)pick(b, 2);
    d->matrix = (int)pick(b, 2);
    d->tolerance = pick(b, 2) ? 1e-6 : 1e-3;
    d->max_iterations = pick(b, 4) == 3 ? 1 : 500;
    d->max_rounds = 8 - (int)pick(b, 9);
    d->max_slices = 1 << pick(b, 4);
    d->self_collision = pick(b, 4) != 3;
    d->allow_intersecting = pick(b, 4) == 3;
    d->sleep = pick(b, 2) == 0;
    d->wind.density = pick(b, 2) ? 1.2 : 0;
    d->wind.velocity[0] = pick(b, 5);
    d->gravity[1] = pick(b, 4) == 3 ? -200 : -9.81;
    uint32_t how = pick(b, 16); /* one word, as inputs of corpora have it */
    d->newton = (int)(how % 4);
    d->response = how / 4 == 3 ? DRAPE_IMPULSES : DRAPE_SOLVE;
}

/* Sews the first row of the last cloth to the last row of a cloth that has no
 * hole, which may be itself. */
static void draw_seam(struct bytes *b, struct small *s)
{
    const drape_def *d = &s->def;
    int a = d->n_cloths - 1, c = s->cloth[0].hole ? a : 0;
    int m = s->cloth[c].m;
    int32_t last = m * (s->cloth[c].n - 1);
    bool able = d->integrator >= DRAPE_BW && d->response == DRAPE_SOLVE;
    if (!able || s->cloth[a].hole || pick(b, 4) != 3)
        return;
    s->seam = (drape_seam){{a, c},  1 + (int)pick(b, (uint32_t)s->cloth[a].m),
                           s->sewn, (const int32_t(*)[2])s->onto,
                           s->part, pick(b, 2) ? 0.05 : 0};
    for (int k = 0; k < s->seam.n; k++) {
        int at = k < m - 1 ? k : m - 2;
        s->sewn[k] = k;
        s->onto[k][0] = last + at;
        s->onto[k][1] = last + at + (int)pick(b, 2);
        s->part[k] = 0.25 * pick(b, 5);
    }
    s->def.seams = &s->seam;
    s->def.n_seams = 1;
}

void small_make(struct small *s, struct bytes *b)
{
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    draw_choices(b, &s->def);
    s->def.n_cloths = 1 + (int)pick(b, 2);
    for (int k = 0; k < s->def.n_cloths; k++)
        small_cloth(s, b, &s->cloth[k]);
    draw_obstacles(b, s);
    draw_motion(b, s);
    s->def.n_obstacles = (int)pick(b, 4);
    s->def.cloths = s->cloth;
    s->def.obstacles = s->obstacle;
    s->def.motions = &s->motion;
    s->def.n_motions = 1;
    draw_seam(b, s);
    bank_open(&s->host, (size_t)1 << 28);
    bank_open(&s->device, (size_t)1 << 28);
    s->def.allocator = bank_of(&s->host);
    s->def.device_allocator = bank_of(&s->device);
}

struct state {
    int64_t nv, nt;
    double (*x)[3], (*v)[3];
    int32_t (*tri)[3];
};

static bool state_read(struct state *s, const drape_world *world)
{
    s->nv = drape_vertices(world);
    s->nt = drape_triangles(world);
    s->x = malloc((size_t)s->nv * sizeof *s->x);
    s->v = malloc((size_t)s->nv * sizeof *s->v);
    s->tri = malloc((size_t)s->nt * sizeof *s->tri);
    return s->x && s->v && s->tri &&
           drape_read(world, s->x, s->v) == DRAPE_OK &&
           drape_read_triangles(world, s->tri) == DRAPE_OK;
}

static void state_free(struct state *s)
{
    free(s->x);
    free(s->v);
    free(s->tri);
}

static double rounded(const struct small *s, double x)
{
    return s->def.precision == 32 ? (double)(float)x : x;
}

/* Whether the pin holds its particle at rest: neither this pin nor another pin
 * on the particle has a motion. */
static bool held(const drape_cloth *c, const drape_pin *pin)
{
    bool alone = pin->motion < 0;
    for (int k = 0; k < c->n_pins; k++)
        alone = alone && (c->pins[k].i != pin->i || c->pins[k].j != pin->j ||
                          c->pins[k].motion < 0);
    return alone;
}

static const char *look_at_rest(const struct small *s, const drape_world *world,
                                const struct state *now)
{
    for (int k = 0; k < s->def.n_cloths; k++) {
        const drape_cloth *c = &s->cloth[k];
        for (int p = 0; p < c->n_pins; p++) {
            const drape_pin *pin = &c->pins[p];
            int64_t at = drape_first_vertex(world, k) + pin->i + c->m * pin->j;
            double u = c->width / (c->m - 1) * pin->i;
            double v = c->height / (c->n - 1) * pin->j;
            double far = fabs(now->x[at][0] - c->origin[0] - u) +
                         fabs(now->x[at][1] - c->origin[1]) +
                         fabs(now->x[at][2] - c->origin[2] - v);
            if (held(c, pin) && !(far < 1e-6))
                return "a held particle moved";
        }
    }
    for (int k = 0; k < s->def.n_obstacles; k++) {
        const drape_obstacle *o = &s->obstacle[k];
        int64_t first = drape_first_vertex(world, s->def.n_cloths + k);
        for (int64_t p = 0; p < 3 * o->n_vertices; p++)
            if (o->motion < 0 && !o->frames &&
                now->x[first + p / 3][p % 3] != rounded(s, o->x[p / 3][p % 3]))
                return "an obstacle at rest moved";
    }
    return NULL;
}

const char *small_state(const struct small *s, const drape_world *world)
{
    struct state now;
    const char *failed = NULL;
    if (!state_read(&now, world))
        failed = "the state cannot be read";
    for (int64_t k = 0; k < 3 * now.nv && !failed; k++)
        if (!isfinite(now.x[k / 3][k % 3]) || !isfinite(now.v[k / 3][k % 3]))
            failed = "a state is not finite";
    if (!failed && !s->prescribed)
        failed = look_at_rest(s, world, &now);
    state_free(&now);
    return failed;
}

/* The number of pairs that the mesh has without those that a seam joins. */
static int64_t count_apart(const drape_world *world, const drape_mesh *mesh,
                           int64_t found)
{
    int32_t(*pair)[2] = malloc(((size_t)found + 1) * sizeof *pair);
    int64_t all = found, apart = -1;
    if (pair && drape_audit(mesh, all, pair, &found, NULL) == DRAPE_OK)
        apart = found;
    for (int64_t k = 0; k < found && apart >= 0; k++)
        apart -= drape_are_sewn(world, pair[k][0], pair[k][1]);
    free(pair);
    return apart;
}

int64_t small_audit(const struct small *s, const drape_world *world)
{
    struct state now;
    int64_t found = -1;
    bool good = state_read(&now, world);
    int32_t *group = malloc((size_t)now.nt * sizeof *group);
    int64_t cloth = drape_first_triangle(world, s->def.n_cloths);
    for (int64_t k = 0; group && k < now.nt; k++)
        group[k] = k < cloth;
    drape_mesh mesh = {.nv = now.nv,
                       .nt = now.nt,
                       .x = (const double(*)[3])now.x,
                       .tri = (const int32_t(*)[3])now.tri,
                       .group = group,
                       .threads = 1};
    if (!good || !group ||
        drape_audit(&mesh, 0, NULL, &found, NULL) != DRAPE_OK)
        found = -1;
    if (found > 0 && s->def.n_seams > 0)
        found = count_apart(world, &mesh, found);
    free(group);
    state_free(&now);
    return found;
}
