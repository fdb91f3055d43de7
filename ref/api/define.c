/* SPDX-License-Identifier: Apache-2.0 */
/* Checks a definition once and completely; no later code checks it again.
 * spec/drape.h */
#include "ref/api/define.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "ref/base/cells.h"
#include "ref/cloth/table.h"

static const double BIG = 1152921504606846976.0; /* 2^60 */

/* The state of a check: the place in the definition, and the first fault. */
struct check {
    drape_error *error;
    char where[64]; /* "cloth 2: ", or empty */
    int status;
};

static int fail_check(struct check *c, int status, const char *format, ...)
{
    if (c->status != DRAPE_OK)
        return c->status;
    c->status = status;
    if (c->error) {
        va_list args;
        int n = snprintf(c->error->text, sizeof c->error->text, "%s", c->where);
        va_start(args, format);
        vsnprintf(c->error->text + n, sizeof c->error->text - (size_t)n, format,
                  args);
        va_end(args);
    }
    return status;
}

static void write_place(struct check *c, const char *what, int k)
{
    snprintf(c->where, sizeof c->where, "%s %d: ", what, k);
}

/* Returns the status for a wrong number, as in spec/drape.h: NaN or a number
 * beyond 2^60 is bad data (DRAPE_EDATA), any other number out of its range is a
 * bad argument (DRAPE_EARG). */
static int fault_of(double a)
{
    return fabs(a) <= BIG ? DRAPE_EARG : DRAPE_EDATA;
}

/* Checks that a is in [lo, hi]; NaN is not. */
static void check_number(struct check *c, const char *name, double a, double lo,
                         double hi)
{
    if (!(a >= lo && a <= hi))
        fail_check(c, fault_of(a), "%s is %g, expected %g to %g", name, a, lo,
                   hi);
}

static void check_positive(struct check *c, const char *name, double a)
{
    if (!(a > 0 && a <= BIG))
        fail_check(c, fault_of(a), "%s is %g, expected above 0", name, a);
}

static void check_integer(struct check *c, const char *name, int64_t a,
                          int64_t lo, int64_t hi)
{
    if (a < lo || a > hi)
        fail_check(c, DRAPE_EARG, "%s is %lld, expected %lld to %lld", name,
                   (long long)a, (long long)lo, (long long)hi);
}

/* Checks that the array p of n items exists. False: this or an earlier check
 * failed. */
static bool check_array(struct check *c, const char *name, int64_t n,
                        const void *p)
{
    if (n > 0 && !p)
        fail_check(c, DRAPE_EARG, "%s is NULL, expected %lld", name,
                   (long long)n);
    return c->status == DRAPE_OK;
}

static void check_vectors(struct check *c, const char *name, int64_t n,
                          const double (*x)[3])
{
    for (int64_t i = 0; check_array(c, name, n, x) && i < n; i++)
        for (int k = 0; k < 3; k++)
            if (!(x[i][k] >= -BIG && x[i][k] <= BIG)) {
                fail_check(c, DRAPE_EDATA,
                           "%s %lld has coordinate %g, expected |x| up to 2^60",
                           name, (long long)i, x[i][k]);
                break;
            }
}

static void check_table(struct check *c, int o,
                        const double table[DRAPE_POINTS][2])
{
    int k = table_fault(table);
    if (k < 0)
        return;
    double strain = table[k][0], force = table[k][1];
    double least = (k ? table[k - 1][0] : 0) + TABLE_STEP;
    if (!(strain >= least && strain <= TABLE_STRAIN))
        fail_check(c, fault_of(strain),
                   "material.stretch.%s[%d]: strain %g, expected %g to %d",
                   table_name(o), k, strain, least, TABLE_STRAIN);
    else
        fail_check(c, fault_of(force),
                   "material.stretch.%s[%d]: %g N/m, expected %s %g",
                   table_name(o), k, force, k ? "at least" : "above",
                   k ? table[k - 1][1] : 0);
}

static void check_material(struct check *c, const drape_material *m)
{
    check_positive(c, "density", m->density);
    check_positive(c, "stretch", m->stretch);
    check_number(c, "shear", m->shear, 0, m->stretch / 2);
    check_number(c, "bend", m->bend, 0, BIG);
    check_number(c, "damping", m->damping, 0, 1e6);
    check_positive(c, "thickness", m->thickness);
    check_number(c, "friction", m->friction, 0, 1e6);
    for (int k = 0; k < 3; k++)
        if (m->limit[k] != 0)
            check_number(c, "a limit that is not 0", m->limit[k], 0.01, 10);
    for (int o = 0; o < DRAPE_TABLES; o++)
        check_table(c, o, m->table[o]);
}

