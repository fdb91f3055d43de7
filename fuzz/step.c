/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes drape_step and checks its guarantees. */
#include <math.h>

#include "fuzz/play.h"

bool play_note(struct play *p, struct tape note[2])
{
    bool good = tape_save(&note[0], p->world[0]);
    if (!p->world[1])
        return good;
    return tape_save(&note[1], p->world[1]) && tape_same(&note[0], &note[1]);
}

const char *play_unchanged(struct play *p)
{
    EXPECT(play_note(p, p->after));
    EXPECT(tape_same(&p->before[0], &p->after[0]));
    return NULL;
}

/* Whether two worlds' reports of the same step agree. fresh: one world was just
 * loaded, so it may have refitted boxes that the other had kept. */
static bool reports_same(drape_step_report a, drape_step_report b, bool fresh)
{
    memset(a.seconds, 0, sizeof a.seconds);
    memset(b.seconds, 0, sizeof b.seconds);
    if (fresh)
        a.work = b.work;
    const char *p = (const char *)&a, *q = (const char *)&b;
    for (size_t k = 0; k < sizeof a; k++)
        if (p[k] != q[k])
            return false;
    return true;
}

static const char *look_at_report(const struct play *p,
                                  const drape_step_report *r)
{
    bool stands = r->outcome & DRAPE_DIVERGED;
    EXPECT((r->outcome & ~OUTCOME_BITS) == 0);
    EXPECT(!(r->outcome & DRAPE_ASLEEP) || p->s.def.sleep);
    EXPECT(!stands || r->time == p->time);
    EXPECT(stands || fabs(r->time - p->time - p->s.def.dt) < 1e-9);
    EXPECT(r->slices >= 0 && r->slices <= p->s.def.max_slices);
    EXPECT(r->iterations >= 0 && r->rounds >= 0 && r->substeps >= 0);
    EXPECT(r->contacts >= 0 && r->impacts >= 0 && r->candidates >= 0);
    EXPECT(r->zone_vertices >= 0 && r->rolled_back >= 0);
    EXPECT(r->residual >= 0 || stands);
    EXPECT(stands || (r->kinetic >= 0 && isfinite(r->kinetic)));
    EXPECT(stands || (isfinite(r->elastic) && isfinite(r->potential)));
    return NULL;
}

/* A step that starts without intersections ends without, or its outcome says
 * otherwise. Where self-collision is off the audit finds pairs that do not
 * count. */
static const char *look_at_pairs(struct play *p, int outcome)
{
    int64_t before = p->pairs;
    p->pairs = small_audit(&p->s, p->world[0]);
    EXPECT(p->pairs >= 0);
    EXPECT(before != 0 || p->pairs == 0 || !p->s.def.self_collision ||
           outcome & DRAPE_TRAPPED);
    return NULL;
}

/* Makes allocations fail in one call of eight. */
static bool be_short(struct play *p)
{
    struct bank *bank = pick(&p->b, 2) ? &p->s.device : &p->s.host;
    if (p->world[1] || pick(&p->b, 8) != 7)
        return false;
    bank->from = bank->calls + pick(&p->b, 24);
    bank->times = pick(&p->b, 2) ? 1 : INT64_MAX;
    return true;
}

const char *play_step(struct play *p)
{
    drape_step_report r[2];
    int status[2] = {DRAPE_OK, DRAPE_OK};
    if (p->steps++ >= p->most_steps)
        return NULL;
    EXPECT(play_note(p, p->before));
    bool quiet = pick(&p->b, 8) == 7, lean = be_short(p);
    if (p->pairs < 0)
        p->pairs = small_audit(&p->s, p->world[0]);
    memset(r, 0, sizeof r);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] =
            drape_step(p->world[k], quiet && !p->world[1] ? NULL : &r[k]);
    p->s.host.from = p->s.device.from = INT64_MAX;
    EXPECT(!p->world[1] || status[0] == status[1]);
    EXPECT(play_note(p, p->after));
    if (status[0] != DRAPE_OK) {
        EXPECT(lean && status[0] == DRAPE_ENOMEM);
        EXPECT(tape_same(&p->before[0], &p->after[0]));
        return NULL;
    }
    EXPECT(!p->world[1] || reports_same(r[0], r[1], false));
    const char *failed = small_state(&p->s, p->world[0]);
    if (quiet && !p->world[1]) {
        p->pairs = -1;
        p->time = -1;
        return failed;
    }
    if (!failed && p->time >= 0)
        failed = look_at_report(p, &r[0]);
    p->time = r[0].time;
    return failed ? failed : look_at_pairs(p, r[0].outcome);
}

/* A new world, with other threads and block sizes, that loads the checkpoint
 * continues bit for bit as this world does. */
const char *play_again(struct play *p)
{
    drape_world *fresh;
    drape_step_report r[2];
    drape_def def = p->s.def;
    if (p->steps++ >= p->most_steps || !tape_save(&p->before[0], p->world[0]))
        return NULL;
    def.threads = 3 - def.threads;
    def.block = 32 + (def.block + 32) % 96;
    EXPECT(drape_create(&def, &fresh, NULL) == DRAPE_OK);
    EXPECT(drape_load(fresh, tape_read, &p->before[0]) == DRAPE_OK);
    memset(r, 0, sizeof r);
    int a = drape_step(p->world[0], &r[0]), b = drape_step(fresh, &r[1]);
    if (p->world[1])
        EXPECT(drape_step(p->world[1], NULL) == a);
    bool same = tape_save(&p->before[0], p->world[0]) &&
                tape_save(&p->before[1], fresh) &&
                tape_same(&p->before[0], &p->before[1]);
    drape_destroy(fresh);
    p->pairs = -1;
    p->time = r[0].time;
    EXPECT(a == DRAPE_OK && b == DRAPE_OK && same);
    EXPECT(reports_same(r[0], r[1], true));
    return NULL;
}
