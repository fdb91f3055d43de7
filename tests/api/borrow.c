/* SPDX-License-Identifier: Apache-2.0 */
/* A world lends its streams to the host program without a copy, and writes a
 * log. spec/drape.h */
#include <stdio.h>
#include <stdlib.h>

#include "gpu/run/gpu.h"
#include "tests/api/guest.h"

enum { FALL = 16, SETTLE = 12, SHORT = 3 };

/* Copies n numbers of the view's precision to `to`, from the host or the
 * device.
 */
static void fetch(struct gpu *g, const drape_view *view, const void *from,
                  size_t n, double *to)
{
    size_t size = view->precision == 64 ? sizeof(double) : sizeof(float);
    char *copy = malloc(n * size);
    if (view->device < 0)
        memcpy(copy, from, n * size);
    else
        gpu_down(g, copy, from, n * size);
    for (size_t k = 0; k < n; k++)
        to[k] = size == sizeof(double) ? ((double *)(void *)copy)[k]
                                       : (double)((float *)(void *)copy)[k];
    free(copy);
}

static const char *compare_view(const drape_world *world, struct gpu *g,
                                const drape_view *view)
{
    enum { MOST = 64 };
    double x[MOST][3], v[MOST][3], there[MOST][3];
    int32_t tri[2 * MOST][3], tri_there[2 * MOST][3];
    size_t n = (size_t)view->vertices, nt = (size_t)view->triangles;
    EXPECT(view->vertices == drape_vertices(world) && n <= MOST);
    EXPECT(view->triangles == drape_triangles(world) && nt <= 2 * MOST);
    EXPECT(view->precision == REAL_BITS);
    EXPECT(drape_read(world, x, v) == DRAPE_OK);
    EXPECT(drape_read_triangles(world, tri) == DRAPE_OK);
    fetch(g, view, view->x, 3 * n, there[0]);
    EXPECT(!memcmp(x, there, n * sizeof *x));
    fetch(g, view, view->v, 3 * n, there[0]);
    EXPECT(!memcmp(v, there, n * sizeof *v));
    if (view->device < 0)
        memcpy(tri_there, view->tri, nt * sizeof *tri);
    else
        gpu_down(g, tri_there, view->tri, nt * sizeof *tri);
    EXPECT(!memcmp(tri, tri_there, nt * sizeof *tri));
    ran(1);
    return NULL;
}

/* drape_borrow lends the same numbers that drape_read copies, on the caller's
 * stream and without an allocation, while the scene collides. */
const char *test_embed_borrow(void)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g)
        return skip("there is no device");
    for (int backend = DRAPE_REF; backend <= DRAPE_GPU; backend++) {
        struct guest s;
        drape_world *world;
        drape_view view, again;
        guest_make(&s, backend);
        s.def.stream = gpu_stream(g);
        EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
        const char *what = NULL;
        for (int k = 0; k < SHORT && !what; k++) {
            int64_t calls = s.host.calls + s.device.calls;
            EXPECT(drape_borrow(world, &view) == DRAPE_OK);
            EXPECT(drape_borrow(world, &again) == DRAPE_OK);
            EXPECT(again.x == view.x && again.tri == view.tri);
            EXPECT(calls == s.host.calls + s.device.calls);
            what = compare_view(world, g, &view);
            EXPECT(view.stream == (backend ? gpu_stream(g) : NULL));
            EXPECT(view.device == (backend ? gpu_device(g) : -1));
            EXPECT(guest_go(world, 1) == DRAPE_OK);
        }
        drape_destroy(world);
        if (what)
            return what;
    }
    gpu_close(g);
    return NULL;
}

/* The number of log lines of each kind. */
struct lines {
    int made, grew, failed, other;
    char last[640];
};

static void hear(void *user, const char *line)
{
    struct lines *l = user;
    int *count = !strncmp(line, "made: ", 6)     ? &l->made
                 : strstr(line, "memory grew")   ? &l->grew
                 : strstr(line, "out of memory") ? &l->failed
                                                 : &l->other;
    ++*count;
    snprintf(l->last, sizeof l->last, "%s", line);
}

/* Each step in which memory is taken, here or on the device, has one line: the
 * sheet begins above its plate, so that some steps need more on the device
 * alone. */
static const char *check_growth(int backend)
{
    struct guest s;
    struct lines l = {0};
    drape_world *world;
    int grew = 0;
    guest_make(&s, backend);
    s.def.precond = DRAPE_JACOBI;
    s.def.log = hear;
    s.def.log_user = &l;
    s.cloth.origin[1] += 0.02;
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    for (int k = 0; k < FALL; k++) {
        int64_t calls = s.host.calls + s.device.calls;
        EXPECT(guest_go(world, 1) == DRAPE_OK);
        grew += calls != s.host.calls + s.device.calls;
    }
    EXPECT(grew > 1 && l.grew == grew);
    drape_destroy(world);
    ran(1);
    return NULL;
}

/* The log has one line when a world is made or refused, when memory grows, and
 * when a step fails; it has no other lines. */
const char *test_embed_log(void)
{
    for (int backend = DRAPE_REF; backend <= DRAPE_GPU; backend++) {
        struct guest s;
        struct lines l = {0};
        drape_world *world;
        drape_error error;
        guest_make(&s, backend);
        s.def.precond = DRAPE_JACOBI;
        s.def.log = hear;
        s.def.log_user = &l;
        int status = drape_create(&s.def, &world, NULL);
        if (status == DRAPE_EDEVICE)
            return skip("there is no device");
        EXPECT(status == DRAPE_OK && l.made == 1);
        EXPECT(strstr(l.last, backend ? "gpu" : "ref"));
        struct counting_allocator *purse = backend ? &s.device : &s.host;
        purse->most = purse->calls;
        EXPECT(guest_go(world, SHORT) == DRAPE_ENOMEM && l.failed == 1);
        purse->most = INT64_MAX;
        EXPECT(guest_go(world, SETTLE) == DRAPE_OK && l.grew > 1);
        int grew = l.grew;
        EXPECT(guest_go(world, SHORT) == DRAPE_OK && l.grew == grew);
        drape_destroy(world);
        s.def.dt = -1;
        EXPECT(drape_create(&s.def, &world, &error) == DRAPE_EARG);
        EXPECT(!strcmp(l.last, error.text));
        EXPECT(l.made == 1 && l.failed == 1 && l.other == 1);
        ran(1);
        const char *what = check_growth(backend);
        if (what)
            return what;
    }
    return NULL;
}
