/* SPDX-License-Identifier: Apache-2.0 */
/* A world of one precision as the API (ref/api/drape.c) sees it: a table of
 * functions, which ref/api/table.c fills for the reference. */
#ifndef REF_OPS_H
#define REF_OPS_H

#include "ref/base/arena.h"
#include "ref/base/names.h"
#include "spec/drape.h"

struct edited;
struct given;
struct scene_edit;
struct world;

/* Bodies that are added and removed: ref/control/edit.h. */
struct edit_ops {
    int (*define)(const struct world *old, const struct scene_edit *edit,
                  struct arena *arena, drape_def *def, struct edited *edited);
    int (*make)(const drape_def *def, const struct edited *edited,
                struct arena *arena, struct world **world, drape_error *error);
    int (*inherit)(struct world *w, const struct edited *edited,
                   drape_error *error);
};

/* Live control: ref/control/control.h. */
struct control_ops {
    void (*gravity)(struct world *w, const double gravity[3]);
    int (*material)(struct world *w, int cloth, const drape_material *m);
    int (*positions)(struct world *w, int64_t first, int64_t n, struct given x,
                     drape_error *error);
    int (*velocities)(struct world *w, int64_t first, int64_t n,
                      struct given v);
    int (*pins)(struct world *w, int cloth, int64_t n, const int32_t *particle,
                struct given x);
    int (*obstacle)(struct world *w, int obstacle, struct given x);
    int (*pose)(struct world *w, int obstacle, const drape_motion *motion);
    int (*fetch)(struct world *w, void *host, const void *there, size_t bytes);
    int64_t (*seam_points)(const struct world *w, int seam); /* -1: none */
    int (*seam_target)(struct world *w, int seam, int64_t n,
                       const double (*gap)[3]);
    int (*seam_state)(const struct world *w, int seam, double (*gap)[3],
                      double (*pull)[3]);
    bool (*sewn)(const struct world *w, int32_t a, int32_t b);
};

/* The functions that the API calls, of one precision and one backend. */
struct world_ops {
    int (*make)(const drape_def *def, struct arena *arena, struct world **world,
                drape_error *error);
    int (*step)(struct world *w, drape_step_report *report);
    int (*read)(const struct world *w, double (*x)[3], double (*v)[3]);
    void (*read_triangles)(const struct world *w, int32_t (*tri)[3]);
    void (*clock)(const struct world *w, int64_t *step, double *time);
    const drape_material *(*material)(const struct world *w, int cloth);
    const drape_wind *(*wind)(const struct world *w);
    const double *(*gravity)(const struct world *w); /* [3] */
    int64_t (*first_vertex)(const struct world *w, int body);
    int64_t (*first_triangle)(const struct world *w, int body);
    void (*wake)(struct world *w);
    int (*set_wind)(struct world *w, const drape_wind *wind);
    struct control_ops control;
    struct edit_ops edit;
    int (*contacts)(struct world *w, bool there, drape_contact_list *list);
    int (*plan)(const struct world *w, drape_plan_row *row, int capacity);
    int (*save)(const struct world *w, drape_write *write, void *user);
    int (*load)(struct world *w, drape_read_bytes *read, void *user);
    /* Sets the members of view except counts and precision. */
    int (*borrow)(struct world *w, drape_view *view);
    /* NULL for the reference: the device on which a world can be advanced
     * together with others, ≥ 0, or -1; and calls work(with, k) for each of n
     * such worlds of one device, together. */
    int (*place)(const struct world *w);
    int (*together)(struct world *const *w, int n, int threads,
                    void (*work)(void *with, int k), void *with);
    /* These three are NULL for the reference. They add the device's memory to
     * m; name the device and, if it was lost, the reason; and release what the
     * arena does not hold. */
    void (*count)(const struct world *w, drape_memory *m);
    const char *(*device)(const struct world *w);
    void (*end)(struct world *w);
};

extern const struct world_ops world_ops_32, world_ops_64;
/* Worlds on a device. In a build without CUDA their `make` fails. */
extern const struct world_ops world_ops_gpu_32, world_ops_gpu_64;

#endif
