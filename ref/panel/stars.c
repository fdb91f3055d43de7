/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the stars of a panel. spec/panel/panel.md §4 */
#include "ref/panel/stars.h"

#include "ref/base/cells.h"
#include "ref/cloth/triple.h"

enum { ARMS = 4, POINTS = 5, RINGS = 3 };
/* The arms of the stars of the directions 0 and 1, and of 2 and 3. */
static const int8_t arm_i[2][ARMS] = {{1, 0, -1, 0}, {1, -1, -1, 1}};
static const int8_t arm_j[2][ARMS] = {{0, 1, 0, -1}, {1, 1, -1, -1}};
/* What a direction's second difference answers to u²/2, v²/2 and u v, and how
 * far a star's may be off. */
static const double asked[SPRINGS_SINGLE][3] = {
    {1, 0, 0}, {0, 1, 0}, {1, 1, 2}, {1, 1, -2}};
static const double most_off[SPRINGS_SINGLE] = {0.7, 0.7, 1.4, 1.4};

/* Whether a cell has both the particles p and q. */
static bool share_cell(const drape_cloth *d, int64_t p, int64_t q)
{
    for (int k = 0; k < 4; k++) {
        int64_t i = p % d->m - k % 2, j = p / d->m - k / 2, at[4];
        int n = cell_corners(cell_kind(d, i, j), i + d->m * j, d->m, at);
        int found = 0;
        for (int c = 0; c < n; c++)
            found += (at[c] == p) + (at[c] == q);
        if (found == 2)
            return true;
    }
    return false;
}

/* The neighbour of p at (di, dj), of which some cell has both; -1: none. */
static int64_t neighbour_of(const drape_cloth *d, int64_t p, int di, int dj)
{
    int64_t i = p % d->m + di, j = p / d->m + dj;
    if (i < 0 || j < 0 || i >= d->m || j >= d->n)
        return -1;
    return share_cell(d, p, i + d->m * j) ? i + d->m * j : -1;
}

