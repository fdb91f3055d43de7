/* SPDX-License-Identifier: Apache-2.0 */
/* Panels that begin within a body are moved out of it:
 * app/patterns/README.md §10. */
#include "app/base/app.h"
#include "app/base/vec3.h"
#include "app/read/apart.h"
#include "app/read/crossings.h"
#include "app/read/untangle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double farthest = 0.3; /* m, of a flat panel */
static const double step = 0.005;   /* m */
static const double layer = 0.01;   /* m, between a panel and one it pushes */
static const double even = 1e-4;    /* m, that a flat panel is off its plane */
static const double along = 0.9998; /* the cosine between what is parallel */
/* Of its extent across, which is twice the radius of a tube. So a sleeve goes
 * around a limb whose axis is within it, as the way off that limb is longer. */
static const double rolled = 0.5;
/* The last of these steps in a row is free, and so are those before it: the
 * panel stays at the middle one. */
enum { FREE = 3 };

/* A panel as it stands. */
struct sheet {
    bool flat;
    double n[3], middle[3]; /* unit; m */
    double lo[3], hi[3];    /* m, its box */
};

struct search {
    struct clearing *c;
    int32_t *part;       /* [nt] */
    bool *in;            /* [parts] it is moved now */
    bool *closed;        /* [parts] its mesh is */
    bool *left;          /* [parts] a closed body that the panel is to leave */
    double (*was)[3];    /* [nv] before */
    double (*best)[3];   /* [parts] ways of the best try */
    double (*shift)[3];  /* [parts] of this one */
    struct sheet *sheet; /* [parts] before */
    int32_t (*tri)[3], *group;
    int64_t *from; /* [nt] triangles of an audit, as they are in the mesh */
};

static void widen(double lo[3], double hi[3], const double x[3])
{
    for (int i = 0; i < 3; i++) {
        lo[i] = fmin(lo[i], x[i]);
        hi[i] = fmax(hi[i], x[i]);
    }
}

/* The box of those that are moved. */
static void find_box(const struct search *s, double lo[3], double hi[3])
{
    for (int i = 0; i < 3; i++) {
        lo[i] = INFINITY;
        hi[i] = -INFINITY;
    }
    for (int64_t k = 0; k < s->c->nt; k++)
        for (int i = 0; i < 3 && s->in[s->part[k]]; i++)
            widen(lo, hi, s->c->x[s->c->tri[k][i]]);
}

static bool is_in_box(const struct search *s, int64_t k, const double lo[3],
                      const double hi[3])
{
    const int32_t *v = s->c->tri[k];
    bool near = true;
    for (int i = 0; i < 3; i++) {
        double a = s->c->x[v[0]][i], b = s->c->x[v[1]][i], c = s->c->x[v[2]][i];
        near &= fmin(a, fmin(b, c)) <= hi[i] && fmax(a, fmax(b, c)) >= lo[i];
    }
    return near;
}

/* Finds the pairs of those that are moved with everything else; part a of a
 * pair is moved. */
static int find_pairs(struct search *s, struct crossings *pairs)
{
    const struct clearing *c = s->c;
    double lo[3], hi[3];
    int64_t nt = 0, kept = 0;
    find_box(s, lo, hi);
    for (int64_t k = 0; k < c->nt; k++) {
        bool in = s->in[s->part[k]];
        if (!in && !is_in_box(s, k, lo, hi))
            continue;
        memcpy(s->tri[nt], c->tri[k], sizeof s->tri[nt]);
        s->group[nt] = in;
        s->from[nt++] = k;
    }
    const drape_mesh mesh = {.nv = c->first[c->parts],
                             .nt = nt,
                             .x = (const double(*)[3])c->x,
                             .tri = (const int32_t(*)[3])s->tri,
                             .group = s->group,
                             .threads = c->threads};
    int status = crossings_find(&mesh, pairs);
    for (int64_t k = 0; status == APP_OK && k < pairs->found; k++) {
        int32_t a = pairs->pair[k][0], b = pairs->pair[k][1];
        if (s->group[a] && s->group[b])
            continue; /* both are moved alike */
        bool swap = !s->group[a];
        pairs->pair[kept][0] = (int32_t)s->from[swap ? b : a];
        pairs->pair[kept++][1] = (int32_t)s->from[swap ? a : b];
    }
    pairs->found = kept;
    return status;
}

