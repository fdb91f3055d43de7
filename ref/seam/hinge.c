/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the hinges of seams, from the definition alone. spec/seam/seam.md §6 */
#include "ref/seam/hinge.h"

#include "ref/base/cells.h"

enum { BESIDE = 8, BEHIND = 2 * BESIDE };

/* §6.1: how far off a hinge's answer may be, as a star's (panel.md §4.1). */
static const double MOST_OFF = 0.7;

/* Particles of one side of a seam near a point, unfolded about it: along the
 * seam, and across it away from the other side, m. */
struct behind {
    int n;
    int32_t at[BEHIND];
    double along[BEHIND], across[BEHIND];
};

/* One side of a seam: its particles, or their places. */
struct border {
    const drape_cloth *cloth;
    const drape_seam *seam;
    bool places;
};

static double length_of(double x, double y)
{
    return sqrt(x * x + y * y);
}

static void rest_of(const drape_cloth *d, int32_t p, double x[2])
{
    if (d->panel) {
        memcpy(x, d->panel->rest[p], 2 * sizeof *x);
        return;
    }
    x[0] = p % d->m * (d->width / (d->m - 1));
    x[1] = p / d->m * (d->height / (d->n - 1));
}

/* Where point k of a side is at rest. */
static void point_of(const struct border *s, int64_t k, double x[2])
{
    double a[2], b[2];
    if (!s->places) {
        rest_of(s->cloth, s->seam->particle[k], x);
        return;
    }
    double part = s->seam->part[k];
    rest_of(s->cloth, s->seam->onto[k][0], a);
    rest_of(s->cloth, s->seam->onto[k][1], b);
    for (int i = 0; i < 2; i++)
        x[i] = (1 - part) * a[i] + part * b[i];
}

/* Adds the particles that a cell joins to particle p. */
static void add_beside(const drape_cloth *d, int32_t p, struct behind *to)
{
    for (int q = 0; q < 4; q++) {
        int64_t i = p % d->m - q % 2, j = p / d->m - q / 2, at[4];
        int n = cell_corners(cell_kind(d, i, j), i + d->m * j, d->m, at);
        bool has = false;
        for (int c = 0; c < n; c++)
            has |= at[c] == p;
        for (int c = 0; c < n && has; c++) {
            int k = 0;
            while (k < to->n && to->at[k] != at[c])
                k++;
            if (at[c] != p && k == to->n && k < BEHIND)
                to->at[to->n++] = (int32_t)at[c];
        }
    }
}

/* Unfolds the particles of a side near point k. False if it has no direction
 * there. */
static bool unfold(const struct border *s, int64_t k, struct behind *to)
{
    double x[2], from[2], end[2], way[2], q[2], middle = 0;
    to->n = 0;
    if (s->places)
        for (int i = 0; i < 2; i++)
            add_beside(s->cloth, s->seam->onto[k][i], to);
    else
        add_beside(s->cloth, s->seam->particle[k], to);
    point_of(s, k, x);
    point_of(s, k > 0 ? k - 1 : k, from);
    point_of(s, k + 1 < s->seam->n ? k + 1 : k, end);
    for (int i = 0; i < 2; i++)
        way[i] = end[i] - from[i];
    double length = length_of(way[0], way[1]);
    if (!(length > 0) || to->n == 0)
        return false;
    for (int a = 0; a < to->n; a++) {
        rest_of(s->cloth, to->at[a], q);
        q[0] -= x[0];
        q[1] -= x[1];
        to->along[a] = (q[0] * way[0] + q[1] * way[1]) / length;
        to->across[a] = (q[1] * way[0] - q[0] * way[1]) / length;
        middle += to->across[a];
    }
    for (int a = 0; a < to->n; a++)
        to->across[a] = middle < 0 ? -to->across[a] : to->across[a];
    return true;
}

/* §6.1: the form on particle a of one side and b, c of the other that vanishes
 * on affine functions: its weights there, 1 at a. False if one is negative. */
static bool solve_form(const struct behind *s, const struct behind *t, int a,
                       int b, int c, double w[2])
{
    double det = t->along[b] * t->across[c] - t->along[c] * t->across[b];
    double scale = length_of(t->along[b], t->across[b]) *
                   length_of(t->along[c], t->across[c]);
    if (!(fabs(det) > 1e-6 * scale))
        return false; /* on one line with the point: any weights would do */
    double x = -s->along[a], y = s->across[a];
    w[0] = (x * t->across[c] - y * t->along[c]) / det;
    w[1] = (y * t->along[b] - x * t->across[b]) / det;
    for (int k = 0; k < 2; k++)
        w[k] = fabs(w[k]) < 1e-9 ? 0 : w[k]; /* 0 but for rounding */
    return w[0] >= 0 && w[1] >= 0;
}

