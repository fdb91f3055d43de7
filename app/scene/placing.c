/* SPDX-License-Identifier: Apache-2.0 */
/* Places panels: where the pattern has them, rolled if they are sewn to
 * themselves, and parted where they touch in one plane; and finds where three
 * of them meet. app/patterns/README.md §10, §11 */
#include "app/base/app.h"
#include "app/base/vec3.h"
#include "app/scene/garment.h"

#include <math.h>
#include <stdlib.h>

static const double way = 0.01; /* m, that each of two panels is moved */
/* Panels are in one plane if their normals are within this angle, rad, and
 * their planes within half a cell, and nearer than panels that were parted. */
static const double parallel = 0.02;
static double depth_of(double h)
{
    return fmin(h / 2, way);
}
/* Panels are near below two cells, where contact might press in the first step,
 * and below what parted panels are apart. */
static double reach_of(double h)
{
    return fmin(2 * h, 1.5 * way);
}

/* What of a tube is open at the start, as a part. */
static const double left_open = 0.1;
/* Edges make a panel a tube if their angle is less than 90 degrees: the cosine
 * of half of that. */
static const double opposite = 0.7;
/* Two panels face each other if what draws them together is within 45 degrees
 * of the normals of both, on their wrong sides: the cosine. It is half way from
 * what is drawn across a limb to what is drawn along the panels. */
static const double facing = 0.7;
/* A panel may have been moved towards a third. */
enum { ROUNDS = 8 };

/* Turns two coordinates by an angle in degrees. */
static void turn(double *a, double *b, double degrees)
{
    double angle = degrees * acos(-1) / 180;
    double x = *a, y = *b;
    *a = cos(angle) * x - sin(angle) * y;
    *b = sin(angle) * x + cos(angle) * y;
}

/* Where the pattern places a point, of which x[2] is above the panel, m. */
static void place(const struct pattern_panel *panel, const double x[3],
                  double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = x[i];
    turn(&out[1], &out[2], panel->turn[0]);
    turn(&out[2], &out[0], panel->turn[1]);
    turn(&out[0], &out[1], panel->turn[2]);
    for (int i = 0; i < 3; i++)
        out[i] += panel->at[i];
}

void garment_stand(const struct garment_panel *panel, const double x[2],
                   double out[3])
{
    const struct garment_roll *roll = &panel->roll;
    double y[3] = {x[0], x[1], 0};
    if (roll->radius > 0) {
        const double *u = roll->along;
        double to[2] = {x[0] - roll->at[0], x[1] - roll->at[1]};
        double far = to[1] * u[0] - to[0] * u[1];
        double angle = far / roll->radius;
        double by = roll->radius * sin(angle) - far;
        double down = roll->radius * (1 - cos(angle));
        y[0] -= by * u[1];
        y[1] += by * u[0];
        y[2] = garment_is_clockwise(panel->panel) ? down : -down;
    }
    place(panel->panel, y, out);
    for (int i = 0; i < 3; i++)
        out[i] += panel->shift[i];
}

/* The line between two edges of a panel along which it is rolled. false: they
 * are not opposite each other. */
static bool find_axis(const struct garment_panel *p, int a, int b,
                      struct garment_roll *roll)
{
    const struct curve *one = &p->curve[a];
    const struct curve *two = &p->curve[b];
    double l = plane_length(one->b[0] - one->a[0], one->b[1] - one->a[1]);
    double m = plane_length(two->b[0] - two->a[0], two->b[1] - two->a[1]);
    if (!(l > 0 && m > 0))
        return false;
    for (int i = 0; i < 2; i++) {
        /* the loop runs along one and back along the other */
        roll->along[i] =
            (one->b[i] - one->a[i]) / l - (two->b[i] - two->a[i]) / m;
        roll->at[i] = (one->a[i] + one->b[i] + two->a[i] + two->b[i]) / 4;
    }
    double length = plane_length(roll->along[0], roll->along[1]);
    roll->along[0] /= length;
    roll->along[1] /= length;
    return length > 2 * opposite;
}

