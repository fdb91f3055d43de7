/* SPDX-License-Identifier: Apache-2.0 */
/* Measures what a feature costs where it is used, and checks that it costs
 * nothing where it is not. spec/accuracy.md §7 */
#include "bench/skip.h"

#include <stdlib.h>
#include <string.h>

enum { STAGE_NAMES = 40, SIDE = 65 };

/* The stages that a run called, and how often each. */
struct calls {
    const char *name[STAGE_NAMES];
    int64_t count[STAGE_NAMES];
    int n;
};

static void call(void *user, int64_t step, const char *stage, uint64_t digest,
                 double seconds)
{
    struct calls *c = user;
    int k = 0;
    (void)step, (void)digest, (void)seconds;
    while (k < c->n && strcmp(c->name[k], stage) != 0)
        k++;
    if (k == c->n && k < STAGE_NAMES)
        c->name[c->n++] = stage;
    if (k < c->n)
        c->count[k]++;
}

static void add_body(struct skip *s, int detail, double height)
{
    const double at[3] = {0, height, 0};
    solid_ball(&s->ball, 0.1, at, detail);
    s->def.obstacles = &s->ball.body;
    s->def.n_obstacles = 1;
}

static void implicit(struct skip *s)
{
    s->def.integrator = DRAPE_BW;
}
static void obstacle(struct skip *s)
{
    add_body(s, 24, -5);
}
static void large_obstacle(struct skip *s)
{
    add_body(s, 192, -5);
}
static void moving_obstacle(struct skip *s)
{
    static const double time[2] = {0, 10};
    static const double way[2][3] = {{0, 0, 0}, {1, 0, 0}};
    add_body(s, 192, -5);
    s->motion = (drape_motion){2, time, way, NULL, {0, 0, 0}};
    s->def.motions = &s->motion;
    s->def.n_motions = 1;
    s->ball.body.motion = 0;
}
static void self_collision(struct skip *s)
{
    s->def.self_collision = 1;
}
static void friction(struct skip *s)
{
    s->cloth.material.friction = 0.5;
}
static void wind(struct skip *s)
{
    s->def.wind = (drape_wind){{7, 0, 1.5}, 1.2, 1, 0.5};
}
static void pins(struct skip *s)
{
    for (int i = 0; i < SIDE; i++)
        s->pin[i] = (drape_pin){i, 0, -1};
    s->cloth.pins = s->pin;
    s->cloth.n_pins = SIDE;
}
static void holes(struct skip *s)
{
    for (int p = 0; p < SIDE * SIDE; p++)
        s->hole[p] = p % 50 == 7;
    s->cloth.hole = s->hole;
}
static void ignore(void *user, int64_t step, const char *stage, uint64_t digest,
                   double seconds)
{
    (void)user, (void)step, (void)stage, (void)digest, (void)seconds;
}
static void trace(struct skip *s)
{
    s->def.trace = ignore;
}
static void contact(struct skip *s)
{
    add_body(s, 24, -0.1015);
}

static const struct feature {
    const char *name;
    void (*add)(struct skip *s);
    bool touches; /* the narrow phase gets candidates */
    bool mute;    /* drape_step is called without a report */
} features[] = {{"nothing", NULL, 0, 0},
                {"implicit solver", implicit, 0, 0},
                {"static obstacle, 528 triangles", obstacle, 0, 0},
                {"static obstacle, 36,480 triangles", large_obstacle, 0, 0},
                {"moving obstacle, 36,480 triangles", moving_obstacle, 0, 0},
                {"obstacle in contact", contact, 1, 0},
                {"self-collision, flat", self_collision, 0, 0},
                {"friction", friction, 0, 0},
                {"wind", wind, 0, 0},
                {"pins", pins, 0, 0},
                {"holes", holes, 0, 0},
                {"trace", trace, 0, 0},
                {"report left out", NULL, 0, 1}};
