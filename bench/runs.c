/* SPDX-License-Identifier: Apache-2.0 */
/* Runs a scene through the public API and collects the results. */
#include "bench/accuracy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const integrator_name[] = {
    "euler", "midpoint", "verlet", "rk4", "baraff-witkin", "choi-ko", "bdf2"};
const char *const precond_name[] = {"jacobi", "multigrid"};
const char *const backend_name[] = {"ref", "gpu"};

/* Counts the bytes that the library holds. */
struct meter {
    size_t held, most;
};

static void *allocate(void *user, size_t bytes)
{
    struct meter *m = user;
    void *p = aligned_alloc(64, (bytes + 64) / 64 * 64);
    if (!p)
        return NULL;
    m->held += bytes;
    m->most = m->held > m->most ? m->held : m->most;
    return p;
}

static void release(void *user, void *p, size_t bytes)
{
    struct meter *m = user;
    if (p)
        m->held -= bytes;
    free(p);
}

static void add(struct run *r, const drape_step_report *s, double start)
{
    double energy = s->kinetic + s->elastic + s->potential;
    double rise = energy - (r->steps ? r->energy : start);
    r->rise = rise > r->rise ? rise : r->rise;
    r->energy = energy;
    r->own = s->kinetic + s->elastic;
    r->iterations += s->iterations;
    r->substeps = s->substeps > r->substeps ? s->substeps : r->substeps;
    r->residual = s->residual > r->residual ? s->residual : r->residual;
    r->contacts = s->contacts > r->contacts ? s->contacts : r->contacts;
    r->candidates += s->candidates;
    r->impacts += s->impacts;
    r->steps++;
}

static void keep_state(struct bench *b, const drape_world *world, struct run *r)
{
    r->n = drape_vertices(world);
    r->x = bench_take((size_t)r->n, sizeof *r->x);
    r->v = bench_take((size_t)r->n, sizeof *r->v);
    drape_read(world, r->x, r->v);
    r->finite = isfinite(r->energy);
    for (int64_t p = 0; p < r->n; p++)
        for (int k = 0; k < 3; k++)
            r->finite &= isfinite(r->x[p][k]) && isfinite(r->v[p][k]);
    bench_check(b, r->finite, "a state is not finite, and a step said %d",
                r->outcome);
}

void run_watched(struct bench *b, const drape_def *def, int64_t steps,
                 run_watch *watch, void *user, struct run *r)
{
    memset(r, 0, sizeof *r);
    struct meter meter = {0, 0};
    drape_def d = *def;
    d.backend = b->backend;
    d.allocator = (drape_allocator){allocate, release, &meter};
    drape_world *world;
    drape_error error;
    r->finite = true;
    r->status = drape_create(&d, &world, &error);
    if (r->status != DRAPE_OK) {
        memcpy(r->text, error.text, sizeof r->text);
        return;
    }
    drape_step_report report = {0};
    double first = INFINITY;
    for (int64_t k = 0; k < steps; k++) {
        double start = bench_clock(b);
        r->status = drape_step(world, b->mute ? NULL : &report);
        r->seconds += bench_clock(b) - start;
        if (r->status != DRAPE_OK)
            break;
        r->outcome |= report.outcome;
        if (report.outcome & DRAPE_DIVERGED)
            break;
        add(r, &report, first);
        if (watch && !watch(user, world, &report))
            break;
    }
    keep_state(b, world, r);
    drape_destroy(world);
    r->bytes = meter.most;
}

void run_scene(struct bench *b, const drape_def *def, int64_t steps,
               struct run *r)
{
    run_watched(b, def, steps, NULL, NULL, r);
}

void run_free(struct run *r)
{
    free(r->x);
    free(r->v);
    r->x = r->v = NULL;
}

const char *run_word(const struct run *r)
{
    if (!r->finite)
        return "not finite";
    if (r->status != DRAPE_OK)
        return "refused";
    return r->outcome & DRAPE_DIVERGED      ? "diverged"
           : r->outcome & DRAPE_TRAPPED     ? "trapped"
           : r->outcome & DRAPE_ROLLBACK    ? "rolled back"
           : r->outcome & DRAPE_ZONES       ? "zones"
           : r->outcome & DRAPE_UNCONVERGED ? "unconverged"
                                            : "stable";
}

double run_distance(const struct run *a, const struct run *b, int64_t n)
{
    double sum = 0;
    if (!a->x || !b->x)
        return NAN;
    for (int64_t p = 0; p < n; p++)
        for (int k = 0; k < 3; k++) {
            double d = a->x[p][k] - b->x[p][k];
            sum += d * d;
        }
    return sqrt(sum / (double)n);
}

int64_t world_pairs(const drape_world *world, int n_cloths)
{
    int64_t nv = drape_vertices(world), nt = drape_triangles(world), found = -1;
    double(*x)[3] = bench_take((size_t)nv, sizeof *x);
    int32_t(*tri)[3] = bench_take((size_t)nt, sizeof *tri);
    int32_t *group = bench_take((size_t)nt, sizeof *group);
    drape_read(world, x, NULL);
    drape_read_triangles(world, tri);
    for (int64_t k = 0; k < nt; k++)
        group[k] = k < drape_first_triangle(world, n_cloths);
    drape_mesh mesh = {.nv = nv,
                       .nt = nt,
                       .x = (const double(*)[3])x,
                       .tri = (const int32_t(*)[3])tri,
                       .group = group,
                       .threads = 1};
    if (drape_audit(&mesh, 0, NULL, &found, NULL) != DRAPE_OK)
        found = -1;
    free(x);
    free(tri);
    free(group);
    return found;
}
