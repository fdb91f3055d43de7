/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the bare scene in a program that has no other stage, and checks a scene
 * that is asleep. spec/accuracy.md §7 */
#include "bench/skip.h"

#include <stdlib.h>
#include <string.h>

/* The bare scene's seconds a step, bytes and hash. */
struct bare {
    double seconds;
    size_t bytes;
    uint64_t hash;
};

static struct bare run_bare(struct bench *b)
{
    struct bare best = {1e9, 0, 0};
    for (int n = 0; n < (b->quick ? 1 : 9); n++) {
        struct skip s;
        struct run r;
        skip_bare(&s);
        run_scene(b, &s.def, 40, &r);
        double t = r.seconds / 40;
        best.seconds = t < best.seconds ? t : best.seconds;
        best.bytes = r.bytes;
        best.hash = skip_hash(&r);
        run_free(&r);
    }
    return best;
}

void part_bare(struct bench *b)
{
    struct bare a = run_bare(b);
    printf("%.9g %zu %llx\n", a.seconds, a.bytes, (unsigned long long)a.hash);
}

/* Runs a program, this one or the one with the suffix, in a process of its own,
 * and keeps the fastest result so far in *least. A new process is needed, since
 * the place of its memory can make all runs of a process 1.7 times as slow. */
static bool ask(const struct bench *b, const char *suffix, struct bare *least)
{
    char command[4200];
    unsigned long long hash = 0;
    struct bare a = {0};
    snprintf(command, sizeof command, "'%s%s' --bare %s", b->program, suffix,
             b->quick ? "--quick" : "");
    FILE *pipe = popen(command, "r");
    bool good =
        pipe && fscanf(pipe, "%lf %zu %llx", &a.seconds, &a.bytes, &hash) == 3;
    if (pipe && pclose(pipe) != 0)
        good = false;
    a.hash = hash;
    if (least->seconds == 0 || a.seconds < least->seconds)
        *least = a;
    return good;
}

void skip_never(struct bench *b)
{
    if (b->backend == DRAPE_GPU)
        return; /* the other program lacks stages of the reference only */
    FILE *out =
        bench_csv(b, "never", "program,ms a step,bytes,hash of the positions");
    struct bare here = {0}, there = {0};
    for (int k = 0; k < (b->quick ? 1 : 5); k++) {
        bool good = ask(b, "", &here) && ask(b, "-bare", &there);
        bench_check(b, good, "a program of the bare scene did not run");
    }
    fprintf(out, "all stages,%.4g,%zu,%llx\n", 1e3 * here.seconds, here.bytes,
            (unsigned long long)here.hash);
    fprintf(out, "only the bare scene's,%.4g,%zu,%llx\n", 1e3 * there.seconds,
            there.bytes, (unsigned long long)there.hash);
    bench_check(b, here.hash == there.hash && here.bytes == there.bytes,
                "other bits or bytes without the stages");
    fclose(out);
}

struct watch {
    int64_t fell;         /* the first step asleep; 0: none yet */
    double awake, asleep; /* s, of the last step of each kind */
    bool same, woke;      /* no bit changed asleep; it woke by command */
    int n;
    double (*x)[3], (*v)[3];
};

/* Checks after each step that no bit changes while the scene is asleep, and
 * that drape_wake, called after five steps asleep, changes no bit and wakes the
 * scene. */
static bool look(void *user, drape_world *world, const drape_step_report *r)
{
    struct watch *w = user;
    size_t n = (size_t)drape_vertices(world);
    double(*x)[3] = bench_take(n, sizeof *x),
    (*v)[3] = bench_take(n, sizeof *v);
    drape_read(world, x, v);
    double seconds = 0;
    for (int k = 0; k < DRAPE_PART_COUNT; k++)
        seconds += r->seconds[k];
    bool asleep = r->outcome & DRAPE_ASLEEP;
    if (asleep && !w->fell)
        w->fell = r->step;
    if (asleep)
        w->same &=
            !memcmp(x, w->x, n * sizeof *x) && !memcmp(v, w->v, n * sizeof *v);
    *(asleep ? &w->asleep : &w->awake) = seconds;
    if (w->fell && r->step == w->fell + 5) {
        drape_wake(world);
        drape_read(world, x, v);
        w->same &= !memcmp(x, w->x, n * sizeof *x);
    }
    w->woke |= w->fell && r->step > w->fell + 5 && !asleep;
    free(w->x);
    free(w->v);
    w->x = x;
    w->v = v;
    return !w->woke;
}

/* Lays a sheet on a plane and runs it until it has slept and been woken, or for
 * 300 steps. */
static void lay(struct bench *b, FILE *out, int integrator, double tolerance)
{
    drape_def def;
    drape_cloth c;
    struct solid plane;
    struct run r;
    struct watch w = {.same = true};
    drape_default(&def);
    cloth_flat(&c, 17, 0.4, 0.0019);
    solid_plane(&plane, 1, 0);
    def.cloths = &c;
    def.n_cloths = 1;
    def.obstacles = &plane.body;
    def.n_obstacles = 1;
    def.integrator = integrator;
    def.tolerance = tolerance;
    run_watched(b, &def, 300, look, &w, &r);
    fprintf(out, "%s,%g,%lld,%.3g,%.3g,%s,%s\n", integrator_name[integrator],
            tolerance, (long long)w.fell, w.awake, w.asleep,
            !w.fell  ? ""
            : w.same ? "yes"
                     : "no",
            w.woke ? "yes" : "no");
    /* Whether it sleeps at all can depend on a last bit: no check. */
    bench_check(b, !w.fell || w.woke, "sleep, %s: did not wake",
                integrator_name[integrator]);
    bench_check(b, w.same, "sleep, %s: bits changed",
                integrator_name[integrator]);
    run_free(&r);
    solid_free(&plane);
    free(w.x);
    free(w.v);
}

void skip_sleep(struct bench *b)
{
    FILE *out = bench_csv(b, "sleep",
                          "integrator,tolerance,asleep from step,seconds awake,"
                          "seconds asleep,no bit changed,woke by command");
    for (int m = DRAPE_BW; m <= DRAPE_CK; m++)
        for (int t = b->quick ? 6 : 3; t <= 6; t += 3)
            lay(b, out, m, t == 3 ? 1e-3 : 1e-6);
    fclose(out);
}
