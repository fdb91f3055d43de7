/* SPDX-License-Identifier: Apache-2.0 */
/* Systems for the tests of the linear solver. */
#include "tests/solve/system.h"

#include <stdlib.h>

#include "ref/cloth/springs.h"
#include "spec/drape.h"

static sym outer(vec a)
{
    sym r = {a.x * a.x, a.x * a.y, a.x * a.z, a.y * a.y, a.y * a.z, a.z * a.z};
    return r;
}

static void *room(int64_t count, size_t size)
{
    return calloc((size_t)count + 1, size);
}

static int64_t index_of(const struct system *s, int32_t i, int32_t j)
{
    return i + (int64_t)s->m * j;
}

/* Chooses a grid of about `size` particles, sometimes with very few columns. */
static void pick_grid(struct bytes *b, int64_t size, struct system *s)
{
    int64_t m = 1 + (int64_t)pick(b, 40);
    if (pick(b, 4) == 0)
        m = 1 + (int64_t)pick(b, 5);
    s->m = (int32_t)(m < size || !size ? m : size);
    s->n = (int32_t)(size / s->m);
    s->count = (int64_t)s->m * s->n;
    s->n_blocks = SPRINGS * s->count;
    s->n_extra = pick(b, 3) ? 0 : s->count;
    s->triples = (int)pick(b, 2);
}

/* Whether the spring of direction o from p and both of its ends exist. */
static bool is_there(const struct system *s, int64_t p, int o)
{
    int32_t i = (int32_t)(p % s->m), j = (int32_t)(p / s->m);
    return spring_inside(s->m, s->n, i, j, o, 1) &&
           s->fixed[p] != CLOTH_ABSENT &&
           s->fixed[p + spring_step(s->m, o)] != CLOTH_ABSENT;
}

/* Adds k |x₋ − 2x + x₊|², for some triples, to the blocks b I of its three
 * pairs. blocks.md §7 */
static void pick_triples(struct bytes *b, const struct system *s, real *across)
{
    for (int o = 0; o < SPRINGS_SINGLE; o++)
        for (int64_t p = 0; p < s->count; p++) {
            int64_t at = p + spring_step(s->m, o), two = o + SPRINGS_SINGLE;
            if (!is_there(s, p, (int)two) || !is_there(s, p, o) ||
                !is_there(s, at, o) || !pick(b, 8))
                continue;
            real k = for_bench(b) ? R(0.5) : pick_uniform(b, 0, 1);
            across[o * s->count + p] += 2 * k;
            across[o * s->count + at] += 2 * k;
            across[two * s->count + p] -= k;
        }
}

/* Sets the blocks v vᵀ + across I; with triples v is 0 for double springs. */
static void pick_blocks(struct bytes *b, struct system *s, bool flat,
                        const real *across)
{
    for (int o = 0; o < SPRINGS; o++)
        for (int64_t p = 0; p < s->count; p++) {
            int64_t k = o * s->count + p;
            vec v = for_bench(b) ? vec_make(1, 0, R(0.5)) : pick_vec(b, 1);
            if (flat)
                v.z = 0;
            if (!is_there(s, p, o) || !pick(b, 8) ||
                (s->triples && o >= SPRINGS_SINGLE))
                v = vec_make(0, 0, 0);
            real length = vec_length(v), one = length > 0 ? 1 / length : 0;
            s->block[k] = outer(v);
            s->block[k].xx += across[k];
            s->block[k].yy += across[k];
            s->block[k].zz += across[k];
            s->packed[k] =
                packed_make(vec_dot(v, v), across[k], vec_scale(one, v));
        }
}

