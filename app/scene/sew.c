/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a cloth's start, holes, cuts and pins from their descriptions. */
#include "app/base/app.h"
#include "app/base/vec3.h"
#include "app/scene/cloth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool inside(const struct region *region, double x, double y)
{
    const double *d = region->disc, *r = region->rect;
    double a = x - d[0], b = y - d[1];
    if (d[2] >= 0 && a * a + b * b <= d[2] * d[2])
        return true;
    return x >= r[0] && x <= r[2] && y >= r[1] && y <= r[3];
}

/* A range of grid points along an axis that includes all points of a region,
 * and maybe a few more. side: of a cell, m; axis: 0 or 1. */
struct span {
    int64_t from, to;
};

static struct span find_span(const struct region *region, int axis, double side,
                             int64_t points)
{
    const double *d = region->disc, *r = region->rect;
    double lo = r[2] >= 0 ? r[axis] : INFINITY, hi = r[axis + 2];
    if (d[2] >= 0) {
        lo = fmin(lo, d[axis] - d[2]);
        hi = fmax(hi, d[axis] + d[2]);
    }
    return (struct span){
        (int64_t)fmax(floor(lo / side) - 2, 0),
        (int64_t)fmin(ceil(hi / side) + 2, (double)points - 1)};
}

/* Marks the points of a region in a map of m × n points, which start at half a
 * cell times `shift`, and returns their number. */
static int64_t mark(const struct region *region, const drape_cloth *c,
                    int shift, uint8_t *map)
{
    int64_t m = c->m - shift, n = c->n - shift, count = 0;
    double h = c->width / (c->m - 1), g = c->height / (c->n - 1);
    struct span u = find_span(region, 0, h, m);
    struct span v = find_span(region, 1, g, n);
    for (int64_t j = v.from; j <= v.to; j++)
        for (int64_t i = u.from; i <= u.to; i++)
            if (inside(region, ((double)i + 0.5 * shift) * h,
                       ((double)j + 0.5 * shift) * g)) {
                map[i + m * j] = 1;
                count++;
            }
    return count;
}

/* Makes the map of a cloth's holes (shift 0) or cuts (shift 1). A region that
 * takes nothing away is refused: it is too small for the cells, or misplaced.
 */
static int mark_all(struct json *json, const struct regions *regions,
                    const drape_cloth *c, int shift, const uint8_t **out)
{
    if (!regions->count)
        return APP_OK;
    size_t points = (size_t)(c->m - shift) * (size_t)(c->n - shift);
    uint8_t *map = pool_take(json->pool, points, 1);
    if (!map)
        return complain(APP_FAILED, "out of memory");
    for (int k = 0; k < regions->count; k++)
        if (!mark(&regions->list[k], c, shift, map))
            return json_refuse(json,
                               "%s[%d] takes nothing away: it holds no %s; "
                               "cells are %g m × %g m",
                               shift ? "cuts" : "holes", k,
                               shift ? "middle of a cell" : "particle",
                               c->width / (c->m - 1), c->height / (c->n - 1));
    *out = map;
    return APP_OK;
}

/* Assigns the particles of a panel that pin p names to pin p: those on an edge
 * of the outline, or the nearest to a place. */
static void mark_panel_pin(const struct pin *pin, int p,
                           const struct cloth *cloth, int *owner)
{
    const struct cloth_panel *panel = cloth->panel;
    int64_t count = (int64_t)cloth->out.m * cloth->out.n, nearest = 0;
    double least = INFINITY;
    for (int64_t k = 0; k < count; k++) {
        double a = panel->panel.rest[k][0] - pin->at[0];
        double b = panel->panel.rest[k][1] - pin->at[1];
        bool on = pin->outline >= 0 && (panel->edge[k][0] == pin->outline ||
                                        panel->edge[k][1] == pin->outline);
        if (panel->there[k] && on)
            owner[k] = p;
        if (panel->there[k] && a * a + b * b < least) {
            least = a * a + b * b;
            nearest = k;
        }
    }
    if (pin->outline < 0)
        owner[nearest] = p;
}

/* Assigns the particles of pin p's edge or place to pin p. */
static void mark_pin(const struct pin *pin, int p, const drape_cloth *c,
                     int *owner)
{
    double h = c->width / (c->m - 1), g = c->height / (c->n - 1);
    bool column = pin->edge < 2;
    if (pin->edge < 0) {
        double i = fmin(floor(pin->at[0] / h + 0.5), c->m - 1);
        double j = fmin(floor(pin->at[1] / g + 0.5), c->n - 1);
        owner[(int64_t)i + c->m * (int64_t)j] = p;
        return;
    }
    int last = (column ? c->n : c->m) - 1;
    int across = pin->edge % 2 ? (column ? c->m : c->n) - 1 : 0;
    double every = floor(pin->every / (column ? g : h) + 0.5);
    for (int k = 0; k <= last; k++)
        if (every < 2 || fmod(k, every) == 0 || k == last)
            owner[column ? across + (int64_t)c->m * k
                         : k + (int64_t)c->m * across] = p;
}

/* Makes a pin for each pinned particle; the first pin that includes a particle
 * gets it. */
