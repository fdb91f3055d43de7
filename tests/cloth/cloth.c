/* SPDX-License-Identifier: Apache-2.0 */
/* The cloth model: masks, masses, force laws, and forces against energies.
 * spec/cloth/cloth.md */
#include "ref/cloth/cloth.h"

#include <stdlib.h>

#include "ref/cloth/law.h"
#include "tests/cloth/sheet.h"

enum { MOST = 12 };

/* A small random cloth with holes and cuts, the same for the same seed. */
static drape_cloth holed(unsigned seed, uint8_t *hole, uint8_t *cut)
{
    unsigned state = seed * 2654435761u + 1;
    drape_cloth d = sheet_default(2 + (int)(seed % (MOST - 1)),
                                  2 + (int)(seed / 5 % (MOST - 1)));
    d.width = 0.1 * (d.m - 1);
    d.height = (seed % 3 ? 0.1 : 0.12) * (d.n - 1);
    for (int p = 0; p < MOST * MOST; p++) {
        state = state * 1664525u + 1013904223u;
        hole[p] = state >> 20 & 7 ? 0 : 1;
        cut[p] = state >> 24 & 7 ? 0 : 1;
    }
    d.hole = seed % 2 ? hole : NULL;
    d.cut = seed / 2 % 2 ? cut : NULL;
    return d;
}

/* §1, independent of ref/: a cell is present if it is not cut and none of its
 * corners is a hole. */
static bool cell(const drape_cloth *d, int i, int j)
{
    if (i < 0 || j < 0 || i > d->m - 2 || j > d->n - 2)
        return false;
    bool there = !d->cut || !d->cut[i + (d->m - 1) * j];
    for (int c = 0; c < 4; c++)
        there &= !d->hole || !d->hole[i + c % 2 + d->m * (j + c / 2)];
    return there;
}

/* §2, independent of ref/: whether the segment from (i, j) to (i + di, j + dj)
 * is an edge or a diagonal of a present cell. */
static bool along(const drape_cloth *d, int i, int j, int di, int dj)
{
    for (int y = 0; y < d->n - 1; y++)
        for (int x = 0; x < d->m - 1; x++) {
            bool a = i >= x && i <= x + 1 && j >= y && j <= y + 1;
            int k = i + di, l = j + dj;
            bool b = k >= x && k <= x + 1 && l >= y && l <= y + 1;
            if (a && b && cell(d, x, y))
                return true;
        }
    return false;
}

static bool spring(const drape_cloth *d, int i, int j, int o)
{
    int di = spring_di[o], dj = spring_dj[o];
    if (o < SPRINGS_SINGLE)
        return along(d, i, j, di, dj);
    di /= 2;
    dj /= 2;
    return along(d, i, j, di, dj) && along(d, i + di, j + dj, di, dj);
}

static const char *check_masks(const drape_cloth *d, const struct cloth *c)
{
    double total = 0, area = 0;
    int64_t t = 0;
    for (int p = 0; p < d->m * d->n; p++) {
        int i = p % d->m, j = p / d->m, cells = 0;
        for (int k = 0; k < 4; k++)
            cells += cell(d, i - k % 2, j - k / 2);
        EXPECT(c->cell[p] == cell(d, i, j));
        EXPECT((c->fixed[p] == CLOTH_ABSENT) == !cells);
        EXPECT((c->mass[p] > 0) == (cells > 0));
        for (int o = 0; o < SPRINGS; o++)
            EXPECT((c->springs[p] >> o & 1) == spring(d, i, j, o));
        total += (double)c->mass[p];
        area += c->cell[p];
        if (!c->cell[p])
            continue;
        /* §3: two triangles that share the diagonal from p to p + m + 1. */
        const int32_t want[6] = {p, p + 1,        p + d->m + 1,
                                 p, p + d->m + 1, p + d->m};
        EXPECT(!memcmp(c->tri + t, want, sizeof want));
        t += 2;
    }
    EXPECT(t == c->n_triangles);
    /* §3: at most eight roundings a particle, and the roundings of this sum. */
    double mass = d->material.density * area * d->width * d->height /
                  ((d->m - 1) * (d->n - 1));
    EXPECT(fabs(total - mass) <=
           (8 * REAL_U + (double)c->count * 0x1p-53) * mass);
    return NULL;
}