/* Checks the axes of a flat start: unit length and orthogonal, within 1e-6. */
static void check_axes(struct check *c, const drape_cloth *cloth)
{
    double uu = 0, vv = 0, uv = 0;
    check_vectors(c, "origin", 1, &cloth->origin);
    check_vectors(c, "u", 1, &cloth->u);
    check_vectors(c, "v", 1, &cloth->v);
    for (int k = 0; k < 3; k++) {
        uu += cloth->u[k] * cloth->u[k];
        vv += cloth->v[k] * cloth->v[k];
        uv += cloth->u[k] * cloth->v[k];
    }
    if (!(fabs(uu - 1) <= 1e-6 && fabs(vv - 1) <= 1e-6 && fabs(uv) <= 1e-6))
        fail_check(c, DRAPE_EARG, "u and v must be unit and at right angles");
}

/* The area of a triangle of a panel at rest. */
static double rest_area(const double (*rest)[2], const int64_t tri[3])
{
    const double *p = rest[tri[0]], *q = rest[tri[1]], *r = rest[tri[2]];
    return 0.5 *
           ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]));
}

/* Checks a cell of a panel: its kind, its corners and its triangles. */
static void check_cell(struct check *c, const drape_cloth *cloth, int i, int j)
{
    int kind = cell_kind(cloth, i, j), m = cloth->m;
    const double(*rest)[2] = cloth->panel->rest;
    double side[2] = {cloth->width / (m - 1), cloth->height / (cloth->n - 1)};
    int64_t at[4], tri[2][3];
    if (kind > DRAPE_CELL_WITHOUT + 3)
        fail_check(c, DRAPE_EARG, "panel: cell (%d, %d) is %d, expected 0 to 7",
                   i, j, kind);
    if (c->status != DRAPE_OK)
        return;
    int corners = cell_corners(kind, i + (int64_t)m * j, m, at);
    for (int k = 0; k < corners; k++)
        for (int a = 0; a < 2; a++) {
            int on = (int)(a ? at[k] / m : at[k] % m);
            double off = fabs(rest[at[k]][a] / side[a] - on);
            if (!(off < (kind == DRAPE_CELL_REGULAR ? 1e-6 : 1)))
                fail_check(c, DRAPE_EARG,
                           "panel: a corner of cell (%d, %d) is %g cells off, "
                           "expected less than %g",
                           i, j, off, kind == DRAPE_CELL_REGULAR ? 1e-6 : 1.0);
        }
    int count = cell_triangles(kind, i + (int64_t)m * j, m, tri);
    for (int t = 0; t < count; t++) {
        double part = rest_area(rest, tri[t]) / (side[0] * side[1]);
        if (!(part >= 0.05))
            fail_check(c, DRAPE_EARG,
                       "panel: a triangle of cell (%d, %d) has %g of a cell's "
                       "area, expected at least 0.05",
                       i, j, part);
    }
}

/* Whether a cell that is not regular is convex. */
static bool is_convex(const drape_cloth *cloth, int kind, int64_t p)
{
    int64_t tri[2][3] = {{0}};
    bool convex = true;
    if (kind < DRAPE_CELL_WITHOUT)
        for (int other = DRAPE_CELL_RISING; other <= DRAPE_CELL_FALLING;
             other++) {
            int count = cell_triangles(other, p, cloth->m, tri);
            for (int t = 0; t < count; t++)
                convex &= rest_area(cloth->panel->rest, tri[t]) > 0;
        }
    return convex;
}

/* How many cells have two particles next to each other: odd and convex ones;
 * -1: one is not convex. */
