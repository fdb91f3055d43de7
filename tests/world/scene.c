/* SPDX-License-Identifier: Apache-2.0 */
/* Small random scenes through the public API; see tests/world/scene.h. */
#include "tests/world/scene.h"

#include <stdlib.h>

#include "tests/panel/random.h"
#include "tests/world/twin.h"

enum { SIDE = RANDOM_SIDE, PINS = 3, KEYS = 2 };

/* A random definition and the data that it points to. */
struct scene {
    drape_def def;
    drape_cloth cloth[2];
    drape_obstacle obstacle[2];
    drape_motion motion;
    double time[KEYS], position[KEYS][3], rotation[KEYS][4];
    drape_pin pin[PINS];
    uint8_t hole[SIDE * SIDE], cut[SIDE * SIDE];
    double box_x[8][3], ground_x[4][3];
    struct random_panel panel[2];
    drape_seam seam[2];
    int32_t particle[2][SIDE], onto[2][SIDE][2];
    double part[2][SIDE];
};

static const int32_t ground_tri[2][3] = {{0, 2, 1}, {1, 2, 3}};
static const int32_t box_tri[12][3] = {
    {0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

static void pick_cloth(struct bytes *b, struct scene *s, int k)
{
    drape_cloth *c = &s->cloth[k];
    drape_default_cloth(c);
    c->m = 2 + (int)pick(b, SIDE - 2);
    c->n = 2 + (int)pick(b, SIDE - 2);
    c->width = c->m * 0.02;
    c->height = c->n * 0.02;
    c->material.thickness = 0.002;
    c->material.bend = pick(b, 2) ? 1e-4 : 0;
    c->material.friction = 0.25 * pick(b, 5);
    for (int i = 0; i < 3 && c->m % 3 == 0; i++)
        c->material.limit[i] = 0.05;
    for (int o = 0; o < DRAPE_TABLES && c->n % 3 == 0; o++)
        for (int i = 0; i < 3; i++) { /* soft first; far from warp and weft */
            c->material.table[o][i][0] = 0.005 * (i + 1);
            c->material.table[o][i][1] = 1.5 * (i + 1) * (i + 1) * (3 - o);
        }
    c->origin[1] = 0.12 + 0.05 * k;
    c->origin[0] = -0.5 * c->width;
    c->origin[2] = -0.5 * c->height;
    static double velocity[SIDE * SIDE][3];
    for (int p = 0; p < c->m * c->n; p++)
        for (int i = 0; i < 3; i++)
            velocity[p][i] = (double)pick_uniform(b, -3, 3);
    if (pick(b, 2))
        c->velocity = (const double(*)[3])velocity;
    if (k == 0 && !pick(b, 3)) {
        for (int p = 0; p < SIDE * SIDE; p++)
            s->hole[p] = !pick(b, 12), s->cut[p] = !pick(b, 12);
        c->hole = s->hole;
        c->cut = s->cut;
    }
    if (k == 0 && !pick(b, 3)) {
        c->n_pins = 1 + (int)pick(b, PINS);
        c->pins = s->pin;
        for (int p = 0; p < c->n_pins; p++)
            s->pin[p] =
                (drape_pin){(int)pick(b, (uint32_t)c->m),
                            (int)pick(b, (uint32_t)c->n), (int)pick(b, 2) - 1};
    }
}

static void pick_obstacles(struct bytes *b, struct scene *s)
{
    for (int k = 0; k < 4; k++) {
        s->ground_x[k][0] = k & 1 ? 2 : -2;
        s->ground_x[k][2] = k & 2 ? 2 : -2;
    }
    double side = 0.02 + 0.02 * pick(b, 4);
    for (int k = 0; k < 8; k++) {
        s->box_x[k][0] = (k & 1 ? 0.5 : -0.5) * side;
        s->box_x[k][1] = 0.005 + (k & 4 ? side : 0);
        s->box_x[k][2] = (k & 2 ? 0.5 : -0.5) * side;
    }
    for (int k = 0; k < 2; k++)
        drape_default_obstacle(&s->obstacle[k]);
    s->obstacle[0].n_vertices = 4;
    s->obstacle[0].n_triangles = 2;
    s->obstacle[0].x = (const double(*)[3])s->ground_x;
    s->obstacle[0].tri = ground_tri;
    s->obstacle[1].n_vertices = 8;
    s->obstacle[1].n_triangles = 12;
    s->obstacle[1].x = (const double(*)[3])s->box_x;
    s->obstacle[1].tri = box_tri;
    s->obstacle[1].motion = pick(b, 2) ? 0 : -1;
}

static void pick_scene(struct bytes *b, struct scene *s)
{
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    s->time[1] = 0.1;
    for (int i = 0; i < 3; i++)
        s->position[1][i] = 0.03 * ((int)pick(b, 5) - 2);
    s->rotation[0][0] = s->rotation[1][pick(b, 4)] = 1;
    s->motion = (drape_motion){KEYS,
                               s->time,
                               (const double(*)[3])s->position,
                               (const double(*)[4])s->rotation,
                               {0, 0, 0}};
    s->def.motions = &s->motion;
    s->def.n_motions = 1;
    s->def.cloths = s->cloth;
    s->def.n_cloths = 1 + (int)pick(b, 2);
    for (int k = 0; k < s->def.n_cloths; k++)
        pick_cloth(b, s, k);
    pick_obstacles(b, s);
    s->def.obstacles = s->obstacle;
    s->def.n_obstacles = (int)pick(b, 3);
    s->def.precision = REAL_BITS;
    s->def.threads = 1 + (int)pick(b, 2);
    s->def.integrator = (int)pick(b, DRAPE_CK + 1);
    s->def.precond = (int)pick(b, 2);
    s->def.matrix = (int)pick(b, 2);
    s->def.max_rounds = (int)pick(b, 9);
    s->def.max_slices = 1 << pick(b, 5);
    s->def.wind.density = pick(b, 2) ? 1.2 : 0;
    s->def.wind.velocity[0] = 4;
    s->def.gravity[1] = pick(b, 4) ? -9.81 : -200;
    for (int k = 0; k < s->def.n_cloths && s->def.integrator >= DRAPE_BW; k++)
        if (pick(b, 3) == 2)
            random_panel(b, &s->cloth[k], &s->panel[k]);
}

int64_t scene_audit(const drape_world *world, int n_cloths)
{
    int64_t nv = drape_vertices(world), nt = drape_triangles(world);
    double(*x)[3] = malloc((size_t)nv * sizeof *x);
    int32_t(*tri)[3] = malloc((size_t)nt * sizeof *tri);
    int32_t *group = malloc((size_t)nt * sizeof *group);
    int64_t found = -1;
    if (x && tri && group) {
        drape_read(world, x, NULL);
        drape_read_triangles(world, tri);
        for (int64_t k = 0; k < nt; k++)
            group[k] = k < drape_first_triangle(world, n_cloths);
        drape_mesh mesh = {.nv = nv,
                           .nt = nt,
                           .x = (const double(*)[3])x,
                           .tri = (const int32_t(*)[3])tri,
                           .group = group};
        if (drape_audit(&mesh, 0, NULL, &found, NULL) != DRAPE_OK)
            found = -1;
    }
    free(x);
    free(tri);
    free(group);
    return found;
}

uint64_t scene_hash(const drape_world *world)
{
    size_t nv = (size_t)drape_vertices(world);
    double *x = malloc(6 * nv * sizeof *x);
    if (!x)
        abort();
    drape_read(world, (double(*)[3])(void *)x,
               (double(*)[3])(void *)(x + 3 * nv));
    uint64_t hash = hash_bytes(HASH_START, x, 6 * nv * sizeof *x);
    free(x);
    return hash;
}

/* The counters and the outcome of a report agree with each other. step.md §7,
 * §10; response.md §5, §6 */
static const char *check_report(const drape_def *def,
                                const drape_step_report *r)
{
    const drape_work *w = &r->work;
    bool whole = !(r->outcome & DRAPE_DIVERGED);
    EXPECT(r->time == (double)r->step * def->dt);
    EXPECT((r->zone_vertices > 0) == !!(r->outcome & DRAPE_ZONES));
    EXPECT((r->rolled_back > 0) == !!(r->outcome & DRAPE_ROLLBACK));
    EXPECT(!(r->outcome & (DRAPE_ZONES | DRAPE_ROLLBACK)) || r->impacts > 0);
    EXPECT(!whole || (r->slices >= 1 && r->slices <= def->max_slices));
    EXPECT(w->tries >= r->slices && w->later <= r->candidates);
    EXPECT(r->contacts <= w->near && r->impacts <= r->candidates);
    EXPECT(r->kinetic >= 0 && r->elastic >= 0 && r->residual >= 0);
    return NULL;
}

/* Whether a later pin names the particle of pin k: of several pins of one
 * particle the last holds (drape.h). */
static bool replaced(const drape_cloth *c, int k)
{
    for (int l = k + 1; l < c->n_pins; l++)
        if (c->pins[l].i == c->pins[k].i && c->pins[l].j == c->pins[k].j)
            return true;
    return false;
}

/* Whether all fixed pins have kept their bits. */
static bool stays(const struct scene *s, const drape_world *world)
{
    const drape_cloth *c = &s->cloth[0];
    static double x[2 * SIDE * SIDE + 12][3];
    drape_read(world, x, NULL);
    for (int k = 0; k < c->n_pins; k++) {
        const drape_pin *pin = &s->pin[k];
        int p = pin->i + c->m * pin->j;
        real start[3];
        if (pin->motion >= 0 || replaced(c, k))
            continue;
        for (int i = 0; i < 3; i++)
            start[i] =
                (real)(c->origin[i] + c->width / (c->m - 1) * pin->i * c->u[i] +
                       c->height / (c->n - 1) * pin->j * c->v[i]);
        for (int i = 0; i < 3; i++)
            if (fabs(x[p][i] - (double)start[i]) > 0x1p-24)
                return false;
    }
    return true;
}

const char *scene_random(struct bytes *b)
{
    static struct scene s;
    drape_world *world;
    drape_error error;
    pick_scene(b, &s);
    if (s.def.integrator < DRAPE_BW)
        s.def.dt = 1.0 / 240; /* a quarter of the substeps, for speed */
    int status = drape_create(&s.def, &world, &error);
    if (status != DRAPE_OK) { /* a refusal has a message */
        EXPECT(error.text[0] && !world);
        return NULL;
    }
    const char *failed = NULL;
    for (int k = 0; k < 6 && !failed; k++) {
        drape_step_report report;
        status = drape_step(world, &report);
        if (status != DRAPE_OK)
            failed = "a step failed";
        else if ((failed = check_report(&s.def, &report)) != NULL)
            break;
        else if (!stays(&s, world))
            failed = "01: a pin that holds has moved";
        else if (report.outcome & DRAPE_TRAPPED)
            break;
        else if (scene_audit(world, s.def.n_cloths) != 0)
            failed = "a step that says it is clean intersects";
    }
    drape_destroy(world);
    return failed;
}

const char *scene_twins(struct bytes *b, int64_t *steps)
{
    static struct scene s;
    pick_scene(b, &s);
    if (s.def.integrator < DRAPE_BW)
        s.def.dt = 1e-3; /* few substeps: an emulated device is slow */
    if (s.def.max_slices > 2)
        s.def.max_slices = 2;
    struct twin twin;
    const char *failed = twin_run(&s.def, 4, &twin);
    *steps = twin.steps;
    return failed;
}

const char *scene_panels(struct bytes *b, int64_t *steps)
{
    static struct scene s;
    pick_scene(b, &s);
    s.def.integrator = DRAPE_BW + (int)pick(b, 3);
    s.def.max_slices = 1 + (int)pick(b, 2);
    int k = (int)pick(b, (uint32_t)s.def.n_cloths);
    random_panel(b, &s.cloth[k], &s.panel[k]);
    struct twin twin;
    const char *failed = twin_run(&s.def, 3, &twin);
    *steps = twin.steps;
    return failed;
}

/* Seam k sews the first row of a cloth to the last one of a cloth, from some
 * point on. */
static void pick_seam(struct bytes *b, struct scene *s, int k)
{
    drape_seam *to = &s->seam[k];
    uint32_t cloths = (uint32_t)s->def.n_cloths;
    int a = (int)pick(b, cloths), c = (int)pick(b, cloths);
    int m = s->cloth[a].m, other = s->cloth[c].m;
    int32_t last = s->cloth[c].m * (s->cloth[c].n - 1);
    *to = (drape_seam){{a, c},         1 + (int)pick(b, (uint32_t)m),
                       s->particle[k], (const int32_t(*)[2])s->onto[k],
                       s->part[k],     pick(b, 2) ? 0.02 : 0};
    for (int i = 0; i < to->n; i++) {
        int at = i < other - 1 ? i : other - 2;
        s->particle[k][i] = i;
        s->onto[k][i][0] = last + at;
        s->onto[k][i][1] = last + at + (int)pick(b, 2);
        s->part[k][i] =
            pick(b, 3) ? (double)pick_uniform(b, 0, 1) : 0.5 * pick(b, 3);
    }
}

const char *scene_seams(struct bytes *b, int64_t *steps)
{
    static struct scene s;
    pick_scene(b, &s);
    s.def.integrator = DRAPE_BW + (int)pick(b, 3);
    s.def.max_slices = 1 + (int)pick(b, 2);
    s.def.seams = s.seam;
    s.def.n_seams = 1 + (int)pick(b, 2);
    s.def.self_collision = pick(b, 4) > 0;
    for (int k = 0; k < s.def.n_seams; k++)
        pick_seam(b, &s, k);
    struct twin twin;
    const char *failed = twin_run(&s.def, 3, &twin);
    *steps = twin.steps;
    return failed;
}
