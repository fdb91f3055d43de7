/* SPDX-License-Identifier: Apache-2.0 */
/* Stages excess, coarsen and multigrid: generators and properties.
 * spec/solve/multigrid.md */
#include "ref/solve/multigrid.h"

#include <stdlib.h>

#include "ref/solve/coarsen.h"
#include "ref/solve/jacobi.h"
#include "tests/solve/system.h"

const struct field fields_excess[] = {
    IN(excess, mass, count, 1),     IN(excess, extra, n_extra, 1),
    IN(excess, block, n_blocks, 1), IN(excess, fixed, count, 1),
    OUT(excess, excess, count, 1),  OUT(excess, live, count, 1),
    OUT(excess, rule, count, 1),    FIELD_END};

const struct field fields_coarsen[] = {IN(coarsen, excess, count, 1),
                                       IN(coarsen, block, n_blocks, 1),
                                       IN(coarsen, live, n_live, 1),
                                       IN(coarsen, rule, count, 1),
                                       OUT(coarsen, coarse_rule, n_coarse, 1),
                                       OUT(coarsen, coarse_excess, n_coarse, 1),
                                       OUT(coarsen, coarse_block, n_out, 1),
                                       OUT(coarsen, factor, n_coarse, 1),
                                       FIELD_END};

const struct field fields_multigrid[] = {
    IN(multigrid, mass, count, 1),       IN(multigrid, extra, n_extra, 1),
    IN(multigrid, block, n_blocks, 1),   IN(multigrid, fixed, count, 1),
    IN(multigrid, packed, n_packed, 1),  IN(multigrid, factor, count, 1),
    IN(multigrid, r, count, 1),          SCRATCH(multigrid, parts, n_parts, 1),
    SCRATCH(multigrid, pool, n_pool, 1), SCRATCH(multigrid, room, n_room, 1),
    SCRATCH(multigrid, live, n_live, 1), SCRATCH(multigrid, dense, n_dense, 1),
    OUT(multigrid, z, count, 1),         FIELD_END};

static void excess_of(const struct system *a, struct excess *s)
{
    GIVE_SYSTEM(s, a);
    s->fixed = a->fixed;
}

void gen_excess(struct bytes *b, struct excess *s)
{
    struct system a;
    pick_system(b, &a);
    excess_of(&a, s);
}

/* Makes the input of a coarsening of the finest grid, or of the grid below. */
void gen_coarsen(struct bytes *b, struct coarsen *s)
{
    struct system a;
    struct excess e = {0};
    pick_system(b, &a);
    excess_of(&a, &e);
    e.excess = take(b, a.count, sizeof *e.excess);
    e.live = take(b, a.count, sizeof *e.live);
    e.rule = take(b, a.count, sizeof *e.rule);
    ref_excess(&e);
    struct coarsen c = {.m = a.m,
                        .n = a.n,
                        .count = a.count,
                        .excess = e.excess,
                        .n_blocks = a.n_blocks,
                        .block = a.block,
                        .n_live = a.count,
                        .live = e.live,
                        .rule = e.rule};
    for (uint32_t twice = pick(b, 2);; twice--) {
        c.n_coarse = (int64_t)coarse_size(c.m) * coarse_size(c.n);
        c.n_out = STENCIL * c.n_coarse;
        if (!twice || !a.count)
            break;
        c.coarse_excess = take(b, c.n_coarse, sizeof(sym));
        c.coarse_block = take(b, c.n_out, sizeof(sym));
        c.factor = take(b, c.n_coarse, sizeof(sym));
        c.coarse_rule = take(b, c.n_coarse, 1);
        ref_coarsen(&c);
        struct coarsen d = {.m = coarse_size(c.m),
                            .n = coarse_size(c.n),
                            .count = c.n_coarse,
                            .excess = c.coarse_excess,
                            .n_blocks = c.n_out,
                            .block = c.coarse_block,
                            .rule = c.coarse_rule};
        c = d;
    }
    *s = c;
}

void gen_multigrid(struct bytes *b, struct multigrid *s)
{
    struct system a;
    pick_system(b, &a);
    GIVE_SYSTEM(s, &a);
    s->n_packed = pick(b, 4) ? a.n_blocks : 0;
    s->triples = a.triples;
    ref_multigrid_size(s);
    s->fixed = a.fixed;
    s->packed = a.packed;
    struct jacobi j = {
        .n_packed = s->n_packed, .packed = a.packed, .fixed = a.fixed};
    GIVE_SYSTEM(&j, &a);
    j.factor = take(b, a.count, sizeof *j.factor);
    if (a.count)
        ref_jacobi(&j);
    vec *r = a.b, zero = {0, 0, 0};
    for (int64_t p = 0; p < a.count; p++)
        r[p] = a.fixed[p] ? zero : r[p];
    s->factor = j.factor;
    s->r = r;
}