static int count_eased(const drape_cloth *cloth, const int32_t end[2])
{
    int m = cloth->m, found = 0;
    for (int k = 0; k < 4; k++) {
        int i = end[0] % m - k % 2, j = end[0] / m - k / 2;
        int kind = cell_kind(cloth, i, j);
        int64_t at[4];
        int corners = cell_corners(kind, i + (int64_t)m * j, m, at);
        for (int c = 0; c < corners && cell_is_odd(kind); c++) {
            int64_t next = at[(c + 1) % corners];
            if ((at[c] != end[0] || next != end[1]) &&
                (at[c] != end[1] || next != end[0]))
                continue;
            if (!is_convex(cloth, kind, i + (int64_t)m * j))
                return -1;
            found++;
        }
    }
    return found;
}

static void check_eases(struct check *c, const drape_cloth *cloth)
{
    const drape_panel *panel = cloth->panel;
    int64_t n = (int64_t)cloth->m * cloth->n;
    check_integer(c, "panel.n_eases", panel->n_eases, 0, 1000000);
    if (!check_array(c, "panel.eases", panel->n_eases, panel->eases))
        return;
    for (int k = 0; k < panel->n_eases && c->status == DRAPE_OK; k++) {
        const drape_ease *e = &panel->eases[k];
        char name[32];
        snprintf(name, sizeof name, "panel.eases %d end", k);
        check_integer(c, name, e->end[0], 0, n - 1);
        check_integer(c, name, e->end[1], 0, n - 1);
        snprintf(name, sizeof name, "panel.eases %d ratio", k);
        check_number(c, name, e->ratio, 0.5, 1);
        if (c->status != DRAPE_OK)
            return;
        int cells = count_eased(cloth, e->end);
        if (cells <= 0)
            fail_check(c, DRAPE_EARG,
                       "panel.eases %d: particles %d and %d are %s", k,
                       (int)e->end[0], (int)e->end[1],
                       cells ? "an edge of a cell that is not convex"
                             : "no edge of a cell that is not regular");
    }
}

/* What a panel does not go with. */
static const char *panel_misfit(const drape_def *def, const drape_cloth *cloth)
{
    if (cloth->hole || cloth->cut)
        return "a panel has no holes and cuts";
    if (cloth->bending != DRAPE_TRIPLES)
        return "a panel needs bending by triples";
    if (def->integrator < DRAPE_BW)
        return "a panel needs an implicit integrator";
    return NULL;
}

static void check_panel(struct check *c, const drape_def *def,
                        const drape_cloth *cloth)
{
    const drape_panel *panel = cloth->panel;
    const char *why = panel_misfit(def, cloth);
    int64_t n = (int64_t)cloth->m * cloth->n;
    if (why)
        fail_check(c, DRAPE_EARG, "%s", why);
    if (!check_array(c, "panel.rest", n, panel->rest) ||
        !check_array(c, "panel.cell", n, panel->cell))
        return;
    for (int64_t p = 0; p < n && c->status == DRAPE_OK; p++)
        for (int k = 0; k < 2; k++)
            if (!(fabs(panel->rest[p][k]) <= BIG))
                fail_check(c, DRAPE_EDATA, "panel.rest %lld has coordinate %g",
                           (long long)p, panel->rest[p][k]);
    for (int j = 0; j < cloth->n - 1; j++)
        for (int i = 0; i < cloth->m - 1 && c->status == DRAPE_OK; i++)
            check_cell(c, cloth, i, j);
    if (c->status == DRAPE_OK)
        check_eases(c, cloth);
}

static void check_cloth(struct check *c, const drape_def *def,
                        const drape_cloth *cloth)
{
    int n_motions = def->n_motions;
    int64_t n = (int64_t)cloth->m * cloth->n;
    check_positive(c, "width", cloth->width);
    check_positive(c, "height", cloth->height);
    check_material(c, &cloth->material);
    check_integer(c, "bending", cloth->bending, DRAPE_TRIPLES, DRAPE_SPRINGS);
    check_integer(c, "n_pins", cloth->n_pins, 0, n);
    if (!check_array(c, "pins", cloth->n_pins, cloth->pins))
        return;
    if (cloth->x)
        check_vectors(c, "particle", n, cloth->x);
    else
        check_axes(c, cloth);
    if (cloth->panel)
        check_panel(c, def, cloth);
    if (cloth->velocity)
        check_vectors(c, "velocity", n, cloth->velocity);
    for (int k = 0; k < cloth->n_pins && c->status == DRAPE_OK; k++) {
        const drape_pin *p = &cloth->pins[k];
        char name[32];
        snprintf(name, sizeof name, "pin %d i", k);
        check_integer(c, name, p->i, 0, cloth->m - 1);
        snprintf(name, sizeof name, "pin %d j", k);
        check_integer(c, name, p->j, 0, cloth->n - 1);
        snprintf(name, sizeof name, "pin %d motion", k);
        check_integer(c, name, p->motion, -1, n_motions - 1);
    }
}

