/* SPDX-License-Identifier: Apache-2.0 */
/* Lifts panels whose seams would be drawn through a body:
 * app/patterns/README.md §10. */
#include "app/base/app.h"
#include "app/base/vec3.h"
#include "app/scene/sewing.h"

#include <math.h>

static const double step = 0.005; /* m */
/* How many are tried. GarmentCode places shoulder seams 3 to 4 cm below the
 * shoulders of its body; what stands 5 cm high in the way is an arm or a head,
 * and above it a seam would close on its wrong side. */
enum { STEPS = 10 };

/* The straight ways between the sides of a seam. */
struct lifting {
    const struct sewing *s;
    double up[3];        /* unit */
    int *group;          /* [cloths] the first of those that are lifted alike */
    double (*way)[2][3]; /* [ways] m, the ends of each */
    int64_t ways;
    int32_t *near; /* [nears] triangles of bodies that they may meet */
    int64_t nears;
    double lo[3], hi[3]; /* m, around the ways, as far as they are lifted */
};

/* Whether the segment from a by d meets the triangle u, v, w (Möller and
 * Trumbore 1997). */
static bool meets(const double a[3], const double d[3], const double u[3],
                  const double v[3], const double w[3])
{
    double e[3], f[3], p[3], q[3], t[3];
    vec3_subtract(v, u, e);
    vec3_subtract(w, u, f);
    vec3_subtract(a, u, t);
    vec3_cross(d, f, p);
    vec3_cross(t, e, q);
    double det = vec3_dot(e, p);
    if (det == 0)
        return false;
    double x = vec3_dot(t, p) / det, y = vec3_dot(d, q) / det;
    double at = vec3_dot(f, q) / det;
    return x >= 0 && y >= 0 && x + y <= 1 && at >= 0 && at <= 1;
}

static void widen(struct lifting *l, const double x[3])
{
    for (int i = 0; i < 3; i++) {
        double far = x[i] + STEPS * step * l->up[i];
        l->lo[i] = fmin(l->lo[i], fmin(x[i], far));
        l->hi[i] = fmax(l->hi[i], fmax(x[i], far));
    }
}

static void find_ways(struct lifting *l, const drape_seam *seam)
{
    const double(*x)[3] = (const double(*)[3])l->s->x;
    const double(*a)[3] = x + drape_first_vertex(l->s->world, seam->cloth[0]);
    const double(*b)[3] = x + drape_first_vertex(l->s->world, seam->cloth[1]);
    for (int i = 0; i < 3; i++) {
        l->lo[i] = INFINITY;
        l->hi[i] = -INFINITY;
    }
    l->ways = seam->n;
    for (int64_t p = 0; p < seam->n; p++) {
        double(*way)[3] = l->way[p];
        const double *y = b[seam->onto[p][0]], *z = b[seam->onto[p][1]];
        for (int i = 0; i < 3; i++) {
            way[0][i] = a[seam->particle[p]][i];
            way[1][i] = y[i] + seam->part[p] * (z[i] - y[i]);
        }
        widen(l, way[0]);
        widen(l, way[1]);
    }
}

static void find_near(struct lifting *l)
{
    const struct sewing *s = l->s;
    l->nears = 0;
    for (int64_t k = 0; k < s->nt; k++) {
        bool near = !s->group[k];
        for (int i = 0; i < 3 && near; i++) {
            double a = s->x[s->tri[k][0]][i], b = s->x[s->tri[k][1]][i];
            double c = s->x[s->tri[k][2]][i];
            near = fmin(a, fmin(b, c)) <= l->hi[i] &&
                   fmax(a, fmax(b, c)) >= l->lo[i];
        }
        if (near)
            l->near[l->nears++] = (int32_t)k;
    }
}

/* Counts the ways that go through a body when they are so many steps higher. */
static int64_t count_blocked(const struct lifting *l, int steps)
{
    const struct sewing *s = l->s;
    int64_t blocked = 0;
    for (int64_t k = 0; k < l->ways; k++) {
        double a[3], d[3];
        bool is = false;
        vec3_subtract(l->way[k][1], l->way[k][0], d);
        for (int i = 0; i < 3; i++)
            a[i] = l->way[k][0][i] + steps * step * l->up[i];
        for (int64_t t = 0; t < l->nears && !is; t++) {
            const int32_t *v = s->tri[l->near[t]];
            is = meets(a, d, s->x[v[0]], s->x[v[1]], s->x[v[2]]);
        }
        blocked += is;
    }
    return blocked;
}

/* The least lift at which no way of a seam is blocked, in steps; 0: there is
 * none, or none is needed. */
static int find_lift(struct lifting *l, const drape_seam *seam)
{
    find_ways(l, seam);
    find_near(l);
    for (int k = 0; k <= STEPS; k++)
        if (!count_blocked(l, k))
            return k;
    return 0;
}

/* Lifts panels a and b alike, and what goes with them. */
static void lift_alike(struct lifting *l, int a, int b, double by)
{
    double *lift = l->s->lift, most = fmax(by, fmax(lift[a], lift[b]));
    int other = l->group[b];
    for (int k = 0; k < l->s->whole.n_cloths; k++) {
        if (l->group[k] == other)
            l->group[k] = l->group[a];
        if (l->group[k] == l->group[a])
            lift[k] = most;
    }
}

/* Lifts a panel, and says so. */
static void lift(const struct lifting *l, int cloth)
{
    const struct sewing *s = l->s;
    int64_t from = drape_first_vertex(s->world, cloth);
    int64_t to = drape_first_vertex(s->world, cloth + 1);
    for (int64_t p = from; p < to; p++)
        for (int i = 0; i < 3; i++)
            s->x[p][i] += s->lift[cloth] * l->up[i];
    complain(APP_OK,
             "%s: note: panel %s is lifted by %.3g cm, as a body is in the way "
             "of its seams",
             s->scene->file, s->scene->cloth_name[cloth], 1e2 * s->lift[cloth]);
}

int lift_panels(struct sewing *s, const bool *moves)
{
    const drape_def *def = &s->whole;
    size_t cloths = (size_t)def->n_cloths, nt = (size_t)s->nt, most = 0;
    for (int k = 0; k < def->n_seams; k++)
        most = most > (size_t)def->seams[k].n ? most : (size_t)def->seams[k].n;
    struct lifting l = {.s = s,
                        .group = pool_take(&s->pool, cloths, sizeof *l.group),
                        .way = pool_take(&s->pool, most + 1, sizeof *l.way),
                        .near = pool_take(&s->pool, nt + 1, sizeof *l.near)};
    s->lift = pool_take(&s->pool, cloths, sizeof *s->lift);
    if (!l.group || !l.way || !l.near || !s->lift)
        return no_memory();
    for (int k = 0; k < def->n_cloths; k++)
        l.group[k] = k;
    for (int i = 0; i < 3; i++)
        l.up[i] = -def->gravity[i];
    if (vec3_normalise(l.up) == 0)
        return APP_OK;
    for (int k = 0; k < def->n_seams; k++) {
        const int *cloth = def->seams[k].cloth;
        int steps = s->scene->seam[k].around && moves[cloth[0]]
                        ? find_lift(&l, &def->seams[k])
                        : 0;
        if (steps)
            lift_alike(&l, cloth[0], cloth[1], steps * step);
    }
    for (int k = 0; k < def->n_cloths; k++)
        if (s->lift[k] > 0)
            lift(&l, k);
    return APP_OK;
}