enum { FEATURES = sizeof features / sizeof *features };

void skip_bare(struct skip *s)
{
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    cloth_flat(&s->cloth, SIDE, 1, 0);
    s->cloth.material.damping = 0;
    s->cloth.material.friction = 0;
    s->def.dt = 1e-4;
    s->def.integrator = DRAPE_VERLET;
    s->def.self_collision = 0;
    s->def.sleep = 0;
    s->def.cloths = &s->cloth;
    s->def.n_cloths = 1;
}

static void make(struct skip *s, const struct feature *f)
{
    skip_bare(s);
    if (f->add)
        f->add(s);
}

uint64_t skip_hash(const struct run *r)
{
    const unsigned char *p = (const unsigned char *)r->x;
    uint64_t hash = UINT64_C(14695981039346656037);
    for (size_t k = 0; p && k < (size_t)r->n * sizeof *r->x; k++)
        hash = (hash ^ p[k]) * UINT64_C(1099511628211);
    return hash;
}

static void count_calls(struct bench *b, const struct feature *f,
                        struct calls *c, int64_t *candidates)
{
    struct skip s;
    struct run r;
    make(&s, f);
    s.def.trace = call;
    s.def.trace_user = c;
    run_scene(b, &s.def, 4, &r);
    *candidates = r.candidates;
    run_free(&r);
    solid_free(&s.ball);
}

/* Writes the stages that a scene calls and the bare scene does not, with their
 * number of calls a step. */
static void put_calls(FILE *out, const struct calls *c,
                      const struct calls *bare)
{
    bool any = false;
    for (int k = 0; k < c->n; k++) {
        int j = 0;
        while (j < bare->n && strcmp(c->name[k], bare->name[j]) != 0)
            j++;
        if (j < bare->n)
            continue;
        fprintf(out, "%s%s %lld", any ? " " : "", c->name[k],
                (long long)(c->count[k] + 3) / 4);
        any = true;
    }
}

/* Measures the seconds of a step in every scene: the least of several runs. The
 * scenes take turns, so that slow phases of the machine affect all of them. */
static void time_all(struct bench *b, double seconds[FEATURES],
                     size_t bytes[FEATURES])
{
    int repeats = b->quick ? 1 : 9, steps = b->quick ? 2 : 40;
    for (int k = 0; k < FEATURES; k++)
        seconds[k] = 1e9;
    for (int n = 0; n < repeats; n++)
        for (int k = 0; k < FEATURES; k++) {
            struct skip s;
            struct run r;
            make(&s, &features[k]);
            b->mute = features[k].mute;
            run_scene(b, &s.def, steps, &r);
            b->mute = false;
            double t = r.seconds / steps;
            seconds[k] = t < seconds[k] ? t : seconds[k];
            bytes[k] = r.bytes;
            run_free(&r);
            solid_free(&s.ball);
        }
}

void skip_table(struct bench *b)
{
    FILE *out = bench_csv(b, "skip",
                          "feature,ms a step,by the bare scene,MB,candidates,"
                          "stages more (calls a step)");
    double seconds[FEATURES];
    size_t bytes[FEATURES];
    struct calls bare = {.n = 0};
    time_all(b, seconds, bytes);
    for (int k = 0; k < FEATURES; k++) {
        struct calls c = {.n = 0};
        int64_t candidates;
        count_calls(b, &features[k], &c, &candidates);
        if (k == 0)
            bare = c;
        fprintf(out, "\"%s\",%.4g,%.3f,%.4g,%lld,\"", features[k].name,
                1e3 * seconds[k], seconds[k] / seconds[0],
                1e-6 * (double)bytes[k], (long long)candidates);
        put_calls(out, &c, &bare);
        fprintf(out, "\"\n");
        bench_check(b, features[k].touches || !candidates,
                    "%s: %lld candidates of the narrow phase", features[k].name,
                    (long long)candidates);
    }
    fclose(out);
}
