/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a panel: which particles are there, and which are moved onto the
 * outline. app/patterns/README.md §4. */
#include "app/base/cut.h"

#include <math.h>

/* An offset below this part of a cell is rounding: the particle stays. */
static const double still = 1e-9;

static double grid(const struct cut *cut, int axis, int64_t k)
{
    return cut->at[axis] + cut->h * (double)k;
}

/* The particle of a line that is nearest to k cells along it; of two that are
 * as near, but for rounding, the first. */
static double nearest(double k)
{
    return ceil(k - 0.5 - still);
}

static void lay(struct cut *cut)
{
    for (int64_t p = 0; p < (int64_t)cut->m * cut->n; p++) {
        cut->x[p][0] = grid(cut, 0, p % cut->m);
        cut->x[p][1] = grid(cut, 1, p / cut->m);
        cut->chord[p] = -1;
    }
}

/* How far the particle is moved; a border particle along one axis. */
static double moved_by(const struct cut *cut, int64_t p)
{
    return fabs(cut->x[p][0] - grid(cut, 0, p % cut->m)) +
           fabs(cut->x[p][1] - grid(cut, 1, p / cut->m));
}

/* A crossing of chord c with line `line` of the grid, which runs along the
 * axis: at x[axis], which is x. */
struct crossing {
    const struct outline *outline;
    int axis;
    int64_t line;
    double x;
    int32_t c;
};

/* The particle of the line that is number k there. */
static int64_t particle(const struct cut *cut, const struct crossing *at,
                        double k)
{
    return at->axis ? at->line + cut->m * (int64_t)k
                    : (int64_t)k + cut->m * at->line;
}

static void move(struct cut *cut, const struct crossing *at, int64_t p)
{
    double place = grid(cut, at->axis, at->axis ? p / cut->m : p % cut->m);
    cut->chord[p] = at->c;
    cut->x[p][0] = grid(cut, 0, p % cut->m);
    cut->x[p][1] = grid(cut, 1, p / cut->m);
    if (fabs(at->x - place) > still * cut->h)
        cut->x[p][at->axis] = at->x;
}

/* The nearest particle of the line is moved to the crossing, unless it already
 * is on a part of the outline that is nearer. Along x, the crossing is also
 * counted for the particles on its right. */
static void snap(struct cut *cut, const struct crossing *at)
{
    double k = (at->x - cut->at[at->axis]) / cut->h;
    int last = (at->axis ? cut->n : cut->m) - 1;
    double near = nearest(k), right = floor(k) + 1;
    if (at->axis == 0 && right <= last)
        cut->kind[(int64_t)fmax(right, 0) + cut->m * at->line] ^= CUT_IN;
    if (near < 0 || near > last)
        return;
    int64_t p = particle(cut, at, near);
    if (cut->chord[p] < 0 || fabs(k - near) * cut->h < moved_by(cut, p))
        move(cut, at, p);
}

/* The nearest particle of an edge's beginning. */
static int64_t find_corner(const struct cut *cut, const struct outline *outline,
                           int edge)
{
    const double *x = outline->x[outline->first[edge]];
    double i = nearest((x[0] - cut->at[0]) / cut->h);
    double j = nearest((x[1] - cut->at[1]) / cut->h);
    i = fmin(fmax(i, 0), cut->m - 1);
    j = fmin(fmax(j, 0), cut->n - 1);
    return (int64_t)i + cut->m * (int64_t)j;
}

/* Whether two edges meet in a corner that takes particle p. */
static bool meet_at(const struct cut *cut, const struct outline *outline, int e,
                    int f, int64_t p)
{
    return ((e + 1) % outline->edges == f &&
            find_corner(cut, outline, f) == p) ||
           ((f + 1) % outline->edges == e && find_corner(cut, outline, e) == p);
}

/* In a gap narrower than a cell, both sides may want one particle. The further
 * side takes the next particle, inside the panel, so that the gap is cut. The
 * particle of the gap's own tip is of both sides: were they parted there, their
 * cells would overlap. */
