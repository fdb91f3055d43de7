/* SPDX-License-Identifier: Apache-2.0 */
/* The modes of check that run on the device: comparison with the reference,
 * timing, and the rows of a certificate. spec/gpu.md §7 */
#include <dirent.h>
#include <stdio.h>

#include "tests/base/device.h"
#include "tests/base/modes.h"

/* Compares all cases of a stage on the device with the reference. */
static void run_device(struct gpu *g, const struct stage *stage, int bits)
{
    const char *what = NULL;
    int64_t good = 0;
    for (int z = 0; z < SIZES && !what; z++)
        for (int k = 0; k < options.cases && !what; k++) {
            struct bytes b = seeded(sizes[z], k);
            struct case_result c = device_case(stage, &b, g);
            what = c.failed;
            good += c.status == DRAPE_OK;
            if (what)
                save_case(stage->name, bits, &b);
            choices_free(&b);
        }
    if (!what && !good)
        what = "no case ran to its end";
    report("device", stage->name, bits, what);
}

void run_devices(void)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    printf("device: %s\n", g ? gpu_name(g) : drape_status_text(status));
    if (!g)
        report("device", "gpu_open", 0, "there is none");
    if (g && options.ranks)
        gpu_set_ranks(g, options.ranks);
    if (g && options.hosted)
        gpu_set_hosted(g);
    for (int k = 0; k < 2 && g; k++)
        for (const struct stage *s = stages(k); s->name; s++)
            if (wanted(s->name))
                run_device(g, s, bits_of[k]);
    gpu_close(g);
}

/* Whether some case of a stage has other results when threads run in this
 * way. */
static bool caught(struct gpu *g, const struct stage *s, struct gpu_way way)
{
    static const int64_t size[] = {33, 257, 1000};
    bool differs = false;
    for (int k = 0; k < 3 && !differs; k++) {
        struct bytes b = seeded(size[k], 0);
        differs = device_differs(s, &b, g, way);
        choices_free(&b);
    }
    return differs;
}

void self_test_races(void)
{
    static const struct {
        const char *stage;
        int left_out, parted;
    } planted[] = {{"sum", 2, 0},
                   {"sum", 3, 0},
                   {"multigrid", 2, 0},
                   {"multigrid", 0, 2},
                   {"multigrid", 0, 3}};
    int status, by[2] = {0, 0};
    struct gpu *g = gpu_open(NULL, &status);
    for (size_t k = 0; k < sizeof planted / sizeof *planted; k++)
        for (const struct stage *s = stages(0); g && s->name; s++) {
            if (gpu_device(g) >= 0 || strcmp(s->name, planted[k].stage))
                continue;
            struct gpu_way up = {.left_out = planted[k].left_out,
                                 .parted = planted[k].parted};
            struct gpu_way down = up;
            down.descending = true;
            bool one = caught(g, s, up), other = caught(g, s, down);
            by[0] += one && !other;
            by[1] += other && !one;
            report("self-test of races", s->name, 32,
                   one || other ? NULL : "a barrier left out");
        }
    if (g && gpu_device(g) < 0)
        report("self-test of races", "both orders", 32,
               by[0] && by[1] ? NULL : "one of them found nothing alone");
    gpu_close(g);
}

/* The last column is the time over a lower bound: all bytes moved once at the
 * copy speed of an H200, reads and writes counted. */
void bench_gpu(void)
{
    const double copied = 4.27e12;
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    printf("stage,bits,us,MiB,GB/s,times its floor\n");
    for (int k = 0; k < 2 && g; k++)
        for (const struct stage *s = stages(k); s->name; s++) {
            int64_t bytes;
            if (!wanted(s->name))
                continue;
            double t = device_bench(s, g, &bytes);
            printf("%s,%d,%.4g,%.4g,%.4g,%.3g\n", s->name, bits_of[k], 1e6 * t,
                   (double)bytes / 1048576, (double)bytes / t / 1e9,
                   t * copied / (double)bytes);
            fflush(stdout);
        }
    gpu_close(g);
}

struct row {
    int cases, good, mismatches; /* good: ref returned DRAPE_OK */
};

static void count(struct row *r, const char *stage, struct case_result c)
{
    r->cases++;
    r->good += c.status == DRAPE_OK;
    r->mismatches += c.failed != NULL;
    if (c.failed)
        printf("FAILED %s: %s\n", stage, c.failed);
}

static void certify_cases(struct gpu *g, const struct stage *s, struct row *r)
{
    for (int z = 0; z < SIZES; z++)
        for (int k = 0; k < options.cases; k++) {
            struct bytes b = seeded(sizes[z], k);
            count(r, s->name, device_case(s, &b, g));
            choices_free(&b);
        }
}

static void certify_file(struct gpu *g, const struct stage *s, const char *path,
                         struct row *r)
{
    static uint32_t words[1 << 14];
    FILE *f = fopen(path, "rb");
    if (!f)
        return;
    struct bytes b = {.data = words, .size = -1};
    b.n_data = fread(words, sizeof *words, sizeof words / sizeof *words, f);
    fclose(f);
    count(r, s->name, device_case(s, &b, g));
    choices_free(&b);
}

static void certify_corpus(struct gpu *g, const struct stage *s,
                           const char *corpus, struct row *r)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", corpus, s->name);
    DIR *dir = opendir(path);
    if (!dir)
        return;
    for (struct dirent *e; (e = readdir(dir));)
        if (e->d_name[0] != '.') {
            snprintf(path, sizeof path, "%s/%s/%s", corpus, s->name, e->d_name);
            certify_file(g, s, path, r);
        }
    closedir(dir);
}

void certify(const char *corpus)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g) {
        report("certify", "gpu_open", 0, drape_status_text(status));
        return;
    }
    printf("device %s\n", gpu_name(g));
    for (int k = 0; k < 2; k++)
        for (const struct stage *s = stages(k); s->name; s++) {
            if (!wanted(s->name))
                continue;
            struct row r = {0};
            certify_cases(g, s, &r);
            certify_corpus(g, s, corpus, &r);
            r.mismatches += !r.good; /* if every case was refused, nothing
                                        was compared */
            printf("stage %s %d %d %d %016llx\n", s->name, bits_of[k], r.cases,
                   r.mismatches,
                   (unsigned long long)run_stage(s, bits_of[k], true));
            report("certify", s->name, bits_of[k],
                   r.mismatches ? "the device differs" : NULL);
        }
    gpu_close(g);
}
