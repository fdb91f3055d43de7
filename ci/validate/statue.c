/* SPDX-License-Identifier: Apache-2.0 */
/* A small sheet that slides down the flank of a statue. spec/validation.md §9
 */
#include "ci/validate/path.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ROW, POINTS: every second particle of a row and a column. */
enum { SIDE = 11, N = SIDE * SIDE, ROW = (SIDE + 1) / 2, POINTS = ROW * ROW };
enum { FEW = 3 }; /* points that may come to no end */
/* m: of a sheet's side, and of a statue's largest extent. FINE, s: steps of
 * points beside an integrator of second order, which has none of their error.
 */
static const double SIZE = 0.04, STATUE = 4, FINE = 1.0 / 960;

/* A ground to slide on. */
struct flank {
    const char *name, *file; /* file NULL: made in code */
    int frictions;           /* how many of the part's, from the first */
    double facet, rough;     /* m, of the boulder */
    struct ground ground, coarse;
};
/* A sheet that slides from a place. */
struct ride {
    const struct ground *ground;
    const double *start;
    double friction, dt;
    int integrator;
};
/* What came of it. */
enum { WAY, FACETS, ASIDE, LAW, LOST, CREEP, RESULTS };
/* A sheet on its way, and the point beside it. */
struct slide {
    struct sheet sheet;
    drape_obstacle obstacle;
    drape_world *world;
    struct point point;
    double gap, start[3];    /* start: of the sheet's middle */
    double (*x)[3], (*u)[3]; /* all vertices of the world */
    double work, due;       /* of friction, by contacts, and by Coulomb's law */
    double energy[2][2];    /* J/kg, kinetic and elastic, of sheet and point,
                               after the first step and now */
    double potential[2][2]; /* J/kg, of gravity, likewise */
    double rested[3];       /* the sheet's middle after 0.1 s */
};

/* Lays the sheet on the ground with its middle where the point is: on the
 * smooth surface, and then each particle on the triangle below. */
static void lay(const struct ground *g, struct slide *t)
{
    double n[3], down[3], across[3], h = SIZE / (SIDE - 1);
    const double *at = t->point.x;
    ground_height(g, at, n);
    for (int c = 0; c < 3; c++)
        down[c] = (n[1] * n[c] - (c == 1)) / sqrt(1 - n[1] * n[1]);
    cross3(n, down, across);
    for (int p = 0; p < N; p++) {
        double i = h * (p % SIDE - SIDE / 2), j = h * (p / SIDE - SIDE / 2);
        double *x = t->sheet.x[p], up[3];
        for (int c = 0; c < 3; c++)
            x[c] = at[c] + i * down[c] + j * across[c];
        ground_put(g, x, t->gap);
        ground_height(g, x, up);
        double lift = ground_lift(&t->obstacle, x, up, t->gap);
        for (int c = 0; c < 3 && !isnan(lift); c++)
            x[c] += lift * up[c];
    }
}

/* Reads the state. The sheet's middle is the mean of its particles, moved along
 * the normal to the height of the point, as the mean of a curved sheet is too
 * low. Returns the speed of the slowest particle; NAN: the middle is not near
 * the ground. */
static double look(const struct ground *g, struct slide *t, double middle[3])
{
    double slowest = INFINITY;
    drape_read(t->world, t->x, t->u);
    memset(middle, 0, 3 * sizeof *middle);
    for (int p = 0; p < N; p++) {
        for (int c = 0; c < 3; c++)
            middle[c] += t->x[p][c] / N;
        slowest = fmin(slowest, sqrt(dot3(t->u[p], t->u[p])));
    }
    return ground_put(g, middle, t->gap) ? slowest : NAN;
}

/* Adds friction's work in a step, and what it should be: the coefficient times
 * normal impulse times slip, of each contact. Both take the velocities at the
 * step's end, so that their quotient is a mean of friction over its limit. */
static void add_work(struct slide *t, double friction)
{
    drape_contact_list list;
    if (drape_contacts(t->world, &list) != DRAPE_OK)
        return;
    for (int64_t k = 0; k < list.n; k++) {
        const drape_contact *a = &list.contact[k];
        double slip[3] = {0};
        for (int i = 0; i < 4; i++)
            for (int c = 0; c < 3; c++)
                slip[c] += a->weight[i] * t->u[a->vertex[i]][c];
        double along = dot3(slip, a->normal);
        for (int c = 0; c < 3; c++)
            slip[c] -= along * a->normal[c];
        t->work -= dot3(a->impulse, slip);
        t->due +=
            friction * dot3(a->impulse, a->normal) * sqrt(dot3(slip, slip));
    }
}

