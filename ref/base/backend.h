/* SPDX-License-Identifier: Apache-2.0 */
/* A backend: the table of functions by which the host's code calls stages. The
 * host's decisions (ref/world, ref/broad/broad.c, and response.c, failsafe.c
 * and lagrange.c of ref/contact) are written once. They use the table of the
 * world's backend, which ref/world/backend.c fills for the reference and
 * gpu/world/backend.cu for a device. spec/world/step.md §12 */
#ifndef REF_BACKEND_H
#define REF_BACKEND_H

#include "ref/base/arena.h"
#include "ref/base/real.h"
#include "ref/base/trace.h"

struct blend;
struct broad;
struct contact;
struct dynamics;
struct joint;
struct jumps;
struct response;
struct seam;
struct seam_point;
struct sheet;
struct shift;
struct wake;
struct world;
#define STAGE(room, file, X, rule) struct X;
#include "spec/stages.def"
#undef STAGE

/* A stream that can grow. Growing it loses its contents. */
struct pool {
    void *data;
    int64_t cap; /* items */
};

/* What a backend works on: a device. The reference passes its arena as one, by
 * backend_of, and nothing else looks into it. */
struct gpu;

/* The functions of a backend. Streams lie in the memory of the backend. A
 * function of a device may queue its work and return; a later `status` then
 * returns its error. */
struct backend {
    /* Takes a zeroed stream of n items. NULL if there is no memory. */
    void *(*take)(struct gpu *on, enum arena_part part, int64_t n, size_t size);
    /* Gives the pool room for `need` items, and for more, so that growth is
     * rare. kept: the contents must outlast a linear solve. DRAPE_OK or
     * DRAPE_ENOMEM. */
    int (*grow)(struct gpu *on, struct pool *pool, enum arena_part part,
                int64_t need, size_t size, bool kept);
    /* Gives back a stream of `take`, or NULL. */
    void (*give)(struct gpu *on, void *p);
    void (*copy)(struct gpu *on, void *to, const void *from, size_t bytes);
    void (*clear)(struct gpu *on, void *p, size_t bytes);
    /* Copies from host memory. The host memory may be reused on return. */
    void (*send)(struct gpu *on, void *to, const void *from, size_t bytes);
    /* Copies to host memory; it is there on return. */
    void (*fetch)(struct gpu *on, void *host, const void *from, size_t bytes);
    /* How many vectors of scratch stage contacts needs for each contact. */
    int pushes;

    void (*begin)(struct gpu *on); /* forgets an earlier lack of memory */
    void (*wait)(struct gpu *on);  /* waits for all work, to measure time */
    int (*status)(struct gpu *on); /* DRAPE_OK or the first error since begin */
    /* Does what trace_stage does, for a stream in the backend's memory. */
    void (*trace)(struct gpu *on, struct trace *t, const char *stage,
                  const void *out, size_t bytes);

    /* Every stage, and the work between stages. */
#define STAGE(room, file, X, rule) int (*X)(struct gpu * on, struct X * s);
#include "spec/stages.def"
#undef STAGE
#define CALL(result, name, ...) result (*name)(__VA_ARGS__);
#include "ref/base/backend.def"
#undef CALL
};

#define CALL(result, name, ...) result ref_##name(__VA_ARGS__);
#include "ref/base/backend.def"
#undef CALL

/* ref/world/backend.c */
extern const struct backend backend_ref;
struct gpu *backend_of(struct arena *arena);

#endif
