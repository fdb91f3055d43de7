/* SPDX-License-Identifier: Apache-2.0 */
/* What accuracy costs, where each method breaks, what is skipped: the parts
 * of build/accuracy. Each writes csv; what must hold is counted as a check.
 * spec/accuracy.md */
#ifndef BENCH_ACCURACY_H
#define BENCH_ACCURACY_H

#include <drape.h>
#include <stdbool.h>
#include <stdio.h>

struct bench {
    const char *program;   /* this one's path */
    const char *directory; /* of the csv files */
    int backend;           /* enum drape_backend */
    bool wall;             /* time of the reference is wall time too */
    bool quick;            /* a small form, for make check */
    bool mute;             /* no report is asked for: runs keep no counts */
    int passed, failed;
};

/* Opens DIRECTORY/name.csv and writes its first line; ends the program where
 * it cannot. */
FILE *bench_csv(const struct bench *b, const char *name, const char *header);
/* Counts a check and prints it where it fails. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
void bench_check(struct bench *b, bool good, const char *format, ...);
/* Memory, zeroed, or the end of the program. */
void *bench_take(size_t count, size_t size);

extern const char *const integrator_name[DRAPE_BDF2 + 1];
extern const char *const precond_name[2];
extern const char *const backend_name[2];

/* What a run of a scene came to. */
struct run {
    int status;         /* of drape_create or the step that failed */
    int outcome;        /* of all steps, or */
    int64_t steps;      /* that ended well */
    int64_t iterations; /* of the solver, all steps */
    int substeps;       /* the most of a step */
    double residual;    /* the worst */
    double seconds;     /* of drape_step: processor's for ref, else wall */
    double energy, own; /* J at the end: all; kinetic and elastic */
    double rise;        /* J, the largest gain of energy in a step */
    int64_t contacts, candidates, impacts;
    size_t bytes; /* held by the library, at most */
    bool finite;  /* the last state is */
    int64_t n;    /* vertices */
    double (*x)[3], (*v)[3];
    char text[256]; /* why it was refused */
};

/* Looks at a world after a step; false ends the run. */
typedef bool run_watch(void *user, drape_world *world,
                       const drape_step_report *report);

/* Runs def on the bench's backend for `steps` steps, on one thread, until one
 * fails or diverges. A state that is not finite and not reported so is a
 * failed check. */
void run_scene(struct bench *b, const drape_def *def, int64_t steps,
               struct run *r);
void run_watched(struct bench *b, const drape_def *def, int64_t steps,
                 run_watch *watch, void *user, struct run *r);
void run_free(struct run *r);
/* clean, refused, diverged …: how a run ended, in a word. */
const char *run_word(const struct run *r);
/* Root of the mean squared distance of the first n positions, m. */
double run_distance(const struct run *a, const struct run *b, int64_t n);
/* Processor seconds of the process; wall time for a device or if asked. */
double bench_clock(const struct bench *b);
/* Pairs of triangles that intersect in the world as it is, by the audit. */
int64_t world_pairs(const drape_world *world, int n_cloths);

enum sample_kind {
    SAMPLE_STRETCHED, /* pinned all around, all springs long: smooth */
    SAMPLE_HANGING,   /* held by its upper edge, released 2 % long */
    SAMPLE_FLAG,      /* held by one edge, in wind */
    SAMPLE_FALLING,   /* held by two corners, released flat */
    SAMPLE_SWINGING,  /* hangs by one edge, released at 0.3 rad */
    SAMPLES
};
extern const char *const sample_name[SAMPLES];

struct sample {
    drape_def def; /* of cloth alone; points into this struct */
    drape_cloth cloth;
    drape_pin *pin;
    double (*x)[3], (*v)[3];
};
/* side × side particles of 1 m × 1 m. */
void sample_make(struct sample *s, enum sample_kind kind, int side);
void sample_free(struct sample *s);

/* A flat sheet of side × side particles, `size` m wide, its middle at x = z =
 * 0 and at the given height, for scenes with contact. */
void cloth_flat(drape_cloth *c, int side, double size, double height);

/* An obstacle with memory of its own. */
struct solid {
    drape_obstacle body;
    double (*x)[3];
    int32_t (*tri)[3];
};
void solid_ball(struct solid *s, double radius, const double at[3], int detail);
/* A square about the origin, turned by `slope` radians about z. */
void solid_plane(struct solid *s, double size, double slope);
void solid_free(struct solid *s);

/* The converged run of a sample: Runge-Kutta in binary64. Returns how far, in
 * m, it is from itself at twice the step. */
double run_converged(struct bench *b, struct sample *s, double time, int steps,
                     struct run *to);

void part_work(struct bench *b);
void part_orders(struct bench *b);
void part_newton(struct bench *b);
void part_stability(struct bench *b);
void part_stress(struct bench *b);
void part_contact(struct bench *b);
void part_drift(struct bench *b);
void part_skip(struct bench *b);
void part_stages(struct bench *b);
void part_lion(struct bench *b);
void part_backends(struct bench *b); /* where a device is */

#endif