/* §1 to §3: masks, triangles and masses, compared by brute force with the
 * definitions above. */
const char *test_cloth_masks(void)
{
    uint8_t hole[MOST * MOST], cut[MOST * MOST];
    for (unsigned seed = 0; seed < 400; seed++) {
        drape_cloth d = holed(seed, hole, cut);
        struct sheet s;
        EXPECT(sheet_make(&s, &d, DRAPE_BW) == DRAPE_OK);
        const char *bad = check_masks(&d, &s.c);
        sheet_free(&s);
        if (bad)
            return bad;
        ran(1);
    }
    return NULL;
}

/* The elastic energy per area of a uniform strain, by the springs of an inner
 * particle. eu, ev: strains along u and v; g: shear. */
static double density(const struct cloth *c, double eu, double ev, double g)
{
    double sum = 0, hu = (double)c->hu, hv = (double)c->hv;
    for (int o = 0; o < SPRINGS; o++) {
        double du = spring_di[o] * hu, dv = spring_dj[o] * hv;
        double x = du * (1 + eu) + dv * g / 2, y = dv * (1 + ev) + du * g / 2;
        sum += law_oracle_energy(&c->law[o], c->piece, sqrt(x * x + y * y));
    }
    return sum / (hu * hv);
}

/* §4: on a cell of any shape a small strain has the energy of the material. A
 * spring's energy has a cubic term besides the quadratic one, hence a relative
 * error of the order of the strain; e is large enough against the rounding of
 * rest lengths. */
const char *test_cloth_material(void)
{
    static const double ratio[] = {1, 0.8, 1.3};
    double e = REAL_BITS == 32 ? 1e-2 : 1e-5, close = 4 * e + 1e3 * REAL_U / e;
    for (int k = 0; k < 9; k++) {
        drape_cloth d = sheet_default(2, 2);
        struct cloth c;
        d.width = 0.1 / (1 + k / 3);
        d.height = d.width * ratio[k % 3];
        EXPECT(ref_cloth_size(&d, &c) == DRAPE_OK);
        double s = d.material.stretch, g = d.material.shear;
        /* Double springs are stiffer in compression (§4), so the strains only
         * stretch. */
        EXPECT(fabs(density(&c, e, 0, 0) / (s * e * e / 2) - 1) <= close);
        EXPECT(fabs(density(&c, 0, e, 0) / (s * e * e / 2) - 1) <= close);
        double both = (s + g) * e * e;
        EXPECT(fabs(density(&c, e, e, 0) / both - 1) <= close);
        double more = density(&c, e, e, e) - density(&c, e, e, 0);
        EXPECT(fabs(more / (g * e * e / 2) - 1) <= 4 * close);
        ran(1);
    }
    /* Cells that are too oblong for the shear stiffness are refused. */
    drape_cloth d = sheet_default(2, 2);
    struct cloth c;
    d.height = 0.2;
    EXPECT(ref_cloth_size(&d, &c) == DRAPE_EARG);
    return NULL;
}

/* §4 and §5: a cylinder of radius 1 / curvature has the energy bend·curvature²
 * / 2 per area, on any grid that is fine enough to resolve the cylinder and
 * coarse enough that springs buckle. The error is the energy of the knee,
 * `well`: a share of about 12·bend / compression. */
const char *test_cloth_bending(void)
{
    const double curvature = 40, pi = 3.1415926535897932;
    for (int n = 11; n <= 41; n += 10) {
        drape_cloth d = sheet_default(n, n);
        struct cloth c;
        d.width = d.height = 0.1;
        d.material.stretch = 1e7;
        d.material.shear = 3e6;
        d.bending = DRAPE_SPRINGS;
        EXPECT(ref_cloth_size(&d, &c) == DRAPE_OK);
        double e = 0, h = (double)c.hu;
        for (int o = SPRINGS_SINGLE; o < SPRINGS; o++) {
            double u = spring_di[o] * h, v = spring_dj[o] * h;
            double angle = u * curvature / 2;
            double x = angle != 0 ? 2 * sin(angle) / curvature : 0;
            double length = sqrt(x * x + v * v);
            if (u == 0)
                continue;
            EXPECT(length < (double)c.law[o].knee && fabs(angle) < pi);
            e += (double)law_energy(&c.law[o], c.piece, (real)length);
        }
        double want = d.material.bend * curvature * curvature / 2 * h * h;
        EXPECT(fabs(e / want - 1) <= 0.05);
        ran(1);
    }
    return NULL;
}

