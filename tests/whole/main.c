/* SPDX-License-Identifier: Apache-2.0 */
/* whole [--threads N] [--jobs N] [NAME...]: runs small scenes, all or the named
 * ones, in both precisions, and writes a digest of every stage's output. N jobs
 * are N threads of this program, each with worlds of its own. */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "tests/whole/whole.h"

enum { ROWS = 64, JOBS = 8 };

/* The command line, and the output of each run. */
struct asked {
    int threads, jobs, failed[ROWS];
    char **name;
    int n_names;
    char *text[ROWS];
    size_t bytes[ROWS];
};

/* Job k makes the scenes whose number is k modulo the number of jobs, in both
 * precisions: jobs that had one precision each would share little code. */
struct job {
    pthread_t thread;
    struct asked *asked;
    int k;
};

static int wanted(const struct asked *a, const char *name)
{
    for (int k = 0; k < a->n_names; k++)
        if (strcmp(a->name[k], name) == 0)
            return 1;
    return a->n_names == 0;
}

/* Runs 2 s and 2 s + 1 are scene s in binary32 and binary64; queries are last.
 */
static void run(struct asked *a, int k)
{
    FILE *out = open_memstream(&a->text[k], &a->bytes[k]);
    if (!out) {
        a->failed[k] = 1;
    } else if (k < 2 * n_scene_rows) {
        const struct scene_row *row = &scene_rows[k / 2];
        if (wanted(a, row->name))
            a->failed[k] = !show_play(row, k % 2 ? 64 : 32, a->threads, out);
    } else if (wanted(a, "queries")) {
        show_queries(a->threads, out);
        show_refusals(out);
    }
    if (out && fclose(out))
        a->failed[k] = 1;
}

static void *work(void *user)
{
    struct job *job = user;
    for (int s = job->k; s <= n_scene_rows; s += job->asked->jobs)
        for (int k = 2 * s; k < 2 * s + 2 && k <= 2 * n_scene_rows; k++)
            run(job->asked, k);
    return NULL;
}

/* --threads and --jobs take a number; all other arguments are names of scenes.
 */
static int read_arguments(struct asked *a, int argc, char **argv)
{
    a->threads = a->jobs = 1;
    a->name = argv;
    for (int k = 1; k < argc; k++) {
        int *number = strcmp(argv[k], "--threads") == 0 ? &a->threads
                      : strcmp(argv[k], "--jobs") == 0  ? &a->jobs
                                                        : NULL;
        if (!number)
            argv[a->n_names++] = argv[k];
        else if (++k == argc || (*number = atoi(argv[k])) < 1)
            return 0;
    }
    for (int k = 0; k < a->n_names; k++) {
        int known = strcmp(a->name[k], "queries") == 0;
        for (int j = 0; j < n_scene_rows; j++)
            known |= strcmp(a->name[k], scene_rows[j].name) == 0;
        if (!known)
            return 0;
    }
    return a->jobs <= JOBS && 2 * n_scene_rows < ROWS;
}

int main(int argc, char **argv)
{
    static struct asked a;
    if (!read_arguments(&a, argc, argv)) {
        fputs("usage: whole [--threads N] [--jobs 1 to 8] [SCENE | queries]\n",
              stderr);
        return 2;
    }
    static struct job job[JOBS];
    for (int k = 0; k < a.jobs; k++) {
        job[k].asked = &a;
        job[k].k = k;
    }
    for (int k = 1; k < a.jobs; k++)
        if (pthread_create(&job[k].thread, NULL, work, &job[k]))
            return 2;
    work(&job[0]);
    for (int k = 1; k < a.jobs; k++)
        pthread_join(job[k].thread, NULL);
    int failed = 0;
    for (int k = 0; k <= 2 * n_scene_rows; k++) {
        fwrite(a.text[k], 1, a.bytes[k], stdout);
        free(a.text[k]);
        failed += a.failed[k];
        if (a.failed[k])
            fprintf(stderr, "whole: run %d has failed\n", k);
    }
    return fflush(stdout) || failed;
}