const char *prop_excess(const struct excess *s)
{
    for (int64_t p = 0; p < s->count; p++)
        for (int o = 0; o < SPRINGS; o++) {
            bool inside = spring_inside(s->m, s->n, (int32_t)(p % s->m),
                                        (int32_t)(p / s->m), o, 1);
            bool live =
                inside && !s->fixed[p] && !s->fixed[p + spring_step(s->m, o)];
            EXPECT(live == (s->live[p] >> o & 1)); /* §1 */
        }
    return NULL;
}

static double entry(sym b, int r, int c)
{
    double a[3][3] = {{(double)b.xx, (double)b.xy, (double)b.xz},
                      {(double)b.xy, (double)b.yy, (double)b.yz},
                      {(double)b.xz, (double)b.yz, (double)b.zz}};
    return a[r][c];
}

/* A random field on the coarse grid for the quadratic form of §2; fine_value is
 * its interpolation to the fine grid. */
static double coarse_value(int64_t p, int c)
{
    return noise_of((uint64_t)(3 * p + c));
}

static double fine_value(const struct coarsen *s, int64_t p, int c)
{
    int64_t i = p % s->m, j = p / s->m;
    double sum = 0;
    for (int64_t y = j / 2; y <= (j + 1) / 2; y++)
        for (int64_t x = i / 2; x <= (i + 1) / 2; x++)
            sum += weight_of(s->rule[p], (int)(i - 2 * x), (int)(j - 2 * y)) /
                   4.0 * coarse_value(x + y * coarse_size(s->m), c);
    return sum;
}

struct energy {
    double value, size;
};

/* Adds dᵀ b d to the value, and the sizes of its terms. */
static void add_energy(struct energy *e, sym b, const double d[3])
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            e->value += d[r] * entry(b, r, c) * d[c];
            e->size += fabs(d[r] * entry(b, r, c) * d[c]);
        }
}

static struct energy fine_energy(const struct coarsen *s)
{
    struct energy e = {0, 0};
    int springs = s->n_live ? SPRINGS : STENCIL;
    const int8_t *di = s->n_live ? spring_di : stencil_di;
    const int8_t *dj = s->n_live ? spring_dj : stencil_dj;
    for (int64_t p = 0; p < s->count; p++) {
        double d[3], u[3];
        for (int c = 0; c < 3; c++)
            u[c] = fine_value(s, p, c);
        add_energy(&e, s->excess[p], u);
        for (int o = 0; o < springs; o++) {
            int64_t i = p % s->m + di[o], j = p / s->m + dj[o];
            if (i < 0 || i >= s->m || j >= s->n ||
                (s->n_live && !(s->live[p] >> o & 1)))
                continue;
            for (int c = 0; c < 3; c++)
                d[c] = u[c] - fine_value(s, i + j * s->m, c);
            add_energy(&e, s->block[o * s->count + p], d);
            e.size += 30 * fabs(entry(s->block[o * s->count + p], 0, 0)) +
                      30 * fabs(entry(s->block[o * s->count + p], 1, 1)) +
                      30 * fabs(entry(s->block[o * s->count + p], 2, 2));
        }
    }
    return e;
}

static struct energy coarse_energy(const struct coarsen *s)
{
    struct energy e = {0, 0};
    int64_t m = coarse_size(s->m), n = coarse_size(s->n);
    for (int64_t p = 0; p < s->n_coarse; p++) {
        double d[3], u[3];
        for (int c = 0; c < 3; c++)
            u[c] = coarse_value(p, c);
        add_energy(&e, s->coarse_excess[p], u);
        for (int o = 0; o < STENCIL; o++) {
            int64_t i = p % m + stencil_di[o], j = p / m + stencil_dj[o];
            if (i < 0 || i >= m || j >= n)
                continue;
            for (int c = 0; c < 3; c++)
                d[c] = u[c] - coarse_value(i + j * m, c);
            add_energy(&e, s->coarse_block[o * s->n_coarse + p], d);
        }
    }
    return e;
}

/* §2, the Galerkin product: the quadratic form of the coarse operator for a
 * field equals the form of the fine operator for the interpolated field. No
 * coarse block leads outside the grid. */
