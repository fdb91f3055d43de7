/* SPDX-License-Identifier: Apache-2.0 */
/* A world that stops before every step, and goes on elsewhere from its
 * checkpoint, beside one that never stops. spec/control/control.md §6 */
#include "tests/twins/ensemble.h"
#include "tests/world/recall.h"
#include "tests/world/scene.h"

/* What must have happened in a run, so that remembering it is tested. */
struct seen {
    int slept, woke, cut;
    int64_t contacts, impacts;
};

static void look(struct seen *s, const drape_step_report *r, int before)
{
    s->slept += r->asleep > before;
    s->woke += r->asleep < before;
    s->cut += r->slices > 1;
    s->contacts += r->contacts;
    s->impacts += r->impacts;
}

/* The lists of contacts after the same step have the same bits. */
static bool same_lists(drape_world *a, drape_world *b)
{
    drape_contact_list l, m;
    int status = drape_contacts(a, &l);
    if (drape_contacts(b, &m) != status)
        return false;
    if (status != DRAPE_OK)
        return true; /* an explicit method has none */
    size_t bytes = sizeof *l.impulse * (ENSEMBLE_CLOTHS + 1);
    return l.n == m.n && l.dt == m.dt && !memcmp(l.impulse, m.impulse, bytes) &&
           (l.n == 0 ||
            !memcmp(l.contact, m.contact, (size_t)l.n * sizeof *l.contact));
}

/* §8.1: a contact of the loop that no impact replaced is listed once, with what
 * the rounds gave it. */
static bool listed_once(drape_world *world)
{
    drape_contact_list l;
    if (drape_contacts(world, &l) != DRAPE_OK)
        return true;
    for (int64_t k = 1; k < l.n; k++)
        for (int64_t j = 0; j < k; j++)
            if (!memcmp(&l.contact[j], &l.contact[k],
                        offsetof(drape_contact, impulse)))
                return false;
    return true;
}

/* Step k of a world, and of `to` from the checkpoint of `from`. The calls
 * before the step are made before the world stops or, while all are awake,
 * after it goes on. */
static const char *step_both(const struct ensemble *e, int k, drape_world *on,
                             drape_world *from, drape_world *to,
                             drape_step_report *r)
{
    static struct recall m, n;
    drape_step_report s = {0};
    drape_contact_list none;
    drape_world *told = k % 2 ? from : to;
    memset(r, 0, sizeof *r);
    if (told == from)
        EXPECT(ensemble_call(from, e, k) == DRAPE_OK);
    EXPECT(recall_save(from, &m) && recall_load(to, &m) == DRAPE_OK);
    EXPECT(drape_contacts(to, &none) != DRAPE_OK || none.n == 0);
    if (told == to)
        EXPECT(ensemble_call(to, e, k) == DRAPE_OK);
    EXPECT(ensemble_call(on, e, k) == DRAPE_OK);
    EXPECT(drape_step(on, r) == DRAPE_OK && drape_step(to, &s) == DRAPE_OK);
    EXPECT(ensemble_same(*r, s) && same_lists(on, to) && listed_once(on));
    EXPECT(scene_hash(on) == scene_hash(to));
    EXPECT(recall_save(on, &m) && recall_save(to, &n) && recall_same(&m, &n));
    return NULL;
}

static const char *check(int how, struct seen *seen)
{
    static struct ensemble e;
    drape_world *world[3];
    drape_step_report r = {0};
    ensemble_make(&e, how);
    for (int k = 0; k < 3; k++) {
        world[k] = slab_world(&e.d);
        EXPECT(world[k]);
    }
    const char *failed = NULL;
    for (int k = 0; k < ENSEMBLE_STEPS && !failed; k++) {
        int before = r.asleep;
        /* the world that goes on was left two steps ago */
        failed =
            step_both(&e, k, world[0], world[1 + k % 2], world[2 - k % 2], &r);
        look(seen, &r, before);
        ran(1);
    }
    for (int k = 0; k < 3; k++)
        drape_destroy(world[k]);
    return failed;
}

const char *test_resumed_always(void)
{
    const char *failed = NULL;
    for (int how = 0; how < ENSEMBLE_HOWS && !failed; how++) {
        struct seen seen = {0};
        failed = check(how, &seen);
        bool explicit = how == ENSEMBLE_HOWS - 1;
        EXPECT(failed || seen.contacts > 0);
        EXPECT(failed || explicit || (seen.slept > 0 && seen.woke > 0));
    }
    return failed;
}