void pick_system(struct bytes *b, struct system *s)
{
    int64_t size = for_bench(b) ? 1 << 18 : pick_size(b);
    pick_grid(b, size, s);
    s->mass = take(b, s->count, sizeof *s->mass);
    s->extra = take(b, s->n_extra, sizeof *s->extra);
    s->block = take(b, s->n_blocks, sizeof *s->block);
    s->packed = take(b, s->n_blocks, sizeof *s->packed);
    s->fixed = take(b, s->count, sizeof *s->fixed);
    s->b = take(b, s->count, sizeof *s->b);
    uint32_t holes = pick(b, 3), flat = pick(b, 2);
    for (int64_t p = 0; p < s->count; p++) {
        s->fixed[p] = holes && !pick(b, 10) ? (uint8_t)(1 + pick(b, 2)) : 0;
        s->mass[p] = pick_uniform(b, R(0.001), 1);
        s->b[p] = pick_vec(b, 1);
        if (s->n_extra && !pick(b, 3))
            s->extra[p] = outer(pick_vec(b, 1));
    }
    real *across = take(b, s->n_blocks, sizeof *across);
    if (s->triples)
        pick_triples(b, s, across);
    pick_blocks(b, s, flat, across);
}

sym packed_sym(struct packed t)
{
    struct packed_parts a = packed_open(t);
    double s = (double)a.size, all = (double)a.all;
    struct wide e = wide_of(a.e);
    sym r = {(real)(s * e.x * e.x + all), (real)(s * e.x * e.y),
             (real)(s * e.x * e.z),       (real)(s * e.y * e.y + all),
             (real)(s * e.y * e.z),       (real)(s * e.z * e.z + all)};
    return r;
}