/* Checks n times, each later than the one before; NULL: there are none. */
static void check_ascent(struct check *c, const char *name, int n,
                         const double *time)
{
    for (int k = 0; time && k < n && c->status == DRAPE_OK; k++) {
        check_number(c, name, time[k], k ? time[k - 1] : -BIG, BIG);
        if (k && !(time[k] > time[k - 1]))
            fail_check(c, DRAPE_EARG, "%s %d does not ascend", name, k);
    }
}

static void check_motion(struct check *c, const drape_motion *m)
{
    check_integer(c, "keys", m->keys, 1, 1 << 24);
    if (!check_array(c, "time", m->keys, m->time))
        return;
    check_vectors(c, "position", m->keys, m->position);
    check_vectors(c, "pivot", 1, &m->pivot);
    check_ascent(c, "time", m->keys, m->time);
    for (int k = 0; k < m->keys && c->status == DRAPE_OK; k++) {
        double qq = 0;
        for (int i = 0; m->rotation && i < 4; i++) {
            check_number(c, "rotation", m->rotation[k][i], -BIG, BIG);
            qq += m->rotation[k][i] * m->rotation[k][i];
        }
        if (m->rotation && !(fabs(qq - 1) <= 1e-6))
            fail_check(c, DRAPE_EARG, "rotation %d is not a unit quaternion",
                       k);
    }
}

/* Checks the times and the places of a mesh that deforms. */
static void check_frames(struct check *c, const drape_obstacle *o)
{
    if (!o->frame_time)
        check_positive(c, "frame_dt", o->frame_dt);
    check_ascent(c, "frame_time", o->frames, o->frame_time);
    if (!check_array(c, "frame", o->frames, o->frame))
        return;
    for (int k = 0; k < o->frames && c->status == DRAPE_OK; k++) {
        char name[32];
        snprintf(name, sizeof name, "frame %d vertex", k);
        check_vectors(c, name, o->n_vertices, o->frame + k * o->n_vertices);
    }
}

static void check_obstacle(struct check *c, const drape_obstacle *o,
                           int n_motions)
{
    check_number(c, "friction", o->friction, 0, 1e6);
    check_integer(c, "motion", o->motion, -1, n_motions - 1);
    check_integer(c, "frames", o->frames, 0, 1 << 24);
    if (!check_array(c, "tri", o->n_triangles, o->tri))
        return;
    check_vectors(c, "vertex", o->n_vertices, o->x);
    for (int64_t k = 0; k < o->n_triangles && c->status == DRAPE_OK; k++)
        for (int i = 0; i < 3; i++)
            if (o->tri[k][i] < 0 || o->tri[k][i] >= o->n_vertices)
                fail_check(
                    c, DRAPE_EARG, "triangle %lld names vertex %d of %lld",
                    (long long)k, (int)o->tri[k][i], (long long)o->n_vertices);
    if (o->frames) {
        if (o->motion >= 0)
            fail_check(c, DRAPE_EARG, "has both a motion and frames");
        check_integer(c, "between", o->between, DRAPE_LINEAR, DRAPE_CUBIC);
        check_frames(c, o);
    }
}

/* Checks a point of a seam between two cloths of these numbers of particles. */
static void check_point(struct check *c, const drape_seam *s, int64_t k,
                        const int64_t count[2])
{
    int32_t p = s->particle[k], a = s->onto[k][0], b = s->onto[k][1];
    double part = s->part[k];
    if (p < 0 || p >= count[0])
        fail_check(c, DRAPE_EARG,
                   "point %lld has particle %d, expected 0 to %lld",
                   (long long)k, (int)p, (long long)count[0] - 1);
    for (int j = 0; j < 2; j++)
        if (s->onto[k][j] < 0 || s->onto[k][j] >= count[1])
            fail_check(c, DRAPE_EARG,
                       "point %lld is onto particle %d, expected 0 to %lld",
                       (long long)k, (int)s->onto[k][j],
                       (long long)count[1] - 1);
    if (!(part >= 0 && part <= 1))
        fail_check(c, fault_of(part), "point %lld has part %g, expected 0 to 1",
                   (long long)k, part);
    if (s->cloth[0] == s->cloth[1] && (p == a || p == b))
        fail_check(c, DRAPE_EARG, "point %lld holds particle %d to itself",
                   (long long)k, (int)p);
}

