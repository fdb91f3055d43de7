/* SPDX-License-Identifier: Apache-2.0 */
/* Places a mesh in the scene: levels, scales, stands, rotates and moves it. */
#include "app/read/mesh.h"
#include "app/scene/shapes.h"

#include <math.h>
#include <string.h>

/* The rotation matrix about unit a by the angle of cosine c and sine s:
 * c 1 + (1 - c) a aᵀ + s [a]×. */
static void about(const double a[3], double c, double s, double r[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r[i][j] = (i == j ? c : 0) + (1 - c) * a[i] * a[j];
    r[0][1] -= s * a[2];
    r[0][2] += s * a[1];
    r[1][0] += s * a[2];
    r[1][2] -= s * a[0];
    r[2][0] -= s * a[1];
    r[2][1] += s * a[0];
}

/* Positions of a mesh in all its frames, of which the first decides. */
struct places {
    double (*x)[3];
    int64_t nv, n; /* vertices, and positions of all frames */
};

static void apply(const struct places *all, double r[3][3])
{
    for (int64_t k = 0; k < all->n; k++) {
        double *x = all->x[k], p[3] = {x[0], x[1], x[2]};
        for (int i = 0; i < 3; i++)
            x[i] = r[i][0] * p[0] + r[i][1] * p[1] + r[i][2] * p[2];
    }
}

static double length(const double a[3])
{
    return square_root(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Rotates all by the smallest rotation that takes direction `up` to +y. */
static void level(const struct places *all, const double up[3])
{
    double n = length(up), axis[3] = {-up[2] / n, 0, up[0] / n};
    double s = length(axis), c = up[1] / n, r[3][3];
    if (s == 0) {
        axis[0] = 1;
    } else {
        axis[0] /= s;
        axis[2] /= s;
    }
    about(axis, c, s, r);
    apply(all, r);
}

static void move(const struct places *all, const double by[3])
{
    for (int64_t k = 0; k < all->n; k++)
        for (int i = 0; i < 3; i++)
            all->x[k][i] += by[i];
}

static void stretch(const struct places *all, double factor)
{
    for (int64_t k = 0; k < all->n; k++)
        for (int i = 0; i < 3; i++)
            all->x[k][i] *= factor;
}

static void box(const struct places *all, double lo[3], double hi[3])
{
    const struct mesh first = {.nv = all->nv, .x = all->x};
    mesh_box(&first, lo, hi);
}

static void stand(const struct places *all)
{
    double lo[3], hi[3];
    box(all, lo, hi);
    double by[3] = {-(lo[0] + hi[0]) / 2, -lo[1], -(lo[2] + hi[2]) / 2};
    move(all, by);
}

void mesh_place_frames(double (*x)[3], int64_t nv, int64_t frames,
                       const struct placement *p)
{
    const struct places all = {x, nv, frames * nv};
    double lo[3], hi[3], r[3][3];
    if (length(p->up) > 0)
        level(&all, p->up);
    box(&all, lo, hi);
    double largest = fmax(fmax(hi[0] - lo[0], hi[1] - lo[1]), hi[2] - lo[2]);
    if (p->size > 0 && largest > 0)
        stretch(&all, p->size / largest);
    if (p->scale != 1)
        stretch(&all, p->scale);
    if (p->stand)
        stand(&all);
    double n = length(p->axis);
    if (p->angle != 0 && n > 0) {
        double c, s, axis[3];
        for (int i = 0; i < 3; i++)
            axis[i] = p->axis[i] / n;
        circle(p->angle / 360, &c, &s);
        about(axis, c, s, r);
        apply(&all, r);
    }
    if (p->at[0] != 0 || p->at[1] != 0 || p->at[2] != 0)
        move(&all, p->at);
}

void mesh_place(struct mesh *mesh, const struct placement *placement)
{
    mesh_place_frames(mesh->x, mesh->nv, 1, placement);
}
