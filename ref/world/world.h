/* SPDX-License-Identifier: Apache-2.0 */
/* A world of one precision, as drape.c sees it: ref/world/world.c makes it,
 * ref/world/step.c advances it. */
#ifndef REF_WORLD_H
#define REF_WORLD_H

#include "ref/base/arena.h"
#include "spec/drape.h"

struct world;

/* What the API needs of a precision. */
struct world_ops {
    int (*make)(const drape_def *def, struct arena *arena, struct world **world,
                drape_error *error);
    int (*step)(struct world *w, drape_step_report *report);
    int (*read)(const struct world *w, double (*x)[3], double (*v)[3]);
    void (*read_triangles)(const struct world *w, int32_t (*tri)[3]);
    int64_t (*first_vertex)(const struct world *w, int body);
    int64_t (*first_triangle)(const struct world *w, int body);
    void (*wake)(struct world *w);
    int (*set_wind)(struct world *w, const drape_wind *wind);
    int (*plan)(const struct world *w, drape_plan_row *row, int capacity);
    int (*save)(const struct world *w, drape_write *write, void *user);
    int (*load)(struct world *w, drape_read_bytes *read, void *user);
    /* view: all but its counts and precision. */
    int (*borrow)(struct world *w, drape_view *view);
    /* Of a device, else NULL: adds to m; says which it is and how it fares;
     * ends what the arena does not hold. */
    void (*count)(const struct world *w, drape_memory *m);
    const char *(*device)(const struct world *w);
    void (*end)(struct world *w);
};

extern const struct world_ops world_ops_32, world_ops_64;
/* On the device; in a build without CUDA make refuses. */
extern const struct world_ops world_ops_gpu_32, world_ops_gpu_64;
/* drape_info's text, from where it is known what the device is; static. */
const char *gpu_info(void);
#define WORLD_INFO(gpu)                                                        \
    "drape " DRAPE_VERSION                                                     \
    "\nbackend ref: binary32, binary64\nbackend gpu: " gpu                     \
    "\ncertificate: " CERTIFICATE "\n"

#endif
