/* SPDX-License-Identifier: Apache-2.0 */
/* Measures the price of exactness: times kernels of one precision on a wavy
 * cloth of 1008 × 1008 particles. */
#include "bench/price.h"

#include <stdio.h>
#include <stdlib.h>

#include "ref/cloth/cloth.h"

enum { SIDE = 1008, REPEATS = 31, BATCH = 20, FLAVOURS = 3 };
static const int64_t flood = INT64_C(256) << 20; /* bytes, beyond any cache */

struct bench {
    struct gpu *g;
    struct springs springs;
    struct dot dot;
    int64_t *word;
    void *flood;
    vec *here, *exact; /* forces on the host */
};

static void *need(void *p)
{
    if (!p) {
        fputs("price: out of memory\n", stderr);
        exit(1);
    }
    return p;
}

static void *give(struct bench *b, const void *host, int64_t n, size_t size)
{
    void *p = need(gpu_take(b->g, ARENA_OTHER, n, size));
    if (host)
        gpu_up(b->g, p, host, (size_t)n * size);
    return p;
}

/* Makes waves of parabolas with some noise, so that springs are in tension, in
 * compression and buckled, and neighbours differ. */
static void make_state(vec *x, vec *v)
{
    uint32_t random = 1;
    for (int p = 0; p < SIDE * SIDE; p++) {
        real a = (real)(p % 32) / 16 - 1, b = (real)(p / SIDE % 48) / 24 - 1;
        real n[3];
        for (int k = 0; k < 3; k++) {
            random = random * 1664525 + 1013904223;
            n[k] = (real)(random >> 8) / (1 << 23) - 1;
        }
        real cell = R(1.0) / (SIDE - 1);
        x[p] = vec_make(cell * ((real)(p % SIDE) + R(0.05) * n[0]),
                        cell * ((real)(p / SIDE) + R(0.05) * n[1]),
                        cell * (4 * a * a + 3 * b * b + R(0.05) * n[2]));
        v[p] = vec_make(R(0.1) * n[1], R(0.1) * n[2], n[0]);
    }
}

static void make_cloth(struct cloth *c)
{
    drape_cloth d;
    drape_default_cloth(&d);
    d.m = d.n = SIDE;
    d.width = d.height = 1;
    if (ref_cloth_size(&d, c) != DRAPE_OK)
        exit(1);
    c->cell = need(calloc((size_t)c->count, 1));
    c->springs = need(calloc((size_t)c->count, 1));
    c->fixed = need(calloc((size_t)c->count, 1));
    c->mass = need(calloc((size_t)c->count, sizeof *c->mass));
    c->tri = need(calloc((size_t)c->n_triangles, sizeof *c->tri));
    if (ref_cloth_fill(&d, c, 0) != DRAPE_OK)
        exit(1);
}

static void make(struct bench *b)
{
    struct cloth c;
    make_cloth(&c);
    size_t bytes = (size_t)c.count * sizeof(vec);
    vec *x = need(malloc(bytes)), *v = need(malloc(bytes));
    make_state(x, v);
    vec *there = give(b, x, c.count, sizeof *x);
    vec *speed = give(b, v, c.count, sizeof *v);
    b->springs = (struct springs){
        .m = SIDE,
        .n = SIDE,
        .count = c.count,
        .laws = SPRINGS,
        .law = give(b, c.law, SPRINGS, sizeof *c.law),
        .springs = give(b, c.springs, c.count, 1),
        .mass = give(b, c.mass, c.count, sizeof *c.mass),
        .x = there,
        .n_v = c.count,
        .v = speed,
        .gravity = vec_make(0, R(-9.81), 0),
        .force = give(b, NULL, c.count, sizeof *b->springs.force)};
    b->dot = (struct dot){
        .n = c.count,
        .a = there,
        .b = speed,
        .n_chunks = sum_chunks(c.count),
        .chunk = give(b, NULL, sum_chunks(c.count), sizeof *b->dot.chunk)};
    b->word = give(b, NULL, 2, sizeof *b->word);
    b->flood = give(b, NULL, flood, 1);
    b->here = x;
    b->exact = v;
    free(c.cell);
    free(c.springs);
    free(c.fixed);
    free(c.mass);
    free(c.tri);
}

