/* SPDX-License-Identifier: Apache-2.0 */
/* drape embedded in another program: all memory comes from the caller, lack of
 * memory is a status, and worlds in several threads are independent.
 * spec/drape.h */
#include <dirent.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "ref/base/sum.h"
#include "ref/cloth/dynamics.h"
#include "tests/api/guest.h"
#include "tests/world/scene.h"

enum { SETTLE = 12, SETTLED = 40, SHORT = 3, LENT = 12, LAND = 4, THREADS = 4 };

static size_t planned(const drape_world *world)
{
    drape_plan_row row[64];
    size_t sum = 0;
    int rows = drape_plan(world, row, 64);
    for (int k = 0; k < rows; k++)
        sum += row[k].bytes;
    return sum;
}

/* Reported bytes are the bytes allocated; once the scene has settled nothing
 * more is allocated; in the end all memory is given back. */
const char *test_embed_memory(void)
{
    for (int backend = DRAPE_REF; backend <= DRAPE_GPU; backend++) {
        struct guest s;
        drape_world *world;
        drape_memory a, b;
        guest_make(&s, backend);
        int status = drape_create(&s.def, &world, NULL);
        if (status == DRAPE_EDEVICE)
            return skip("there is no device");
        EXPECT(status == DRAPE_OK);
        EXPECT(guest_go(world, SETTLED) == DRAPE_OK);
        EXPECT(drape_count(world, &a) == DRAPE_OK);
        EXPECT(guest_go(world, SETTLE) == DRAPE_OK);
        EXPECT(drape_count(world, &b) == DRAPE_OK);
        EXPECT(!memcmp(&a, &b, sizeof a));
        EXPECT(b.host_allocations == s.host.calls);
        EXPECT(b.device_allocations == s.device.calls);
        EXPECT(b.device_bytes == s.device.held);
        /* each host allocation has a header of 64 bytes */
        EXPECT(b.host_bytes < s.host.held);
        EXPECT(planned(world) == (backend ? b.device_bytes : b.host_bytes));
        drape_destroy(world);
        EXPECT(s.host.held == 0 && s.device.held == 0);
        ran(1);
    }
    return NULL;
}

/* Bytes of the solver's part. */
static size_t solver_bytes(const drape_world *world)
{
    drape_plan_row row[64];
    int rows = drape_plan(world, row, 64);
    for (int k = 0; k < rows && k < 64; k++)
        if (!strcmp(row[k].stage, "implicit"))
            return row[k].bytes;
    return 0;
}

/* An explicit integrator holds no memory of an implicit one's linear system:
 * only its substeps' streams, and on a device RK4's spare. */