static double dot_of(const double *a, const double *b, int n)
{
    double sum = 0;
    for (int k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

/* The points of a star, in cells from its middle, which is the first. */
struct points {
    int n;
    int arm[POINTS]; /* of each point but the first */
    double x[POINTS][2];
};

/* Takes from a [n] its parts along the `made` unit vectors. Returns its length,
 * and makes it a unit vector if that is above 1e-9. */
static double make_orthogonal(double *a, int n, double (*unit)[POINTS],
                              int made)
{
    for (int turn = 0; turn < 2; turn++) /* once more against rounding */
        for (int k = 0; k < made; k++) {
            double part = dot_of(a, unit[k], n);
            for (int q = 0; q < n; q++)
                a[q] -= part * unit[k][q];
        }
    double length = sqrt(dot_of(a, a, n));
    for (int q = 0; q < n && length > 1e-9; q++)
        a[q] /= length;
    return length;
}

/* §4.1: an orthonormal basis of the forms on the points that vanish on affine
 * functions. Returns how many there are. */
static int find_null_forms(const struct points *s, double form[2][POINTS])
{
    double unit[POINTS + 3][POINTS] = {{0}};
    int made = 0, found = 0;
    for (int k = 0; k < 3; k++) {
        for (int q = 0; q < s->n; q++)
            unit[made][q] = k ? s->x[q][k - 1] : 1;
        made += make_orthogonal(unit[made], s->n, unit, made) > 1e-9;
    }
    for (int k = 0; k < s->n && found < 2; k++) {
        for (int q = 0; q < s->n; q++)
            unit[made][q] = q == k;
        if (!(make_orthogonal(unit[made], s->n, unit, made) > 1e-6))
            continue;
        memcpy(form[found++], unit[made++], sizeof *form);
    }
    return found;
}

/* What a form answers to u²/2, v²/2 and u v. */
static void find_answer(const struct points *s, const double *form,
                        double answer[3])
{
    answer[0] = answer[1] = answer[2] = 0;
    for (int q = 0; q < s->n; q++) {
        double u = s->x[q][0], v = s->x[q][1];
        answer[0] += form[q] * (0.5 * u * u);
        answer[1] += form[q] * (0.5 * v * v);
        answer[2] += form[q] * (u * v);
    }
}

/* §4.1: of the null forms the combination whose answer is nearest to what
 * direction o asks for. False if it is too far from it. */
static bool fit_form(const struct points *s, int o, double c[POINTS])
{
    double form[2][POINTS] = {{0}}, r[2][3] = {{0}}, y[2] = {0, 0}, answer[3];
    int n = find_null_forms(s, form);
    if (n == 0)
        return false;
    for (int k = 0; k < n; k++)
        find_answer(s, form[k], r[k]);
    double aa = dot_of(r[0], r[0], 3), ga = dot_of(r[0], asked[o], 3);
    double bb = n > 1 ? dot_of(r[1], r[1], 3) : 0;
    double ab = n > 1 ? dot_of(r[0], r[1], 3) : 0;
    double gb = n > 1 ? dot_of(r[1], asked[o], 3) : 0;
    double det = aa * bb - ab * ab, trace = aa + bb;
    if (det > 1e-9 * trace * trace) {
        y[0] = (bb * ga - ab * gb) / det;
        y[1] = (aa * gb - ab * ga) / det;
    } else { /* of rank 1 at most: along the gradient */
        double gg = ga * ga + gb * gb;
        double q = ga * (aa * ga + ab * gb) + gb * (ab * ga + bb * gb);
        y[0] = q > 0 ? gg / q * ga : 0;
        y[1] = q > 0 ? gg / q * gb : 0;
    }
    for (int q = 0; q < s->n; q++)
        c[q] = y[0] * form[0][q] + (n > 1 ? y[1] * form[1][q] : 0);
    find_answer(s, c, answer);
    for (int k = 0; k < 3; k++)
        if (!(fabs(answer[k] - asked[o][k]) <= most_off[o]))
            return false;
    return true;
}

/* §4.1: the star of direction o about p, whose arms lie where they are at rest.
 * False if there is none. */
static bool find_star(const struct star_grid *s, int64_t p, int o,
                      struct star *star)
{
    const drape_cloth *d = s->def;
    double hu = d->width / (d->m - 1), hv = d->height / (d->n - 1);
    const double(*rest)[2] = d->panel->rest;
    struct points points = {.n = 1};
    double c[POINTS];
    int set = o / 2, ahead = o % 2, ends = 0;
    for (int k = 0; k < POINTS; k++)
        star->at[k] = (int32_t)p;
    for (int k = 0; k < ARMS; k++) {
        int64_t q = neighbour_of(d, p, arm_i[set][k], arm_j[set][k]);
        star->c[k] = 0;
        if (q < 0)
            continue;
        ends += k % 2 == ahead;
        star->at[k + 1] = (int32_t)q;
        points.x[points.n][0] = (rest[q][0] - rest[p][0]) / hu;
        points.x[points.n][1] = (rest[q][1] - rest[p][1]) / hv;
        points.arm[points.n++] = k;
    }
    if (ends < 2 || !fit_form(&points, o, c))
        return false;
    for (int q = 1; q < points.n; q++)
        star->c[points.arm[q]] = (real)c[q];
    return true;
}

/* §4.2: whether p has bending in direction o: of a star, or of a triple. */
static bool has_bending(const struct star_grid *s, const uint8_t *made, int o,
                        int64_t p)
{
    return made[p] >> o & 1 || has_triple(o, s->cloth->beside[p]);
}

/* §4.2: the particles nearest to p, within RINGS, that have bending in
 * direction o. Returns their number. */
static int find_nearest(const struct star_grid *s, const uint8_t *made, int o,
                        int64_t p,
                        int64_t near[(2 * RINGS + 1) * (2 * RINGS + 1)])
{
    const drape_cloth *d = s->def;
    const double(*rest)[2] = d->panel->rest;
    int64_t i = p % d->m, j = p / d->m;
    for (int ring = 1; ring <= RINGS; ring++) {
        double least = INFINITY;
        int n = 0;
        for (int pass = 0; pass < 2; pass++)
            for (int64_t y = j - ring; y <= j + ring; y++)
                for (int64_t x = i - ring; x <= i + ring; x++) {
                    int64_t q = x + d->m * y;
                    if (x < 0 || y < 0 || x >= d->m || y >= d->n ||
                        !has_bending(s, made, o, q))
                        continue;
                    double u = rest[q][0] - rest[p][0];
                    double v = rest[q][1] - rest[p][1], far = u * u + v * v;
                    if (pass == 0)
                        least = far < least ? far : least;
                    else if (far <= 1.02 * least)
                        near[n++] = q;
                }
        if (n)
            return n;
    }
    return 0;
}

/* §4.2: k [SPRINGS_SINGLE·count] gets the area of each form: a particle's own,
 * and of those near it that lack the direction. made [count] gets the bits of
 * the stars. */
static void share_areas(const struct star_grid *s, uint8_t *made, double *k)
{
    int64_t count = s->cloth->count;
    int64_t near[(2 * RINGS + 1) * (2 * RINGS + 1)];
    struct star star;
    for (int64_t p = 0; p < count; p++)
        for (int o = 0; o < SPRINGS_SINGLE && s->area[p] > 0; o++)
            if (find_star(s, p, o, &star)) {
                made[p] |= (uint8_t)(1 << o);
                k[SPRINGS_SINGLE * p + o] += s->area[p];
            }
    for (int64_t p = 0; p < count; p++)
        for (int o = 0; o < SPRINGS_SINGLE && s->area[p] > 0; o++) {
            if (made[p] >> o & 1 || (s->hinged && s->hinged[p]))
                continue;
            int n = find_nearest(s, made, o, p, near);
            for (int q = 0; q < n; q++)
                k[SPRINGS_SINGLE * near[q] + o] += s->area[p] / n;
        }
}

/* The form of direction o about p: of its star, or of the grid's triple. */
static void make_form(const struct star_grid *s, const uint8_t *made, int o,
                      int64_t p, struct star *star)
{
    int32_t step = (int32_t)spring_step(s->cloth->m, o), at = (int32_t)p;
    if (made[p] >> o & 1 && find_star(s, p, o, star))
        return;
    *star = (struct star){.at = {at, at + step, at - step, at, at},
                          .c = {1, 1, 0, 0}};
}

int make_stars(const struct star_grid *s, struct panel *to)
{
    const struct cloth *c = s->cloth;
    int64_t all = SPRINGS_SINGLE * c->count, n = 0;
    double *k = arena_take(s->arena, ARENA_OTHER, all, sizeof *k);
    uint8_t *made = arena_take(s->arena, ARENA_OTHER, c->count, 1);
    if (k && made)
        share_areas(s, made, k);
    for (int64_t i = 0; i < all && k; i++)
        n += k[i] > 0;
    to->star = arena_take(s->arena, ARENA_CLOTH, n, sizeof *to->star);
    to->share = arena_take(s->arena, ARENA_CLOTH, n, sizeof *to->share);
    to->star_way = arena_take(s->arena, ARENA_CLOTH, n, 1);
    for (int64_t i = 0; i < all && k && made && !s->arena->failed; i++) {
        int o = (int)(i % SPRINGS_SINGLE);
        if (!(k[i] > 0))
            continue;
        make_form(s, made, o, i / SPRINGS_SINGLE, &to->star[to->n_stars]);
        to->share[to->n_stars] = k[i];
        to->star_way[to->n_stars++] = (uint8_t)o;
    }
    arena_give(s->arena, k);
    arena_give(s->arena, made);
    return s->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}
