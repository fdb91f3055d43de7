/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of build/accuracy measure what accuracy costs, where each method
 * breaks, and what unused features cost. Each part writes csv files; results
 * that must hold are counted as checks. spec/accuracy.md */
#ifndef BENCH_ACCURACY_H
#define BENCH_ACCURACY_H

#include <drape.h>
#include <stdbool.h>
#include <stdio.h>

struct bench {
    const char *program;   /* path of this program */
    const char *directory; /* where the csv files go */
    int backend;           /* enum drape_backend */
    bool wall;             /* measure wall time for the reference too */
    bool quick;            /* run a small form, for make check */
    bool mute;             /* runs ask for no reports, and so keep no counts */
    int passed, failed;
};

/* Opens DIRECTORY/name.csv and writes its first line. Ends the program if that
 * fails. */
FILE *bench_csv(const struct bench *b, const char *name, const char *header);
/* Counts a check, and prints it if it failed. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
void bench_check(struct bench *b, bool good, const char *format, ...);
/* Returns zeroed memory. Ends the program if there is none. */
void *bench_take(size_t count, size_t size);

extern const char *const integrator_name[DRAPE_BDF2 + 1];
extern const char *const precond_name[2];
extern const char *const backend_name[2];

/* The result of a run of a scene. */
struct run {
    int status;         /* of drape_create, or of the step that failed */
    int outcome;        /* bitwise or of the outcomes of all steps */
    int64_t steps;      /* steps done */
    int64_t iterations; /* of the solver, all steps together */
    int substeps;       /* the largest number in a step */
    double residual;    /* the largest */
    double seconds;     /* in drape_step: processor time of the reference, or
                           wall time */
    double energy, own; /* J at the end: with gravity's; kinetic and elastic */
    double rise;        /* J, the largest gain of energy in a step */
    int64_t contacts, candidates, impacts; /* largest of a step; sums of all */
    size_t bytes;                          /* the most that the library held */
    bool finite;             /* all numbers of the last state are finite */
    int64_t n;               /* vertices */
    double (*x)[3], (*v)[3]; /* [n] m, m/s, the last state */
    char text[256];          /* why the scene was refused */
};

/* Called after each step. Returns false to end the run. */
typedef bool run_watch(void *user, drape_world *world,
                       const drape_step_report *report);

/* Run def on the bench's backend for `steps` steps, or until a step fails or
 * diverges. A last state that is not finite is a failed check. The caller calls
 * run_free. */
void run_scene(struct bench *b, const drape_def *def, int64_t steps,
               struct run *r);
void run_watched(struct bench *b, const drape_def *def, int64_t steps,
                 run_watch *watch, void *user, struct run *r);
void run_free(struct run *r);
/* Returns a word for how a run ended: stable, refused, diverged, …. */
const char *run_word(const struct run *r);
/* Returns the root of the mean squared distance of the first n positions, m. */
double run_distance(const struct run *a, const struct run *b, int64_t n);
/* Returns the processor time of the process, s; wall time if the backend is a
 * device or if b->wall is set. */
double bench_clock(const struct bench *b);
/* Returns the number of intersecting pairs of triangles in the current state,
 * by drape_audit; -1 if the audit failed. */
int64_t world_pairs(const drape_world *world, int n_cloths);

enum sample_kind {
    SAMPLE_STRETCHED, /* the border is pinned, all springs are in tension */
    SAMPLE_HANGING,   /* held by its upper edge, released 2 % too long */
    SAMPLE_FLAG,      /* held by one edge, in wind */
    SAMPLE_FALLING,   /* held by two corners, released flat */
    SAMPLE_SWINGING,  /* hangs by one edge, released at 0.3 rad */
    SAMPLES
};
extern const char *const sample_name[SAMPLES];

struct sample {
    drape_def def; /* one cloth and no obstacle; points into this struct */
    drape_cloth cloth;
    drape_pin *pin;
    double (*x)[3], (*v)[3];
};
/* Makes a sample: a sheet of 1 m × 1 m with side × side particles. */
void sample_make(struct sample *s, enum sample_kind kind, int side);
void sample_free(struct sample *s);

/* Makes a flat sheet of side × side particles, `size` m wide, with its middle
 * at x = z = 0 and at the given height, for scenes with contact. */
void cloth_flat(drape_cloth *c, int side, double size, double height);

/* An obstacle, with the memory of its mesh. */
struct solid {
    drape_obstacle body;
    double (*x)[3];
    int32_t (*tri)[3];
};
void solid_ball(struct solid *s, double radius, const double at[3], int detail);
/* Makes a square around the origin that falls along x with `slope` radians. */
void solid_plane(struct solid *s, double size, double slope);
void solid_free(struct solid *s);

/* Runs a sample by RK4 in binary64, as the converged run of spec/accuracy.md
 * §1. Returns the distance, m, from the run with twice the step. */
double run_converged(struct bench *b, struct sample *s, double time, int steps,
                     struct run *to);

void part_work(struct bench *b);
void part_orders(struct bench *b);
void part_newton(struct bench *b);
void part_stability(struct bench *b);
void part_stress(struct bench *b);
void part_contact(struct bench *b);
void part_drift(struct bench *b);
/* Part skip: what unused features cost, and programs and scenes without them.
 */
void skip_table(struct bench *b);
void skip_never(struct bench *b);
void skip_sleep(struct bench *b);
void part_stages(struct bench *b);
void part_backends(struct bench *b); /* only if the backend is a device */
/* Runs the bare scene and prints seconds a step, bytes and hash, for
 * skip_never. */
void part_bare(struct bench *b);

#endif
