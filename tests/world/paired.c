/* SPDX-License-Identifier: Apache-2.0 */
/* The same world on both backends, through the public API and without a trace,
 * while a program changes the wind, wakes the world, loads a checkpoint or asks
 * for no report: after each step both have the same report and the same
 * checkpoint. spec/gpu.md §6 */
#include <stdio.h>
#include <stdlib.h>

#include "tests/api/guest.h"
#include "tests/base/choices.h"

enum { TAPS = 40, CHECKPOINT = 1 << 16 };

/* A checkpoint in memory. */
struct store {
    size_t bytes, read;
    uint8_t data[CHECKPOINT];
};

struct pair {
    struct guest s;
    drape_cloth cloth[2];
    drape_motion motion;
    double time[TAPS], way[TAPS][3];
    drape_world *world[2];
    struct store now[2], old;
    int64_t slices, steps;
};

static int append(void *user, const void *data, size_t bytes)
{
    struct store *s = user;
    if (bytes > CHECKPOINT - s->bytes)
        return 1;
    memcpy(s->data + s->bytes, data, bytes);
    s->bytes += bytes;
    return 0;
}

static int take_back(void *user, void *data, size_t bytes)
{
    struct store *s = user;
    if (bytes > s->bytes - s->read)
        return 1;
    memcpy(data, s->data + s->read, bytes);
    s->read += bytes;
    return 0;
}

static int save(const drape_world *world, struct store *s)
{
    s->bytes = s->read = 0;
    return drape_save(world, append, s);
}

/* Makes both worlds. Returns NULL, or why they cannot be made. */
static const char *create(struct pair *p)
{
    for (int k = 0; k < 2; k++) {
        p->s.def.backend = k ? DRAPE_GPU : DRAPE_REF;
        EXPECT(drape_create(&p->s.def, &p->world[k], NULL) == DRAPE_OK);
    }
    return NULL;
}

static void destroy(struct pair *p)
{
    for (int k = 0; k < 2; k++)
        drape_destroy(p->world[k]);
    p->world[0] = p->world[1] = NULL;
}

static const char *compare(struct pair *p)
{
    for (int k = 0; k < 2; k++)
        EXPECT(save(p->world[k], &p->now[k]) == DRAPE_OK);
    EXPECT(p->now[0].bytes == p->now[1].bytes);
    EXPECT(!memcmp(p->now[0].data, p->now[1].data, p->now[0].bytes));
    return NULL;
}

static const char *step(struct pair *p, bool reported)
{
    drape_step_report r[2];
    memset(r, 0, sizeof r);
    for (int k = 0; k < 2; k++)
        EXPECT(drape_step(p->world[k], reported ? &r[k] : NULL) == DRAPE_OK);
    p->slices += r[1].slices;
    p->steps++;
    for (int k = 0; k < 2; k++)
        memset(r[k].seconds, 0, sizeof r[k].seconds);
    EXPECT(!memcmp(&r[0], &r[1], sizeof r[0]));
    ran(1);
    return compare(p);
}

/* Calls of a program between two steps */

static const char *blow(struct pair *p, const drape_wind *wind)
{
    int status = p->s.def.wind.density > 0 ? DRAPE_OK : DRAPE_EARG;
    for (int k = 0; k < 2; k++)
        EXPECT(drape_set_wind(p->world[k], wind) == status);
    return NULL;
}

static const char *go_back(struct pair *p)
{
    for (int k = 0; k < 2; k++) {
        p->old.read = 0;
        EXPECT(drape_load(p->world[k], take_back, &p->old) == DRAPE_OK);
    }
    return compare(p);
}

static const char *interfere(struct pair *p, struct bytes *b)
{
    drape_wind wind = {{0, 0, 0}, 1.2, 1, 0.5};
    switch (pick(b, 16)) {
    case 0:
        wind.velocity[pick(b, 3)] = 0.5 * pick(b, 8) - 2;
        return blow(p, &wind);
    case 1:
        drape_wake(p->world[0]);
        drape_wake(p->world[1]);
        return NULL;
    case 2:
        p->old = p->now[0];
        return NULL;
    case 3:
        return p->old.bytes ? go_back(p) : NULL;
    default:
        return NULL;
    }
}

/* Picks a scene: one sheet or two above a plate that moves up and down, slowly
 * or so fast that steps are cut, with few rounds of impulses before the
 * fail-safe. */
static void pick_pair(struct pair *p, struct bytes *b)
{
    static const double far[] = {0.0015, 0.02, 0.2, 0.6};
    static const int rounds[] = {0, 1, 2, 16};
    drape_def *def = &p->s.def;
    double most = far[pick(b, 4)];
    memset(p, 0, sizeof *p);
    guest_make(&p->s, DRAPE_REF);
    def->integrator = pick(b, 2) ? DRAPE_CK : DRAPE_BW;
    def->precond = DRAPE_JACOBI;
    def->max_rounds = rounds[pick(b, 4)];
    def->max_slices = 1 << pick(b, 5);
    def->sleep = !pick(b, 4);
    if (pick(b, 2))
        def->wind = (drape_wind){{0.2, 0, 0}, 1.2, 1, 0.5};
    p->cloth[0] = p->cloth[1] = p->s.cloth;
    p->cloth[1].origin[1] = 0.006;
    def->cloths = p->cloth;
    def->n_cloths = 1 + !pick(b, 3);
    uint32_t every = 2 + pick(b, 5);
    for (int k = 0; k < TAPS; k++) {
        p->time[k] = k * every * def->dt;
        p->way[k][1] = (k % 2 ? 1 : -1) * most;
    }
    p->way[0][1] = 0;
    p->motion = (drape_motion){
        TAPS, p->time, (const double(*)[3])p->way, NULL, {0, 0, 0}};
    def->motions = &p->motion;
    def->n_motions = 1;
    p->s.plate.motion = pick(b, 5) ? 0 : -1;
}

