/* SPDX-License-Identifier: Apache-2.0 */
/* Measures how many steps of small worlds a machine makes a second: one world
 * after another; side by side from several threads, each of which takes the
 * next world that nobody has taken; and by one call of drape_step_many. All
 * ways start from the same states and must end in the same bits. `build/many
 * --help` lists the options. */
#include <drape.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifdef MANY_GPU
#include "gpu/run/gpu.h"
#include "ref/api/handle.h"
#include "ref/world/state.h"
#endif

enum { WAYS = 16 };

/* One world, and its checkpoint at the start of each way. */
struct one {
    drape_world *world;
    char *saved;
    size_t bytes, room, read;
    uint64_t digest; /* of the state at the end of the last way */
};

/* What is done to each world. */
typedef int visit(struct one *w, int steps);

struct many {
    int worlds, steps, warm, cells[2];
    int threads[WAYS], ways; /* the first is one after another */
    int backend, integrator, precond, ranks, hosted, together;
    struct one *one;
    visit *what; /* of the way that runs now */
    int count, next, failed;
    pthread_mutex_t lock;
};

static void *take(size_t count, size_t size)
{
    void *p = calloc(count ? count : 1, size);
    if (!p) {
        fputs("many: out of memory\n", stderr);
        exit(1);
    }
    return p;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int put(void *user, const void *data, size_t bytes)
{
    struct one *w = user;
    if (w->bytes + bytes > w->room) {
        size_t room = 2 * (w->bytes + bytes);
        char *more = realloc(w->saved, room);
        if (!more)
            return 1;
        w->saved = more;
        w->room = room;
    }
    memcpy(w->saved + w->bytes, data, bytes);
    w->bytes += bytes;
    return 0;
}

static int get(void *user, void *data, size_t bytes)
{
    struct one *w = user;
    if (bytes > w->bytes - w->read)
        return 1;
    memcpy(data, w->saved + w->read, bytes);
    w->read += bytes;
    return 0;
}

static int keep(struct one *w, int steps)
{
    (void)steps;
    w->bytes = 0;
    return drape_save(w->world, put, w);
}

static int restore(struct one *w, int steps)
{
    (void)steps;
    w->read = 0;
    return drape_load(w->world, get, w);
}

/* Without a report no step waits for the end of its parts. */
static int advance(struct one *w, int steps)
{
    int status = DRAPE_OK;
    for (int k = 0; k < steps && status == DRAPE_OK; k++)
        status = drape_step(w->world, NULL);
    return status;
}

static int digest(struct one *w, int steps)
{
    size_t n = (size_t)drape_vertices(w->world), bytes = 3 * sizeof(double);
    uint64_t hash = 14695981039346656037u; /* FNV-1a */
    (void)steps;
    unsigned char *x = take(2 * n, bytes);
    int status = drape_read(w->world, (double(*)[3])(void *)x,
                            (double(*)[3])(void *)(x + n * bytes));
    for (size_t k = 0; k < 2 * n * bytes; k++)
        hash = (hash ^ x[k]) * 1099511628211u;
    w->digest = hash;
    free(x);
    return status;
}

/* A thread takes the next world until none is left. */
static void *work(void *user)
{
    struct many *m = user;
    for (int status = DRAPE_OK;;) {
        pthread_mutex_lock(&m->lock);
        int k = m->next++;
        m->failed = m->failed ? m->failed : status;
        pthread_mutex_unlock(&m->lock);
        if (k >= m->worlds)
            return NULL;
        status = m->what(&m->one[k], m->count);
    }
}

/* Does what to all worlds from so many threads, this one among them, and
 * returns how long that took, s. Ends the program if a call fails. */
static double each(struct many *m, int threads, visit *what, int steps)
{
    pthread_t *thread = take((size_t)threads, sizeof *thread);
    double start = now();
    m->what = what;
    m->count = steps;
    m->next = m->failed = 0;
    int made = 0;
    while (made < threads - 1 && !pthread_create(&thread[made], NULL, work, m))
        made++;
    work(m);
    for (int k = 0; k < made; k++)
        pthread_join(thread[k], NULL);
    double seconds = now() - start;
    free(thread);
    if (made < threads - 1 || m->failed) {
        fprintf(stderr, "many: %s\n",
                made < threads - 1 ? "no more threads"
                                   : drape_status_text(m->failed));
        exit(1);
    }
    return seconds;
}

/* Advances all worlds together, with so many threads, and returns how long that
 * took, s. */
static double all_at_once(struct many *m, int threads, int steps)
{
    drape_world **world = take((size_t)m->worlds, sizeof *world);
    for (int k = 0; k < m->worlds; k++)
        world[k] = m->one[k].world;
    double start = now();
    int status = drape_step_many(world, m->worlds, steps, threads, NULL, NULL);
    double seconds = now() - start;
    free(world);
    if (status != DRAPE_OK) {
        fprintf(stderr, "many: %s\n", drape_status_text(status));
        exit(1);
    }
    return seconds;
}

static void tune(const struct many *m, drape_world *world)
{
#ifdef MANY_GPU
    struct gpu *g = world->world->on;
    if (m->backend == DRAPE_GPU && m->ranks)
        gpu_set_ranks(g, m->ranks);
    if (m->backend == DRAPE_GPU && m->hosted)
        gpu_set_hosted(g);
#else
    (void)m, (void)world;
#endif
}

/* Makes a sphere of 0.2 m of rings of vertices; the two poles are the last. */
static void make_ball(const double at[3], drape_obstacle *ball)
{
    enum { RINGS = 11, DETAIL = 24, N = RINGS * DETAIL };
    static double vertex[N + 2][3];
    static int32_t tri[2 * N][3];
    const double pi = 3.14159265358979323846;
    for (int p = 0; p < N + 2; p++) {
        double a = pi * (p / DETAIL + 1) / (RINGS + 1);
        double b = 2 * pi * (p % DETAIL) / DETAIL;
        double x[3] = {sin(a) * cos(b), cos(a), sin(a) * sin(b)};
        if (p >= N) {
            x[0] = x[2] = 0;
            x[1] = p == N ? 1 : -1;
        }
        for (int k = 0; k < 3; k++)
            vertex[p][k] = at[k] + 0.2 * x[k];
    }
    for (int p = 0; p < N; p++) {
        int right = p / DETAIL * DETAIL + (p + 1) % DETAIL;
        int32_t up[3] = {p, right, p < DETAIL ? N : right - DETAIL};
        int32_t down[3] = {p, p + DETAIL >= N ? N + 1 : p + DETAIL, right};
        memcpy(tri[2 * p], up, sizeof up);
        memcpy(tri[2 * p + 1], down, sizeof down);
    }
    drape_default_obstacle(ball);
    ball->n_vertices = N + 2;
    ball->n_triangles = 2 * (int64_t)N;
    ball->x = (const double(*)[3])vertex;
    ball->tri = (const int32_t(*)[3])tri;
}

/* Makes world k: a sheet that falls on a ball, which lies at another place in
 * each world. */
static void make(const struct many *m, int k)
{
    struct one *w = &m->one[k];
    drape_def def;
    drape_cloth cloth;
    drape_obstacle ball;
    drape_error error = {{0}};
    double part = (double)k / m->worlds;
    const double at[3] = {0.1 * part - 0.05, 0, 0.02 * (k % 5)};
    drape_default(&def);
    drape_default_cloth(&cloth);
    make_ball(at, &ball);
    cloth.m = m->cells[0] + 1;
    cloth.n = m->cells[1] + 1;
    cloth.width = 0.02 * m->cells[0];
    cloth.height = 0.02 * m->cells[1];
    cloth.origin[0] = -cloth.width / 2;
    cloth.origin[1] = 0.21;
    cloth.origin[2] = -cloth.height / 2;
    cloth.material.thickness = 0.004;
    def.cloths = &cloth;
    def.n_cloths = 1;
    def.obstacles = &ball;
    def.n_obstacles = 1;
    def.backend = m->backend;
    def.integrator = m->integrator;
    def.precond = m->precond;
    def.sleep = 0;
    if (drape_create(&def, &w->world, &error) != DRAPE_OK) {
        fprintf(stderr, "many: world %d: %s\n", k, error.text);
        exit(1);
    }
    tune(m, w->world);
}

/* Makes all worlds, brings them to the state in which each way starts, and runs
 * that way once, so that no way that is measured allocates or captures. */
static void prepare(struct many *m)
{
    drape_memory memory = {0};
    double start = now();
    m->one = take((size_t)m->worlds, sizeof *m->one);
    for (int k = 0; k < m->worlds; k++)
        make(m, k);
    double made = now();
    each(m, 8, advance, m->warm);
    each(m, 8, keep, 0);
    for (int k = 0; k < 3; k++) {
        each(m, 8, restore, 0);
        if (k == 2 && m->together)
            all_at_once(m, m->together, m->steps);
        else
            each(m, 8, advance, m->steps);
    }
    for (int k = 0; k < m->worlds; k++)
        if (drape_count(m->one[k].world, &memory) != DRAPE_OK)
            exit(1);
    printf("# %d worlds of %d triangles, ranks %d, hosted %d: made in %.2f s, "
           "warm in %.2f s\n",
           m->worlds, 2 * m->cells[0] * m->cells[1], m->ranks, m->hosted,
           made - start, now() - made);
    printf(
        "# of the last world: %.2f MiB of the host, %.2f MiB of the device\n",
        (double)memory.host_bytes / (1 << 20),
        (double)memory.device_bytes / (1 << 20));
    puts("way,threads,worlds,steps,seconds,world-steps a second,ratio,bits");
}

/* Measures all ways. Returns the number of worlds whose bits differ. */
static int measure(struct many *m)
{
    uint64_t *first = take((size_t)m->worlds, sizeof *first);
    double alone = 0;
    int all = 0;
    for (int way = 0; way < m->ways + (m->together > 0); way++) {
        bool together = way == m->ways;
        int different = 0, threads = together ? m->together : m->threads[way];
        each(m, 8, restore, 0);
        double seconds = together ? all_at_once(m, threads, m->steps)
                                  : each(m, threads, advance, m->steps);
        each(m, 8, digest, 0);
        for (int k = 0; k < m->worlds; k++) {
            if (!way)
                first[k] = m->one[k].digest;
            different += first[k] != m->one[k].digest;
        }
        alone = way ? alone : seconds;
        printf("%s,%d,%d,%d,%.3f,%.1f,%.2f,%s\n",
               together      ? "together"
               : threads > 1 ? "side by side"
                             : "one after another",
               threads, m->worlds, m->steps, seconds,
               m->worlds * m->steps / seconds, alone / seconds,
               different ? "different" : "same");
        fflush(stdout);
        all += different;
    }
    free(first);
    return all;
}

static void help(void)
{
    puts("usage: many [--option value]...\n"
         "  --backend ref|gpu   where worlds live: gpu\n"
         "  --worlds N          256\n"
         "  --cells A,B         of each sheet, 2 triangles a cell: 25,50\n"
         "  --warm N            steps before the first way: 30\n"
         "  --steps N           steps of each way: 10\n"
         "  --threads A,B,...   one way each; the first is the measure of the "
         "others:\n"
         "                      1,2,4,8,16,32,64\n"
         "  --integrator N      enum drape_integrator: Baraff-Witkin\n"
         "  --precond N         enum drape_precond: multigrid\n"
         "  --together N        last, all by drape_step_many with N threads: "
         "16; 0: not\n"
         "  --ranks N           at most so many blocks in a cluster; 0: the "
         "device's\n"
         "  --hosted 1          the host ends the loops of solves");
}

/* Reads numbers with commas between them; returns how many. */
static int numbers(const char *text, int *to, int most)
{
    int n = 0;
    for (char *end; n < most && *text; n++) {
        to[n] = (int)strtol(text, &end, 10);
        if (end == text || to[n] < 0)
            return 0;
        text = *end == ',' ? end + 1 : end;
    }
    return *text ? 0 : n;
}

static bool option(struct many *m, const char *name, const char *value)
{
    struct {
        const char *name;
        int *to;
    } one[] = {{"--worlds", &m->worlds},   {"--steps", &m->steps},
               {"--warm", &m->warm},       {"--ranks", &m->ranks},
               {"--hosted", &m->hosted},   {"--together", &m->together},
               {"--precond", &m->precond}, {"--integrator", &m->integrator},
               {"--backend", &m->backend}};
    if (!value)
        return false;
    if (!strcmp(name, "--threads"))
        return (m->ways = numbers(value, m->threads, WAYS)) > 0;
    if (!strcmp(name, "--cells"))
        return numbers(value, m->cells, 2) == 2;
    if (!strcmp(value, "ref") || !strcmp(value, "gpu"))
        value = *value == 'r' ? "0" : "1";
    for (size_t k = 0; k < sizeof one / sizeof *one; k++)
        if (!strcmp(name, one[k].name))
            return numbers(value, one[k].to, 1) == 1;
    return false;
}

int main(int argc, char **argv)
{
    struct many m = {.worlds = 256,
                     .steps = 10,
                     .warm = 30,
                     .cells = {25, 50},
                     .together = 16,
                     .threads = {1, 2, 4, 8, 16, 32, 64},
                     .ways = 7,
                     .backend = DRAPE_GPU,
                     .integrator = DRAPE_BW,
                     .precond = DRAPE_MULTIGRID,
                     .lock = PTHREAD_MUTEX_INITIALIZER};
    for (int k = 1; k < argc; k += 2)
        if (!option(&m, argv[k], argv[k + 1])) {
            help();
            return strcmp(argv[k], "--help") != 0;
        }
    /* The default of 8 queues makes streams wait for each other. It is read
     * when the device is first used. */
    setenv("CUDA_DEVICE_MAX_CONNECTIONS", "32", 0);
    prepare(&m);
    int different = measure(&m);
    for (int k = 0; k < m.worlds; k++) {
        drape_destroy(m.one[k].world);
        free(m.one[k].saved);
    }
    free(m.one);
    return different > 0;
}