/* The sheet that a ride begins with, not yet in its place. */
static void begin(const struct validate *v, const struct ride *r,
                  struct slide *t)
{
    double h = SIZE / (SIDE - 1);
    struct sheet *s = &t->sheet;
    memset(t, 0, sizeof *t);
    sheet_make(v, s, SIDE, SIDE, h);
    t->gap = s->cloth.material.thickness = h / 4;
    s->cloth.material.bend = 1e-6;
    ground_near(r->ground, r->start, 0.35, &t->obstacle);
    memcpy(t->point.x, r->start, sizeof t->point.x);
    ground_put(r->ground, t->point.x, t->gap);
    s->def.obstacles = &t->obstacle;
    s->def.n_obstacles = 1;
    s->def.max_slices = 32;
    s->def.tolerance = 1e-5;
    s->def.integrator = r->integrator;
}

/* Makes a world of the sheet as it stands, and looks at it. False: there is
 * none, or the sheet is not near the ground. */
static bool make_world(const struct ride *r, struct slide *t)
{
    t->obstacle.friction = t->sheet.cloth.material.friction = r->friction;
    t->world = sheet_world(&t->sheet, r->dt);
    if (!t->world)
        return false;
    size_t all = (size_t)drape_vertices(t->world);
    t->x = take(all, sizeof *t->x);
    t->u = take(all, sizeof *t->u);
    return !isnan(look(r->ground, t, t->start));
}

static void end(struct slide *t)
{
    drape_destroy(t->world);
    free((void *)t->obstacle.x);
    free((void *)t->obstacle.tri);
    free(t->x);
    free(t->u);
    sheet_free(&t->sheet);
}

/* A step of the point: one of Baraff–Witkin's as long as the sheet's, or short
 * ones. */
static bool advance_point(const struct ride *r, struct slide *t)
{
    const struct floor smooth = floor_smooth(r->ground);
    int steps = r->integrator == DRAPE_BW ? 1 : (int)(r->dt / FINE + 0.5);
    bool good = true;
    for (int k = 0; k < steps && good; k++)
        good =
            point_step(&smooth, &t->point, r->friction, r->dt / steps, t->gap);
    return good;
}

/* Step k of sheet and point; false: one of them fails, or leaves the ground. */
static bool advance(const struct ride *r, struct slide *t, int k,
                    double middle[3])
{
    drape_step_report report;
    if (drape_step(t->world, &report) != DRAPE_OK || !advance_point(r, t))
        return false;
    double slowest = look(r->ground, t, middle);
    double mass = t->sheet.cloth.material.density * SIZE * SIZE;
    /* The list has the contacts of the last slice alone, and friction is at its
     * limit only where things slide. */
    if (report.slices == 1 && slowest > 0.05)
        add_work(t, r->friction);
    t->potential[0][k > 0] = report.potential / mass;
    t->energy[0][k > 0] = (report.kinetic + report.elastic) / mass;
    t->potential[1][k > 0] = PATH_GRAVITY * t->point.x[1];
    t->energy[1][k > 0] = dot3(t->point.v, t->point.v) / 2;
    if ((k + 1) * r->dt < 0.1 + 1e-9)
        memcpy(t->rested, middle, sizeof t->rested);
    return !isnan(slowest);
}

/* The share of gravity's work since the first step that is neither in motion
 * nor in springs, of the sheet or of the point. */
static double lost(const struct slide *t, int which)
{
    double fall = t->potential[which][0] - t->potential[which][1];
    return 1 - (t->energy[which][1] - t->energy[which][0]) / fall;
}

/* Where the sheet's particles are after half a second with much friction, which
 * brings the sheet to rest: as it was laid, it touches the ground in few places
 * only. False: a step failed. */
static bool settle(const struct validate *v, const struct ride *slides,
                   double rest[N][3])
{
    struct slide t;
    struct ride r = *slides;
    r.friction = 2;
    r.dt = 1.0 / 60;
    r.integrator = DRAPE_BW;
    begin(v, &r, &t);
    lay(r.ground, &t);
    bool good = make_world(&r, &t);
    for (int k = 0; k < 30 && good; k++)
        good = drape_step(t.world, NULL) == DRAPE_OK;
    if (good) {
        drape_read(t.world, t.x, NULL);
        memcpy(rest, t.x, N * sizeof *rest);
    }
    end(&t);
    return good;
}

/* Where n points on facets are in the mean, at the height of the sheet's
 * middle.
 */
static void middle_of(const struct ground *g, double (*x)[3], int n, double gap,
                      double middle[3])
{
    memset(middle, 0, 3 * sizeof *middle);
    for (int p = 0; p < n; p++)
        for (int c = 0; c < 3; c++)
            middle[c] += x[p][c] / n;
    ground_put(g, middle, gap);
}