const char *prop_coarsen(const struct coarsen *s)
{
    const double u = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    struct energy f = fine_energy(s), c = coarse_energy(s);
    EXPECT(fabs(f.value - c.value) <=
           (70 * u + 0x1p-40) * (f.size + c.size) + 1e-40);
    int64_t m = coarse_size(s->m), n = coarse_size(s->n);
    for (int64_t p = 0; p < s->n_coarse; p++)
        for (int o = 0; o < STENCIL; o++) {
            int64_t i = p % m + stencil_di[o], j = p / m + stencil_dj[o];
            sym b = s->coarse_block[o * s->n_coarse + p];
            if (i < 0 || i >= m || j >= n)
                EXPECT(b.xx == 0 && b.yy == 0 && b.zz == 0);
        }
    return NULL;
}

const char *prop_multigrid(const struct multigrid *s)
{
    double inner = 0;
    bool zero = true;
    for (int64_t p = 0; p < s->count; p++) {
        vec z = s->z[p], r = s->r[p];
        inner += (double)z.x * (double)r.x + (double)z.y * (double)r.y +
                 (double)z.z * (double)r.z;
        if (s->fixed[p])
            EXPECT(z.x == 0 && z.y == 0 && z.z == 0); /* §2 */
        else
            zero &= vec_length(r) == 0; /* also if its square underflows */
    }
    EXPECT(zero || inner > 0); /* §4: positive definite */
    return NULL;
}

static void *room(int64_t count, size_t size)
{
    return calloc((size_t)count + 1, size);
}

static void open_grid(const struct system *a, struct multigrid *s)
{
    s->m = a->m;
    s->n = a->n;
    s->n_packed = a->n_blocks;
    s->triples = a->triples;
    ref_multigrid_size(s);
    s->mass = a->mass;
    s->block = a->block;
    s->packed = a->packed;
    s->fixed = a->fixed;
    struct jacobi j = {
        .n_packed = a->n_blocks, .packed = a->packed, .fixed = a->fixed};
    GIVE_SYSTEM(&j, a);
    s->factor = j.factor = room(a->count, sizeof *j.factor);
    ref_jacobi(&j);
    s->parts = room(s->n_parts, sizeof *s->parts);
    s->pool = room(s->n_pool, sizeof *s->pool);
    s->room = room(s->n_room, sizeof *s->room);
    s->live = room(s->n_live, sizeof *s->live);
    s->dense = room(s->n_dense, sizeof *s->dense);
    ref_multigrid_build(s);
}

static void close_grid(struct multigrid *s)
{
    free(s->parts);
    free(s->pool);
    free(s->room);
    free(s->live);
    free(s->dense);
    free((sym *)s->factor);
}

static double inner(int64_t n, const vec *a, const vec *b)
{
    double s = 0;
    for (int64_t p = 0; p < n; p++)
        s += (double)a[p].x * (double)b[p].x + (double)a[p].y * (double)b[p].y +
             (double)a[p].z * (double)b[p].z;
    return s;
}

/* §4: |yᵀM⁻¹x - xᵀM⁻¹y| / √(xᵀM⁻¹x yᵀM⁻¹y) for random x and y; 1 if M⁻¹ is not
 * positive for them. */
static double asymmetry(struct multigrid *s)
{
    vec *v[4];
    for (int k = 0; k < 4; k++)
        v[k] = room(s->count, sizeof(vec));
    for (int64_t p = 0; p < s->count; p++)
        for (int k = 0; k < 2 && !s->fixed[p]; k++) {
            uint64_t seed = (uint64_t)(6 * p + 3 * k);
            v[k][p] = vec_make((real)noise_of(seed), (real)noise_of(seed + 1),
                               (real)noise_of(seed + 2));
        }
    for (int k = 0; k < 2; k++) {
        s->r = v[k];
        s->z = v[2 + k];
        ref_multigrid_cycle(s);
    }
    double xx = inner(s->count, v[0], v[2]), yy = inner(s->count, v[1], v[3]);
    double xy = inner(s->count, v[0], v[3]), yx = inner(s->count, v[1], v[2]);
    for (int k = 0; k < 4; k++)
        free(v[k]);
    return xx > 0 && yy > 0 ? fabs(xy - yx) / sqrt(xx * yy) : 1;
}

const char *test_multigrid_symmetry(void)
{
    const double u = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    for (int k = 0; k < 24; k++) {
        struct system a;
        struct design d = {9 + 3 * k % 29,
                           40 - k,
                           (enum shape)(k % SHAPES),
                           k % 4 * (TRIM_HOLE | TRIM_CUT | TRIM_PINS),
                           0.1,
                           k / 4 % 2};
        struct multigrid s = {0};
        make_system(&d, &a);
        open_grid(&a, &s);
        double error = asymmetry(&s);
        close_grid(&s);
        free_system(&a);
        EXPECT(error <= 2112 * u);
        ran(1);
    }
    return NULL;
}
