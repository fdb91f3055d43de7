/* SPDX-License-Identifier: Apache-2.0 */
/* Fibres: uniform strains, gradients, momenta, and rigid motions.
 * spec/panel/panel.md §2, §5, §6 */
#include "tests/cloth/sheet.h"
#include "tests/panel/cutting.h"

enum { SHAPES = 6 };

/* Shape k: strips at five angles, and a disc. */
static bool cut_shape(struct cutting *c, int k, double h)
{
    static const double turn[SHAPES - 1] = {0.1, 0.35, 0.52, 0.7853981633974483,
                                            1.2};
    return k < SHAPES - 1 ? cutting_strip(c, 0.3, 0.08, turn[k], h)
                          : cutting_disc(c, 0.1, h);
}

/* A linear map of the plane into space. */
static const double map[3][2] = {{1.05, 0.03}, {-0.02, 0.98}, {0.1, -0.07}};

/* The energy by area of the springs of a regular grid under the map. */
static double energy_by_area(const struct cloth *c)
{
    double sum = 0, hu = (double)c->hu, hv = (double)c->hv;
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        double u = spring_di[o] * hu, v = spring_dj[o] * hv, square = 0;
        for (int k = 0; k < 3; k++) {
            double d = map[k][0] * u + map[k][1] * v;
            square += d * d;
        }
        sum += law_oracle_energy(&c->law[o], c->piece, sqrt(square));
    }
    return sum / (hu * hv);
}

static void map_state(struct model *s)
{
    for (int64_t p = 0; p < s->c.count; p++) {
        const double *a = s->rest[p];
        s->x[p] = vec_make((real)(map[0][0] * a[0] + map[0][1] * a[1]),
                           (real)(map[1][0] * a[0] + map[1][1] * a[1]),
                           (real)(map[2][0] * a[0] + map[2][1] * a[1]));
    }
}

/* §2: a uniform strain has the energy of the grid's springs by area, and no
 * force on an inner particle. */
static const char *check_patch(const struct cutting *c)
{
    struct model s;
    double most = 0, bound = REAL_BITS == 32 ? 1e-5 : 1e-12;
    EXPECT(model_make(&s, c) == DRAPE_OK);
    map_state(&s);
    model_force(&s, NULL);
    for (int64_t p = 0; p < s.c.count; p++)
        if (!s.c.fixed[p] && model_is_inner(c, p)) {
            double f = (double)vec_length(s.f[p]);
            most = f > most ? f : most;
        }
    double want = energy_by_area(&s.c) * model_area(c);
    double off = model_energy(&s) / want - 1;
    EXPECT(fabs(off) <= bound);
    /* positions of 0.3 m are rounded */
    EXPECT(most <= 20 * REAL_U * 0.3 * (double)s.c.law[0].stiff);
    model_free(&s);
    ran(1);
    return NULL;
}

const char *test_panel_patch(void)
{
    static const double size[] = {0.01, 0.005, 0.0025};
    for (int k = 0; k < 3 * SHAPES; k++) {
        struct cutting c;
        EXPECT(cut_shape(&c, k / 3, size[k % 3]));
        const char *failed = check_patch(&c);
        c.cloth.material.limit[0] = c.cloth.material.limit[2] = 0.02;
        if (!failed)
            failed = check_patch(&c);
        cutting_free(&c);
        if (failed)
            return failed;
    }
    return NULL;
}

/* Moves each particle by up to `far` in each coordinate. */
static void stir(struct model *s, double far)
{
    uint32_t state = 1;
    real *x = &s->x[0].x;
    for (int64_t k = 0; k < 3 * s->c.count; k++) {
        state = state * 1664525u + 1013904223u;
        x[k] += (real)(far * ((double)(state >> 8) / (1 << 23) - 1));
    }
}

/* §5: forces are minus the gradient of the energy, by central differences, and
 * add up to no force and no torque. §6: without compression the matrix is their
 * derivative. */