static void part(struct cut *cut, const struct crossing *at)
{
    const struct outline *o = at->outline;
    const double *a = o->x[at->c], *b = o->x[at->c + 1];
    double k = (at->x - cut->at[at->axis]) / cut->h, near = nearest(k);
    /* inside is on the left of the chord */
    double side = (at->axis ? b[0] > a[0] : b[1] < a[1]) ? 1 : -1;
    double next = near + side;
    int last = (at->axis ? cut->n : cut->m) - 1;
    if (near < 0 || near > last || next < 0 || next > last)
        return;
    int64_t p = particle(cut, at, near), q = particle(cut, at, next);
    int32_t w = cut->chord[p];
    if (w < 0 || w == at->c)
        return;
    const double *d = o->x[w], *e = o->x[w + 1];
    double x[2];
    x[at->axis] = at->x;
    x[1 - at->axis] = grid(cut, 1 - at->axis, at->line);
    bool facing =
        (b[0] - a[0]) * (e[0] - d[0]) + (b[1] - a[1]) * (e[1] - d[1]) < 0;
    if (!facing || !outline_is_right(o, w, x) ||
        !outline_is_right(o, at->c, cut->x[p]) ||
        meet_at(cut, o, o->of[at->c], o->of[w], p))
        return;
    if (cut->chord[q] < 0 || fabs(k - next) * cut->h < moved_by(cut, q))
        move(cut, at, q);
}

/* All crossings of chord c with the lines that run along the axis. A line
 * meets the chord's lower end and not its upper one, so that each crossing of
 * the outline is one of one chord. */
static void cross_lines(struct cut *cut, const struct outline *outline,
                        int32_t c, int axis,
                        void (*take)(struct cut *, const struct crossing *))
{
    const double *a = outline->x[c], *b = outline->x[c + 1];
    int o = 1 - axis, lines = axis ? cut->m : cut->n;
    double lo = fmin(a[o], b[o]), hi = fmax(a[o], b[o]);
    double from = ceil((lo - cut->at[o]) / cut->h) - 1;
    for (int64_t k = from > 0 ? (int64_t)from : 0; k < lines; k++) {
        double y = grid(cut, o, k);
        if (y >= hi)
            break;
        if (y < lo)
            continue;
        double t = (y - a[o]) / (b[o] - a[o]);
        struct crossing at = {outline, axis, k,
                              a[axis] + t * (b[axis] - a[axis]), c};
        take(cut, &at);
    }
}

/* Each edge's beginning takes its nearest particle. */
static void take_corners(struct cut *cut, const struct outline *outline)
{
    for (int k = 0; k < outline->edges; k++) {
        int32_t c = outline->first[k];
        const double *x = outline->x[c];
        int64_t p = find_corner(cut, outline, k);
        cut->corner[k] = (int32_t)p;
        if (cut->kind[p] == CUT_CORNER)
            continue; /* an edge before begins there */
        cut->kind[p] = CUT_CORNER;
        cut->chord[p] = c;
        for (int axis = 0; axis < 2; axis++) {
            double y = grid(cut, axis, axis ? p / cut->m : p % cut->m);
            cut->x[p][axis] = fabs(x[axis] - y) > still * cut->h ? x[axis] : y;
        }
    }
}

void cut_snap(struct cut *cut, const struct outline *outline)
{
    lay(cut);
    for (int k = 0; k < 4 * outline->n; k++)
        cross_lines(cut, outline, k / 2 % outline->n, k % 2,
                    k < 2 * outline->n ? snap : part);
    /* a particle is inside where an odd number of crossings is on its left */
    for (int64_t p = 0; p < (int64_t)cut->m * cut->n; p++) {
        if (p % cut->m)
            cut->kind[p] ^= cut->kind[p - 1];
    }
    for (int64_t p = 0; p < (int64_t)cut->m * cut->n; p++)
        if (cut->chord[p] >= 0)
            cut->kind[p] = CUT_BORDER;
    take_corners(cut, outline);
}