/* The mean way of points that start where particles of the sheet rest, each by
 * itself, on the mesh's own triangles, by short steps. Points that come to no
 * end are left out; NAN: more than FEW do. */
static void slide_points(const struct validate *v, const struct ride *r,
                         double rest[N][3], double from[3], double to[3])
{
    static double x[2][POINTS][3];
    const int steps = (int)(PATH_SECONDS / FINE + 0.5);
    struct slide t;
    int n = 0;
    begin(v, r, &t);
    const struct floor facets = floor_facets(&t.obstacle);
    for (int p = 0; p < POINTS; p++) {
        const double *start = rest[2 * (p / ROW * SIDE + p % ROW)];
        struct point point = {.x = {start[0], start[1], start[2]}};
        int k = 0;
        while (k < steps &&
               point_step(&facets, &point, r->friction, FINE, t.gap))
            k++;
        if (k < steps)
            continue;
        memcpy(x[0][n], start, sizeof x[0][n]);
        memcpy(x[1][n++], point.x, sizeof x[1][n]);
    }
    middle_of(r->ground, x[0], n, t.gap, from);
    middle_of(r->ground, x[1], n, t.gap, to);
    to[0] = n >= POINTS - FEW ? to[0] : NAN;
    end(&t);
}

/* How much of the way due was gone, and how far aside, over that way. */
static double part_of(const double from[3], const double to[3],
                      const double went[3], double *aside)
{
    double due[3];
    for (int c = 0; c < 3; c++)
        due[c] = to[c] - from[c];
    *aside = apart3(due, went) / sqrt(dot3(due, due));
    return dot3(due, went) / dot3(due, due);
}

/* Slides the sheet and the point side by side, from rest; NAN: it failed.
 * `way`: of points on facets, from and to. */
static void slide(const struct validate *v, const struct ride *r,
                  double rest[N][3], double way[2][3], double out[RESULTS])
{
    struct slide t;
    double middle[3] = {0}, went[3], aside;
    int steps = (int)(PATH_SECONDS / r->dt + 0.5), k = 0;
    begin(v, r, &t);
    memcpy(t.sheet.x, rest, N * sizeof *rest);
    bool laid = make_world(r, &t);
    memcpy(t.point.x, t.start, sizeof t.start);
    while (laid && k < steps && advance(r, &t, k, middle))
        k++;
    for (int c = 0; c < 3; c++)
        went[c] = middle[c] - t.start[c];
    bool done = k == steps;
    out[FACETS] = done ? part_of(way[0], way[1], went, &aside) : NAN;
    out[WAY] = done ? part_of(t.start, t.point.x, went, &aside) : NAN;
    out[ASIDE] = done ? aside : NAN;
    out[LAW] = done ? t.work / t.due : NAN;
    out[LOST] = done ? lost(&t, 0) - lost(&t, 1) : NAN;
    out[CREEP] = done ? apart3(t.rested, middle) / (PATH_SECONDS - 0.1) : NAN;
    end(&t);
}

/* Keeps the result that is farther from what is due; NAN is farthest. */
static void keep_worst(double *kept, double one, double due)
{
    if (!isnan(*kept) && !(fabs(one - due) <= fabs(*kept - due)))
        *kept = one;
}

/* The values of all paths that are farthest from what is due, by steps, the
 * longest of which is number `first`. NAN where a slide fails, or there is no
 * path. Returns the number of paths. */
static int slide_all(const struct validate *v, const struct flank *f,
                     double friction, int integrator, int first,
                     double out[RESULTS][SIZES])
{
    static const double due[RESULTS] = {[WAY] = 1, [FACETS] = 1, [LAW] = 1};
    double start[PATHS][3], rest[N][3], way[2][3] = {{0}}, one[RESULTS];
    /* What rests does so where a sheet with friction 0.2 slides. */
    int n = find_paths(&f->ground, &f->coarse, friction > 1 ? 0.2 : friction,
                       start);
    for (int k = 0; k < RESULTS; k++)
        for (int c = 0; c < SIZES; c++)
            out[k][c] = n ? due[k] : NAN;
    for (int p = 0; p < n; p++) {
        struct ride r = {&f->ground, start[p], friction, 0, integrator};
        bool rests = settle(v, &r, rest);
        if (rests && integrator != DRAPE_BW)
            slide_points(v, &r, rest, way[0], way[1]);
        for (int c = first; c < SIZES; c++) {
            r.dt = 1.0 / (60 << c);
            if (rests)
                slide(v, &r, rest, way, one);
            for (int k = 0; k < RESULTS; k++)
                keep_worst(&out[k][c], rests ? one[k] : NAN, due[k]);
        }
    }
    return n;
}

/* A row of one kind of result, by steps from number `first` on. */
struct row {
    int which, integrator, first, paths;
    bool promised;
};

