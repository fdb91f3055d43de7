/* SPDX-License-Identifier: Apache-2.0 */
/* The modes of check on the device: compare, time, certify. spec/50_gpu.md */
#include <dirent.h>
#include <stdio.h>

#include "tests/device.h"
#include "tests/modes.h"

/* All cases of a stage on the device, against the reference. */
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
    for (int k = 0; k < 2 && g; k++)
        for (const struct stage *s = stages(k); s->name; s++)
            if (wanted(s->name))
                run_device(g, s, bits_of[k]);
    gpu_close(g);
}

void bench_gpu(void)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    printf("stage,bits,us,MiB,GB/s\n");
    for (int k = 0; k < 2 && g; k++)
        for (const struct stage *s = stages(k); s->name; s++) {
            int64_t bytes;
            if (!wanted(s->name))
                continue;
            double t = device_bench(s, g, &bytes);
            printf("%s,%d,%.4g,%.4g,%.4g\n", s->name, bits_of[k], 1e6 * t,
                   (double)bytes / 1048576, (double)bytes / t / 1e9);
            fflush(stdout);
        }
    gpu_close(g);
}

/* ---- A certificate's rows ---- */

struct row {
    int cases, good, mismatches; /* good: those that ref ran to their end */
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
            struct row r = {0};
            certify_cases(g, s, &r);
            certify_corpus(g, s, corpus, &r);
            r.mismatches += !r.good; /* two refusals prove nothing */
            printf("stage %s %d %d %d %016llx\n", s->name, bits_of[k], r.cases,
                   r.mismatches,
                   (unsigned long long)run_stage(s, bits_of[k], true));
            report("certify", s->name, bits_of[k],
                   r.mismatches ? "the device differs" : NULL);
        }
    gpu_close(g);
}
