/* SPDX-License-Identifier: Apache-2.0 */
/* Makes obstacles in code. Round obstacles are surfaces of revolution: a
 * profile rotated about the y axis. */
#include "app/scene/shapes.h"
#include "app/base/app.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

double square_root(double a)
{
    return sqrt(a); /* correctly rounded by IEEE 754 */
}

void circle(double turns, double *c, double *s)
{
    /* the angle is reduced to an eighth of a turn, where Taylor's terms up to
     * the 18th power leave an error below 1e-18 */
    double quarter = floor(4 * turns + 0.5);
    double a = (turns - quarter / 4) * (2 * pi), square = a * a;
    double cosine = 1, sine = 1;
    for (int k = 9; k > 0; k--) {
        cosine = 1 - square / ((2 * k - 1) * (2 * k)) * cosine;
        sine = 1 - square / ((2 * k) * (2 * k + 1)) * sine;
    }
    sine *= a;
    double rest = quarter - 4 * floor(quarter / 4);
    bool odd = rest == 1 || rest == 3;
    *c = odd ? sine : cosine;
    *s = odd ? cosine : sine;
    if (rest == 1 || rest == 2)
        *c = -*c;
    if (rest >= 2)
        *s = -*s;
}

static int mesh_make(struct pool *pool, int64_t nv, int64_t nt,
                     struct mesh *mesh)
{
    mesh->nv = nv;
    mesh->nt = 0;
    mesh->x = pool_take(pool, (size_t)nv, sizeof *mesh->x);
    mesh->tri = pool_take(pool, (size_t)nt, sizeof *mesh->tri);
    if (mesh->x && mesh->tri)
        return APP_OK;
    return complain(APP_FAILED,
                    "a shape of %lld vertices: no memory left within the "
                    "scene's limit (key memory)",
                    (long long)nv);
}

static void add(struct mesh *mesh, int64_t a, int64_t b, int64_t c)
{
    int32_t *t = mesh->tri[mesh->nt++];
    t[0] = (int32_t)a;
    t[1] = (int32_t)b;
    t[2] = (int32_t)c;
}

/* A profile of rings from bottom to top; an end of radius 0 is one vertex.
 * lobes: the number of waves of the radius around a ring, with relative
 * amplitude `depth`. */
struct lathe {
    int rings, around;
    double (*profile)[2]; /* r, y */
    const double *depth;  /* [rings] or NULL */
    int lobes;
};

static void ring(const struct lathe *lathe, int k, double (*x)[3])
{
    double r = lathe->profile[k][0], y = lathe->profile[k][1];
    for (int j = 0; j < lathe->around; j++) {
        double c, s, swell, unused;
        double turns = (double)j / lathe->around;
        circle(turns, &c, &s);
        circle(turns * lathe->lobes, &swell, &unused);
        double here = r * (1 + (lathe->depth ? lathe->depth[k] * swell : 0));
        x[j][0] = here * c;
        x[j][1] = y;
        x[j][2] = here * s;
    }
}

/* Appends the triangles between two rings, which begin at vertices a (below)
 * and b. A pole is a ring with one vertex, shared by all columns. */
static void band(struct mesh *mesh, int64_t a, int64_t b, bool pole[2],
                 int around)
{
    for (int j = 0; j < around; j++) {
        int next = (j + 1) % around;
        if (pole[0]) {
            add(mesh, a, b + j, b + next);
        } else if (pole[1]) {
            add(mesh, a + j, b, a + next);
        } else {
            add(mesh, a + j, b + j, a + next);
            add(mesh, a + next, b + j, b + next);
        }
    }
}

static int turn(struct pool *pool, const struct lathe *lathe, struct mesh *mesh)
{
    int64_t most = (int64_t)lathe->rings * lathe->around;
    int status = mesh_make(pool, most, 2 * most, mesh);
    if (status != APP_OK)
        return status;
    int64_t used = 0, below = 0;
    for (int k = 0; k < lathe->rings; k++) {
        bool pole[2] = {k > 0 && lathe->profile[k - 1][0] == 0,
                        lathe->profile[k][0] == 0};
        if (pole[1])
            mesh->x[used][1] = lathe->profile[k][1];
        else
            ring(lathe, k, mesh->x + used);
        if (k > 0)
            band(mesh, below, used, pole, lathe->around);
        below = used;
        used += pole[1] ? 1 : lathe->around;
    }
    mesh->nv = used;
    return APP_OK;
}

static int make_plane(struct pool *pool, const struct shape *s,
                      struct mesh *mesh)
{
    int status = mesh_make(pool, 4, 2, mesh);
    if (status != APP_OK)
        return status;
    for (int k = 0; k < 4; k++) {
        mesh->x[k][0] = (k & 1 ? 0.5 : -0.5) * s->extent[0];
        mesh->x[k][2] = (k & 2 ? 0.5 : -0.5) * s->extent[2];
    }
    add(mesh, 0, 2, 1);
    add(mesh, 1, 2, 3);
    return APP_OK;
}

static int make_box(struct pool *pool, const struct shape *s, struct mesh *mesh)
{
    int status = mesh_make(pool, 8, 12, mesh);
    if (status != APP_OK)
        return status;
    for (int k = 0; k < 8; k++)
        for (int d = 0; d < 3; d++)
            mesh->x[k][d] = (k >> d & 1 ? 0.5 : -0.5) * s->extent[d];
    static const int face[6][4] = {{0, 4, 2, 6}, {1, 3, 5, 7}, {0, 1, 4, 5},
                                   {2, 6, 3, 7}, {0, 2, 1, 3}, {4, 5, 6, 7}};
    for (int k = 0; k < 6; k++) {
        add(mesh, face[k][0], face[k][1], face[k][2]);
        add(mesh, face[k][2], face[k][1], face[k][3]);
    }
    return APP_OK;
}