static void see_panel(const struct search *s, int p, struct sheet *sheet)
{
    const struct clearing *c = s->c;
    double area = 0, off = 0;
    *sheet = (struct sheet){.lo = {INFINITY, INFINITY, INFINITY},
                            .hi = {-INFINITY, -INFINITY, -INFINITY}};
    for (int64_t k = 0; k < c->nt; k++) {
        const double *x[3];
        double u[3], v[3];
        if (s->part[k] != p)
            continue;
        for (int i = 0; i < 3; i++) {
            x[i] = c->x[c->tri[k][i]];
            widen(sheet->lo, sheet->hi, x[i]);
        }
        for (int i = 0; i < 3; i++) {
            u[i] = x[1][i] - x[0][i];
            v[i] = x[2][i] - x[0][i];
        }
        double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                       u[0] * v[1] - u[1] * v[0]};
        double size = sqrt(vec3_dot(n, n));
        area += size;
        for (int i = 0; i < 3; i++) {
            sheet->n[i] += n[i];
            sheet->middle[i] += size * (x[0][i] + x[1][i] + x[2][i]) / 3;
        }
    }
    double length = sqrt(vec3_dot(sheet->n, sheet->n));
    for (int i = 0; i < 3; i++) {
        sheet->n[i] /= length > 0 ? length : 1;
        sheet->middle[i] /= area > 0 ? area : 1;
    }
    for (int64_t k = 0; k < 3 * c->nt; k++) {
        double to[3];
        if (s->part[k / 3] != p)
            continue;
        for (int i = 0; i < 3; i++)
            to[i] = c->x[c->tri[k / 3][k % 3]][i] - sheet->middle[i];
        off = fmax(off, fabs(vec3_dot(to, sheet->n)));
    }
    sheet->flat = off < even;
}

/* Moves those that are in by a way along a direction. */
static void move(struct search *s, const double to[3], double way)
{
    const struct clearing *c = s->c;
    for (int p = 0; p < c->parts; p++) {
        if (!s->in[p])
            continue;
        for (int i = 0; i < 3; i++)
            s->shift[p][i] += way * to[i];
        for (int64_t k = c->first[p]; k < c->first[p + 1]; k++)
            for (int i = 0; i < 3; i++)
                c->x[k][i] = s->was[k][i] + s->shift[p][i];
    }
}

/* Whether panel q lies parallel in front of panel p, which goes that way. */
static bool is_before(const struct search *s, int p, int q, const double to[3])
{
    const struct sheet *a = &s->sheet[p], *b = &s->sheet[q];
    double far[3];
    bool near = true;
    for (int i = 0; i < 3; i++) {
        double by = s->shift[q][i] - s->shift[p][i];
        far[i] = b->middle[i] - a->middle[i] + by;
        near &= b->lo[i] + by <= a->hi[i] + layer &&
                b->hi[i] + by >= a->lo[i] - layer;
    }
    double ahead = vec3_dot(far, to);
    return near && a->flat && b->flat && fabs(vec3_dot(a->n, to)) > along &&
           fabs(vec3_dot(a->n, b->n)) > along && ahead > 0 && ahead <= layer;
}

/* Takes panels that lie in front of those that are moved with them. */
static void push_layers(struct search *s, const double to[3])
{
    const struct clearing *c = s->c;
    bool more = true;
    while (more) {
        more = false;
        for (int p = 0; p < c->parts; p++)
            for (int q = 0; q < c->parts && s->in[p]; q++)
                if (!s->in[q] && c->moves[q] && is_before(s, p, q, to))
                    s->in[q] = more = true;
    }
}

/* What is met: of what may move the first that is not moved yet, -1: nothing;
 * else how much that stands. */
static int meet(struct search *s, int *other, int64_t *standing)
{
    struct crossings pairs;
    int status = find_pairs(s, &pairs);
    *other = -1;
    *standing = 0;
    for (int64_t k = 0; status == APP_OK && k < pairs.found; k++) {
        int part = s->part[pairs.pair[k][1]];
        if (!s->c->moves[part])
            ++*standing;
        else if (*other < 0 || part < *other)
            *other = part;
    }
    crossings_free(&pairs);
    return status;
}

/* Whether a point is inside of a body: by the solid angle of its triangles, in
 * which those that face away count against the others (van Oosterom and
 * Strackee 1983). */
