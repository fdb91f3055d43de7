/* SPDX-License-Identifier: Apache-2.0 */
/* Runs steps that the library would refuse, by the reference's functions, for
 * bench/accuracy. spec/accuracy.md §3 */
#include "tests/cloth/sheet.h"

enum { STABLE, DIVERGED, FAILED, MISSED };

/* Runs an explicit method with one substep a step, whatever its limit. Returns
 * how the run ended; MISSED: the state is not finite, and no outcome said so.
 */
int forced_run(const drape_cloth *cloth, int integrator, double dt, int steps);

int forced_run(const drape_cloth *cloth, int integrator, double dt, int steps)
{
    struct sheet s;
    int end = STABLE, status = sheet_make(&s, cloth, integrator);
    s.c.bound = 0; /* makes the limit infinite: one substep suffices */
    s.d.dt = dt;
    s.d.gravity = vec_make(0, R(-9.81), 0);
    for (int k = 0; k < steps && status == DRAPE_OK && end == STABLE; k++) {
        status = sheet_step(&s);
        if (s.d.outcome & DRAPE_DIVERGED)
            end = DIVERGED;
    }
    if (status != DRAPE_OK)
        end = FAILED;
    for (int64_t p = 0; p < s.c.count; p++)
        if (!vec_sane(s.x[p]) || !vec_sane(s.v[p]))
            end = MISSED;
    sheet_free(&s);
    return end;
}
