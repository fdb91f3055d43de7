/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth with its streams, stepped without contact. tests/cloth/sheet.h */
#include "tests/cloth/sheet.h"

#include <stdlib.h>

#include "ref/base/sum.h"
#include "ref/cloth/energy.h"
#include "ref/cloth/implicit.h"
#include "ref/cloth/law.h"
#include "ref/cloth/motion.h"
#include "ref/cloth/springs.h"
#include "ref/cloth/triple.h"

drape_cloth sheet_default(int m, int n)
{
    drape_cloth d = {.m = m, .n = n, .width = 1, .height = 1};
    d.material = (drape_material){.density = 0.2,
                                  .stretch = 100,
                                  .shear = 30,
                                  .bend = 1e-4,
                                  .thickness = 1e-3};
    d.u[0] = d.v[1] = 1;
    return d;
}

static void *need(struct sheet *s, int64_t count, size_t size)
{
    void *p = calloc((size_t)count + 1, size);
    if (!p)
        abort();
    s->memory[s->n_memory++] = p;
    return p;
}

int sheet_make(struct sheet *s, const drape_cloth *def, int method)
{
    *s = (struct sheet){0};
    int status = ref_cloth_size(def, &s->c);
    if (status != DRAPE_OK)
        return status;
    int64_t n = s->c.count;
    s->c.cell = need(s, n, 1);
    s->c.springs = need(s, n, 1);
    s->c.beside = need(s, n, 1);
    s->c.fixed = need(s, n, 1);
    s->c.mass = need(s, n, sizeof(real));
    s->c.tri = need(s, s->c.n_triangles, sizeof *s->c.tri);
    s->x = need(s, n, sizeof(vec));
    s->v = need(s, n, sizeof(vec));
    s->xp = need(s, n, sizeof(vec));
    s->vp = need(s, n, sizeof(vec));
    s->to = need(s, n, sizeof(vec));
    s->dense = need(s, 15 * n, sizeof(double));
    s->d = (struct dynamics){.method = method,
                             .dt = 1.0 / 60,
                             .max_substeps = 1 << 20,
                             .solve = sheet_solve,
                             .solver = s,
                             .wind = need(s, n, sizeof(vec)),
                             .gust = need(s, 2 * n, sizeof(vec)),
                             .resist = need(s, 2 * n, sizeof(real)),
                             .inertia = need(s, n, sizeof(real)),
                             .work = need(s, 6 * n, sizeof(vec)),
                             .block = need(s, SPRINGS * n, sizeof(sym)),
                             .chunk = need(s, 3 * sum_chunks(n), sizeof(real)),
                             .x1 = need(s, n, sizeof(vec)),
                             .v1 = need(s, n, sizeof(vec))};
    if (method == DRAPE_BDF2) {
        s->d.newton = 64;
        s->d.tolerance = REAL_BITS == 32 ? R(1e-4) : R(1e-12);
        s->d.kept = need(s, 2 * n, sizeof(vec));
    }
    status = ref_cloth_fill(def, &s->c, 0);
    if (status == DRAPE_OK)
        status = ref_cloth_start(def, s->x, s->v);
    memcpy(s->to, s->x, (size_t)n * sizeof(vec));
    return status;
}

void sheet_free(struct sheet *s)
{
    for (int k = 0; k < s->n_memory; k++)
        free(s->memory[k]);
}

int sheet_step(struct sheet *s)
{
    struct dynamics *d = &s->d;
    size_t bytes = (size_t)s->c.count * sizeof(vec);
    d->cloth = &s->c;
    d->x = s->x;
    d->v = s->v;
    d->xp = s->xp;
    d->vp = s->vp;
    d->to = s->to;
    int status = motion_run(d);
    if (status != DRAPE_OK || d->outcome & DRAPE_DIVERGED)
        return status;
    memcpy(s->xp, s->x, bytes);
    memcpy(s->vp, s->v, bytes);
    memcpy(s->x, d->x1, bytes);
    memcpy(s->v, d->v1, bytes);
    d->has_past = 1;
    return status;
}