/* Makes a capsule: a sphere whose halves are `length` apart along y, with this
 * number of bands of triangles between them. */
static int make_capsule(struct pool *pool, const struct shape *s, double length,
                        int bands, struct mesh *mesh)
{
    int half = (s->detail / 2 + 1) / 2, k = 0;
    struct lathe lathe = {.around = s->detail};
    lathe.profile = pool_take(pool, 2 * (size_t)half + 2 + (size_t)bands,
                              sizeof(double[2]));
    if (!lathe.profile)
        return complain(APP_FAILED, "out of memory");
    for (int side = -1; side <= 1; side += 2) {
        for (int j = 1; side > 0 && j < bands; j++) {
            lathe.profile[k][0] = s->radius;
            lathe.profile[k++][1] = length * j / bands - length / 2;
        }
        for (int j = 0; j <= half; j++) {
            double c, y;
            int step = side < 0 ? j - half : j;
            if (side > 0 && j == 0 && length == 0)
                continue;
            circle(0.25 * step / half, &c, &y);
            bool pole = step == half || step == -half;
            lathe.profile[k][0] = pole ? 0 : s->radius * c;
            lathe.profile[k++][1] = s->radius * y + side * length / 2;
        }
    }
    lathe.rings = k;
    return turn(pool, &lathe, mesh);
}

/* As long as the triangles are wide, and an even number, so that a ring is
 * where a limb begins to bend, and one where it ends; at most 2^15. */
static int limb_bands(const struct shape *s)
{
    double n = s->length * s->detail / (2 * pi * s->radius);
    return 4 * (1 + (int)fmin(n / 4, 1 << 13));
}

static int make_funnel(struct pool *pool, const struct shape *s,
                       struct mesh *mesh)
{
    enum { CONE = 16, SPOUT = 6 };
    double profile[CONE + SPOUT + 1][2];
    for (int k = 0; k <= CONE + SPOUT; k++) {
        double t = (double)(k - SPOUT) / CONE;
        profile[k][0] =
            k < SPOUT ? s->throat : s->throat + t * (s->radius - s->throat);
        profile[k][1] =
            k < SPOUT ? -s->length * (SPOUT - k) / SPOUT : t * s->height;
    }
    struct lathe lathe = {
        .rings = CONE + SPOUT + 1, .around = s->detail, .profile = profile};
    return turn(pool, &lathe, mesh);
}

/* Catmull and Rom's cubic between p[1] and p[2]. */
static double spline(const double p[4], double t)
{
    double a = p[2] - p[0], b = 2 * p[0] - 5 * p[1] + 4 * p[2] - p[3];
    double c = 3 * (p[1] - p[2]) + p[3] - p[0];
    return p[1] + t * (a + t * (b + t * c)) / 2;
}

/* Makes a figure on a pedestal: a fluted robe, shoulders and a head. */
static int make_statue(struct pool *pool, const struct shape *s,
                       struct mesh *mesh)
{
    /* Radius, height and fluting at the knots, of a statue 1 m high. */
    static const double knot[][3] = {
        {0, 0, 0},       {.30, 0, 0},     {.30, .05, 0},    {.26, .08, 0},
        {.27, .12, .03}, {.21, .30, .10}, {.16, .45, .12},  {.14, .52, .06},
        {.19, .62, .04}, {.20, .68, .02}, {.12, .735, 0},   {.065, .76, 0},
        {.065, .79, 0},  {.10, .83, .01}, {.115, .88, .02}, {.10, .94, .02},
        {.06, .985, 0},  {0, 1, 0}};
    enum { KNOTS = sizeof knot / sizeof knot[0], BETWEEN = 5, PEDESTAL = 3 };
    double profile[(KNOTS - 1) * BETWEEN + 1][2];
    double depth[(KNOTS - 1) * BETWEEN + 1];
    int rings = (KNOTS - 1) * BETWEEN + 1;
    for (int k = 0; k < rings; k++) {
        int a = k / BETWEEN;
        double at[3][4], t = (double)(k % BETWEEN) / BETWEEN;
        for (int j = 0; j < 4; j++) {
            /* the pedestal has sharp edges: its knots do not smooth the rest */
            int from = j == 0 && a <= PEDESTAL ? a : a + j - 1;
            from = from < KNOTS ? from : KNOTS - 1;
            for (int i = 0; i < 3; i++)
                at[i][j] = knot[from][i];
        }
        profile[k][0] = s->height * spline(at[0], t);
        profile[k][1] = s->height * spline(at[1], t);
        depth[k] = spline(at[2], t);
    }
    struct lathe lathe = {rings, s->detail, profile, depth, 7};
    return turn(pool, &lathe, mesh);
}

int shape_make(struct pool *pool, const struct shape *shape, struct mesh *mesh)
{
    switch (shape->kind) {
    case SHAPE_PLANE:
        return make_plane(pool, shape, mesh);
    case SHAPE_BOX:
        return make_box(pool, shape, mesh);
    case SHAPE_SPHERE:
        return make_capsule(pool, shape, 0, 1, mesh);
    case SHAPE_CAPSULE:
        return make_capsule(pool, shape, shape->length, 1, mesh);
    case SHAPE_LIMB:
        return make_capsule(pool, shape, shape->length, limb_bands(shape),
                            mesh);
    case SHAPE_FUNNEL:
        return make_funnel(pool, shape, mesh);
    default:
        return make_statue(pool, shape, mesh);
    }
}