void garment_roll_up(struct garment *garment)
{
    const struct pattern *pattern = garment->pattern;
    for (int k = 0; k < pattern->stitches; k++) {
        const struct pattern_stitch *stitch = &pattern->stitch[k];
        struct garment_panel *p = &garment->panel[stitch->side[0].panel];
        const struct outline *o = &p->outline;
        struct garment_roll roll = {0};
        int a = garment_find_edge(p, stitch->side[0].edge);
        int b = garment_find_edge(p, stitch->side[1].edge);
        if (stitch->side[0].panel != stitch->side[1].panel || a < 0 || b < 0 ||
            stitch->turned || garment_is_dart(pattern, stitch) ||
            !find_axis(p, a, b, &roll))
            continue;
        double half = 0;
        for (int i = 0; i < o->n; i++) {
            double to[2] = {o->x[i][0] - roll.at[0], o->x[i][1] - roll.at[1]};
            half =
                fmax(half, fabs(to[1] * roll.along[0] - to[0] * roll.along[1]));
        }
        roll.radius = half / (acos(-1) * (1 - left_open));
        p->roll = roll;
    }
}

double garment_gap(const struct garment *garment,
                   const struct pattern_stitch *stitch,
                   const struct cut_seam *seam)
{
    double most = 0;
    const struct garment_panel *p =
        &garment->panel[stitch->side[seam->fine].panel];
    const struct garment_panel *q =
        &garment->panel[stitch->side[!seam->fine].panel];
    for (int k = 0; k < seam->n; k++) {
        const struct cut_point *point = &seam->point[k];
        double x[3], a[3], b[3], sum = 0;
        garment_stand(p, p->cut.x[point->particle], x);
        garment_stand(q, q->cut.x[point->onto[0]], a);
        garment_stand(q, q->cut.x[point->onto[1]], b);
        for (int i = 0; i < 3; i++) {
            double gap = x[i] - a[i] - point->part * (b[i] - a[i]);
            sum += gap * gap;
        }
        most = fmax(most, sqrt(sum));
    }
    return most;
}

/* A corner of a panel: the one where this place of its outline begins. */
struct corner {
    int panel, place;
};
/* The corners that a stitch brings together, at its start and at its end. */
struct ends {
    bool there;
    struct corner corner[2][2]; /* by end and side */
};

static struct ends find_ends(const struct garment *g,
                             const struct pattern_stitch *stitch)
{
    struct ends ends = {.there = true};
    for (int s = 0; s < 2; s++) {
        int k = stitch->side[s].panel;
        const struct garment_panel *p = &g->panel[k];
        int place = garment_find_edge(p, stitch->side[s].edge);
        bool back = s == 1 && garment_runs_back(g, stitch);
        ends.there &= place >= 0;
        ends.corner[back][s] = (struct corner){k, place};
        ends.corner[!back][s] = (struct corner){k, (place + 1) % p->edges};
    }
    return ends;
}

/* The angle of a panel at a corner, inside. */
static double corner_angle(const struct garment *g, struct corner at)
{
    const struct outline *o = &g->panel[at.panel].outline;
    int32_t c = o->first[at.place], before = c ? c - 1 : o->n - 1;
    double a[2], b[2];
    for (int i = 0; i < 2; i++) {
        a[i] = o->x[c][i] - o->x[before][i];
        b[i] = o->x[c + 1][i] - o->x[c][i];
    }
    double left = atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    return acos(-1) - left;
}

static bool are_one(struct corner a, struct corner b)
{
    return a.panel == b.panel && a.place == b.place;
}

/* Whether a stitch brings two corners together. */
static bool brings(const struct ends *ends, struct corner a, struct corner b)
{
    for (int e = 0; e < 2 && ends->there; e++) {
        const struct corner *c = ends->corner[e];
        if ((are_one(c[0], a) && are_one(c[1], b)) ||
            (are_one(c[0], b) && are_one(c[1], a)))
            return true;
    }
    return false;
}

/* Whether stitch k goes across the end of another one at its own end e: there
 * it brings its corner of side s, the widest of three, to the second one, and
 * the stitch of the second and the third ends. */
static bool goes_across(const struct garment *g, const struct ends *all, int k,
                        int e, int s)
{
    struct corner wide = all[k].corner[e][s], other = all[k].corner[e][!s];
    double angle = corner_angle(g, wide);
    if (!(corner_angle(g, other) < angle))
        return false;
    for (int b = 0; b < g->pattern->stitches; b++)
        for (int end = 0; end < 4 && all[b].there; end++) {
            const struct corner *c = all[b].corner[end / 2];
            struct corner third = c[end % 2];
            if (!are_one(c[!(end % 2)], wide) || are_one(third, other) ||
                !(corner_angle(g, third) < angle))
                continue;
            for (int a = 0; a < g->pattern->stitches; a++)
                if (!garment_is_dart(g->pattern, &g->pattern->stitch[a]) &&
                    brings(&all[a], other, third))
                    return true;
        }
    return false;
}