double noise_of(uint64_t k)
{
    k = (k + 1) * UINT64_C(0x9e3779b97f4a7c15);
    k = (k ^ (k >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    k = (k ^ (k >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((k ^ (k >> 31)) >> 11) * 0x1p-52 - 1;
}

/* A point at length s of a curve whose direction swings by ±swing, in radians,
 * with the given period, in m; by steps of h. */
static void fold(double s, double swing, double period, double h, double *x)
{
    x[0] = x[1] = 0;
    for (double a = 0; a < s - h / 2; a += h) {
        double angle = swing * sin(6.283185307179586 * a / period);
        x[0] += h * cos(angle);
        x[1] += h * sin(angle);
    }
}

static void place(enum shape shape, double s, double t, double h, double *x)
{
    double tilt[3] = {0.6 * s - 0.224 * t, 0.8 * s + 0.168 * t, 0.96 * t};
    x[0] = s;
    x[1] = 0;
    x[2] = t;
    if (shape == SHAPE_TILTED)
        memcpy(x, tilt, sizeof tilt);
    if (shape == SHAPE_STRETCHED) {
        x[0] = 1.05 * s;
        x[1] = 0.3 * s;
        x[2] = 1.02 * t;
    }
    if (shape == SHAPE_WRINKLED)
        x[1] = 0.01 * sin(40 * s) * cos(30 * t) + 0.002 * sin(200 * s);
    if (shape == SHAPE_FOLDED)
        fold(s, 2, 0.1, h, x);
    if (shape == SHAPE_DRAPED) {
        x[0] = 0.98 * s;
        x[1] = 0.03 * sin(25 * s + 20 * t) * cos(30 * t);
        x[2] = 0.98 * t + 0.01 * sin(17 * s);
    }
}

static bool trimmed(const struct design *d, int32_t i, int32_t j)
{
    double u = (double)i / d->m - 0.5, v = (double)j / d->n - 0.5;
    uint64_t k = (uint64_t)i + (uint64_t)d->m * (uint64_t)j;
    return ((d->trim & TRIM_HOLE) && u * u + v * v < 0.03) ||
           ((d->trim & TRIM_MOTHS) && noise_of(k) < -0.96) ||
           ((d->trim & TRIM_SLIT) && i == d->m / 3 && v > -0.4 && v < 0.4);
}

static bool pinned(const struct design *d, int32_t i, int32_t j)
{
    uint64_t k = (uint64_t)i + (uint64_t)d->m * (uint64_t)j;
    return (d->trim & TRIM_PINS) && ((j == 0 && (i == 0 || i == d->m - 1)) ||
                                     noise_of(k + 12345) < -0.99);
}

/* Whether cell (i, j) is missing. */
static bool severed(const struct design *d, int32_t i, int32_t j)
{
    return (d->trim & TRIM_CUT) && i == d->m / 2 && j > d->n / 10 &&
           j < d->n - d->n / 10;
}

/* Gives a stage the springs and triples of a cloth. */
#define GIVE_CLOTH(stage, cloth)                                               \
    do {                                                                       \
        (stage)->laws = SPRINGS;                                               \
        (stage)->law = (cloth)->law;                                           \
        (stage)->pieces = (cloth)->pieces;                                     \
        (stage)->piece = (cloth)->piece;                                       \
        (stage)->springs = (cloth)->springs;                                   \
        (stage)->triples = (cloth)->triples;                                   \
        (stage)->triple = (cloth)->triple;                                     \
        (stage)->n_beside = (cloth)->triples ? (cloth)->count : 0;             \
        (stage)->beside = (cloth)->beside;                                     \
    } while (0)

struct blocks blocks_of(const struct system *s)
{
    struct blocks b = {.count = s->count,
                       .m = s->m,
                       .x = s->x,
                       .tau = s->tau,
                       .block = s->block,
                       .n_packed = s->n_blocks,
                       .packed = s->packed};
    GIVE_CLOTH(&b, &s->cloth);
    return b;
}

/* The cloth of the design: a sheet of default cotton, its longest side 1 m. */
static void add_cloth(const struct design *d, double h, struct system *s)
{
    uint8_t *hole = room(s->count, 1), *cut = room(s->count, 1);
    drape_cloth def;
    drape_default_cloth(&def);
    def.m = d->m;
    def.n = d->n;
    def.width = (d->m - 1) * h;
    def.height = (d->n - 1) * h;
    def.bending = d->bending;
    def.hole = hole;
    def.cut = cut;
    for (int32_t j = 0; j < d->n; j++)
        for (int32_t i = 0; i < d->m; i++) {
            hole[index_of(s, i, j)] = trimmed(d, i, j);
            if (i < d->m - 1 && j < d->n - 1)
                cut[i + (int64_t)j * (d->m - 1)] = severed(d, i, j);
        }
    struct cloth *c = &s->cloth;
    ref_cloth_size(&def, c);
    c->cell = room(s->count, 1);
    c->springs = room(s->count, 1);
    c->beside = room(s->count, 1);
    c->fixed = s->fixed;
    c->mass = s->mass;
    c->tri = room(2 * s->count, sizeof *c->tri);
    ref_cloth_fill(&def, c, 0);
    free(hole);
    free(cut);
}

/* Where the particles are, in the shape of the design. */
static void add_positions(const struct design *d, double h, struct system *s)
{
    double(*x)[3] = room(s->count, sizeof *x);
    for (int64_t p = 0; p < s->count; p++) {
        int32_t i = (int32_t)(p % s->m), j = (int32_t)(p / s->m);
        if (d->shape == SHAPE_FOLDED && j > 0) {
            memcpy(x[p], x[i], sizeof *x);
            x[p][2] = j * h;
        } else
            place(d->shape, i * h, j * h, h, x[p]);
    }
    for (uint64_t k = 0; k < 3 * (uint64_t)s->count; k++)
        x[k / 3][k % 3] += d->uneven * h * noise_of(k);
    for (int64_t p = 0; p < s->count; p++)
        s->x[p] = vec_make((real)x[p][0], (real)x[p][1], (real)x[p][2]);
    free(x);
}

/* The right-hand side of a step from rest: springs, triples and gravity. */
static void add_forces(struct system *s)
{
    const struct cloth *c = &s->cloth;
    struct springs f = {.m = s->m,
                        .n = s->n,
                        .count = s->count,
                        .mass = s->mass,
                        .x = s->x,
                        .gravity = vec_make(0, R(-9.81), 0),
                        .force = s->b};
    GIVE_CLOTH(&f, c);
    ref_springs(&f);
    for (int64_t p = 0; p < s->count; p++)
        s->b[p] = s->fixed[p] ? vec_make(0, 0, 0) : vec_scale(s->tau, s->b[p]);
}

void make_system(const struct design *d, struct system *s)
{
    double h = 1.0 / ((d->m > d->n ? d->m : d->n) - 1);
    *s = (struct system){.m = d->m, .n = d->n, .tau = R(1.0 / 60)};
    s->count = (int64_t)d->m * d->n;
    s->n_blocks = SPRINGS * s->count;
    s->mass = room(s->count, sizeof *s->mass);
    s->block = room(s->n_blocks, sizeof *s->block);
    s->packed = room(s->n_blocks, sizeof *s->packed);
    s->fixed = room(s->count, sizeof *s->fixed);
    s->b = room(s->count, sizeof *s->b);
    s->x = room(s->count, sizeof *s->x);
    add_cloth(d, h, s);
    s->triples = s->cloth.triples > 0;
    for (int64_t p = 0; p < s->count; p++)
        if (!s->fixed[p] && pinned(d, (int32_t)(p % s->m), (int32_t)(p / s->m)))
            s->fixed[p] = CLOTH_PINNED;
    add_positions(d, h, s);
    add_forces(s);
    struct blocks b = blocks_of(s);
    ref_blocks(&b);
}

void hold_system(struct system *a, uint32_t every)
{
    a->n_extra = a->count;
    a->extra = room(a->count, sizeof *a->extra);
    for (int64_t p = 0; p < a->count; p++) {
        uint64_t seed = (uint64_t)(8 * p);
        vec n = vec_make((real)noise_of(seed), (real)noise_of(seed + 1),
                         (real)(1 + noise_of(seed + 2)));
        bool held = (1 + noise_of(seed + 3)) / 2 * every < 1;
        if (held)
            a->extra[p] = (sym){n.x * n.x, n.x * n.y, n.x * n.z,
                                n.y * n.y, n.y * n.z, n.z * n.z};
        a->b[p] = held && !a->fixed[p] ? n : vec_make(0, 0, 0);
    }
}

void free_system(struct system *s)
{
    free(s->mass);
    free(s->extra);
    free(s->block);
    free(s->packed);
    free(s->fixed);
    free(s->b);
    free(s->x);
    free(s->cloth.cell);
    free(s->cloth.springs);
    free(s->cloth.beside);
    free(s->cloth.tri);
}

mat dense_entry(const struct system *s, int64_t p, int64_t q)
{
    sym a = {0, 0, 0, 0, 0, 0};
    int64_t di = q % s->m - p % s->m, dj = q / s->m - p / s->m;
    if (p == q) {
        a.xx = a.yy = a.zz = s->mass[p];
        a = s->n_extra ? sym_add(a, s->extra[p]) : a;
    }
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s->block + o * s->count;
        int64_t step = spring_di[o] + (int64_t)s->m * spring_dj[o];
        int64_t i = p % s->m, j = p / s->m, x = spring_di[o], y = spring_dj[o];
        if (p == q && i + x >= 0 && i + x < s->m && j + y < s->n)
            a = sym_add(a, block[p]);
        if (p == q && i - x >= 0 && i - x < s->m && j - y >= 0)
            a = sym_add(a, block[p - step]);
        if (di == x && dj == y)
            a = block[p];
        if (di == -x && dj == -y)
            a = block[q];
    }
    real sign = p == q ? 1 : -1;
    mat r = {vec_make(sign * a.xx + 0, sign * a.xy + 0, sign * a.xz + 0),
             vec_make(sign * a.xy + 0, sign * a.yy + 0, sign * a.yz + 0),
             vec_make(sign * a.xz + 0, sign * a.yz + 0, sign * a.zz + 0)};
    return r;
}
