/* SPDX-License-Identifier: Apache-2.0 */
/* Runs one scene on both backends; see tests/world/twin.h. */
#include "tests/world/twin.h"

#include <stdio.h>

#include "tests/base/notes.h"

static char text[160];

static const char *compare_reports(drape_step_report a, drape_step_report b)
{
    memset(a.seconds, 0, sizeof a.seconds);
    memset(b.seconds, 0, sizeof b.seconds);
    const unsigned char *p = (const void *)&a, *q = (const void *)&b;
    for (size_t k = 0; k < sizeof a; k++)
        if (p[k] != q[k]) {
            snprintf(text, sizeof text, "the reports differ at byte %d",
                     (int)k);
            return text;
        }
    return NULL;
}

static int hash_written(void *user, const void *data, size_t bytes)
{
    uint64_t *hash = user;
    *hash = hash_bytes(*hash, data, bytes);
    return 0;
}

/* Compares the checkpoints of both worlds, which hold everything that the next
 * step reads. */
static const char *compare_checkpoints(drape_world *const world[2])
{
    uint64_t hash[2] = {HASH_START, HASH_START};
    for (int k = 0; k < 2; k++)
        if (drape_save(world[k], hash_written, &hash[k]) != DRAPE_OK)
            return "there is no checkpoint";
    return hash[0] == hash[1] ? NULL : "the checkpoints differ";
}

/* Compares the lists of contacts of both worlds, where they have one. */
static const char *compare_lists(drape_world *const world[2])
{
    drape_contact_list l[2];
    int status[2], bodies = drape_bodies(world[0], NULL);
    for (int k = 0; k < 2; k++)
        status[k] = drape_contacts(world[k], &l[k]);
    if (status[0] != status[1])
        return "the lists of contacts differ in status";
    if (status[0] != DRAPE_OK)
        return NULL;
    if (l[0].n != l[1].n)
        return "the lists of contacts differ in number";
    if (l[0].n && memcmp(l[0].contact, l[1].contact,
                         (size_t)l[0].n * sizeof *l[0].contact) != 0)
        return "the lists of contacts differ";
    bool same = !memcmp(l[0].impulse, l[1].impulse,
                        (size_t)bodies * sizeof *l[0].impulse);
    return same ? NULL : "the impulses of bodies differ";
}

/* Makes a step of both worlds and compares them. The stages of a step that
 * diverges are not compared: it may make a NaN, whose payload IEEE 754 leaves
 * open. */
static const char *step_both(drape_world *const world[2], struct notes notes[2],
                             struct twin *out)
{
    drape_step_report r[2];
    int status[2];
    memset(r, 0, sizeof r);
    for (int k = 0; k < 2; k++) {
        notes[k].n = 0;
        status[k] = drape_step(world[k], &r[k]);
    }
    const char *failed = NULL;
    if (!(r[0].outcome & DRAPE_DIVERGED))
        failed = notes_compare(&notes[0], &notes[1]);
    if (failed)
        return failed;
    if (!notes[0].n && !(r[0].outcome & DRAPE_ASLEEP))
        return "nothing was traced";
    if (status[0] != status[1]) {
        snprintf(text, sizeof text, "status %d and %d", status[0], status[1]);
        return text;
    }
    out->steps += 1;
    out->some |= r[0].outcome;
    out->all &= r[0].outcome;
    failed = compare_reports(r[0], r[1]);
    failed = failed ? failed : compare_checkpoints(world);
    return failed ? failed : compare_lists(world);
}

static const char *create_both(const drape_def *def, struct notes notes[2],
                               drape_world *world[2])
{
    drape_error error[2];
    int status[2];
    for (int k = 0; k < 2; k++) {
        drape_def d = *def;
        d.backend = k ? DRAPE_GPU : DRAPE_REF;
        d.trace = notes_take;
        d.trace_user = &notes[k];
        status[k] = drape_create(&d, &world[k], &error[k]);
    }
    if (status[0] == status[1] && !strcmp(error[0].text, error[1].text))
        return NULL;
    snprintf(text, sizeof text, "created with %d and %d: %.100s", status[0],
             status[1], error[1].text);
    return text;
}

const char *twin_run(const drape_def *def, int n, struct twin *out)
{
    static char where[200];
    drape_world *world[2] = {NULL, NULL};
    struct notes notes[2] = {{0}, {0}};
    *out = (struct twin){.all = ~0};
    const char *failed = create_both(def, notes, world);
    for (int k = 0; k < n && world[0] && world[1] && !failed; k++) {
        failed = step_both(world, notes, out);
        if (failed) {
            snprintf(where, sizeof where, "step %d: %s", k + 1, failed);
            failed = where;
        }
    }
    for (int k = 0; k < 2; k++) {
        drape_destroy(world[k]);
        notes_free(&notes[k]);
    }
    return failed;
}
