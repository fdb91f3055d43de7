/* SPDX-License-Identifier: Apache-2.0 */
/* The smooth surface of a mesh. spec/validation.md §9 */
#include "validate/ground.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double apart3(const double a[3], const double b[3])
{
    double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return sqrt(dot3(d, d));
}

void cross3(const double a[3], const double b[3], double out[3])
{
    for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        out[c] = a[d] * b[e] - a[e] * b[d];
    }
}

void ground_free(struct ground *g)
{
    free(g->x);
    free(g->tri);
    free(g->piece);
    free(g->first);
}

/* The area of a triangle along its normal. */
static void area_of(const struct ground *g, int64_t t, double area[3])
{
    const int32_t *v = g->tri[t];
    double a[3], b[3];
    for (int c = 0; c < 3; c++) {
        a[c] = (g->x[v[1]][c] - g->x[v[0]][c]) / 2;
        b[c] = g->x[v[2]][c] - g->x[v[0]][c];
    }
    cross3(a, b, area);
}

/* Into how many parts a triangle's sides are cut, so that its pieces are small
 * beside the radius. */
static int cuts(const struct ground *g, int64_t t)
{
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(
            longest, apart3(g->x[g->tri[t][k]], g->x[g->tri[t][(k + 1) % 3]]));
    return 1 + (int)(5 * longest / g->radius);
}

/* Writes a triangle's n² pieces. */
static void cut(const struct ground *g, int64_t t, int n, struct piece *out)
{
    double area[3];
    area_of(g, t, area);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < 2 * (n - i) - 1; j++, out++) {
            /* Every second piece of a row is upside down. */
            double s = (i + (j % 2 ? 2.0 : 1.0) / 3) / n,
                   r = (j / 2 + (j % 2 ? 2.0 : 1.0) / 3) / n;
            for (int c = 0; c < 3; c++) {
                const int32_t *v = g->tri[t];
                out->x[c] = (1 - s - r) * g->x[v[0]][c] + s * g->x[v[1]][c] +
                            r * g->x[v[2]][c];
                out->area[c] = area[c] / (n * n);
            }
        }
}

static int64_t box_of(const struct ground *g, const double x[3])
{
    int64_t box = 0;
    for (int c = 0; c < 3; c++)
        box = box * g->boxes[c] + (int64_t)((x[c] - g->lo[c]) / g->radius);
    return box;
}

/* Lays a grid with a margin of more than one box around the mesh. Returns how
 * many boxes it has. */
static int64_t make_grid(struct ground *g)
{
    int64_t count = 1;
    for (int c = 0; c < 3; c++) {
        double hi = g->lo[c] = g->x[0][c];
        for (int64_t k = 0; k < g->nv; k++) {
            g->lo[c] = fmin(g->lo[c], g->x[k][c]);
            hi = fmax(hi, g->x[k][c]);
        }
        g->lo[c] -= 2 * g->radius;
        g->boxes[c] = (int)((hi - g->lo[c]) / g->radius) + 3;
        count *= g->boxes[c];
    }
    return count;
}

void ground_smooth(struct ground *g, double side)
{
    /* By the weights of ground_height a disc of this radius has the moments of
     * a square of this side. */
    g->radius = side * sqrt(10.0 / 12);
    int64_t boxes = make_grid(g), all = 0;
    for (int64_t t = 0; t < g->nt; t++)
        all += cuts(g, t) * cuts(g, t);
    struct piece *loose = take((size_t)all, sizeof *loose);
    all = 0;
    for (int64_t t = 0; t < g->nt; t++) {
        int n = cuts(g, t);
        cut(g, t, n, loose + all);
        all += n * n;
    }
    g->piece = take((size_t)all, sizeof *g->piece);
    g->first = take((size_t)boxes + 1, sizeof *g->first);
    for (int64_t k = 0; k < all; k++)
        g->first[box_of(g, loose[k].x) + 1]++;
    for (int64_t b = 0; b < boxes; b++)
        g->first[b + 1] += g->first[b];
    for (int64_t k = all; k-- > 0;)
        g->piece[--g->first[box_of(g, loose[k].x) + 1]] = loose[k];
    /* Each first is now its box's end less its count: that box's own start. */
    memmove(g->first, g->first + 1, (size_t)boxes * sizeof *g->first);
    g->first[boxes] = all;
    free(loose);
}

/* Sums over the pieces near a place: of weights, of weights times the place's
 * height over a piece's plane, and the gradients of both sums. */
struct sums {
    double weight, height, by_weight[3], by_height[3];
};

static void add_piece(struct sums *s, const struct piece *p, const double x[3],
                      double radius)
{
    double d[3] = {x[0] - p->x[0], x[1] - p->x[1], x[2] - p->x[2]};
    double near = 1 - dot3(d, d) / (radius * radius);
    if (near <= 0)
        return;
    double area = sqrt(dot3(p->area, p->area)), weight = near * near * near;
    double high = dot3(p->area, d), rate = -6 * near * near / (radius * radius);
    s->weight += weight * area;
    s->height += weight * high;
    for (int c = 0; c < 3; c++) {
        s->by_weight[c] += rate * d[c] * area;
        s->by_height[c] += rate * d[c] * high + weight * p->area[c];
    }
}

double ground_height(const struct ground *g, const double x[3],
                     double normal[3])
{
    struct sums s = {0};
    int at[3];
    for (int c = 0; c < 3; c++) {
        double place = (x[c] - g->lo[c]) / g->radius;
        if (!(place >= 1 && place < g->boxes[c] - 1))
            return NAN;
        at[c] = (int)place;
    }
    for (int i = at[0] - 1; i <= at[0] + 1; i++)
        for (int j = at[1] - 1; j <= at[1] + 1; j++) {
            int64_t row = ((int64_t)i * g->boxes[1] + j) * g->boxes[2] + at[2];
            for (int64_t k = g->first[row - 1]; k < g->first[row + 2]; k++)
                add_piece(&s, &g->piece[k], x, g->radius);
        }
    if (!(s.weight > 0))
        return NAN;
    double height = s.height / s.weight;
    for (int c = 0; c < 3; c++)
        normal[c] = (s.by_height[c] - height * s.by_weight[c]) / s.weight;
    /* The mean of heights need not grow by 1 m a metre: its zero counts, and
     * near it height over gradient is the distance. */
    double gradient = sqrt(dot3(normal, normal));
    for (int c = 0; c < 3; c++)
        normal[c] /= gradient;
    return height / gradient;
}

bool ground_put(const struct ground *g, double x[3], double height)
{
    for (int k = 0; k < 20; k++) {
        double n[3] = {0}, off = ground_height(g, x, n) - height;
        if (fabs(off) < 1e-9)
            return true;
        for (int c = 0; c < 3; c++)
            x[c] -= off * n[c];
    }
    return false;
}