static bool is_inside(const struct search *s, int body, const double at[3])
{
    const struct clearing *c = s->c;
    double sum = 0;
    for (int64_t k = 0; k < c->nt; k++) {
        double to[3][3], far[3], n[3];
        if (s->part[k] != body)
            continue;
        for (int i = 0; i < 9; i++)
            to[i / 3][i % 3] = c->x[c->tri[k][i / 3]][i % 3] - at[i % 3];
        for (int i = 0; i < 3; i++) {
            far[i] = sqrt(vec3_dot(to[i], to[i]));
            n[i] = to[1][(i + 1) % 3] * to[2][(i + 2) % 3] -
                   to[1][(i + 2) % 3] * to[2][(i + 1) % 3];
        }
        sum +=
            2 * atan2(vec3_dot(to[0], n), far[0] * far[1] * far[2] +
                                              vec3_dot(to[0], to[1]) * far[2] +
                                              vec3_dot(to[1], to[2]) * far[0] +
                                              vec3_dot(to[2], to[0]) * far[1]);
    }
    return fabs(sum) > 2 * acos(-1);
}

/* Whether what is moved, and intersects nothing, is inside of a body that the
 * panel is to leave: then so is any of its points. */
static bool is_within(const struct search *s)
{
    const struct clearing *c = s->c;
    bool within = false;
    int seen = -1;
    for (int64_t k = 0; k < c->nt && !within; k++) {
        int p = s->part[k];
        if (p == seen || !s->in[p])
            continue;
        seen = p;
        for (int body = 0; body < c->parts; body++)
            within |= s->left[body] && is_inside(s, body, c->x[c->tri[k][0]]);
    }
    return within;
}

/* Tries a direction for panel p, no farther than `most`. *way: how far it goes;
 * INFINITY: it does not. */
static int try_way(struct search *s, int p, const double to[3], double most,
                   double *way)
{
    const struct clearing *c = s->c;
    int status = APP_OK, other, free = 0;
    int64_t standing;
    *way = INFINITY;
    memset(s->in, 0, (size_t)c->parts * sizeof *s->in);
    memset(s->shift, 0, (size_t)c->parts * sizeof *s->shift);
    s->in[p] = true;
    for (int k = 1; status == APP_OK && (k - 1) * step < most; k++) {
        push_layers(s, to);
        move(s, to, step);
        status = meet(s, &other, &standing);
        if (other >= 0) { /* it is taken along from before they were near */
            int back = k > 1 ? 2 : 1;
            move(s, to, -back * step);
            s->in[other] = true;
            k -= back;
            free = 0;
            continue;
        }
        free = standing || is_within(s) ? 0 : free + 1;
        if (free == FREE) {
            move(s, to, -step);
            *way = (k - 1) * step;
            break;
        }
    }
    memcpy(c->x, s->was, (size_t)c->first[c->parts] * sizeof *c->x);
    return status;
}