static void check_seam(struct check *c, const drape_def *def,
                       const drape_seam *s)
{
    int64_t count[2];
    for (int j = 0; j < 2; j++) {
        check_integer(c, j ? "cloth[1]" : "cloth[0]", s->cloth[j], 0,
                      def->n_cloths - 1);
        if (c->status != DRAPE_OK)
            return;
        const drape_cloth *cloth = &def->cloths[s->cloth[j]];
        count[j] = (int64_t)cloth->m * cloth->n;
    }
    check_integer(c, "n", s->n, 1, count[0]);
    if (!check_array(c, "particle", s->n, s->particle) ||
        !check_array(c, "onto", s->n, s->onto) ||
        !check_array(c, "part", s->n, s->part))
        return;
    check_number(c, "strength", s->strength, 0, 1e9);
    for (int64_t k = 0; k < s->n && c->status == DRAPE_OK; k++)
        check_point(c, s, k, count);
}

static void check_wind(struct check *c, const drape_wind *wind)
{
    check_vectors(c, "wind velocity", 1, &wind->velocity);
    check_number(c, "wind density", wind->density, 0, BIG);
    check_number(c, "wind drag", wind->drag, 0, 1e6);
    check_number(c, "wind lift", wind->lift, 0, 1e6);
}

int define_check_wind(const drape_wind *wind)
{
    struct check c = {.error = NULL, .status = DRAPE_OK};
    check_wind(&c, wind);
    return c.status;
}

int define_check_material(const drape_material *material)
{
    struct check c = {.error = NULL, .status = DRAPE_OK};
    check_material(&c, material);
    return c.status;
}

int define_check_vectors(int64_t n, const double (*x)[3])
{
    struct check c = {.error = NULL, .status = DRAPE_OK};
    check_vectors(&c, "vector", n, x);
    return c.status;
}

int define_check_motion(const drape_motion *motion)
{
    struct check c = {.error = NULL, .status = DRAPE_OK};
    check_motion(&c, motion);
    return c.status;
}

bool define_check_allocator(const drape_allocator *allocator)
{
    return !allocator->allocate == !allocator->release;
}

static void check_world(struct check *c, const drape_def *def)
{
    check_integer(c, "backend", def->backend, DRAPE_REF, DRAPE_GPU);
    if (def->precision != 32 && def->precision != 64)
        fail_check(c, DRAPE_EARG, "precision is %d, expected 32 or 64",
                   def->precision);
    check_integer(c, "threads", def->threads, 0, 4096);
    check_integer(c, "block", def->block, 0, 256);
    if (def->block % 32)
        fail_check(c, DRAPE_EARG, "block is %d, expected a multiple of 32",
                   def->block);
    if (!define_check_allocator(&def->allocator) ||
        !define_check_allocator(&def->device_allocator))
        fail_check(c, DRAPE_EARG,
                   "an allocator needs both its functions, or none");
    check_number(c, "dt", def->dt, 1e-9, 1e3);
    check_vectors(c, "gravity", 1, &def->gravity);
    check_wind(c, &def->wind);
    check_integer(c, "integrator", def->integrator, DRAPE_EULER, DRAPE_BDF2);
    check_integer(c, "max_substeps", def->max_substeps, 1, INT32_MAX);
    check_integer(c, "precond", def->precond, DRAPE_JACOBI, DRAPE_MULTIGRID);
    check_integer(c, "matrix", def->matrix, DRAPE_CDF, DRAPE_COMPACT);
    check_integer(c, "solver", def->solver, DRAPE_EXACT, DRAPE_CUBLAS);
    check_integer(c, "response", def->response, DRAPE_SOLVE, DRAPE_IMPULSES);
    if (def->solver == DRAPE_CUBLAS && def->backend != DRAPE_GPU)
        fail_check(c, DRAPE_EARG, "solver cublas needs backend gpu");
    check_number(c, "tolerance", def->tolerance, 1e-15, 1);
    check_integer(c, "max_iterations", def->max_iterations, 1, INT32_MAX);
    check_integer(c, "newton", def->newton, 0, 64);
    check_integer(c, "max_rounds", def->max_rounds, 0, 10000);
    check_integer(c, "max_slices", def->max_slices, 1, 64);
    if (def->max_slices > 0 && def->max_slices & (def->max_slices - 1))
        fail_check(c, DRAPE_EARG, "max_slices is %d, expected a power of two",
                   def->max_slices);
    check_integer(c, "n_cloths", def->n_cloths, 1, 4096);
    check_integer(c, "n_obstacles", def->n_obstacles, 0, 4096);
    check_integer(c, "n_motions", def->n_motions, 0, 1 << 20);
    check_array(c, "cloths", def->n_cloths, def->cloths);
    check_array(c, "obstacles", def->n_obstacles, def->obstacles);
    check_array(c, "motions", def->n_motions, def->motions);
    check_integer(c, "n_seams", def->n_seams, 0, 1 << 20);
    check_array(c, "seams", def->n_seams, def->seams);
    if (def->n_seams > 0 && def->integrator < DRAPE_BW)
        fail_check(c, DRAPE_EARG, "seams need an implicit integrator");
    if (def->n_seams > 0 && def->response != DRAPE_SOLVE)
        fail_check(c, DRAPE_EARG,
                   "seams need contacts that are solved with the cloths, not "
                   "response impulses");
}

