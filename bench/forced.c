/* SPDX-License-Identifier: Apache-2.0 */
/* Runs steps that the library would refuse, by calling the reference's
 * functions directly. */
#include "bench/forced.h"

#include "tests/cloth/sheet.h"

static bool finite(const struct sheet *s)
{
    for (int64_t p = 0; p < s->c.count; p++)
        if (!vec_sane(s->x[p]) || !vec_sane(s->v[p]))
            return false;
    return true;
}

const char *forced_run(struct bench *b, const struct sample *sample, int steps)
{
    struct sheet s;
    const char *word = "stable";
    int status = sheet_make(&s, &sample->cloth, sample->def.integrator);
    s.c.bound = 0; /* makes the limit infinite: one substep suffices */
    s.d.dt = sample->def.dt;
    s.d.gravity = vec_make(0, R(-9.81), 0);
    for (int k = 0; k < steps && status == DRAPE_OK; k++) {
        status = sheet_step(&s);
        if (s.d.outcome & DRAPE_DIVERGED) {
            word = "diverged";
            break;
        }
    }
    if (status != DRAPE_OK)
        word = "failed";
    if (!finite(&s))
        word = "missed";
    bench_check(b, word[0] != 'm' && word[0] != 'f', "forced %s, dt %g: %s",
                integrator_name[sample->def.integrator], s.d.dt, word);
    sheet_free(&s);
    return word;
}
