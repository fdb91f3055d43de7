/* SPDX-License-Identifier: Apache-2.0 */
/* A backend: the table of functions by which the host's code calls stages. The
 * host's decisions (ref/world, ref/contact/response.c, failsafe.c and
 * lagrange.c) are written once. They use the table of the world's backend,
 * which ref/world/backend.c fills for the reference and gpu/world/backend.cu
 * for a device. spec/world/step.md §12 */
#ifndef REF_BACKEND_H
#define REF_BACKEND_H

#include "ref/base/arena.h"
#include "ref/base/real.h"
#include "ref/base/trace.h"

struct audit;
struct blend;
struct broad;
struct carry;
struct contact;
struct contacts;
struct coulomb;
struct dot;
struct history;
struct impacts;
struct impulses;
struct islands;
struct jumps;
struct kinematics;
struct moments;
struct narrow;
struct proximity;
struct response;
struct retain;
struct rollback;
struct wake;
struct sheet;
struct shift;
struct spin;
struct travel;
struct joint;
struct world;
struct zones;

/* A stream that can grow. Growing it loses its contents. */
struct pool {
    void *data;
    int64_t cap; /* items */
};

/* The functions of a backend. Their argument `on` is the arena of the
 * reference, or the struct gpu of a device. Streams lie in the memory of the
 * backend. A function of a device may queue its work and return; a later
 * `status` then returns its error. */
struct backend {
    /* Takes a zeroed stream of n items. NULL if there is no memory. */
    void *(*take)(void *on, enum arena_part part, int64_t n, size_t size);
    /* Gives the pool room for `need` items, and for more, so that growth is
     * rare. kept: the contents must outlast a linear solve. DRAPE_OK or
     * DRAPE_ENOMEM. */
    int (*grow)(void *on, struct pool *pool, int64_t need, size_t size,
                bool kept);
    /* Gives back a stream of `take`, or NULL. */
    void (*give)(void *on, void *p);
    void (*copy)(void *on, void *to, const void *from, size_t bytes);
    void (*clear)(void *on, void *p, size_t bytes);
    /* Copies from host memory. The host memory may be reused on return. */
    void (*send)(void *on, void *to, const void *from, size_t bytes);
    /* How many vectors of scratch stage contacts needs for each contact. */
    int pushes;

    void (*begin)(void *on); /* forgets an earlier lack of memory */
    void (*wait)(void *on);  /* waits for all work, to measure time */
    int (*status)(void *on); /* DRAPE_OK or the first error since begin */
    /* Does what trace_stage does, for a stream in the backend's memory. */
    void (*trace)(void *on, struct trace *t, const char *stage, const void *out,
                  size_t bytes);

    int (*dot)(void *on, struct dot *s);
    int (*kinematics)(void *on, struct kinematics *s);
    int (*moments)(void *on, struct moments *s);
    int (*islands)(void *on, struct islands *s);
    int (*spin)(void *on, struct spin *s);
    int (*history)(void *on, struct history *s);
    int (*travel)(void *on, struct travel *s);
    int (*narrow)(void *on, struct narrow *s);
    int (*audit)(void *on, struct audit *s);
    int (*proximity)(void *on, struct proximity *s);
    int (*impacts)(void *on, struct impacts *s);
    int (*impulses)(void *on, struct impulses *s);
    int (*contacts)(void *on, struct contacts *s);
    int (*zones)(void *on, struct zones *s);
    int (*rollback)(void *on, struct rollback *s);
    int (*coulomb)(void *on, struct coulomb *s);
    int (*carry)(void *on, struct carry *s);
    int (*retain)(void *on, struct retain *s);

    /* Run ref_motion and motion_energy on one cloth. */
    int (*motion)(void *on, struct sheet *s);
    /* Runs a part of it, as ref_motion_part does: enum motion_part. */
    int (*motion_part)(void *on, struct sheet *s, int part);
    void (*energy)(void *on, struct sheet *s, const vec *x, const vec *v,
                   double value[3]);
    /* Do what joint_X does (ref/solve/joint.h); joint: joint_solve. */
    int (*joint_set_up)(struct world *w, struct joint *s);
    int (*joint_measure)(struct world *w, struct joint *s, const vec *r,
                         real *value);
    int (*joint)(struct world *w, struct joint *s);
    /* Do what the functions of these names in ref/broad/broad.h do. */
    int (*broad_meshes_apart)(void *on, struct broad *b, const vec *x0,
                              const vec *x1, real r, bool *apart);
    int (*broad_query)(void *on, struct broad *b, const vec *x0, const vec *x1,
                       real r, const uint8_t *moved);

    void (*start)(void *on, struct response *s);
    void (*advance)(void *on, struct response *s, int64_t n,
                    const int32_t *vertex, const uint8_t *moved, bool stop);
    void (*touch)(void *on, const struct response *s);
    void (*cap_targets)(void *on, const struct response *s,
                        struct contact *contact);

    /* Do what unknowns_X does (ref/contact/unknowns.h); slice_room:
     * unknowns_room. */
    int (*slice_room)(struct world *w, int64_t n);
    void (*shift)(void *on, const struct shift *s);
    void (*jump)(void *on, const struct jumps *s);
    /* r -= part·q, n items. */
    void (*lessen)(void *on, int64_t n, real part, const vec *q, vec *r);

    void (*pin)(void *on, int64_t n, const int32_t *pinned, const vec *x,
                vec *to);
    /* The loops of ref/base/prescribed.h. */
    void (*blend)(void *on, const struct blend *s);
    void (*keep)(void *on, int64_t n, const uint8_t *fixed, const vec *old,
                 vec *a);
    bool (*sane)(void *on, int64_t n, const vec *a);
    /* Copies to host memory; it is there on return. */
    void (*fetch)(void *on, void *host, const void *from, size_t bytes);
    /* Brings the laws and triples of a cloth, which have changed, to where the
     * backend's stages read them. */
    void (*laws)(void *on, struct sheet *s);
    bool (*moves)(const struct world *w);
    /* Whether n vertices, or those that `at` names, have other bits in x0 than
     * the n of x1. */
    bool (*differs)(void *on, int64_t n, const int32_t *at, const vec *x0,
                    const vec *x1);
    /* The loops of ref/sleep/wake.h. */
    void (*wake_find)(void *on, struct wake *s);
    void (*wake_mask)(void *on, int64_t n, const uint16_t *body,
                      const uint8_t *awake, uint8_t *mask);
    void (*wake_displacements)(void *on, int64_t n, const uint16_t *body,
                               const vec *x0, const vec *x1, int bodies,
                               real *most);
    void (*velocities)(void *on, int64_t n, const vec *x0, const vec *x1,
                       real dt, vec *v);
    real (*furthest)(void *on, int64_t n, const vec *x0, const vec *x1);
    /* Takes the streams of the ending's audit that this backend alone needs,
     * and fills the groups of its nt triangles, of which the first `cloths`
     * belong to cloth. DRAPE_OK or DRAPE_ENOMEM. */
    int (*ending_streams)(void *on, struct audit *s, int64_t nt,
                          int64_t cloths);
};

/* ref/world/backend.c */
extern const struct backend backend_ref;

#endif
