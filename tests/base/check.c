/* SPDX-License-Identifier: Apache-2.0 */
/* The test program: generated cases, tests, golden hashes, replay of failures,
 * self-test and benchmark of every stage in spec/stages.def. */
#include <stdio.h>
#include <stdlib.h>

#include "ref/base/threads.h"
#include "tests/base/modes.h"
#include "tests/base/tally.h"

extern const struct stage stages_table_32[], stages_table_64[];
extern const struct test tests_table_32[], tests_table_64[];

const int bits_of[2] = {32, 64};
const struct stage *stages(int k)
{
    return k ? stages_table_64 : stages_table_32;
}
static const struct test *tests(int k)
{
    return k ? tests_table_64 : tests_table_32;
}

const int64_t sizes[SIZES] = {0, 1, 2, 3, 31, 32, 33, 255, 256, 257, 1000};
int passed, failed, skipped;

bool wanted(const char *name)
{
    return !options.only || !strcmp(options.only, name);
}

void save_case(const char *stage, int bits, const struct bytes *b)
{
    char path[256];
    const char *dir = getenv("DRAPE_FAILURES");
    snprintf(path, sizeof path, "%s/%s-%d.case", dir ? dir : ".", stage, bits);
    FILE *f = fopen(path, "wb");
    if (!f)
        return;
    fprintf(f, "%s %d\n", stage, bits);
    fwrite(b->record, sizeof *b->record, b->n_record, f);
    fclose(f);
    printf("  again: check --replay %s\n", path);
}

void report(const char *kind, const char *name, int bits, const char *what)
{
    if (what) {
        printf("FAILED %s %s, %d bits: %s\n", kind, name, bits, what);
        failed++;
    } else
        passed++;
    fflush(stdout);
}

struct bytes seeded(int64_t size, int k)
{
    struct bytes b = {.seed = options.seed * 1000003 + (uint64_t)size * 101 +
                              (uint64_t)k,
                      .size = size};
    return b;
}

uint64_t run_stage(const struct stage *stage, int bits, bool quiet)
{
    uint64_t hash = HASH_START;
    int64_t good = 0;
    const char *what = NULL;
    for (int z = 0; z < SIZES && !what; z++)
        for (int k = 0; k < options.cases && !what; k++) {
            struct bytes b = seeded(sizes[z], k);
            struct case_result c =
                case_run(stage, &b, FAULT_NONE, !options.plain);
            what = c.failed;
            good += c.status == DRAPE_OK;
            hash = hash_bytes(hash, &c.hash, sizeof c.hash);
            if (what && !quiet)
                save_case(stage->name, bits, &b);
            choices_free(&b);
        }
    if (!what && !good)
        what = "no case ran to its end";
    if (!quiet)
        report("stage", stage->name, bits, what);
    return hash;
}

static void run_stages(void)
{
    for (int k = 0; k < 2; k++)
        for (const struct stage *s = stages(k); s->name; s++)
            if (wanted(s->name))
                run_stage(s, bits_of[k], false);
}

static void run_tests(void)
{
    for (int k = 0; k < 2; k++)
        for (const struct test *t = tests(k); t->name; t++) {
            if (!wanted(t->name) ||
                (options.bits && options.bits != bits_of[k]))
                continue;
            tally = (struct tally){0};
            const char *what = t->run();
            if (tally.skipped) {
                printf("skipped: test %s, %d bits: %s\n", t->name, bits_of[k],
                       tally.skipped);
                skipped++;
                continue;
            }
            if (!what && !tally.cases)
                what = "it ran no case";
            report("test", t->name, bits_of[k], what);
        }
}

/* Each kind of planted fault must be caught in at least one case of each stage
 * that can have the fault. */
static void self_test(void)
{
    static const char *const names[] = {"none",    "flip",     "miss",
                                        "overrun", "underrun", "input"};
    for (const struct stage *s = stages(0); s->name; s++)
        for (int f = 1; f < FAULT_COUNT && wanted(s->name); f++) {
            bool planted = false, caught = false;
            for (int k = 0; k < 40 && !caught; k++) {
                struct bytes b = seeded(33, k);
                struct case_result c = case_run(s, &b, (enum fault)f, false);
                planted |= c.faulted;
                caught |= c.faulted && c.failed;
                choices_free(&b);
            }
            if (planted)
                report("self-test", s->name, 32, caught ? NULL : names[f]);
        }
    if (!options.only)
        self_test_races();
}

static void golden(const char *path, bool write)
{
    FILE *f = fopen(path, write ? "w" : "r");
    if (!f) {
        report("golden", path, 0, "cannot be opened");
        return;
    }
    char name[64];
    int bits;
    uint64_t want;
    for (int k = 0; k < 2 && write; k++)
        for (const struct stage *s = stages(k); s->name; s++, passed++)
            fprintf(f, "%s %d %016llx\n", s->name, bits_of[k],
                    (unsigned long long)run_stage(s, bits_of[k], true));
    while (!write && fscanf(f, "%63s %d %llx", name, &bits,
                            (unsigned long long *)&want) == 3) {
        const struct stage *s = stages(bits == 64);
        while (s->name && strcmp(s->name, name))
            s++;
        if (!wanted(name))
            continue;
        report("golden", name, bits,
               !s->name ? "no such stage"
               : run_stage(s, bits, false) == want
                   ? NULL
                   : "other bits than recorded");
    }
    /* A stage without a recorded hash is a failure, too. */
    rewind(f);
    int lines = 0, rows = 0;
    for (int c; !write && (c = fgetc(f)) != EOF;)
        lines += c == '\n';
    for (const struct stage *s = stages(0); s->name; s++)
        rows += 2;
    if (!write)
        report("golden", "all stages recorded", 0,
               lines == rows ? NULL : "another number of lines than stages");
    fclose(f);
}