/* y = (dynamics_mass + Σ blocks) z for free particles, 0 for the others. */
static void multiply(const struct dynamics *d, const double *z, double *y)
{
    const struct cloth *c = d->cloth;
    for (int64_t k = 0; k < 3 * c->count; k++)
        y[k] = (double)dynamics_mass(d)[k / 3] * z[k];
    for (int64_t k = 0; k < SPRINGS * c->count; k++) {
        int64_t o = k / c->count, p = k % c->count;
        if (!(c->springs[p] >> o & 1))
            continue;
        int64_t q = p + spring_di[o] + (int64_t)spring_dj[o] * c->m;
        const sym *a = &d->block[k];
        double dx = z[3 * p] - z[3 * q], dy = z[3 * p + 1] - z[3 * q + 1];
        double dz = z[3 * p + 2] - z[3 * q + 2];
        double f[3] = {
            (double)a->xx * dx + (double)a->xy * dy + (double)a->xz * dz,
            (double)a->xy * dx + (double)a->yy * dy + (double)a->yz * dz,
            (double)a->xz * dx + (double)a->yz * dy + (double)a->zz * dz};
        for (int e = 0; e < 3; e++) {
            y[3 * p + e] += f[e];
            y[3 * q + e] -= f[e];
        }
    }
    for (int64_t k = 0; k < 3 * c->count; k++)
        if (c->fixed[k / 3])
            y[k] = 0;
}

static double inner(int64_t n, const double *a, const double *b)
{
    double s = 0;
    for (int64_t k = 0; k < n; k++)
        s += a[k] * b[k];
    return s;
}

int sheet_solve(struct dynamics *d)
{
    struct sheet *s = d->solver;
    int64_t n = 3 * s->c.count;
    double *z = s->dense, *r = z + n, *p = r + n, *ap = p + n;
    const real *b = &d->b[0].x;
    for (int64_t k = 0; k < n; k++) {
        z[k] = 0;
        p[k] = r[k] = (double)b[k];
    }
    double rr = inner(n, r, r), least = rr * 1e-26;
    for (int it = 0; it < 2000 && rr > least; it++) {
        multiply(d, p, ap);
        double a = rr / inner(n, p, ap), before = rr;
        for (int64_t k = 0; k < n; k++) {
            z[k] += a * p[k];
            r[k] -= a * ap[k];
        }
        rr = inner(n, r, r);
        for (int64_t k = 0; k < n; k++)
            p[k] = r[k] + rr / before * p[k];
        d->iterations++;
    }
    real *dv = &d->dv[0].x;
    for (int64_t k = 0; k < n; k++)
        dv[k] = (real)z[k];
    return DRAPE_OK;
}

void sheet_force(const struct sheet *s, const vec *x, const vec *v, vec *f)
{
    const struct cloth *c = &s->c;
    struct springs a = {.m = c->m,
                        .n = c->n,
                        .count = c->count,
                        .laws = SPRINGS,
                        .law = c->law,
                        .pieces = c->pieces,
                        .piece = c->piece,
                        .springs = c->springs,
                        .triples = c->triples,
                        .triple = c->triple,
                        .n_beside = c->triples ? c->count : 0,
                        .beside = c->beside,
                        .mass = c->mass,
                        .x = x,
                        .n_v = c->count,
                        .v = v,
                        .gravity = s->d.gravity,
                        .force = f};
    ref_springs(&a);
}

void sheet_energy(const struct sheet *s, const vec *x, const vec *v,
                  double energy[3])
{
    const struct cloth *c = &s->c;
    struct energy e = {.count = c->count,
                       .m = c->m,
                       .laws = SPRINGS,
                       .law = c->law,
                       .pieces = c->pieces,
                       .piece = c->piece,
                       .springs = c->springs,
                       .triples = c->triples,
                       .triple = c->triple,
                       .n_beside = c->triples ? c->count : 0,
                       .beside = c->beside,
                       .mass = c->mass,
                       .x = x,
                       .v = v,
                       .gravity = s->d.gravity,
                       .n_chunks = sum_chunks(c->count),
                       .chunk = s->d.chunk};
    ref_energy(&e);
    for (int k = 0; k < 3; k++)
        energy[k] = (double)e.value[k];
}