/* Random scenes, in which steps are cut. */
const char *test_paired_random(void)
{
    enum { SEEDS = 7, STEPS = 12 };
    static struct pair p;
    static char text[200];
    int64_t cut = 0;
    if (REAL_BITS == 64)
        return skip("the same source in binary32 decides");
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct bytes b = {.seed = seed, .size = -1};
        pick_pair(&p, &b);
        p.s.def.newton = seed % 3 == 0 ? 3 : 0;
        p.s.def.response = seed % 2 ? DRAPE_IMPULSES : DRAPE_SOLVE;
        if (seed == 5)
            p.s.def.dt *= 8; /* so that steps are cut */
        if (seed == 6)
            p.s.def.integrator = DRAPE_BDF2;
        const char *what = create(&p);
        for (int k = 0; k < STEPS && !what; k++) {
            what = interfere(&p, &b);
            if (!what)
                what = step(&p, pick(&b, 8) > 0);
            if (what)
                snprintf(text, sizeof text, "seed %d, step %d: %s", (int)seed,
                         k + 1, what);
        }
        destroy(&p);
        choices_free(&b);
        if (what)
            return text;
        cut += p.slices - p.steps;
    }
    EXPECT(cut > 0);
    return NULL;
}

/* Makes two cells above each other, with all corners pinned. One pin moves far:
 * the first vertex of the world, or the last. Only the displacement of this
 * vertex makes a cut of the step necessary. */
static void hold_cells(struct pair *p, bool last, drape_pin pin[2][4])
{
    memset(p, 0, sizeof *p);
    guest_make(&p->s, DRAPE_REF);
    for (int k = 0; k < 2; k++) {
        drape_cloth *c = &p->cloth[k];
        *c = p->s.cloth;
        c->m = c->n = 2;
        c->origin[1] = 0.05 * k;
        c->pins = pin[k];
        c->n_pins = 4;
        for (int i = 0; i < 4; i++)
            pin[k][i] = (drape_pin){i % 2, i / 2, -1};
    }
    pin[last][last ? 3 : 0].motion = 0;
    p->time[1] = p->s.def.dt;
    for (int i = 0; i < 3; i++)
        p->way[1][i] = (last ? 1 : -1) * (i == 1 ? -0.5 : 3);
    p->motion =
        (drape_motion){2, p->time, (const double(*)[3])p->way, NULL, {0, 0, 0}};
    p->s.def.motions = &p->motion;
    p->s.def.n_motions = 1;
    p->s.def.cloths = p->cloth;
    p->s.def.n_cloths = 2;
    p->s.def.n_obstacles = 0;
    p->s.def.response = DRAPE_IMPULSES; /* step.md §7.2 */
    p->s.def.max_slices = 8;
}

const char *test_paired_far(void)
{
    static struct pair p;
    drape_pin pin[2][4];
    for (int last = 0; last < 2; last++) {
        hold_cells(&p, last, pin);
        const char *what = create(&p);
        if (!what)
            what = step(&p, true);
        destroy(&p);
        if (what)
            return what;
        EXPECT(p.slices > p.steps);
    }
    return NULL;
}

/* Makes a sheet that is thrown at the plate; it falls freely for two steps, and
 * the third step is cut. Whichever device allocation fails in the third step,
 * in whichever slice, the state stays as it was before the step. */
static void throw_sheet(struct pair *p)
{
    static double v[7 * 6][3];
    memset(p, 0, sizeof *p);
    guest_make(&p->s, DRAPE_GPU);
    for (int k = 0; k < 7 * 6; k++)
        v[k][1] = -20 - 0.01 * k;
    p->s.cloth.velocity = (const double(*)[3])v;
    p->s.cloth.origin[1] = 0.9;
    p->s.def.integrator = DRAPE_CK; /* keeps the step before in its state */
    p->s.def.precond = DRAPE_JACOBI;
    p->s.def.response = DRAPE_IMPULSES; /* step.md §7.2 */
}

/* Makes the third step with k device allocations allowed; *failed: it needed
 * more. */
static const char *short_third(struct pair *p, int64_t k, bool *failed)
{
    drape_step_report r;
    EXPECT(drape_create(&p->s.def, &p->world[1], NULL) == DRAPE_OK);
    EXPECT(guest_go(p->world[1], 2) == DRAPE_OK);
    EXPECT(save(p->world[1], &p->now[0]) == DRAPE_OK);
    p->s.device.most = p->s.device.calls + k;
    int status = drape_step(p->world[1], &r);
    p->s.device.most = INT64_MAX;
    *failed = status != DRAPE_OK;
    EXPECT(*failed ? status == DRAPE_ENOMEM : r.slices > 1);
    EXPECT(save(p->world[1], &p->now[1]) == DRAPE_OK);
    bool same = !memcmp(p->now[0].data, p->now[1].data, p->now[0].bytes);
    EXPECT(same == *failed);
    p->s.device.calls = 0;
    destroy(p);
    ran(1);
    return NULL;
}

const char *test_paired_restore(void)
{
    static struct pair p;
    if (REAL_BITS == 64)
        return skip("the same source in binary32 decides");
    bool failed = true;
    const char *what = NULL;
    int64_t k = 0;
    throw_sheet(&p);
    for (; failed && !what; k += 3)
        what = short_third(&p, k, &failed);
    EXPECT(what || k > 9);
    return what;
}