int garment_across(const struct garment *garment, bool *across)
{
    int n = garment->pattern->stitches;
    struct ends *all = calloc((size_t)n + 1, sizeof *all);
    if (!all)
        return no_memory();
    for (int k = 0; k < n; k++)
        all[k] = find_ends(garment, &garment->pattern->stitch[k]);
    for (int k = 0; k < n; k++) {
        across[k] = false;
        for (int end = 0; end < 4 && all[k].there; end++)
            across[k] |= goes_across(garment, all, k, end / 2, end % 2);
    }
    free(all);
    return APP_OK;
}

/* A panel in space. */
struct sheet {
    const struct garment_panel *panel;
    double u[3], v[3], n[3]; /* the directions of its plane, and its normal */
    double middle[3];        /* of its outline */
};

static void make_sheet(const struct garment_panel *p, struct sheet *sheet)
{
    const struct outline *o = &p->outline;
    double at[3], u[3], v[3], x[3];
    garment_stand(p, (double[]){0, 0}, at);
    garment_stand(p, (double[]){1, 0}, u);
    garment_stand(p, (double[]){0, 1}, v);
    *sheet = (struct sheet){.panel = p};
    for (int i = 0; i < 3; i++) {
        sheet->u[i] = u[i] - at[i];
        sheet->v[i] = v[i] - at[i];
    }
    for (int i = 0; i < 3; i++)
        sheet->n[i] = sheet->u[(i + 1) % 3] * sheet->v[(i + 2) % 3] -
                      sheet->u[(i + 2) % 3] * sheet->v[(i + 1) % 3];
    for (int k = 0; k < o->n; k++) {
        garment_stand(p, o->x[k], x);
        for (int i = 0; i < 3; i++)
            sheet->middle[i] += x[i] / o->n;
    }
}

bool garment_is_around(const struct garment *garment,
                       const struct pattern_stitch *stitch,
                       const struct cut_seam *seam)
{
    const struct garment_panel *p =
        &garment->panel[stitch->side[seam->fine].panel];
    const struct garment_panel *q =
        &garment->panel[stitch->side[!seam->fine].panel];
    struct sheet a, b;
    double way[3] = {0};
    if (p == q)
        return p->roll.radius > 0 && !garment_is_dart(garment->pattern, stitch);
    for (int k = 0; k < seam->n; k++) {
        double x[3], y[3];
        garment_stand(p, p->cut.x[seam->point[k].particle], x);
        garment_stand(q, q->cut.x[seam->point[k].onto[0]], y);
        for (int i = 0; i < 3; i++)
            way[i] += x[i] - y[i];
    }
    make_sheet(p, &a);
    make_sheet(q, &b);
    double from = vec3_dot(way, a.n), to = -vec3_dot(way, b.n);
    from = garment_is_clockwise(p->panel) ? -from : from;
    to = garment_is_clockwise(q->panel) ? -to : to;
    return fmin(from, to) > facing * vec3_length(way);
}

/* Where two outlines are near each other, in the plane of the first. */
struct meeting {
    bool over; /* some of the second's is well within the first */
    int count;
    double sum[2], square[3]; /* of the places: x, y; xx, xy, yy */
};

static void add(struct meeting *m, const double x[2])
{
    m->count++;
    m->sum[0] += x[0];
    m->sum[1] += x[1];
    m->square[0] += x[0] * x[0];
    m->square[1] += x[0] * x[1];
    m->square[2] += x[1] * x[1];
}

/* Adds a point of another outline, if it is within `reach` of this one, or says
 * that it is further inside. */
static void meet_point(const struct outline *o, const double y[2], double reach,
                       struct meeting *m)
{
    double near[2], least = INFINITY;
    bool inside = false;
    for (int i = 0; i < 2; i++)
        if (y[i] < o->lo[i] - reach || y[i] > o->hi[i] + reach)
            return;
    for (int j = 0; j < o->n && !(least < reach); j++) {
        least = segment_distance(y, o->x[j], o->x[j + 1], near);
        inside ^= segment_meets_ray(y, o->x[j], o->x[j + 1]);
    }
    if (least < reach)
        add(m, y);
    else if (inside)
        m->over = true;
}