/* §5: the fit of the arc's force, of its slope and of its energy, over the
 * whole range of lengths. */
const char *test_cloth_arc(void)
{
    struct law a = {
        .k = 1, .compression = 1e6, .rest = 1, .bend = 1, .stiff = 1e6};
    law_set_knee(&a, true);
    law_set_limit(&a, 0);
    for (int k = 0; k < 20000; k++) {
        real length = (real)k * (a.knee / 20000);
        double f = law_oracle(&a, NULL, (double)length);
        double rounding = 1e3 * REAL_U;
        EXPECT(fabs((double)law_tension(&a, NULL, length) / f - 1) <=
               LAW_ERROR + rounding);
        double slope = law_oracle_slope(&a, NULL, (double)length);
        EXPECT(fabs((double)law_slope(&a, NULL, length) - slope) <=
               LAW_SLOPE_ERROR + rounding * slope);
        EXPECT(law_slope(&a, NULL, length) <= LAW_STEEPEST);
        double e = law_oracle_energy(&a, NULL, (double)length);
        EXPECT(fabs((double)law_energy(&a, NULL, length) - e) <=
               LAW_ERROR * e + 100 * REAL_U);
        ran(1);
    }
    return NULL;
}

static void shake(struct sheet *s, double size)
{
    unsigned state = 7;
    for (int64_t k = 0; k < 3 * s->c.count; k++) {
        state = state * 1664525u + 1013904223u;
        (&s->x[k / 3].x)[k % 3] +=
            (real)(size * ((state >> 8) / 8388608.0 - 1));
    }
}

/* springs.md §3: the force is minus the gradient of the energy, by central
 * differences in binary64: error h² f'' and rounding of the energy by h. */
const char *test_force_gradient(void)
{
    if (REAL_BITS == 32)
        return skip("the same source in binary64 decides");
    drape_cloth d = sheet_default(7, 6);
    struct sheet s;
    EXPECT(sheet_make(&s, &d, DRAPE_BW) == DRAPE_OK);
    s.d.gravity = vec_make(1, -2, R(-9.81));
    for (int kind = 0; kind < 3; kind++) {
        shake(&s, kind ? 0.1 : 0.01);
        sheet_force(&s, s.x, s.v, s.d.x1);
        for (int64_t k = 0; k < 3 * s.c.count; k++) {
            real *x = &(&s.x[k / 3].x)[k % 3], keep = *x;
            double lo[3], hi[3], h = 1e-6;
            *x = keep - (real)h;
            sheet_energy(&s, s.x, s.v, lo);
            *x = keep + (real)h;
            sheet_energy(&s, s.x, s.v, hi);
            *x = keep;
            double f = -(hi[1] - lo[1] + hi[2] - lo[2]) / (2 * h);
            double have = (double)(&s.d.x1[k / 3].x)[k % 3];
            /* At a kink of the law the slope jumps by at most 3k, over a
             * distance h. */
            EXPECT(fabs(f - have) <= 1e-6 + 50 * h * fabs(have) + 160 * h);
            ran(1);
        }
    }
    sheet_free(&s);
    return NULL;
}

/* springs.md §1, blocks.md §1: particles all at one point, or of no length
 * by underflow, give finite forces: none from the springs. */
const char *test_coincident(void)
{
    drape_cloth d = sheet_default(5, 5);
    struct sheet s;
    EXPECT(sheet_make(&s, &d, DRAPE_BW) == DRAPE_OK);
    real tiny = REAL_BITS == 32 ? R(1e-30) : R(1e-200);
    for (int kind = 0; kind < 2; kind++) {
        for (int64_t p = 0; p < s.c.count; p++)
            s.x[p] = vec_make(kind ? tiny * (real)p : 1, 0, 0);
        sheet_force(&s, s.x, s.v, s.d.x1);
        for (int64_t p = 0; p < s.c.count; p++)
            EXPECT(vec_dot(s.d.x1[p], s.d.x1[p]) == 0);
        EXPECT(sheet_step(&s) == DRAPE_OK && !s.d.outcome);
        ran(1);
    }
    sheet_free(&s);
    return NULL;
}