static void replay(const char *path)
{
    static uint32_t words[1 << 18];
    char name[64] = "";
    int bits = 0;
    FILE *f = fopen(path, "rb");
    if (!f || fscanf(f, "%63s %d", name, &bits) != 2 || fgetc(f) != '\n') {
        report("replay", path, 0, "not a case file");
        if (f)
            fclose(f);
        return;
    }
    struct bytes b = {.data = words, .size = -1};
    b.n_data = fread(words, sizeof *words, sizeof words / sizeof *words, f);
    fclose(f);
    const struct stage *s = stages(bits == 64);
    while (s->name && strcmp(s->name, name))
        s++;
    report("replay", path, bits,
           s->name ? case_run(s, &b, FAULT_NONE, true).failed
                   : "no such stage");
    choices_free(&b);
}

static void bench(void)
{
    printf("stage,bits,ms,MiB,GiB/s\n");
    for (int k = 0; k < 2; k++)
        for (const struct stage *s = stages(k); s->name; s++) {
            int64_t bytes;
            if (!wanted(s->name))
                continue;
            double t = case_bench(s, &bytes);
            printf("%s,%d,%.4g,%.4g,%.4g\n", s->name, bits_of[k], 1e3 * t,
                   (double)bytes / 1048576, (double)bytes / t / 1073741824);
            fflush(stdout);
        }
}

static void bench_solves(void)
{
    bench_solve_32();
    bench_solve_64();
}

static int usage(void)
{
    fputs("usage: check [--only NAME] [--cases N] [--seed N] [--ranks N] "
          "[--hosted] [--plain]\n"
          "             [--bits 32|64] MODE...\n"
          "  --stages        every stage on generated inputs\n"
          "  --gpu           every stage on the device, against the reference\n"
          "  --certify DIR   rows of a certificate; DIR: the fuzz corpora\n"
          "  --tests         every test of tests/tests.def, --bits: in one "
          "precision\n"
          "  --self-test     planted faults must be caught\n"
          "  --golden FILE   --stages, against recorded hashes\n"
          "  --golden-write FILE\n"
          "  --replay FILE   one recorded case\n"
          "  --lose K        the device in the K-th stage of a run\n"
          "  --bench         time of each stage as csv, --bench-gpu there\n"
          "  --bench-solve   whole solves on the device, as csv\n",
          stderr);
    return 2;
}

/* Interprets one argument: sets an option or, if `modes`, runs a mode. Options
 * are set in a first pass, so they hold for all modes wherever they stand.
 * Returns how many arguments were used; 0 if the argument is unknown. */
static int obey(const char *a, const char *value, bool modes)
{
    static const struct {
        const char *name;
        void (*run)(void);
    } plain[] = {{"--stages", run_stages},
                 {"--gpu", run_devices},
                 {"--tests", run_tests},
                 {"--self-test", self_test},
                 {"--bench", bench},
                 {"--bench-gpu", bench_gpu},
                 {"--bench-solve", bench_solves}};
    for (size_t k = 0; k < sizeof plain / sizeof *plain; k++)
        if (!strcmp(a, plain[k].name)) {
            if (modes)
                plain[k].run();
            return 1;
        }
    if (!strcmp(a, "--hosted"))
        return options.hosted = true;
    if (!strcmp(a, "--plain"))
        return options.plain = true;
    if (!value)
        return 0;
    if (!strcmp(a, "--only"))
        options.only = value;
    else if (!strcmp(a, "--cases"))
        options.cases = atoi(value);
    else if (!strcmp(a, "--bits") &&
             (!strcmp(value, "32") || !strcmp(value, "64")))
        options.bits = atoi(value);
    else if (!strcmp(a, "--seed"))
        options.seed = strtoull(value, NULL, 10);
    else if (!strcmp(a, "--ranks"))
        options.ranks = atoi(value);
    else if (!strcmp(a, "--golden") || !strcmp(a, "--golden-write")) {
        if (modes)
            golden(value, a[8] == '-');
    } else if (!strcmp(a, "--certify")) {
        if (modes)
            certify(value);
    } else if (!strcmp(a, "--lose")) {
        if (modes)
            report("device", "lost", 32, lose_device_32(atoi(value)));
    } else if (!strcmp(a, "--replay")) {
        if (modes)
            replay(value);
    } else
        return 0;
    return 2;
}

/* The number of threads for stages that are called outside a world:
 * OMP_NUM_THREADS, or 1. */
static int threads_asked(void)
{
    const char *text = getenv("OMP_NUM_THREADS");
    int n = text ? atoi(text) : 1;
    return n > 0 ? n : 1;
}

int main(int argc, char **argv)
{
    bool timed = false;
    struct threads threads;
    threads_begin(&threads, threads_asked());
    for (int modes = 0; modes < 2; modes++)
        for (int k = 1, words; k < argc; k += words) {
            words = obey(argv[k], k + 1 < argc ? argv[k + 1] : NULL, modes);
            if (!words)
                return usage();
            timed |= !strncmp(argv[k], "--bench", 7);
        }
    threads_end(&threads);
    if (timed)
        return 0;
    printf("%d passed, %d failed", passed, failed);
    printf(skipped ? ", %d skipped\n" : "\n", skipped);
    return failed || !(passed + skipped) ? 1 : 0;
}