/* Half the angle of the arc: a in [0, π] with sin(a) / a = q, by bisection. */
static double half_angle(double q)
{
    double lo = 0, hi = 3.1415926535897932;
    for (int k = 0; k < 60; k++) {
        double mid = (lo + hi) / 2;
        if (sin(mid) > q * mid)
            lo = mid;
        else
            hi = mid;
    }
    return lo;
}

/* The buckling force -f_b of Choi–Ko divided by bend: 4a² / (sin(a)/a - cos a).
 * Near q = 1 the difference cancels, so its series is used: 12 + 36/5 (1 - q) +
 * O((1 - q)²). */
static double arc_force(double q)
{
    if (1 - q < 1e-4)
        return 12 + 7.2 * (1 - q);
    double a = half_angle(q);
    return 4 * a * a / (q - cos(a));
}

static bool is_buckled(const struct law *a, double length)
{
    double rest = (double)a->rest,
           line = (double)a->compression * (length - rest);
    return a->knee > 0 && length < rest &&
           line < -(double)a->bend * arc_force(length / rest);
}

static double constant(const struct law *a, double length)
{
    return (double)(length < (double)a->rest ? a->compression : a->k);
}

/* cloth.md §8: the law of a stiffened spring as polynomials of the pieces. */
struct more {
    double tension, slope, energy;
};

static struct more more_of(const struct law *a, double length)
{
    double e = length - (double)a->limit, w = (double)a->over;
    double gain = (double)a->gain, g = e - w;
    if (!(e > 0))
        return (struct more){0, 0, 0};
    if (e <= w)
        return (struct more){gain * e * e, 2 * gain * e, gain * e * e * e / 3};
    return (struct more){gain * (w * w + 2 * w * g), 2 * gain * w,
                         gain * (w * w * w / 3 + w * w * g + w * g * g)};
}

/* cloth.md §9: what holds above the rest length without a limit, as polynomials
 * of the pieces; without pieces the constant. */
static struct more straight(const struct law *a, const struct piece *t,
                            double length)
{
    double rest = (double)a->rest, k = constant(a, length), d = length - rest;
    struct more sum = {k * d, k, k * d * d / 2};
    double from = rest, pull = 0, work = 0;
    if (!a->pieces || !(d > 0))
        return sum;
    for (int i = 0; i < a->pieces; i++) {
        double slope = (double)t[a->first + i].slope, to = INFINITY;
        if (i + 1 < a->pieces)
            to = (double)t[a->first + i + 1].from;
        double e = (length < to ? length : to) - from;
        sum = (struct more){pull + slope * e, slope,
                            work + pull * e + slope * e * e / 2};
        if (length <= to)
            break;
        from = to;
        pull = sum.tension;
        work = sum.energy;
    }
    return sum;
}

double law_oracle(const struct law *a, const struct piece *t, double length)
{
    if (is_buckled(a, length))
        return -(double)a->bend * arc_force(length / (double)a->rest);
    return straight(a, t, length).tension + more_of(a, length).tension;
}

double law_oracle_slope(const struct law *a, const struct piece *t,
                        double length)
{
    double q = length / (double)a->rest;
    if (!is_buckled(a, length))
        return straight(a, t, length).slope + more_of(a, length).slope;
    if (1 - q < 1e-4)
        return 7.2 * (double)a->bend / (double)a->rest;
    double b = half_angle(q), h = q - cos(b), db = -b / h;
    double drop = 4 * b * (b * (1 + sin(b) * db) - 2 * db * h) / (h * h);
    return (double)a->bend * drop / (double)a->rest;
}

double law_oracle_energy(const struct law *a, const struct piece *t,
                         double length)
{
    double rest = (double)a->rest;
    if (!is_buckled(a, length))
        return straight(a, t, length).energy + more_of(a, length).energy;
    double knee = (double)a->knee, angle = half_angle(length / rest);
    double start = half_angle(knee / rest), e = knee - rest;
    return (double)a->compression * e * e / 2 +
           2 * (double)a->bend * rest * (angle * angle - start * start);
}