/* Moves panel p. *found: there is a way. */
static int clear(struct search *s, int p, bool *found)
{
    struct clearing *c = s->c;
    const struct sheet *sheet = &s->sheet[p];
    size_t parts = (size_t)c->parts;
    double most = farthest, way;
    int status = APP_OK;
    *found = false;
    memcpy(s->was, c->x, (size_t)c->first[parts] * sizeof *c->x);
    for (int q = 0; q < c->parts; q++)
        see_panel(s, q, &s->sheet[q]);
    int ways = sheet->flat ? 2 : 27;
    for (int k = 0; k < ways && status == APP_OK; k++) {
        double to[3], far = most;
        int sign = k ? -1 : 1;
        int digit[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        double length = sqrt(abs(digit[0]) + abs(digit[1]) + abs(digit[2]));
        if (!sheet->flat && length == 0)
            continue;
        for (int i = 0; i < 3; i++)
            to[i] = sheet->flat ? sign * sheet->n[i] : digit[i] / length;
        for (int i = 0; i < 3 && !sheet->flat; i++)
            if (digit[i])
                far = fmin(far, rolled * (sheet->hi[i] - sheet->lo[i]));
        status = try_way(s, p, to, far, &way);
        if (!*found)
            c->place.tried = fmax(c->place.tried, far);
        if (way > most || (*found && way == most))
            continue;
        *found = true;
        most = way;
        memcpy(s->best, s->shift, parts * sizeof *s->best);
    }
    if (status != APP_OK || !*found)
        return status;
    for (int q = 0; q < c->parts; q++) {
        if (vec3_dot(s->best[q], s->best[q]) == 0)
            continue;
        c->by[q] = p;
        for (int i = 0; i < 3; i++)
            c->way[q][i] += s->best[q][i];
        for (int64_t k = c->first[q]; k < c->first[q + 1]; k++)
            for (int i = 0; i < 3; i++)
                c->x[k][i] += s->best[q][i];
    }
    return APP_OK;
}

/* Finds the first panel that is in what stands, and where; -1: none is. */
static int find_panel(struct search *s, int *panel, struct clear_place *place)
{
    const struct clearing *c = s->c;
    struct crossings pairs;
    double lo[3] = {INFINITY, INFINITY, INFINITY};
    double hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    *panel = -1;
    *place = (struct clear_place){0};
    memcpy(s->in, c->moves, (size_t)c->parts * sizeof *s->in);
    memset(s->left, 0, (size_t)c->parts * sizeof *s->left);
    int status = find_pairs(s, &pairs);
    for (int64_t k = 0; status == APP_OK && k < pairs.found; k++) {
        int part = s->part[pairs.pair[k][0]];
        *panel = *panel < 0 || part < *panel ? part : *panel;
    }
    for (int64_t k = 0; status == APP_OK && k < pairs.found; k++) {
        const int32_t *pair = pairs.pair[k];
        if (s->part[pair[0]] != *panel)
            continue;
        int body = s->part[pair[1]];
        s->left[body] = s->closed[body];
        place->body =
            !place->pairs++ || body < place->body ? body : place->body;
        for (int i = 0; i < 3; i++)
            widen(lo, hi, c->x[c->tri[pair[0]][i]]);
    }
    for (int i = 0; i < 3 && *panel >= 0; i++) {
        place->at[i] = (lo[i] + hi[i]) / 2;
        place->size = fmax(place->size, hi[i] - lo[i]);
    }
    crossings_free(&pairs);
    return status;
}

int clear_panels(struct clearing *clearing)
{
    struct clearing *c = clearing;
    size_t nt = (size_t)c->nt + 1, parts = (size_t)c->parts;
    size_t nv = (size_t)c->first[parts] + 1;
    struct search s = {.c = c,
                       .part = pool_take(c->pool, nt, sizeof *s.part),
                       .in = pool_take(c->pool, parts, sizeof *s.in),
                       .closed = pool_take(c->pool, parts, sizeof *s.closed),
                       .left = pool_take(c->pool, parts, sizeof *s.left),
                       .was = pool_take(c->pool, nv, sizeof *s.was),
                       .best = pool_take(c->pool, parts, sizeof *s.best),
                       .shift = pool_take(c->pool, parts, sizeof *s.shift),
                       .sheet = pool_take(c->pool, parts, sizeof *s.sheet),
                       .tri = pool_take(c->pool, nt, sizeof *s.tri),
                       .group = pool_take(c->pool, nt, sizeof *s.group),
                       .from = pool_take(c->pool, nt, sizeof *s.from)};
    c->way = pool_take(c->pool, parts, sizeof *c->way);
    c->by = pool_take(c->pool, parts, sizeof *c->by);
    if (!s.part || !s.in || !s.closed || !s.left || !s.was || !s.best ||
        !s.shift || !s.sheet || !s.tri || !s.group || !s.from || !c->way ||
        !c->by)
        return no_memory();
    for (int64_t k = 0; k < c->nt; k++)
        while (c->tri[k][0] >= c->first[s.part[k] + 1])
            s.part[k]++;
    int64_t from = 0, to = 0;
    for (int p = 0; p < c->parts; p++, from = to) {
        c->by[p] = -1;
        while (to < c->nt && s.part[to] == p)
            to++;
        struct mesh mesh = {0, to - from, c->x, (int32_t(*)[3])c->tri + from};
        int closed = !c->moves[p] && to > from ? apart_closed(&mesh) : 0;
        if (closed < 0)
            return no_memory();
        s.closed[p] = closed;
    }
    int status = APP_OK;
    /* one that was moved may be pushed into a body by another */
    for (int round = 0; round <= 2 * c->parts && status == APP_OK; round++) {
        bool found = false;
        status = find_panel(&s, &c->stuck, &c->place);
        if (status != APP_OK || c->stuck < 0)
            break;
        status = clear(&s, c->stuck, &found);
        if (!found)
            break;
    }
    return status;
}
