/* SPDX-License-Identifier: Apache-2.0 */
/* Measures the narrow phase, FCL and the GMP oracle on the same candidates of
 * cloth-ball, on one thread. A part of `make bench`. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "oracle/oracle.h"
#include "ref/narrow/narrow.h"
#include "tests/base/data.h"
#include "tests/base/harness.h"
/* its names need the harness's */
#include "tests/narrow/ply.h"

enum { MOST = 400000 }; /* candidates; at most half are vertex-face */

struct item {
    vec lo, hi;
    int32_t v[3];
    int n; /* vertices: 1 vertex, 2 edge, 3 face */
};

struct list {
    int32_t (*v)[4];
    uint8_t *kind;
    int n;
};

static struct ply at[2];

/* Reads cloth-ball before (0) or after (1) its step. False if the file is
 * missing. */
static bool frame_read(int t)
{
    char path[512];
    snprintf(path, sizeof path, "%s/ccd/frames/cloth-ball/t%d.ply", data_home(),
             t);
    return ply_read(path, &at[t]);
}

static double now(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_x(const void *a, const void *b)
{
    real p = ((const struct item *)a)->lo.x, q = ((const struct item *)b)->lo.x;
    return (p > q) - (p < q);
}

static struct item make_item(int n, const int32_t *v)
{
    struct item i = {at[0].x[v[0]], at[0].x[v[0]], {0}, n};
    for (int k = 0; k < n; k++) {
        i.v[k] = v[k];
        for (int t = 0; t < 2; t++) {
            i.lo = vec_min(i.lo, at[t].x[v[k]]);
            i.hi = vec_max(i.hi, at[t].x[v[k]]);
        }
    }
    return i;
}

/* Adds a vertex and a face, or two edges, to the list if their swept boxes meet
 * and they have no common vertex. */
static void offer(struct list *l, const struct item *a, const struct item *b)
{
    if (a->n + b->n != 4 || a->lo.y > b->hi.y || b->lo.y > a->hi.y ||
        a->lo.z > b->hi.z || b->lo.z > a->hi.z)
        return;
    if (a->n > b->n) {
        const struct item *c = a;
        a = b;
        b = c;
    }
    for (int i = 0; i < a->n; i++)
        for (int j = 0; j < b->n; j++)
            if (a->v[i] == b->v[j])
                return;
    memcpy(l->v[l->n], a->v, (size_t)a->n * sizeof *a->v);
    memcpy(l->v[l->n] + a->n, b->v, (size_t)b->n * sizeof *b->v);
    l->kind[l->n++] = a->n == 2;
}

/* Finds candidates of vertices and faces, or of edges, by sorting along x and
 * starting from the middle, until the list has `most`. An edge of two faces is
 * taken once: from the face in which its smaller vertex comes first. */
static void sweep(struct list *l, bool edges, int most)
{
    size_t n = 0, room = (size_t)at[0].nv + 3 * (size_t)at[0].nt;
    struct item *item = calloc(room, sizeof *item);
    if (!item)
        exit(3);
    for (int32_t k = 0; k < at[0].nv && !edges; k++)
        item[n++] = make_item(1, &k);
    for (int32_t k = 0; k < at[0].nt; k++)
        for (int j = 0; j < (edges ? 3 : 1); j++) {
            const int32_t *t = at[0].tri[k], e[2] = {t[j], t[(j + 1) % 3]};
            if (!edges)
                item[n++] = make_item(3, t);
            else if (e[0] < e[1])
                item[n++] = make_item(2, e);
        }
    qsort(item, n, sizeof *item, by_x);
    for (size_t a = n / 2; a < n; a++)
        for (size_t b = a + 1; b < n && item[b].lo.x <= item[a].hi.x; b++)
            if (l->n < most)
                offer(l, &item[a], &item[b]);
    free(item);
}

static int narrow(int kind, const vec a[4], const vec b[4])
{
    int tier;
    return (kind ? narrow_ee(a, b, &tier) : narrow_vf(a, b, &tier)) !=
           NARROW_MISS;
}

/* Decides one pair by a method: 0 the narrow phase, 1 FCL, 2 the GMP oracle. */
static int decide(int method, int kind, const int32_t v[4])
{
    vec a[2][4];
    double x[2][4][3], t;
    uint32_t toi;
    for (int i = 0; i < 8; i++)
        a[i / 4][i % 4] = at[i / 4].x[v[i % 4]];
    if (method == 0)
        return narrow(kind, a[0], a[1]);
    for (int i = 0; i < 8; i++) {
        x[i / 4][i % 4][0] = (double)a[i / 4][i % 4].x;
        x[i / 4][i % 4][1] = (double)a[i / 4][i % 4].y;
        x[i / 4][i % 4][2] = (double)a[i / 4][i % 4].z;
    }
    const double(*x0)[3] = (const double(*)[3])x[0];
    const double(*x1)[3] = (const double(*)[3])x[1];
    return method == 1 ? orc_ccd_fcl(kind, 0, x0, x1, &t)
                       : orc_ccd_gmp(kind, x0, x1, &toi);
}

/* Returns the time of the slowest pair in the narrow phase, s. The time of a
 * pair is the least of five runs. */
static double worst_of(const struct list *l)
{
    double worst = 0;
    for (int k = 0; k < l->n; k++) {
        double least = 1;
        for (int run = 0; run < 5 && least > worst; run++) {
            double start = now(CLOCK_MONOTONIC);
            decide(0, l->kind[k], l->v[k]);
            double s = now(CLOCK_MONOTONIC) - start;
            least = s < least ? s : least;
        }
        worst = least > worst ? least : worst;
    }
    return worst;
}

int main(void)
{
    static const char *const names[] = {"narrow", "FCL 0.7 Newton", "GMP"};
    struct list l = {calloc(MOST, sizeof *l.v), calloc(MOST, 1), 0};
    if (!l.v || !l.kind || !orc_present() || !frame_read(0) || !frame_read(1)) {
        puts("skipped: no ccd/frames in DRAPE_DATA, or no oracles here");
        return 0;
    }
    sweep(&l, false, MOST / 2);
    sweep(&l, true, MOST);
    double rate[3];
    printf("method,candidates,touch,M/s,narrow is faster by\n");
    for (int m = 0; m < 3; m++) {
        int hits = 0;
        double start = now(CLOCK_THREAD_CPUTIME_ID);
        for (int k = 0; k < l.n; k++)
            hits += decide(m, l.kind[k], l.v[k]);
        rate[m] = 1e-6 * l.n / (now(CLOCK_THREAD_CPUTIME_ID) - start);
        printf("%s,%d,%d,%.3g,%.3g\n", names[m], l.n, hits, rate[m],
               rate[0] / rate[m]);
    }
    printf("worst query of narrow: %.1f us\n", 1e6 * worst_of(&l));
    return 0;
}