static struct law pick_law(struct bytes *b, int o)
{
    struct law a = {.rest = pick_uniform(b, R(0.01), R(0.1))};
    a.k = pick_uniform(b, 1, 1000);
    a.damp = pick(b, 2) ? 0 : pick_uniform(b, 0, 1);
    a.compression = o < SPRINGS_SINGLE ? a.k : pick_uniform(b, 1, 3) * a.k;
    a.stiff = 3 * a.k;
    if (o < SPRINGS_SINGLE)
        return a;
    a.bend = pick(b, 4) ? pick_uniform(b, 0, R(0.01)) * a.k * a.rest : 0;
    return a;
}

struct grid pick_grid(struct bytes *b)
{
    struct grid g = {0};
    int64_t size = for_bench(b) ? 1 << 20 : pick_size(b);
    g.m = for_bench(b) ? 1024 : 1 + (int32_t)pick(b, 40);
    g.n = (int32_t)(size / g.m);
    g.count = (int64_t)g.m * g.n;
    g.law = take(b, SPRINGS, sizeof *g.law);
    g.springs = take(b, g.count, 1);
    g.cell = take(b, g.count, 1);
    g.fixed = take(b, g.count, 1);
    g.mass = take(b, g.count, sizeof *g.mass);
    for (int o = 0; o < SPRINGS; o++) {
        g.law[o] = pick_law(b, o);
        law_set_knee(&g.law[o], o >= SPRINGS_SINGLE);
        law_set_limit(&g.law[o], 0);
    }
    bool whole = for_bench(b) || pick(b, 2);
    for (int64_t p = 0; p < g.count; p++) {
        int32_t i = (int32_t)(p % g.m), j = (int32_t)(p / g.m);
        int mask = 0;
        for (int o = 0; o < SPRINGS; o++) {
            int32_t x = i + spring_di[o], y = j + spring_dj[o];
            mask |= (x >= 0 && x < g.m && y < g.n) << o;
        }
        g.springs[p] = (uint8_t)(mask & (whole ? 255 : (int)pick(b, 256)));
        g.cell[p] = i + 1 < g.m && j + 1 < g.n && (whole || pick(b, 4));
        g.fixed[p] = (uint8_t)(pick(b, 8) ? 0 : 1 + pick(b, 2));
        g.mass[p] =
            g.fixed[p] == CLOTH_ABSENT ? 0 : pick_uniform(b, R(1e-5), R(1e-3));
    }
    return g;
}

/* The cells about each particle, and the springs and triples that they leave,
 * as spec/cloth/cloth.md §2 and §7 have them. */
static void pick_triples(struct bytes *b, struct grid *g)
{
    g->triples = TRIPLES;
    g->n_beside = g->count;
    g->triple = take(b, TRIPLES, sizeof *g->triple);
    g->beside = take(b, g->count, 1);
    for (int k = 0; k < TRIPLES; k++)
        if (has_triple(k / CELL_MASKS, (unsigned)(k % CELL_MASKS)))
            g->triple[k] = pick_uniform(b, R(0.01), 10);
    for (int64_t p = 0; p < g->count; p++)
        for (int k = 0; k < 4 && g->cell[p]; k++)
            g->beside[p + k % 2 + k / 2 * g->m] |= (uint8_t)(1 << k);
    for (int64_t p = 0; p < g->count; p++) {
        unsigned a = g->beside[p];
        g->springs[p] =
            (uint8_t)(((a & 5) != 0) | ((a & 3) != 0) << 1 | (a & 3) << 2);
    }
    for (int64_t p = 0; p < g->count; p++)
        for (int o = 0; o < SPRINGS_SINGLE; o++)
            if (g->springs[p] >> o & 1 &&
                g->springs[p + spring_step(g->m, o)] >> o & 1)
                g->springs[p] |= (uint8_t)(1 << (o + SPRINGS_SINGLE));
}