/* Checks all sizes, before any array is read, so that none of their products
 * can overflow. */
static void check_sizes(struct check *c, const drape_def *def)
{
    const int64_t most = INT32_MAX / 8;
    int64_t vertices = 0, triangles = 0, points = 0;
    for (int k = 0; k < def->n_cloths && c->status == DRAPE_OK; k++) {
        const drape_cloth *cloth = &def->cloths[k];
        write_place(c, "cloth", k);
        check_integer(c, "m", cloth->m, 2, 32768);
        check_integer(c, "n", cloth->n, 2, 32768);
        if (c->status != DRAPE_OK)
            return;
        vertices += (int64_t)cloth->m * cloth->n;
        triangles += 2 * (int64_t)(cloth->m - 1) * (cloth->n - 1);
    }
    for (int k = 0; k < def->n_obstacles && c->status == DRAPE_OK; k++) {
        const drape_obstacle *o = &def->obstacles[k];
        write_place(c, "obstacle", k);
        check_integer(c, "n_vertices", o->n_vertices, 1, most);
        check_integer(c, "n_triangles", o->n_triangles, 1, most);
        if (c->status != DRAPE_OK)
            return;
        vertices += o->n_vertices;
        triangles += o->n_triangles;
    }
    for (int k = 0; k < def->n_seams && c->status == DRAPE_OK; k++) {
        write_place(c, "seam", k);
        check_integer(c, "n", def->seams[k].n, 1, most);
        points += c->status == DRAPE_OK ? def->seams[k].n : 0;
    }
    if (c->status != DRAPE_OK)
        return;
    c->where[0] = 0;
    check_integer(c, "the scene's number of seam points", points, 0, most);
    check_integer(c, "the scene's number of vertices", vertices, 0, most);
    check_integer(c, "the scene's number of triangles", triangles, 0, most);
}

int define_check(const drape_def *def, drape_error *error)
{
    struct check c = {.error = error, .status = DRAPE_OK};
    check_world(&c, def);
    if (c.status == DRAPE_OK)
        check_sizes(&c, def);
    for (int k = 0; k < def->n_motions && c.status == DRAPE_OK; k++) {
        write_place(&c, "motion", k);
        check_motion(&c, &def->motions[k]);
    }
    for (int k = 0; k < def->n_cloths && c.status == DRAPE_OK; k++) {
        write_place(&c, "cloth", k);
        check_cloth(&c, def, &def->cloths[k]);
    }
    for (int k = 0; k < def->n_obstacles && c.status == DRAPE_OK; k++) {
        write_place(&c, "obstacle", k);
        check_obstacle(&c, &def->obstacles[k], def->n_motions);
    }
    for (int k = 0; k < def->n_seams && c.status == DRAPE_OK; k++) {
        write_place(&c, "seam", k);
        check_seam(&c, def, &def->seams[k]);
    }
    return c.status;
}