/* Where the second's outline meets the first panel. */
static void meet(const struct sheet *a, const struct sheet *b, double reach,
                 struct meeting *m)
{
    const struct outline *q = &b->panel->outline;
    double at[3];
    garment_stand(a->panel, (double[]){0, 0}, at);
    for (int k = 0; k < q->n; k++) {
        double x[3];
        garment_stand(b->panel, q->x[k], x);
        for (int i = 0; i < 3; i++)
            x[i] -= at[i];
        meet_point(&a->panel->outline,
                   (double[]){vec3_dot(x, a->u), vec3_dot(x, a->v)}, reach, m);
    }
}

/* The direction across the line along which two panels meet, from a to b; where
 * they meet in a point, from middle to middle. */
static void find_way(const struct sheet *a, const struct sheet *b,
                     const struct meeting *m, double h, double out[3])
{
    double n = m->count, x = m->sum[0] / n, y = m->sum[1] / n;
    double xx = m->square[0] / n - x * x, yy = m->square[2] / n - y * y;
    double xy = m->square[1] / n - x * y;
    double middle[3], across[2];
    for (int i = 0; i < 3; i++)
        middle[i] = b->middle[i] - a->middle[i];
    double to[2] = {vec3_dot(middle, a->u), vec3_dot(middle, a->v)};
    double angle = atan2(2 * xy, xx - yy) / 2;
    bool line = xx + yy > reach_of(h) * reach_of(h);
    across[0] = line ? -sin(angle) : to[0];
    across[1] = line ? cos(angle) : to[1];
    double length = plane_length(across[0], across[1]);
    double sign = across[0] * to[0] + across[1] * to[1] < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++)
        out[i] =
            length > 0
                ? sign * (across[0] * a->u[i] + across[1] * a->v[i]) / length
                : a->u[i];
}

/* How two panels of one plane are to each other. */
enum nearness { FAR, TOUCH, OVERLAP };

/* out: the way from the first to the second: across the line along which they
 * touch; where one lies over the other, along their normal, the smaller one
 * away from the middle of all, as a pocket or a sleeve. */
static enum nearness find_nearness(const struct sheet *a, const struct sheet *b,
                                   double h, const double middle[3],
                                   double out[3])
{
    double apart[3];
    double reach = reach_of(h);
    struct meeting m = {0}, back = {0};
    for (int i = 0; i < 3; i++)
        apart[i] = b->middle[i] - a->middle[i];
    if (a->panel->roll.radius > 0 || b->panel->roll.radius > 0)
        return FAR;
    if (fabs(vec3_dot(a->n, b->n)) < cos(parallel) ||
        fabs(vec3_dot(apart, a->n)) > depth_of(h))
        return FAR;
    meet(a, b, reach, &m);
    meet(b, a, reach, &back);
    if (m.over || back.over) {
        double from[3] = {a->middle[0] - middle[0], a->middle[1] - middle[1],
                          a->middle[2] - middle[2]};
        bool outwards = vec3_dot(from, a->n) > 0;
        bool smaller = b->panel->outline.area < a->panel->outline.area;
        for (int i = 0; i < 3; i++)
            out[i] = outwards == smaller ? a->n[i] : -a->n[i];
        return OVERLAP;
    }
    if (!m.count)
        return FAR;
    find_way(a, b, &m, h, out);
    return TOUCH;
}

/* Parts two panels, if they are near each other in one plane. */
static bool part(const struct garment *garment, struct garment_panel *p,
                 struct garment_panel *q, const double middle[3])
{
    struct sheet a, b;
    double to[3];
    make_sheet(p, &a);
    make_sheet(q, &b);
    enum nearness near = find_nearness(&a, &b, garment->h, middle, to);
    if (near == FAR)
        return false;
    complain(APP_OK,
             "%s: note: panels %s and %s %s in one plane, and are parted by "
             "%g cm each",
             garment->pattern->file, p->panel->name, q->panel->name,
             near == TOUCH ? "touch" : "overlap", 1e2 * way);
    for (int k = 0; k < 3; k++) {
        p->shift[k] -= way * to[k];
        q->shift[k] += way * to[k];
    }
    return true;
}

void garment_part(struct garment *garment)
{
    int panels = garment->pattern->panels;
    double middle[3] = {0, 0, 0};
    bool moved = true;
    for (int k = 0; k < panels; k++) {
        struct sheet sheet;
        make_sheet(&garment->panel[k], &sheet);
        for (int i = 0; i < 3; i++)
            middle[i] += sheet.middle[i] / panels;
    }
    for (int round = 0; round < ROUNDS && moved; round++) {
        moved = false;
        for (int i = 0; i < panels; i++)
            for (int j = i + 1; j < panels; j++)
                moved |= part(garment, &garment->panel[i], &garment->panel[j],
                              middle);
    }
}
