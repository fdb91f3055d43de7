/* SPDX-License-Identifier: Apache-2.0 */
/* When a device is lost, at whatever point, all calls on its world return a
 * status from then on, and worlds of the reference continue. spec/gpu.md §10 */
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gpu/run/gpu.h"
#include "tests/api/guest.h"
#include "tests/base/modes.h"
#include "tests/base/stages.h"
#include "tests/world/scene.h"

enum { STEPS = 3, PATIENCE = 120 };

/* A world whose device will be lost, and a world of the reference beside it. */
struct loss {
    struct guest lent, here;
    drape_world *world, *twin;
    uint64_t want;  /* the twin's hash after STEPS steps */
    char last[640]; /* last line of the log */
    struct gpu *g;  /* the same device, by which the test loses it */
    int stages;     /* traced stages until the device is lost */
};

/* Loses the device; on a real device a kernel reads an invalid address. */
static void lose(struct gpu *g)
{
    struct history nothing = {.count = 1};
    if (gpu_device(g) < 0)
        gpu_set_way(g, (struct gpu_way){.lost = 1});
    else
        gpu_history(g, &nothing);
}

static void hear(void *user, const char *line)
{
    struct loss *l = user;
    snprintf(l->last, sizeof l->last, "%s", line);
}

static void pass(void *user, int64_t step, const char *stage, uint64_t digest,
                 double seconds)
{
    struct loss *l = user;
    (void)step, (void)stage, (void)digest, (void)seconds;
    if (--l->stages == 0)
        lose(l->g);
}

static int write_nothing(void *user, const void *data, size_t bytes)
{
    (void)user, (void)data, (void)bytes;
    return 0;
}

/* Makes the reference's world and its first step; the other world is not made
 * yet. */
static const char *prepare(struct loss *l, int precond)
{
    guest_make(&l->here, DRAPE_REF);
    guest_make(&l->lent, DRAPE_GPU);
    l->here.def.precond = l->lent.def.precond = precond;
    l->lent.def.log = hear;
    l->lent.def.log_user = l;
    EXPECT(drape_create(&l->here.def, &l->twin, NULL) == DRAPE_OK);
    EXPECT(guest_go(l->twin, STEPS) == DRAPE_OK);
    l->want = scene_hash(l->twin);
    drape_destroy(l->twin);
    EXPECT(drape_create(&l->here.def, &l->twin, NULL) == DRAPE_OK);
    EXPECT(guest_go(l->twin, 1) == DRAPE_OK);
    return NULL;
}

/* No other world can be made on the lost device. */
static const char *refused(struct loss *l)
{
    drape_world *other;
    drape_error error;
    EXPECT(drape_create(&l->lent.def, &other, &error) == DRAPE_EDEVICE);
    EXPECT(!other && error.text[0] && !strcmp(l->last, error.text));
    return NULL;
}

/* Each call on the world returns DRAPE_EDEVICE, and the log says why. */
static const char *stays_lost(struct loss *l)
{
    double x[64][3], v[64][3];
    drape_view view;
    const char *why = drape_status_text(DRAPE_EDEVICE);
    EXPECT(drape_vertices(l->world) <= 64);
    for (int k = 0; k < 2; k++) {
        EXPECT(strstr(l->last, why) && !strncmp(l->last, "step ", 5));
        EXPECT(strstr(l->last, gpu_device(l->g) < 0 ? "lost on purpose"
                                                    : "illegal memory"));
        EXPECT(drape_step(l->world, NULL) == DRAPE_EDEVICE);
    }
    EXPECT(drape_read(l->world, x, v) == DRAPE_EDEVICE);
    EXPECT(drape_borrow(l->world, &view) == DRAPE_EDEVICE);
    EXPECT(drape_save(l->world, write_nothing, NULL) == DRAPE_EDEVICE);
    return refused(l);
}

/* The reference's world continues, and in the end all memory is given back. */
static const char *goes_on(struct loss *l)
{
    EXPECT(guest_go(l->twin, STEPS - 1) == DRAPE_OK);
    EXPECT(scene_hash(l->twin) == l->want);
    drape_destroy(l->twin);
    drape_destroy(l->world);
    EXPECT(l->lent.host.held == 0 && l->lent.device.held == 0);
    EXPECT(l->here.host.held == 0);
    return NULL;
}

/* Emulated device: it is lost at its operation k. *lost: whether drape_create
 * and the steps made that many operations. */
static const char *lost_at(struct gpu *g, int64_t k, bool *lost)
{
    struct loss l = {.g = g};
    const char *what = prepare(&l, DRAPE_JACOBI); /* multigrid is slow here */
    if (what)
        return what;
    gpu_set_way(g, (struct gpu_way){.lost = k});
    int status = drape_create(&l.lent.def, &l.world, NULL);
    *lost = status != DRAPE_OK;
    if (*lost) {
        EXPECT(status == DRAPE_EDEVICE && !l.world);
        what = refused(&l);
    } else {
        status = guest_go(l.world, STEPS);
        *lost = status != DRAPE_OK;
        EXPECT(!*lost || status == DRAPE_EDEVICE);
        if (*lost)
            what = stays_lost(&l);
    }
    if (!what)
        what = goes_on(&l);
    ran(*lost);
    return what;
}

/* Real device: it is lost in a child process */

const char *lose_device(int stage)
{
    alarm(PATIENCE); /* a call that never returns is a failure too */
    int status;
    struct loss l = {.g = gpu_open(NULL, &status), .stages = stage};
    EXPECT(l.g);
    const char *what = prepare(&l, DRAPE_MULTIGRID);
    if (what)
        return what;
    if (stage > 0) {
        l.lent.def.trace = pass;
        l.lent.def.trace_user = &l;
    }
    EXPECT(drape_create(&l.lent.def, &l.world, NULL) == DRAPE_OK);
    if (stage == 0) {
        EXPECT(guest_go(l.world, 1) == DRAPE_OK);
        lose(l.g);
    }
    EXPECT(guest_go(l.world, STEPS) == DRAPE_EDEVICE);
    what = stays_lost(&l);
    if (!what)
        what = goes_on(&l);
    gpu_close(l.g);
    return what;
}

/* Runs the test in a child process, since CUDA does not give a process a device
 * again that the process has lost. */
static const char *lose_apart(int stage)
{
    char number[16];
    int status = 1;
    snprintf(number, sizeof number, "%d", stage);
    fflush(stdout);
    pid_t child = fork();
    EXPECT(child >= 0);
    if (child == 0) {
        execl("/proc/self/exe", "check", "--lose", number, (char *)NULL);
        _exit(127);
    }
    EXPECT(waitpid(child, &status, 0) == child);
    EXPECT(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    ran(1);
    return NULL;
}

const char *test_embed_lost(void)
{
    static const int stages[] = {0, 1, 2, 9, 40};
    int status;
    if (REAL_BITS == 64)
        return skip("the same source in binary32 decides");
    struct gpu *g = gpu_open(NULL, &status);
    if (!g)
        return skip("there is no device");
    const char *what = NULL;
    bool lost = gpu_device(g) < 0;
    for (int64_t k = 1; lost && !what; k += 1 + k / 64)
        what = lost_at(g, k, &lost);
    gpu_set_way(g, (struct gpu_way){0});
    for (size_t k = 0; k < sizeof stages / sizeof *stages && !what; k++)
        what = lose_apart(stages[k]);
    gpu_close(g);
    return what;
}
