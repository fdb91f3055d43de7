/* SPDX-License-Identifier: Apache-2.0 */
/* Tests the narrow phase on the device: all candidates of the public frames,
 * against the reference and the known truth, with times. */
#include <stdio.h>
#include <stdlib.h>

#include "gpu/run/gpu.h"
#include "tests/base/data.h"
#include "tests/base/harness.h"
#include "tests/base/stages.h"
#include "tests/narrow/sweep.h"

enum { RUNS = 11 };

struct pairs {
    int64_t n, room;
    int32_t *pair;
    uint8_t *kind;
    bool failed;
};

static void append(void *user, int kind, const int32_t v[4])
{
    struct pairs *p = user;
    if (p->n == p->room) {
        p->room = 2 * p->room + 1024;
        void *pair = realloc(p->pair, (size_t)p->room * 4 * sizeof *p->pair);
        p->pair = pair ? pair : p->pair;
        void *kinds = realloc(p->kind, (size_t)p->room);
        p->kind = kinds ? kinds : p->kind;
        p->failed = p->failed || !pair || !kinds;
    }
    if (p->failed)
        return;
    memcpy(p->pair + 4 * p->n, v, 4 * sizeof *v);
    p->kind[p->n++] = (uint8_t)kind;
}

/* Copies n items to the device, or only allocates them if host is NULL. */
static void *put(struct gpu *g, const void *host, int64_t n, size_t size)
{
    void *p = gpu_take(g, ARENA_OTHER, n, size);
    if (p && host)
        gpu_up(g, p, host, (size_t)n * size);
    return p;
}

/* Runs s on the device and stores the shortest time. */
static int run(struct gpu *g, struct narrow *s, double *seconds)
{
    struct narrow d = *s;
    d.pair = put(g, s->pair, 4 * s->n, sizeof *s->pair);
    d.kind = put(g, s->kind, s->n, 1);
    d.x0 = put(g, s->x0, s->nv, sizeof *s->x0);
    d.x1 = put(g, s->x1, s->nv, sizeof *s->x1);
    d.toi = put(g, NULL, s->n, sizeof *s->toi);
    d.tier = put(g, NULL, s->n, 1);
    int status = gpu_status(g);
    *seconds = HUGE_VAL;
    for (int k = 0; k < (getenv("DRAPE_SOAK") ? RUNS : 1) && !status; k++) {
        gpu_clock_start(g);
        status = gpu_narrow(g, &d);
        double t = gpu_clock_stop(g);
        *seconds = t < *seconds ? t : *seconds;
    }
    gpu_down(g, s->toi, d.toi, (size_t)s->n * sizeof *s->toi);
    gpu_down(g, s->tier, d.tier, (size_t)s->n);
    return status ? status : gpu_status(g);
}

/* Runs reference and device and compares them. toi and tier have room for the
 * results of both. */
static const char *compare(const char *name, struct narrow *s, int64_t hits,
                           uint32_t *toi, uint8_t *tier)
{
    int status, touching = 0, tiers[3] = {0};
    double seconds;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g)
        return skip("there is no device");
    status = run(g, s, &seconds);
    if (getenv("DRAPE_SOAK"))
        printf("%s, binary%d on %s: %lld candidates, %.3f ms, %.1f M/s\n", name,
               REAL_BITS, gpu_name(g), (long long)s->n, 1e3 * seconds,
               1e-6 * (double)s->n / seconds);
    gpu_close(g);
    EXPECT(status == DRAPE_OK);
    for (int64_t k = 0; k < s->n; k++) {
        touching += s->toi[k] != NARROW_MISS;
        tiers[s->tier[k] - 1]++;
    }
    if (getenv("DRAPE_SOAK"))
        printf("  touching %d of %lld known, tiers %d %d %d\n", touching,
               (long long)hits, tiers[0], tiers[1], tiers[2]);
    struct narrow r = *s;
    r.toi = toi;
    r.tier = tier;
    EXPECT(ref_narrow(&r) == DRAPE_OK && hits > 0);
    EXPECT(!memcmp(toi, s->toi, (size_t)s->n * sizeof *toi));
    EXPECT(!memcmp(tier, s->tier, (size_t)s->n));
    EXPECT(touching == hits);
    ran(s->n);
    return NULL;
}

static void ignore(void *user, int kind, const int32_t v[4])
{
    (void)user, (void)kind, (void)v;
}

static const char *check_scene(const char *name, int parts)
{
    struct frames f = {.from = 0};
    struct pairs p = {.n = 0};
    int64_t lines, hits = 0;
    const char *what = "a frame cannot be read";
    if (frames_read(name, &f)) {
        frames_slab(&f, parts);
        hits = frames_hits(&f, name, ignore, NULL, &lines);
        p.failed = !frames_sweep(&f, append, &p);
    }
    size_t n = (size_t)p.n;
    uint32_t *toi = calloc(2 * n + 1, sizeof *toi);
    uint8_t *tier = calloc(2 * n + 1, 1);
    struct narrow s = {.n = p.n,
                       .pair = p.pair,
                       .kind = p.kind,
                       .x0 = f.at[0].x,
                       .x1 = f.at[1].x,
                       .nv = f.at[0].nv,
                       .toi = toi,
                       .tier = tier};
    if (toi && tier && n && !p.failed)
        what = compare(name, &s, hits, toi + n, tier + n);
    free(toi);
    free(tier);
    free(p.pair);
    free(p.kind);
    frames_free(&f);
    return what;
}

/* Tests a slab of each scene, or all candidates with the shortest of several
 * times where DRAPE_SOAK is set. */
const char *test_narrow_gpu(void)
{
    bool all = getenv("DRAPE_SOAK");
    FILE *f = data_open("ccd/frames/cloth-ball/hits.txt");
    if (!f)
        return skip("no ccd/frames in DRAPE_DATA" FETCHED);
    fclose(f);
    if (REAL_BITS == 64)
        return check_scene("cloth-funnel", 0);
    const char *what = check_scene("cloth-ball", all ? 0 : 16);
    f = all ? data_open("ccd/frames/n-body-simulation/hits.txt") : NULL;
    if (f && !what)
        what = check_scene("n-body-simulation", 0);
    if (f)
        fclose(f);
    return what;
}