/* §6.1: makes the hinge on particle a of one side and b, c of the other, but
 * for its at[1] and its length. Returns how far its answer is off, squared;
 * HUGE_VAL: there is none. */
static double make_hinge(const struct behind *s, const struct behind *t, int a,
                         int b, int c, struct hinge *to)
{
    double ss = s->along[a] * s->along[a], dd = s->across[a] * s->across[a];
    double sd = s->along[a] * s->across[a], w[2], across = 0;
    const int on[2] = {b, c};
    if (!(s->across[a] > 0 && t->across[b] > 0 && t->across[c] > 0) ||
        !solve_form(s, t, a, b, c, w))
        return HUGE_VAL;
    for (int k = 0; k < 2; k++) {
        double u = t->along[on[k]], v = t->across[on[k]];
        ss += w[k] * (u * u);
        dd += w[k] * (v * v);
        sd -= w[k] * (u * v);
        across += w[k] * v;
    }
    double off = ss / dd, twist = 2 * sd / dd;
    if (!(off <= MOST_OFF && fabs(twist) <= MOST_OFF))
        return HUGE_VAL;
    double sum = w[0] + w[1], all = 1 + sum, scale = 2 * all / dd;
    *to = (struct hinge){.at = {s->at[a], 0, t->at[b], t->at[c]},
                         .c = {1 / all, -1, w[0] / all, w[1] / all},
                         .shape = scale * scale,
                         .behind = (s->across[a] + across / sum) / 2};
    return off * off + twist * twist;
}

/* The length of seam that a point has, m. */
static double find_spacing(const struct border *s, int64_t k)
{
    double x[2], y[2], sum = 0;
    for (int side = -1; side < 2; side += 2) {
        int64_t to = k + side;
        if (to < 0 || to >= s->seam->n)
            continue;
        point_of(s, k, x);
        point_of(s, to, y);
        sum += length_of(y[0] - x[0], y[1] - x[1]) / 2;
    }
    return sum;
}

/* Whether the same particle is on both sides, as at the tip of a dart. */
static bool share_particle(const drape_seam *seam, int64_t point, int32_t a,
                           int32_t b, int32_t c)
{
    int32_t p = seam->particle[point];
    return seam->cloth[0] == seam->cloth[1] &&
           (a == b || a == c || p == b || p == c);
}

bool hinge_find(const drape_def *def, const drape_seam *seam, int64_t point,
                struct hinge *hinge)
{
    const drape_cloth *cloth[2] = {&def->cloths[seam->cloth[0]],
                                   &def->cloths[seam->cloth[1]]};
    struct border one = {cloth[0], seam, false};
    struct border other = {cloth[1], seam, true};
    struct behind s, t;
    double least = HUGE_VAL;
    *hinge = (struct hinge){{0}, {0}, 0, 0};
    if (cloth[0]->bending != DRAPE_TRIPLES ||
        cloth[1]->bending != DRAPE_TRIPLES || !unfold(&one, point, &s) ||
        !unfold(&other, point, &t))
        return false;
    for (int a = 0; a < s.n; a++)
        for (int b = 0; b < t.n; b++)
            for (int c = b + 1; c < t.n; c++) {
                struct hinge one;
                double off = HUGE_VAL;
                if (!share_particle(seam, point, s.at[a], t.at[b], t.at[c]))
                    off = make_hinge(&s, &t, a, b, c, &one);
                if (!(off < least - 1e-9))
                    continue; /* rounding does not choose between two */
                least = off;
                *hinge = one;
            }
    if (!(least < HUGE_VAL))
        return false;
    hinge->at[1] = seam->particle[point];
    hinge->shape *= hinge->behind * find_spacing(&one, point);
    return true;
}

double hinge_bend(const drape_material *a, const drape_material *b)
{
    double sum = a->bend + b->bend;
    return sum > 0 ? 2 * a->bend * b->bend / sum : 0;
}

void hinge_mark(const drape_def *def, int k, uint8_t *marks)
{
    struct hinge hinge;
    for (int s = 0; s < def->n_seams; s++) {
        const drape_seam *seam = &def->seams[s];
        for (int64_t i = 0; i < seam->n; i++) {
            if ((seam->cloth[0] != k && seam->cloth[1] != k) ||
                !hinge_find(def, seam, i, &hinge))
                continue;
            if (seam->cloth[0] == k)
                marks[seam->particle[i]] = 1;
            if (seam->cloth[1] == k)
                marks[seam->onto[i][0]] = marks[seam->onto[i][1]] = 1;
        }
    }
}
