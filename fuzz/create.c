/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes drape_create with any definition and with cloth of any scale. A
 * refusal has a message and keeps no memory; an accepted world steps in bounded
 * time. */
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "fuzz/fuzz.h"
#include "fuzz/small.h"
#include "fuzz/whole.h"

/* Seconds of processor time that an input may take: a hundred times the slowest
 * valid scene, also under sanitizers. A crumpled scene may need all rounds of
 * collision response in all slices, whose numbers the definition bounds: so
 * ROUND more for each round that a step reports. A round of the slowest scene
 * found takes 0.011 s without sanitizers. */
enum { PATIENCE = 30 };
static const double ROUND = 0.25;

static double seconds(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

/* Whether the message is one line of terminated text. */
static bool says(const drape_error *error)
{
    size_t n = strnlen(error->text, sizeof error->text);
    return n > 0 && n < sizeof error->text && !strchr(error->text, '\n');
}

static const char *finite(const drape_world *world)
{
    int64_t nv = drape_vertices(world), wrong = 0;
    double(*x)[3] = malloc((size_t)nv * sizeof *x);
    double(*v)[3] = malloc((size_t)nv * sizeof *v);
    int status = x && v ? drape_read(world, x, v) : DRAPE_ENOMEM;
    for (int64_t k = 0; status == DRAPE_OK && k < 3 * nv; k++)
        wrong += !isfinite(x[k / 3][k % 3]) || !isfinite(v[k / 3][k % 3]);
    free(x);
    free(v);
    EXPECT(status == DRAPE_OK && wrong == 0);
    return NULL;
}

/* Takes n steps; adds the rounds that they report to *rounds. */
static const char *step(drape_world *world, int n, int64_t *rounds)
{
    const char *failed = NULL;
    for (int k = 0; k < n && !failed; k++) {
        drape_step_report r;
        int status = drape_step(world, &r);
        EXPECT(status == DRAPE_OK || status == DRAPE_ENOMEM);
        EXPECT(status != DRAPE_OK || (r.outcome & ~OUTCOME_BITS) == 0);
        *rounds += status == DRAPE_OK ? r.rounds : 0;
        failed = finite(world);
    }
    return failed;
}

/* Whether steps of the scene are fast enough to run. Other scenes are only
 * created. */
static bool steps_soon(const drape_def *d, const drape_world *world)
{
    return drape_vertices(world) < 400 && d->max_iterations <= 2000 &&
           d->max_substeps <= 2000 && d->max_rounds <= 100 && d->threads <= 4;
}

/* Makes the world, takes n steps and destroys it. Returns NULL or the check
 * that failed. */
static const char *make(drape_def *d, struct bank *bank, bool mute, int n)
{
    drape_world *world = (drape_world *)(void *)bank;
    drape_error error;
    double begun = seconds();
    int64_t rounds = 0;
    memset(&error, 0x5a, sizeof error);
    int status = drape_create(d, &world, mute ? NULL : &error);
    const char *failed = NULL;
    if (status == DRAPE_OK) {
        EXPECT(world);
        failed = steps_soon(d, world) ? step(world, n, &rounds) : NULL;
        drape_destroy(world);
    } else {
        EXPECT(!world && (mute || says(&error)));
        EXPECT(status == DRAPE_EARG || status == DRAPE_EDATA ||
               status == DRAPE_ENOMEM || status == DRAPE_ESTART ||
               status == DRAPE_EDEVICE || status == DRAPE_ELIMIT);
    }
    if (failed)
        return failed;
    EXPECT(bank->held == 0 && bank->blocks == 0 && !bank->wrong);
    EXPECT(seconds() - begun < PATIENCE + ROUND * (double)rounds);
    return NULL;
}

const char *fuzz_create(const char *name, const uint8_t *data, size_t size)
{
    static uint32_t words[DRAW_WORDS];
    static struct whole w;
    struct bytes b = draw_open(data, size, words);
    struct bank bank;
    (void)name;
    bank_open(&bank, (size_t)1 << 26);
    whole_make(&w, &b, &bank);
    if (pick(&b, 4) == 3) {
        bank.from = pick(&b, 200);
        bank.times = pick(&b, 2) ? 1 : INT64_MAX;
    }
    const char *failed = make(&w.def, &bank, pick(&b, 8) == 7, 2);
    whole_free(&w);
    choices_free(&b);
    return failed;
}

/* Draws a table whose points are in range. Few such tables have laws. */
static void scale_table(struct bytes *b, double table[DRAPE_POINTS][2])
{
    double strain = 0, force = 0, stiff = draw_scale(b, -100, 40);
    int n = 1 + (int)pick(b, DRAPE_POINTS);
    for (int k = 0; k < n; k++) {
        double step = draw_in(b, 1e-5, 0.5);
        strain += step;
        force += stiff * step * draw_in(b, 0.5, 8);
        table[k][0] = strain;
        table[k][1] = force;
    }
}

/* Draws valid numbers over the whole range that a definition allows. */
static void scale(struct bytes *b, struct small *s)
{
    drape_def *d = &s->def;
    int size = (int)pick(b, 150) - 100; /* of a cell: 2^-100 … 2^50 m */
    for (int k = 0; k < d->n_cloths; k++) {
        drape_cloth *c = &s->cloth[k];
        drape_material *m = &c->material;
        double cell = ldexp(1, size) * draw_in(b, 1, 2);
        c->width = cell * (c->m - 1);
        c->height = cell * (c->n - 1) * (pick(b, 4) == 3 ? 1e3 : 1);
        c->origin[1] =
            pick(b, 4) == 3 ? draw_scale(b, -100, 59) : c->height * (1 + k);
        if (pick(b, 2))
            m->thickness = draw_scale(b, size - 10, size + 10);
        if (pick(b, 2))
            m->density = draw_scale(b, -100, 59);
        if (pick(b, 2))
            m->stretch = draw_scale(b, -100, 59);
        m->shear = m->stretch * draw_in(b, 0, 0.5);
        if (pick(b, 2))
            m->bend = draw_scale(b, -100, 59);
        if (pick(b, 2))
            m->damping = draw_scale(b, -100, 19);
        if (pick(b, 2))
            m->friction = draw_scale(b, -100, 19);
        for (int i = 0; i < 3; i++)
            if (pick(b, 4) == 3)
                m->limit[i] = draw_in(b, 0.01, 10);
        for (int o = 0; o < DRAPE_TABLES; o++)
            if (pick(b, 8) == 7)
                scale_table(b, m->table[o]);
    }
    if (pick(b, 2))
        d->dt = draw_scale(b, -29, 9);
    if (pick(b, 2))
        d->gravity[pick(b, 3)] = draw_scale(b, -100, 59);
    if (pick(b, 2))
        d->tolerance = draw_scale(b, -49, 0);
    double factor = pick(b, 2) ? ldexp(50, size) : 1;
    for (int k = 0; k < 3 * 8; k++)
        s->box_x[k / 3][k % 3] *= factor;
    d->max_substeps = 500;
}

const char *fuzz_scale(const char *name, const uint8_t *data, size_t size)
{
    static uint32_t words[DRAW_WORDS];
    static struct small s;
    struct bytes b = draw_open(data, size, words);
    (void)name;
    small_make(&s, &b);
    scale(&b, &s);
    const char *failed = make(&s.def, &s.host, false, 2);
    choices_free(&b);
    return failed;
}