const char *test_embed_explicit(void)
{
    for (int k = 0; k < 8; k++) {
        struct guest s;
        drape_world *world;
        guest_make(&s, k % 2 ? DRAPE_GPU : DRAPE_REF);
        s.def.integrator = DRAPE_EULER + k / 2;
        s.def.dt = 1e-3;
        int status = drape_create(&s.def, &world, NULL);
        if (status == DRAPE_EDEVICE)
            return skip("there is no device");
        EXPECT(status == DRAPE_OK);
        int64_t count = s.cloth.m * s.cloth.n;
        int64_t vecs = dynamics_vecs(s.def.integrator);
        vecs += s.def.integrator == DRAPE_RK4 && k % 2;
        int64_t most = vecs * count * (int64_t)sizeof(vec) +
                       3 * sum_chunks(count) * (int64_t)sizeof(real);
        size_t held = solver_bytes(world);
        EXPECT(held > 0 && held <= (size_t)most + 1024); /* alignment */
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}

/* Contact borrows the memory of the solver, and nothing that must survive a
 * solve is stored there: the emulated device overwrites it in each solve. That
 * memory suffices for the scene, unless contacts take part in solves: then the
 * matrix and its preconditioner are not lent. */
static const char *lend(int response)
{
    uint64_t hash[2];
    for (int backend = DRAPE_REF; backend <= DRAPE_GPU; backend++) {
        struct guest s;
        drape_world *world;
        drape_step_report r;
        drape_memory a, b;
        guest_make(&s, backend);
        s.cloth.m = s.cloth.n = 16;
        s.def.response = response;
        s.def.matrix = DRAPE_CDF; /* this matrix lends most memory */
        s.def.precond = DRAPE_JACOBI;
        int status = drape_create(&s.def, &world, NULL);
        if (status == DRAPE_EDEVICE)
            return skip("there is no device");
        EXPECT(status == DRAPE_OK && drape_count(world, &a) == DRAPE_OK);
        EXPECT(guest_go(world, LAND) == DRAPE_OK);
        EXPECT(drape_step(world, &r) == DRAPE_OK && r.contacts > 0);
        EXPECT(drape_count(world, &b) == DRAPE_OK);
        /* the front, contacts, their lists, and what is too large */
        EXPECT(response == DRAPE_SOLVE ||
               b.device_allocations - a.device_allocations < LENT);
        /* rounds borrow, which a loop that ends clean does without */
        EXPECT(!backend                  ? b.borrowed_bytes == 0
               : response == DRAPE_SOLVE ? b.borrowed_bytes >= a.borrowed_bytes
                                         : b.borrowed_bytes > a.borrowed_bytes);
        hash[backend] = scene_hash(world);
        drape_destroy(world);
        ran(1);
    }
    EXPECT(hash[0] == hash[1]);
    return NULL;
}

const char *test_embed_lent(void)
{
    const char *failed = lend(DRAPE_SOLVE);
    return failed ? failed : lend(DRAPE_IMPULSES);
}

/* Whichever allocation of drape_create fails, it returns a status and keeps no
 * memory. */
static const char *short_making(struct guest *s,
                                struct counting_allocator *purse)
{
    for (purse->most = 0;; purse->most++) {
        drape_world *world;
        s->host.calls = s->device.calls = 0;
        int status = drape_create(&s->def, &world, NULL);
        if (status == DRAPE_OK) {
            drape_destroy(world);
            EXPECT(purse->most > 20);
            EXPECT(s->host.held == 0 && s->device.held == 0);
            purse->most = INT64_MAX;
            return NULL;
        }
        EXPECT(status == DRAPE_ENOMEM && !world);
        EXPECT(s->host.held == 0 && s->device.held == 0);
        ran(1);
    }
}

/* Allocation k after drape_create fails: the step leaves the state as it was,
 * and when there is memory again the run ends with the same bits. */
static const char *short_run(struct guest *s, struct counting_allocator *purse,
                             int64_t k, uint64_t want, bool *failed)
{
    drape_world *world;
    *failed = false;
    EXPECT(drape_create(&s->def, &world, NULL) == DRAPE_OK);
    purse->most = purse->calls + k;
    for (int step = 0; step < SHORT; step++) {
        uint64_t before = scene_hash(world);
        int status = drape_step(world, NULL);
        if (status == DRAPE_OK)
            continue;
        EXPECT(status == DRAPE_ENOMEM && !*failed);
        EXPECT(scene_hash(world) == before);
        purse->most = INT64_MAX;
        *failed = true;
        step--;
    }
    purse->most = INT64_MAX;
    EXPECT(scene_hash(world) == want);
    drape_destroy(world);
    EXPECT(s->host.held == 0 && s->device.held == 0);
    ran(*failed);
    return NULL;
}

const char *test_embed_short(void)
{
    if (REAL_BITS == 64)
        return skip("the same source in binary32 decides");
    for (int backend = DRAPE_REF; backend <= DRAPE_GPU; backend++) {
        struct guest s;
        drape_world *world;
        guest_make(&s, backend);
        s.def.precond = DRAPE_JACOBI; /* emulated multigrid is slow */
        int status = drape_create(&s.def, &world, NULL);
        if (status == DRAPE_EDEVICE)
            return skip("there is no device");
        EXPECT(status == DRAPE_OK && guest_go(world, SHORT) == DRAPE_OK);
        uint64_t want = scene_hash(world);
        drape_destroy(world);
        struct counting_allocator *purse[] = {&s.host, &s.device};
        for (int j = 0; j <= backend; j++) {
            const char *what = short_making(&s, purse[j]);
            int64_t k = 0;
            int by = j < backend ? 5 : 1; /* records of the device's memory */
            for (bool failed = true; failed && !what; k += by)
                what = short_run(&s, purse[j], k, want, &failed);
            if (what)
                return what;
            EXPECT(k > 3);
        }
    }
    return NULL;
}

struct job {
    int backend;
    uint64_t hash; /* out: 0 if the run failed */
};

static void *work(void *user)
{
    struct job *job = user;
    struct guest s;
    drape_world *world;
    guest_make(&s, job->backend);
    s.def.device_allocator = (drape_allocator){0};
    job->hash = 0;
    if (drape_create(&s.def, &world, NULL) != DRAPE_OK)
        return NULL;
    if (guest_go(world, SHORT) == DRAPE_OK)
        job->hash = scene_hash(world);
    drape_destroy(world);
    return NULL;
}

static int threads_now(void)
{
    int n = 0;
    DIR *dir = opendir("/proc/self/task");
    for (struct dirent *e; dir && (e = readdir(dir));)
        n += e->d_name[0] != '.';
    if (dir)
        closedir(dir);
    return n;
}

/* Worlds in several threads of the caller give the same bits as each world
 * alone, and the reference starts no thread unless asked to. */
const char *test_embed_threads(void)
{
    pthread_t thread[THREADS];
    struct job alone[2] = {{DRAPE_REF, 0}, {DRAPE_GPU, 0}}, job[THREADS];
    int before = threads_now();
    work(&alone[0]);
    EXPECT(alone[0].hash && before == threads_now());
    work(&alone[1]);
    if (!alone[1].hash)
        return skip("there is no device");
    EXPECT(alone[0].hash == alone[1].hash);
    for (int k = 0; k < THREADS; k++) {
        job[k].backend = k % 2;
        EXPECT(!pthread_create(&thread[k], NULL, work, &job[k]));
    }
    for (int k = 0; k < THREADS; k++)
        pthread_join(thread[k], NULL);
    for (int k = 0; k < THREADS; k++) {
        EXPECT(job[k].hash == alone[0].hash);
        ran(1);
    }
    return NULL;
}
