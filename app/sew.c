/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth's start, holes, cuts and pins from their descriptions. */
#include "app/app.h"
#include "app/cloth.h"

#include <string.h>

static bool inside(const struct regions *regions, double x, double y)
{
    for (int k = 0; k < regions->count; k++) {
        const double *d = regions->list[k].disc, *r = regions->list[k].rect;
        double a = x - d[0], b = y - d[1];
        if (d[2] >= 0 && a * a + b * b <= d[2] * d[2])
            return true;
        if (x >= r[0] && x <= r[2] && y >= r[1] && y <= r[3])
            return true;
    }
    return false;
}

/* A map of m × n points that begin at half a cell times `shift`. */
static const uint8_t *mark(struct pool *pool, const struct regions *regions,
                           const drape_cloth *c, int shift)
{
    size_t m = (size_t)(c->m - shift), n = (size_t)(c->n - shift);
    double h = c->width / (c->m - 1), g = c->height / (c->n - 1);
    uint8_t *map = pool_take(pool, m * n, 1);
    for (size_t k = 0; map && k < m * n; k++)
        map[k] = inside(regions, ((double)(k % m) + 0.5 * shift) * h,
                        ((double)(k / m) + 0.5 * shift) * g);
    return map;
}

/* The nearest whole number, of which only that it is large matters where it
 * is: far more than a cloth has particles. */
static int nearest(double a)
{
    const int far = 1 << 24;
    return a > -1 ? (int)((a < far ? a : far) + 0.5) : -1;
}

/* Whether particle i, j belongs to the pin's edge or place. */
static bool pinned(const struct pin *pin, const drape_cloth *c, int i, int j)
{
    double h = c->width / (c->m - 1), g = c->height / (c->n - 1);
    if (pin->edge < 0)
        return i == nearest(pin->at[0] / h) && j == nearest(pin->at[1] / g);
    const int end[4] = {i == 0, i == c->m - 1, j == 0, j == c->n - 1};
    if (!end[pin->edge])
        return false;
    double cell = pin->edge < 2 ? g : h;
    int along = pin->edge < 2 ? j : i, last = pin->edge < 2 ? c->n : c->m;
    int every = nearest(pin->every / cell);
    return every < 2 || along % every == 0 || along == last - 1;
}

/* Particles of the border and of single places, each once. */
static int make_pins(struct pool *pool, struct cloth *cloth)
{
    drape_cloth *c = &cloth->out;
    int count = 0;
    for (int pass = 0; pass < 2; pass++) {
        drape_pin *pins = pool_take(pool, (size_t)count + 1, sizeof *pins);
        if (!pins)
            return complain(APP_FAILED, "out of memory");
        c->pins = pins;
        c->n_pins = count;
        count = 0;
        for (int64_t k = 0; k < (int64_t)c->m * c->n; k++) {
            int i = (int)(k % c->m), j = (int)(k / c->m), p = 0;
            while (p < cloth->n_pins && !pinned(&cloth->pins[p], c, i, j))
                p++;
            if (p == cloth->n_pins || (c->hole && c->hole[k]))
                continue;
            if (pass)
                pins[count] = (drape_pin){i, j, cloth->pins[p].motion};
            count++;
        }
    }
    return APP_OK;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Unit axes, v square to u. */
static int make_axes(struct json *json, struct cloth *cloth)
{
    double *u = cloth->start.u, *v = cloth->start.v;
    double n = square_root(dot(u, u));
    for (int i = 0; i < 3 && n > 0; i++)
        u[i] /= n;
    double along = dot(u, v);
    for (int i = 0; i < 3; i++)
        v[i] -= along * u[i];
    double l = square_root(dot(v, v));
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
    /* A hung cloth is held by the middle of its edge v0. */
    double down = cloth->start.shape == START_HUNG ? 0 : 0.5;
    for (int i = 0; i < 3; i++)
        c->origin[i] = cloth->start.at[i] - 0.5 * c->width * c->u[i] -
                       down * c->height * c->v[i];
}

/* Rows along a curve: folded when hung, a spiral when rolled. */
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
    if (cloth->holes.count)
        c->hole = mark(json->pool, &cloth->holes, c, 0);
    if (cloth->cuts.count)
        c->cut = mark(json->pool, &cloth->cuts, c, 1);
    if ((cloth->holes.count && !c->hole) || (cloth->cuts.count && !c->cut))
        return complain(APP_FAILED, "out of memory");
    const struct start *s = &cloth->start;
    bool folded = s->shape == START_HUNG && s->folds > 0 && s->depth > 0;
    if (folded || s->shape == START_ROLLED)
        status = make_curved(json, cloth);
    else
        make_flat(cloth);
    if (status == APP_OK)
        status = make_velocity(json->pool, cloth);
    return status == APP_OK ? make_pins(json->pool, cloth) : status;
}