static const char *check_gradient(const struct cutting *c)
{
    struct model s;
    const double step = 1e-6;
    EXPECT(model_make(&s, c) == DRAPE_OK);
    map_state(&s);
    for (int64_t p = 0; p < s.c.count; p++)
        s.x[p] = vec_scale(R(1.1), s.x[p]); /* all in tension */
    stir(&s, 0.01 * c->cut.h);
    model_force(&s, NULL);
    model_blocks(&s, 1);
    vec sum = {0, 0, 0}, torque = {0, 0, 0};
    double scale = 0;
    for (int64_t p = 0; p < s.c.count; p++) {
        sum = vec_add(sum, s.f[p]);
        torque = vec_add(torque, vec_cross(s.x[p], s.f[p]));
        scale += (double)vec_length(s.f[p]);
    }
    EXPECT((double)vec_length(sum) <= 40 * REAL_U * scale);
    EXPECT((double)vec_length(torque) <= 40 * REAL_U * scale * 0.4);
    vec *before = arena_take(&s.arena, ARENA_OTHER, s.c.count, sizeof *before);
    vec *after = arena_take(&s.arena, ARENA_OTHER, s.c.count, sizeof *after);
    EXPECT(before && after);
    memcpy(before, s.f, (size_t)s.c.count * sizeof *before);
    for (int64_t i = 0; i < s.c.panel->n_parts && REAL_BITS == 64; i += 3) {
        int32_t p = s.c.panel->part[i];
        real *at = &s.x[p].x + i % 3, was = *at;
        *at = was + R(step);
        double e = model_energy(&s);
        model_force(&s, NULL);
        memcpy(after, s.f, (size_t)s.c.count * sizeof *after);
        *at = was - R(step);
        double slope = (e - model_energy(&s)) / (2 * step);
        EXPECT(fabs(slope + (double)(&before[p].x)[i % 3]) <=
               1e-6 * c->cloth.material.stretch * c->cut.h);
        model_force(&s, NULL);
        *at = was;
        vec moved = {0, 0, 0};
        *(&moved.x + i % 3) = 1;
        for (int o = 0; o < SPRINGS; o++)
            for (int sign = -1; sign <= 1; sign += 2) {
                int64_t far = spring_step(s.c.m, o), q = p + sign * far;
                int32_t x = p % s.c.m, y = p / s.c.m;
                if (!spring_inside(s.c.m, s.c.n, x, y, o, sign))
                    continue;
                const sym *b = s.block + o * s.c.count + (sign > 0 ? p : q);
                vec is = vec_scale(R(0.5 / step), vec_sub(after[q], s.f[q]));
                vec off = vec_sub(is, sym_apply(*b, moved));
                EXPECT((double)vec_length(off) <=
                       1e-5 * c->cloth.material.stretch);
            }
    }
    model_free(&s);
    ran(1);
    return NULL;
}

const char *test_panel_gradient(void)
{
    for (int k = 0; k < 2 * SHAPES; k++) {
        struct cutting c;
        EXPECT(cut_shape(&c, k / 2, 0.01));
        c.cloth.material.bend = 1e-3;
        if (k % 2) { /* a limit within reach, and measured tensions */
            c.cloth.material.limit[0] = c.cloth.material.limit[1] = 0.12;
            c.cloth.material.table[DRAPE_WARP][0][0] = 0.05;
            c.cloth.material.table[DRAPE_WARP][0][1] = 3;
            c.cloth.material.table[DRAPE_WARP][1][0] = 0.2;
            c.cloth.material.table[DRAPE_WARP][1][1] = 30;
        }
        const char *failed = check_gradient(&c);
        cutting_free(&c);
        if (failed)
            return failed;
    }
    return NULL;
}

/* §2, §4: a panel that was moved as a rigid body has no energy and no force but
 * by rounding. */
const char *test_panel_rigid(void)
{
    for (int k = 0; k < SHAPES; k++) {
        struct cutting c;
        struct model s;
        EXPECT(cut_shape(&c, k, 0.005));
        EXPECT(model_make(&s, &c) == DRAPE_OK);
        for (int64_t p = 0; p < s.c.count; p++) {
            double u = c.rest[p][0], v = c.rest[p][1];
            s.x[p] = vec_make((real)(0.48 * u - 0.6 * v),
                              (real)(0.64 * u + 0.8 * (0.6 * v) + 0.2),
                              (real)(0.6 * u + 0.64 * v));
            /* two orthonormal columns */
            double a[3] = {0.48, 0.64, 0.6}, b[3] = {-0.8, 0.6, 0};
            s.x[p] = vec_make((real)(a[0] * u + b[0] * v),
                              (real)(a[1] * u + b[1] * v),
                              (real)(a[2] * u + b[2] * v));
        }
        double strain = 8 * REAL_U / c.cut.h * 0.3;
        double stiff = c.cloth.material.stretch;
        model_force(&s, NULL);
        for (int64_t p = 0; p < s.c.count; p++)
            EXPECT((double)vec_length(s.f[p]) <= 8 * strain * stiff * c.cut.h);
        EXPECT(model_energy(&s) <=
               strain * strain * stiff * model_area(&c) * 4);
        model_free(&s);
        cutting_free(&c);
        ran(1);
    }
    return NULL;
}