static void add(struct validate *v, const struct flank *f, double friction,
                const struct row *row, double value[RESULTS][SIZES])
{
    static const char *what[RESULTS] = {
        "way over a point's",
        "way over that of points on its facets",
        "end's distance from the point's; over its way",
        "friction's work over its coefficient times load and slip",
        "energy lost over gravity's work; less a point's",
        "speed after 0.1 s"};
    char name[160], paths[32];
    snprintf(paths, sizeof paths, "%d of %d paths; ", row->paths, PATHS);
    snprintf(name, sizeof name, "%s; friction %g; %s%s%s%s", f->name, friction,
             row->integrator == DRAPE_BDF2 ? "bdf2; " : "",
             row->paths < PATHS ? paths : "",
             row->first ? "steps of 4.2 and 2.1 ms; " : "", what[row->which]);
    struct property p = {.part = "statue",
                         .name = name,
                         .unit = row->which == CREEP ? "m/s" : "1",
                         .theory = row->which == WAY || row->which == FACETS ||
                                   row->which == LAW,
                         .bar = row->which == CREEP ? 1e-3 : 0.02,
                         .up_to = 1,
                         .promised = row->promised};
    for (int c = row->first; c < SIZES; c++)
        property_add(&p, 1.0 / (60 << c), value[row->which][c]);
    property_end(v, &p);
}

/* All rows of a flank with one friction by Baraff–Witkin. Friction's work is
 * promised everywhere. Of the smooth boulder its way is, with friction 0.2 by
 * short steps, which is all of the small form, and that it rests with 1.5. */
static void add_rows(struct validate *v, const struct flank *f, double friction)
{
    double value[RESULTS][SIZES];
    bool made = !f->file, promised = made && !f->rough && f->facet > 0.01;
    int n = slide_all(v, f, friction, DRAPE_BW, v->quick ? 2 : 0, value);
    struct row row = {WAY, DRAPE_BW, 2, n, true};
    if (promised && friction == 0.2)
        add(v, f, friction, &row, value);
    if (v->quick)
        return;
    row.first = 0;
    for (row.which = 0; row.which < CREEP && friction <= 1; row.which++) {
        row.promised = row.which == LAW;
        if (row.which != FACETS && (row.which != LAW || friction > 0))
            add(v, f, friction, &row, value);
    }
    row.which = CREEP;
    row.promised = promised;
    if (friction > 1)
        add(v, f, friction, &row, value);
}

/* The ways by BDF2, beside a point on the smooth surface, and where that is
 * rough beside points on the mesh, too. */
static void add_second(struct validate *v, const struct flank *f,
                       double friction)
{
    double value[RESULTS][SIZES];
    int n = slide_all(v, f, friction, DRAPE_BDF2, 0, value);
    bool rough = f->file || f->rough;
    struct row row = {WAY, DRAPE_BDF2, 0, n, !rough && f->facet > 0.01};
    add(v, f, friction, &row, value);
    row.which = FACETS;
    if (rough)
        add(v, f, friction, &row, value);
}

static bool make_flank(struct flank *f)
{
    if (!f->file)
        ground_boulder(&f->ground, f->facet, f->rough);
    else if (!ground_statue(&f->ground, f->file, STATUE))
        return false;
    f->coarse = f->ground;
    ground_smooth(&f->ground, SIZE);
    ground_smooth(&f->coarse, 1.5 * SIZE);
    return true;
}

static void free_flank(struct flank *f)
{
    free(f->coarse.piece);
    free(f->coarse.first);
    ground_free(&f->ground);
}

void part_statue(struct validate *v)
{
    static const double friction[] = {0.2, 0, 1.5, 0.05, 0.5, 1};
    struct flank flanks[] = {
        {.name = "boulder", .frictions = 6, .facet = 0.02},
        {.name = "boulder in facets of 8 mm", .frictions = 1, .facet = 0.008},
        {.name = "rough boulder",
         .frictions = 2,
         .facet = 0.02,
         .rough = 0.5e-3},
        {.name = "lion", .frictions = 3, .file = "lion_20k"},
        {.name = "dragon", .frictions = 3, .file = "dragon_100k"}};
    bool few = v->quick || v->bits == 32;
    if (v->quick && v->bits == 32)
        return;
    for (int f = 0; f < (few ? 1 : 5); f++) {
        if (!make_flank(&flanks[f])) {
            printf("skipped: %s.ply: the folders of meshes have no such mesh\n",
                   flanks[f].file);
            continue;
        }
        for (int k = 0; k < (few ? 1 : flanks[f].frictions); k++) {
            add_rows(v, &flanks[f], friction[k]);
            if (!few && k < 2)
                add_second(v, &flanks[f], friction[k]);
        }
        free_flank(&flanks[f]);
    }
}
