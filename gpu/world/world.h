/* SPDX-License-Identifier: Apache-2.0 */
/* A world on the device: the streams of ref/world/state.h there, and who steps
 * them. Names and meanings are those of struct world. spec/gpu.md §6 */
#ifndef GPU_WORLD_H
#define GPU_WORLD_H

#include "gpu/cloth/rate.h"
#include "ref/world/state.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One cloth. The structs are the host's, their streams the device's. */
struct gpu_sheet {
    int64_t first;
    struct cloth cloth;
    struct law *law;          /* device [SPRINGS] */
    struct dynamics dynamics; /* cloth is the one above; solve is not used */
    struct pcg pcg;
    struct rate *rate;     /* device, or NULL: a solve has no use for it */
    vec *star, *b;         /* device [count], within the world's */
    double solver_seconds; /* out: of the last solve */
    struct kinematics pins;
    int32_t *pinned; /* device [pins.n] particle of each pin */
};

/* One obstacle. */
struct gpu_prop {
    struct kinematics place; /* rest: of the start, or set to a frame */
    double *frame;           /* device, or NULL */
};

struct gpu_world {
    struct world *host; /* made by ref/world/world.c; never stepped itself */
    struct gpu *gpu;
    vec *x0, *v0, *x1, *v1;   /* device [nv] */
    vec *free_x, *free_v;     /* device [nc] or NULL */
    vec *past_x, *past_v;     /* device [nc] or NULL */
    vec *press;               /* likewise */
    vec *to;                  /* device [nc], or NULL: it is not read */
    vec *star, *b;            /* device [nc] of implicit motion, then couple's
                                 g and, [nv] if anything collides, force */
    real *w;                  /* device [nv] */
    uint16_t *body;           /* device [nv] */
    const int32_t (*tri)[3];  /* device [nt], the tree's if anything collides;
                                 NULL: nobody has borrowed it */
    struct surface *surface;  /* device [bodies] */
    struct pose *pose;        /* device [n_motions] */
    struct gpu_prop *prop;    /* [n_obstacles] */
    struct gpu_sheet *sheet;  /* [n_cloths] */
    struct broad broad;       /* arena is NULL: memory is gpu_take's */
    struct response response; /* grow is not used: gpu_take likewise */
    struct couple couple;
    struct start start;   /* device, but for watch */
    struct audit ending;  /* of gpu_ending_count; NULL until it is needed */
    int32_t *group;       /* device [nt] likewise: 1 for a cloth's triangle */
    double broad_seconds; /* not charged yet */
};

/* gpu/world/pipeline.cu: step_advance on the device. */
int gpu_step(struct world *w, drape_step_report *report);

/* The response's broad; user is the gpu_world. */
int gpu_step_broad(void *user, const uint8_t *touched, struct pairs *out);

/* gpu/world/lead.cu: ref/world/lead.h on the device. */
int gpu_lead(struct gpu_world *w, double t, vec *x);
bool gpu_lead_moves(struct gpu_world *w);
void gpu_lead_velocities(struct gpu_world *w);

/* As trace_stage, of a stream on the device; waits only where t asks. */
void gpu_trace(struct gpu *g, struct trace *t, const char *stage,
               const void *out, size_t bytes);

/* gpu/cloth/motion.cu: ref_dynamics and dynamics_energy on the device. */
int gpu_motion(struct gpu *g, struct gpu_sheet *s);
void gpu_motion_energy(struct gpu *g, struct gpu_sheet *s, const vec *x,
                       const vec *v, double value[3]);

/* gpu/broad/broad.cu: broad_make's result copied from the host's; broad_ask
 * and broad_query. */
int gpu_broad_make(struct gpu *g, const struct broad *host, struct broad *b);
int gpu_broad_ask(struct gpu *g, struct broad *b, const vec *x0, const vec *x1,
                  real r, bool *apart);
int gpu_broad_query(struct gpu *g, struct broad *b, const vec *x0,
                    const vec *x1, real r, const uint8_t *moved);

/* gpu/contact/response.cu, gpu/contact/failsafe.cu: ref/contact/response.h on
 * the device. broad and solve are called as there; pairs and contacts are on
 * the device. */
int gpu_response_start(struct gpu *g, struct response *s);
int gpu_response_repel(struct gpu *g, struct response *s,
                       const struct pairs *near);
int gpu_response_penetrate(struct gpu *g, struct response *s);

/* gpu/world/ending.cu: ending_count on the device. */
int gpu_ending_count(struct gpu_world *w, int64_t *found);

/* gpu/contact/couple.cu: ref/contact/couple.h on the device; user is the
 * gpu_world. */
int gpu_couple_make(struct gpu_world *w);
void gpu_couple_start(struct gpu_world *w);
int gpu_couple_solve(void *user, int64_t n, struct contact *contact);

#ifdef __cplusplus
}
#endif
#endif