/* Gives some directions a limit that many springs of pick_state exceed. */
static void pick_limits(struct bytes *b, struct grid *g)
{
    for (int o = 0; o < SPRINGS_SINGLE; o++)
        if (pick(b, 2))
            law_set_limit(&g->law[o],
                          (double)pick_uniform(b, R(0.005), R(0.5)));
}

/* Gives a law 1 to DRAPE_POINTS random pieces whose tension grows as fast as
 * cloth.md §9.4 asks for. */
static void pick_pieces(struct bytes *b, struct law *a, struct piece *t)
{
    double from = (double)a->rest, pull = 0, work = 0, most = 0;
    a->from = a->rest;
    a->pieces = 1 + (int32_t)pick(b, DRAPE_POINTS);
    for (int k = 0; k < a->pieces; k++) {
        double slope = (double)(a->k * pick_uniform(b, R(0.01), 3));
        double step = (double)(a->rest * pick_uniform(b, R(0.001), R(0.5)));
        t[k] = (struct piece){.from = (real)from};
        from = (double)t[k].from; /* as rounded */
        t[k].pull = (real)pull;
        t[k].work = (real)work;
        t[k].slope = (real)(slope + 1.001 * pull / from);
        slope = (double)t[k].slope;
        most = slope > most ? slope : most;
        from = (double)(real)(from + step);
        step = from - (double)t[k].from;
        work += step * (pull + slope * step / 2);
        pull += slope * step;
    }
    a->stiff =
        real_max(a->stiff, (real)(most + 2 * (double)(a->gain * a->over)));
}

static void pick_tables(struct bytes *b, struct grid *g)
{
    g->pieces = PIECES;
    g->piece = take(b, PIECES, sizeof *g->piece);
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        struct law *a = &g->law[o];
        int table = o < DRAPE_BIAS ? o : DRAPE_BIAS;
        a->first = DRAPE_POINTS * table;
        if (o <= DRAPE_BIAS && pick(b, 3))
            pick_pieces(b, a, g->piece + a->first);
    }
    real damp = g->law[3].damp;
    g->law[3] = g->law[2]; /* both diagonals have one table */
    g->law[3].damp = damp;
}

struct grid pick_bent_grid(struct bytes *b)
{
    struct grid g = pick_grid(b);
    if (!for_bench(b) && pick(b, 2))
        pick_limits(b, &g);
    if (!for_bench(b) && !pick(b, 3))
        pick_tables(b, &g);
    if (for_bench(b) || pick(b, 2))
        pick_triples(b, &g);
    return g;
}

vec *pick_state(struct bytes *b, const struct grid *g)
{
    vec *x = take(b, g->count, sizeof *x);
    real noise = pick(b, 2) ? R(0.02) : R(0.3);
    int wild = for_bench(b) ? 0 : (int)pick(b, 3);
    for (int64_t p = 0; p < g->count; p++) {
        x[p] =
            vec_make(R(0.05) * (real)(p % g->m), R(0.05) * (real)(p / g->m), 0);
        x[p].x += pick_uniform(b, -noise, noise);
        x[p].y += pick_uniform(b, -noise, noise);
        x[p].z += pick_uniform(b, -noise, noise);
        if (wild && p && !pick(b, 4))
            x[p] = x[p - 1 - pick(b, (uint32_t)(p < 60 ? p : 60))];
        if (wild == 2 && !pick(b, 16))
            x[p] = pick_vec(b, pick(b, 2) ? 1 : REAL_BIG);
    }
    return x;
}

/* One statement for each choice, since C does not define the order in which
 * arguments are evaluated. */
static vec pick_in_box(struct bytes *b, real scale)
{
    vec r;
    r.x = pick_uniform(b, -scale, scale);
    r.y = pick_uniform(b, -scale, scale);
    r.z = pick_uniform(b, -scale, scale);
    return r;
}

vec *pick_vecs(struct bytes *b, int64_t count, real scale)
{
    vec *v = take(b, count, sizeof *v);
    for (int64_t p = 0; p < count; p++)
        v[p] = pick(b, 4) ? pick_in_box(b, scale) : pick_vec(b, scale);
    return v;
}