static int make_pins(struct pool *pool, struct cloth *cloth)
{
    drape_cloth *c = &cloth->out;
    int64_t particles = (int64_t)c->m * c->n, count = 0;
    int *owner = malloc((size_t)particles * sizeof *owner);
    if (!owner)
        return complain(APP_FAILED, "out of memory");
    for (int64_t k = 0; k < particles; k++)
        owner[k] = -1;
    for (int p = cloth->n_pins; p-- > 0;)
        if (cloth->panel)
            mark_panel_pin(&cloth->pins[p], p, cloth, owner);
        else
            mark_pin(&cloth->pins[p], p, c, owner);
    for (int64_t k = 0; k < particles; k++)
        count += owner[k] >= 0;
    drape_pin *pins = pool_take(pool, (size_t)count + 1, sizeof *pins);
    cloth->pin_from = pool_take(pool, (size_t)count + 1, sizeof(int));
    c->pins = pins;
    c->n_pins = 0;
    for (int64_t k = 0; pins && cloth->pin_from && k < particles; k++) {
        if (owner[k] < 0)
            continue;
        cloth->pin_from[c->n_pins] = owner[k];
        pins[c->n_pins++] = (drape_pin){(int)(k % c->m), (int)(k / c->m),
                                        cloth->pins[owner[k]].motion};
    }
    free(owner);
    return pins && cloth->pin_from ? APP_OK
                                   : complain(APP_FAILED, "out of memory");
}

/* Makes unit axes, with v orthogonal to u. */
static int make_axes(struct json *json, struct cloth *cloth)
{
    double *u = cloth->start.u, *v = cloth->start.v;
    double n = square_root(vec3_dot(u, u));
    for (int i = 0; i < 3 && n > 0; i++)
        u[i] /= n;
    double along = vec3_dot(u, v);
    for (int i = 0; i < 3; i++)
        v[i] -= along * u[i];
    double l = square_root(vec3_dot(v, v));
    if (!(n > 0 && l > 1e-6 * n))
        return json_refuse(json, "start: u and v must be two directions");
    for (int i = 0; i < 3; i++) {
        v[i] /= l;
        cloth->out.u[i] = u[i];
        cloth->out.v[i] = v[i];
    }
    return APP_OK;
}

static void make_flat(struct cloth *cloth)
{
    drape_cloth *c = &cloth->out;
    /* a hung cloth is placed by the middle of its edge v0 */
    double down = cloth->start.shape == START_HUNG ? 0 : 0.5;
    for (int i = 0; i < 3; i++)
        c->origin[i] = cloth->start.at[i] - 0.5 * c->width * c->u[i] -
                       down * c->height * c->v[i];
}

/* Places the rows along a curve: folds if hung, a spiral if rolled. */
static int make_curved(struct json *json, struct cloth *cloth)
{
    drape_cloth *c = &cloth->out;
    const struct start *s = &cloth->start;
    size_t m = (size_t)c->m, n = (size_t)c->n;
    double(*curve)[2] = pool_take(json->pool, m, sizeof *curve);
    double(*x)[3] = pool_take(json->pool, m * n, sizeof *x);
    if (!curve || !x)
        return complain(APP_FAILED, "out of memory");
    if (!start_curve(s, c->m, c->width / (c->m - 1), curve))
        return json_refuse(json, "start: the cloth is too coarse or too "
                                 "narrow for such a curve");
    double w[3], cell = c->height / (c->n - 1);
    double from = s->shape == START_HUNG ? 0 : -0.5 * c->height;
    for (int i = 0; i < 3; i++)
        w[i] = c->u[(i + 1) % 3] * c->v[(i + 2) % 3] -
               c->u[(i + 2) % 3] * c->v[(i + 1) % 3];
    for (size_t k = 0; k < m * n; k++) {
        const double *p = curve[k % m];
        double down = from + cell * (double)(k / m);
        for (int i = 0; i < 3; i++)
            x[k][i] = s->at[i] + p[0] * c->u[i] + p[1] * w[i] + down * c->v[i];
    }
    c->x = (const double(*)[3])x;
    return APP_OK;
}

static int make_velocity(struct pool *pool, struct cloth *cloth)
{
    const double *v = cloth->velocity;
    if (v[0] == 0 && v[1] == 0 && v[2] == 0)
        return APP_OK;
    size_t count = (size_t)cloth->out.m * (size_t)cloth->out.n;
    double(*out)[3] = pool_take(pool, count, sizeof *out);
    if (!out)
        return complain(APP_FAILED, "out of memory");
    for (size_t k = 0; k < count; k++)
        memcpy(out[k], v, sizeof out[k]);
    cloth->out.velocity = (const double(*)[3])out;
    return APP_OK;
}

int cloth_sew(struct json *json, struct cloth *cloth)
{
    int status = make_axes(json, cloth);
    if (status != APP_OK)
        return status;
    drape_cloth *c = &cloth->out;
    if (cloth->panel)
        c->panel = &cloth->panel->panel;
    status = mark_all(json, &cloth->holes, c, 0, &c->hole);
    if (status == APP_OK)
        status = mark_all(json, &cloth->cuts, c, 1, &c->cut);
    if (status != APP_OK)
        return status;
    const struct start *s = &cloth->start;
    bool folded = s->shape == START_HUNG && s->folds > 0 && s->depth > 0;
    if (folded || s->shape == START_ROLLED)
        status = make_curved(json, cloth);
    else
        make_flat(cloth);
    if (status == APP_OK)
        status = make_velocity(json->pool, cloth);
    if (status != APP_OK || !cloth->n_pins)
        return status;
    return make_pins(json->pool, cloth);
}