enum kernel { KERNEL_SPRINGS, KERNEL_DOT, KERNEL_LOOSE, KERNELS };
static const char *const kernel_name[] = {"springs", "dot", "loose dot"};

static void launch(struct bench *b, const struct price *p, enum kernel k)
{
    if (k == KERNEL_SPRINGS)
        p->springs(b->g, &b->springs);
    else
        (k == KERNEL_DOT ? p->dot : p->loose)(b->g, &b->dot, b->word);
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the median seconds of a launch. cold: the caches are flushed before
 * each launch; else a time is the mean of a batch of launches. */
static double seconds(struct bench *b, const struct price *p, enum kernel k,
                      bool cold)
{
    double s[REPEATS];
    int times = cold ? 1 : BATCH;
    for (int r = 0; r < REPEATS; r++) {
        if (cold)
            gpu_clear(b->g, b->flood, (size_t)flood);
        gpu_clock_start(b->g);
        for (int n = 0; n < times; n++)
            launch(b, p, k);
        s[r] = gpu_clock_stop(b->g) / times;
    }
    qsort(s, REPEATS, sizeof *s, ascending);
    return s[REPEATS / 2];
}

/* Returns the largest difference of a coordinate, divided by the largest
 * coordinate. */
static double off(const vec *a, const vec *b, int64_t n)
{
    double most = 0, size = 0;
    const real *x = &a->x, *y = &b->x;
    for (int64_t k = 0; k < 3 * n; k++) {
        double d = fabs((double)x[k] - (double)y[k]), z = fabs((double)y[k]);
        most = d <= most ? most : d; /* once NaN, it stays NaN */
        size = z <= size ? size : z;
    }
    return most / size;
}

/* Returns the relative difference of the result of p's kernel from the exact
 * kernel's. */
static double differs(struct bench *b, const struct price *p, enum kernel k)
{
    size_t bytes = (size_t)b->springs.count * sizeof(vec);
    real sum[2];
    launch(b, p, k);
    if (k == KERNEL_SPRINGS) {
        gpu_down(b->g, b->here, b->springs.force, bytes);
        launch(b, &price_exact, k);
        gpu_down(b->g, b->exact, b->springs.force, bytes);
        return off(b->here, b->exact, b->springs.count);
    }
    gpu_down(b->g, &sum[0], b->word, sizeof *sum);
    launch(b, &price_exact, KERNEL_DOT);
    gpu_down(b->g, &sum[1], b->word, sizeof *sum);
    return fabs((double)sum[0] / (double)sum[1] - 1);
}

int price_run(struct gpu *g)
{
    static const struct price *const flavour[FLAVOURS] = {
        &price_exact, &price_fma, &price_fast};
    struct bench b = {.g = g};
    make(&b);
    for (int k = 0; k < KERNELS; k++) {
        double hot[FLAVOURS], cold[FLAVOURS];
        for (int f = 0; f < FLAVOURS; f++) {
            seconds(&b, flavour[f], k, false); /* warms up */
            hot[f] = seconds(&b, flavour[f], k, false);
            cold[f] = seconds(&b, flavour[f], k, true);
            printf("%s,%d,%s,%.2f,%.2f,%.3f,%.3f,%.2g\n", kernel_name[k],
                   REAL_BITS, flavour[f]->flags, 1e6 * hot[f], 1e6 * cold[f],
                   hot[0] / hot[f], cold[0] / cold[f],
                   differs(&b, flavour[f], k));
            fflush(stdout);
        }
    }
    free(b.here);
    free(b.exact);
    return gpu_status(g);
}
