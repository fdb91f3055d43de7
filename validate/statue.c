/* SPDX-License-Identifier: Apache-2.0 */
/* Small sheets that slide down the flanks of statues. spec/validation.md §9 */
#include "validate/ride.h"

#include <math.h>
#include <stdlib.h>

static const double STATUE = 4; /* m, of a statue's largest extent */

/* A ground to slide on. */
struct flank {
    const char *name, *file; /* file NULL: made in code */
    int frictions;           /* how many of the part's, from the first */
    double facet, rough;     /* m, of the boulder */
    struct ground ground, coarse;
};
/* By what the sheet moves; the name stands in the rows. */
struct method {
    const char *name;
    int integrator, newton;
};
static const struct method linear = {"", DRAPE_BW, 0},
                           solved = {"newton 4; ", DRAPE_BW, 4},
                           second = {"bdf2; ", DRAPE_BDF2, 0};

/* Whether a result needs points on the facets. */
static bool is_of_points(int which)
{
    return which == RIDE_FACETS || which == RIDE_GROUND;
}

/* What a result is due. */
static double due_of(int which)
{
    return which != RIDE_ASIDE && which != RIDE_LOST && which != RIDE_CREEP;
}

/* NAN: none. */
static double bar_of(int which)
{
    bool small = which == RIDE_CREEP || which == RIDE_CONE;
    return which == RIDE_GROUND ? NAN : small ? 1e-3 : 0.02;
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
                     double friction, const struct method *method, int first,
                     double out[RIDE_RESULTS][SIZES])
{
    double start[PATHS][3], rest[RIDE_N][3], way[2][3] = {{0}},
                                             one[RIDE_RESULTS];
    /* What rests does so where a sheet with friction 0.2 slides. */
    int n = find_paths(&f->ground, &f->coarse, friction > 1 ? 0.2 : friction,
                       start);
    for (int k = 0; k < RIDE_RESULTS; k++)
        for (int c = 0; c < SIZES; c++)
            out[k][c] = n ? due_of(k) : NAN;
    for (int p = 0; p < n; p++) {
        struct ride r = {&f->ground, start[p],           friction,
                         0,          method->integrator, method->newton};
        bool rests = ride_settle(v, &r, rest);
        if (rests && method != &linear)
            ride_points(v, &r, rest, way[0], way[1]);
        for (int c = first; c < SIZES; c++) {
            r.dt = 1.0 / (60 << c);
            if (rests)
                ride_slide(v, &r, rest, way, one);
            for (int k = 0; k < RIDE_RESULTS; k++)
                keep_worst(&out[k][c], rests ? one[k] : NAN, due_of(k));
        }
    }
    return n;
}

/* A row of one kind of result, by steps from number `first` on. */
struct row {
    int which;
    const struct method *method;
    int first, paths;
    bool promised;
};

static void add(struct validate *v, const struct flank *f, double friction,
                const struct row *row, double value[RIDE_RESULTS][SIZES])
{
    static const char *what[RIDE_RESULTS] = {
        "way over a point's",
        "way over that of points on its facets",
        "way of points on its facets over a point's",
        "end's distance from the point's; over its way",
        "friction's work over its coefficient times load and slip",
        "largest quotient of a contact in a step; over its coefficient",
        "energy lost over gravity's work; less a point's",
        "speed after 0.1 s"};
    char name[160], paths[32];
    snprintf(paths, sizeof paths, "%d of %d paths; ", row->paths, PATHS);
    snprintf(name, sizeof name, "%s; friction %g; %s%s%s%s", f->name, friction,
             row->method->name, row->paths < PATHS ? paths : "",
             row->first ? "steps of 4.2 and 2.1 ms; " : "", what[row->which]);
    struct property p = {.part = "statue",
                         .name = name,
                         .unit = row->which == RIDE_CREEP ? "m/s" : "1",
                         .theory = due_of(row->which),
                         .bar = bar_of(row->which),
                         .up_to = 1,
                         .promised = row->promised};
    for (int c = row->first; c < SIZES; c++)
        property_add(&p, 1.0 / (60 << c), value[row->which][c]);
    property_end(v, &p);
}

/* All rows of a flank with one friction by Baraff–Witkin. Friction's work is
 * promised everywhere. Of the smooth
 * boulder its way is, with friction 0.2 by short steps, which is all of the
 * small form, and that it rests with 1.5. */
static void add_rows(struct validate *v, const struct flank *f, double friction)
{
    double value[RIDE_RESULTS][SIZES];
    bool made = !f->file, promised = made && !f->rough && f->facet > 0.01;
    int n = slide_all(v, f, friction, &linear, v->quick ? 2 : 0, value);
    struct row row = {RIDE_WAY, &linear, 2, n, true};
    if (promised && friction == 0.2)
        add(v, f, friction, &row, value);
    if (v->quick)
        return;
    row.first = 0;
    for (row.which = 0; row.which < RIDE_CREEP && friction <= 1; row.which++) {
        bool own = row.which == RIDE_LAW || row.which == RIDE_CONE;
        row.promised = row.which == RIDE_LAW;
        if (!is_of_points(row.which) && (!own || friction > 0))
            add(v, f, friction, &row, value);
    }
    row.which = RIDE_CREEP;
    row.promised = promised;
    if (friction > 1)
        add(v, f, friction, &row, value);
}

/* The ways by BDF2, beside a point on the smooth surface, and where that is
 * rough beside points on the mesh, too; and the cones. */
static void add_second(struct validate *v, const struct flank *f,
                       double friction)
{
    double value[RIDE_RESULTS][SIZES];
    int n = slide_all(v, f, friction, &second, 0, value);
    bool rough = f->file || f->rough;
    struct row row = {RIDE_WAY, &second, 0, n, !rough && f->facet > 0.01};
    add(v, f, friction, &row, value);
    for (row.which = RIDE_FACETS; row.which <= RIDE_GROUND && rough;
         row.which++)
        add(v, f, friction, &row, value);
    row.which = RIDE_CONE;
    row.promised = false; /* limits.md: its load is of an earlier evaluation */
    if (friction > 0)
        add(v, f, friction, &row, value);
}

/* The way by backward Euler itself, whose loss its linear form has, too. */
static void add_solved(struct validate *v, const struct flank *f,
                       double friction)
{
    double value[RIDE_RESULTS][SIZES];
    int n = slide_all(v, f, friction, &solved, 0, value);
    struct row row = {RIDE_WAY, &solved, 0, n, false};
    add(v, f, friction, &row, value);
}

static bool make_flank(struct flank *f)
{
    if (!f->file)
        ground_boulder(&f->ground, f->facet, f->rough);
    else if (!ground_statue(&f->ground, f->file, STATUE))
        return false;
    f->coarse = f->ground;
    ground_smooth(&f->ground, RIDE_SIZE);
    ground_smooth(&f->coarse, 1.5 * RIDE_SIZE);
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
            printf("skipped: the statue %s.ply: it is in no folder of meshes "
                   "(drape fetch-models DIR fetches it; set DRAPE_DATA=DIR)\n",
                   flanks[f].file);
            continue;
        }
        for (int k = 0; k < (few ? 1 : flanks[f].frictions); k++) {
            add_rows(v, &flanks[f], friction[k]);
            if (!few && k < 2)
                add_second(v, &flanks[f], friction[k]);
            if (!few && k == 0 && flanks[f].file)
                add_solved(v, &flanks[f], friction[k]);
        }
        free_flank(&flanks[f]);
    }
}
