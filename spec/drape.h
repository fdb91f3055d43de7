/* SPDX-License-Identifier: Apache-2.0 */
/* drape: certified high-resolution cloth simulation (Tang et al. 2013).
 * The whole public API. Units are SI; the up direction is the caller's.
 * No function exits, prints, keeps global state or starts a thread that was
 * not asked for. Calls on one world must not overlap; worlds are independent.
 * Positions are [3] = x, y, z in metres, |x| ≤ 2^60.
 * One fault has one status, whichever function meets it. A pointer that is NULL
 * without being allowed to, a count, an index or an enumerator out of its range
 * and half an allocator are DRAPE_EARG. A number is DRAPE_EDATA if it is not
 * finite or, but for drape_ccd, beyond 2^60; else, out of its range, it is
 * DRAPE_EARG. Arrays must be as long as their counts say. After an error all is
 * as it was before the call, and outputs may hold anything. */
#ifndef DRAPE_H
#define DRAPE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define DRAPE_VERSION "0.1.0"

/* Status of a call: DRAPE_OK or negative. */
enum drape_status {
    DRAPE_OK = 0,
    DRAPE_EARG = -1,    /* an argument is NULL or out of its range */
    DRAPE_EDATA = -2,   /* a number is not finite or beyond 2^60 */
    DRAPE_ENOMEM = -3,  /* the allocator gave nothing */
    DRAPE_EFULL = -4,   /* an output is too small; the needed size is given */
    DRAPE_ESTART = -5,  /* the start state intersects itself or an obstacle; so
                           do triangles without area that touch another */
    DRAPE_EDEVICE = -6, /* no such backend here, or its device is lost */
    DRAPE_EMATCH = -7,  /* a checkpoint of another scene, build or version */
    DRAPE_EIO = -8,     /* the caller's reader or writer failed */
    DRAPE_ELIMIT = -9   /* the scene forbids it, as a limit it set itself */
};

/* How a step ended: 0 is clean, else an or of these. */
enum drape_outcome {
    DRAPE_UNCONVERGED = 1, /* the linear solver missed its tolerance */
    DRAPE_ZONES = 2,       /* impact zones were needed; the state is clean */
    DRAPE_ROLLBACK = 4,    /* vertices were rolled back; the state is clean */
    DRAPE_TRAPPED = 8,     /* the state that the step ends in intersects: what
                              is led left no room, or it did from the start.
                              Every step says so until none is left */
    DRAPE_DIVERGED = 16,   /* energy blew up or a value is not finite: the
                              last good state is kept and time stands still */
    DRAPE_ASLEEP = 32,     /* nothing moved, nothing was done */
    DRAPE_PASSED = 64      /* something went through something that is led, or
                              that it had intersected before; the state is clean */
};

enum drape_integrator {
    DRAPE_EULER,    /* symplectic Euler, explicit, order 1 */
    DRAPE_MIDPOINT, /* explicit midpoint, order 2 */
    DRAPE_VERLET,   /* velocity Verlet, explicit, order 2 */
    DRAPE_RK4,      /* classical Runge–Kutta, explicit, order 4 */
    DRAPE_BW,       /* Baraff–Witkin 1998, implicit, order 1 */
    DRAPE_CK        /* Choi–Ko 2002, semi-implicit BDF2, order 2 */
};

enum drape_precond { DRAPE_JACOBI, DRAPE_MULTIGRID };
enum drape_matrix {
    DRAPE_CDF,    /* the paper's 17 diagonals of 3 × 3 blocks */
    DRAPE_COMPACT /* the symmetric half, blocks of 6 */
};
enum drape_solver {
    DRAPE_EXACT, /* the same bits everywhere */
    DRAPE_CUBLAS /* the paper's: cuBLAS adds in an order of its own */
};
enum drape_backend { DRAPE_REF, DRAPE_GPU };

/* What resists bending. spec/cloth/cloth.md §4, §7 */
enum drape_bending {
    DRAPE_TRIPLES, /* second differences: `bend` at any size of cells */
    DRAPE_SPRINGS  /* the paper's springs between every second particle */
};

/* What cloth is made of, independent of the grid that samples it. */
typedef struct drape_material {
    double density;   /* kg/m², > 0 */
    double stretch;   /* N/m, tension a width for strain 1, > 0 */
    double shear;     /* N/m, ≥ 0, at most stretch / 2 */
    double bend;      /* N·m, moment a width for curvature 1, ≥ 0 */
    double damping;   /* s, stiffness-proportional, 0 … 1e6 */
    double thickness; /* m, distance at which contact begins, > 0; at most
                         half the smaller side of a cell counts */
    double friction;  /* Coulomb coefficient, 0 … 1e6; a pair takes the larger
                         of its two */
    double limit[3];  /* of strain, 0.01 … 10 each, 0: none: along u, along v,
                         and of the shear angle, radians; a diagonal has the
                         strain of that angle, half of it on square cells */
} drape_material;

/* A rigid motion by keyframes: x(t) = p(t) + R(q(t)) (x(0) - pivot). Linear
 * in p, normalised linear in q between keys, constant before and after. */
typedef struct drape_motion {
    int keys;                    /* 1 … 2^24 */
    const double *time;          /* [keys] s, strictly ascending */
    const double (*position)[3]; /* [keys] p, m */
    const double (*rotation)[4]; /* [keys] q = w, x, y, z, unit to 1e-6; NULL:
                                    identity */
    double pivot[3];             /* m */
} drape_motion;

/* Particle (i, j) of a cloth is held, or led by a motion. */
typedef struct drape_pin {
    int i, j;
    int motion; /* index into drape_def.motions, -1: held where it starts */
} drape_pin;

/* A rectangular grid of m × n particles; (i, j) is number i + m·j. */
typedef struct drape_cloth {
    int m, n;             /* 2 … 32768 each */
    double width, height; /* m at rest, along i and along j; the longer side of
                             a cell is below √(stretch / shear) of the other */
    drape_material material;
    const double (*x)[3]; /* [m·n] start; NULL: flat by origin, u and v */
    double origin[3], u[3], v[3]; /* particle 0, m; axes along i and j, unit and
                                     at right angles to 1e-6 */
    const double (*velocity)[3];  /* [m·n] m/s; NULL: zero */
    const uint8_t *hole;   /* [m·n] 1: the particle is missing; NULL: none */
    const uint8_t *cut;    /* [(m-1)·(n-1)] 1: the cell is missing; NULL; at
                              least one cell is left */
    const drape_pin *pins; /* [n_pins] of particles with a cell */
    int n_pins;            /* 0 … m·n */
    int bending;           /* enum drape_bending */
} drape_cloth;

/* A triangle mesh that moves as told; open, closed or non-manifold. */
typedef struct drape_obstacle {
    int64_t n_vertices, n_triangles;
    const double (*x)[3];     /* [n_vertices] m, at time 0 */
    const int32_t (*tri)[3];  /* [n_triangles] vertices of this obstacle */
    double friction;          /* as a material's */
    int motion;               /* index into drape_def.motions, -1: none */
    int frames;               /* deforming: number of frames, to 2^24, and no
                                 motion; else 0 */
    double frame_dt;          /* s between frames, linear in between */
    const double (*frame)[3]; /* [frames][n_vertices] m */
} drape_obstacle;

typedef struct drape_wind {
    double velocity[3]; /* m/s */
    double density;     /* kg/m³ of air; 0: no air at all */
    double drag, lift;  /* coefficients of a triangle, 0 … 1e6 */
} drape_wind;

/* Called within calls on the worlds that have it, and nowhere else. Memory of
 * the host is aligned to 64, of a device to 256. */
typedef struct drape_allocator {
    void *(*allocate)(void *user, size_t bytes); /* NULL: there is none */
    void (*release)(void *user, void *p, size_t bytes);
    void *user;
} drape_allocator;

/* Called after each stage of a step, where asked for. digest: 64 bits of the
 * stage's main output, in stream order; seconds: since the stage before. */
typedef void drape_trace(void *user, int64_t step, const char *stage,
                         uint64_t digest, double seconds);

/* Called within calls on a world with a line for people, which lasts as long
 * as the call: what was made, what failed and why, where memory grew. */
typedef void drape_log(void *user, const char *line);

/* A scene. Everything it points to is copied by drape_create. */
typedef struct drape_def {
    int backend;   /* enum drape_backend */
    int precision; /* 32 or 64: bits of a number in the state */
    int threads;   /* of the reference, to 4096; 0: as many as processors.
                      They live within a call and sleep while they wait. More
                      than 8 and twice the processors, or than can be had, are
                      not started. Same bits. */
    int block;     /* threads of a block of the device, a multiple of 32 up
                      to 256; 0: 256. Same bits. */

    double dt;         /* s a step, 1e-9 … 1e3 */
    double gravity[3]; /* m/s² */
    drape_wind wind;
    int integrator;     /* enum drape_integrator */
    int max_substeps;   /* explicit: refuse (DRAPE_ELIMIT) beyond, ≥ 1 */
    int precond;        /* enum drape_precond */
    int matrix;         /* enum drape_matrix */
    int solver;         /* enum drape_solver; DRAPE_CUBLAS: backend gpu only */
    double tolerance;   /* of the relative residual, 1e-15 … 1 */
    int max_iterations; /* of one solve, ≥ 1 */

    int self_collision;     /* 0: cloth does not see cloth */
    int max_rounds;         /* of collision impulses before the fail-safe, 0 …
                               10000 */
    int max_slices;         /* into which a step is cut where things move far or
                               it goes wrong: a power of two, 1 (never) … 64 */
    int allow_intersecting; /* 1: a start that intersects is accepted */
    int sleep;              /* 1: a scene at rest is skipped until it wakes */

    const drape_cloth *cloths;
    int n_cloths; /* 1 … 4096 */
    const drape_obstacle *obstacles;
    int n_obstacles; /* 0 … 4096 */
    const drape_motion *motions;
    int n_motions; /* 0 … 2^20; vertices, triangles of all: < 2^28 */

    drape_allocator allocator;        /* zero: malloc and free */
    drape_allocator device_allocator; /* zero: cudaMalloc and cudaFree */
    void *stream;   /* of backend gpu: a cudaStream_t that outlives the world;
                       NULL: one of its own. The device is that current in
                       drape_create, and must be in all calls on the world. */
    drape_log *log; /* NULL: none */
    void *log_user;
    drape_trace *trace; /* NULL: none, and no digest is computed */
    void *trace_user;
} drape_def;

/* What went wrong, in one line: what, where, and what was expected. */
typedef struct drape_error {
    char text[256];
} drape_error;

/* Stages whose time and work a step reports. */
enum drape_part {
    DRAPE_PART_INTEGRATION,
    DRAPE_PART_SOLVER,
    DRAPE_PART_BROAD,
    DRAPE_PART_PROXIMITY,
    DRAPE_PART_PENETRATION,
    DRAPE_PART_COUNT
};

/* What a step did of what it might have had to do: of all its slices, those
 * that were taken again too. All 0 in a step asleep. Both backends count the
 * same. spec/world/step.md §10 */
typedef struct drape_work {
    int tries;          /* slices begun; slices of the report were kept */
    int solves;         /* linear systems, a cloth's own and with contacts */
    int queries;        /* of the broad phase */
    int narrow;         /* narrow phases; rounds without a candidate had none */
    int64_t boxes;      /* of the tree, refitted by the queries */
    int64_t boxes_kept; /* not refitted: of obstacles that never move, or all
                           where whole meshes are apart */
    int64_t walked;     /* pairs of boxes looked into */
    int64_t cleared;    /* pairs of boxes that meet, not looked into as cones
                           prove their cloth apart */
    int64_t near;       /* pairs given to proximity */
    int64_t later;      /* of candidates, those of rounds after the first: of
                           what had moved since */
} drape_work;

typedef struct drape_step_report {
    int64_t step;       /* steps done so far, this one included */
    double time;        /* s, at the end of the step */
    int outcome;        /* or of enum drape_outcome */
    int slices;         /* that the step was cut into */
    int substeps;       /* of the integrator, of a slice the most */
    int iterations;     /* of the linear solver, all solves */
    double residual;    /* relative, the worst of its solves */
    int rounds;         /* of penetration, the last finds nothing; 0 where
                           nothing was near anything */
    int64_t contacts;   /* pairs in proximity, of the last slice */
    int64_t impacts;    /* pairs that penetrated, all rounds */
    int64_t candidates; /* pairs given to the narrow phase, all rounds; this,
                           iterations and rounds with slices taken again */
    int64_t zone_vertices, rolled_back; /* touched by the fail-safe */
    int64_t intersecting; /* pairs of triangles that do at the end of the step,
                             as drape_audit counts them; 0 unless TRAPPED */
    double kinetic, elastic, potential; /* J; potential: gravity, from 0 */
    double seconds[DRAPE_PART_COUNT];   /* wall time by part */
    drape_work work;
} drape_step_report;

/* One row of the plan: a stage, whether it exists in this scene, and why. */
typedef struct drape_plan_row {
    const char *stage; /* static */
    int on;
    const char *why; /* static */
    size_t bytes;    /* held now for its streams */
} drape_plan_row;

typedef struct drape_world drape_world;

/* Defaults: the reference on one thread, 32 bits, dt 1/60, gravity -9.81 y, no
 * air (drag 1 and lift 0.3 once it has a density), Baraff–Witkin, multigrid
 * and the symmetric half to 1e-3 within 2000 iterations, at most 100000
 * substeps, self-collision, 16 rounds, 32 slices, sleep. Never fails; NULL,
 * here and in the next two, is left alone. */
void drape_default(drape_def *def);
/* Defaults: 101 × 101, 1 m × 1 m, flat in the xz plane, and light cotton:
 * density 0.2, stretch 1000, shear 300, bend 1e-5, damping 1e-3, thickness
 * 0.002, friction 0.3, bending by triples. */
void drape_default_cloth(drape_cloth *cloth);
/* Defaults: friction 0.3, no motion. */
void drape_default_obstacle(drape_obstacle *obstacle);

/* Checks the whole definition and makes a world, at time 0. On failure *world
 * is NULL and error (may be NULL) says what and where: DRAPE_EARG (also where
 * def or world is NULL), EDATA, ENOMEM, ESTART, EDEVICE, ELIMIT. The caller
 * destroys it. */
int drape_create(const drape_def *def, drape_world **world, drape_error *error);
void drape_destroy(drape_world *world); /* NULL is allowed */

/* Advances by dt. report may be NULL. Negative, as DRAPE_ENOMEM after which the
 * next call may do, DRAPE_EDEVICE, or DRAPE_EARG without a world: nothing has
 * changed. */
int drape_step(drape_world *world, drape_step_report *report);

/* Counts of the whole scene: cloth first, then obstacles. DRAPE_EARG without a
 * world. */
int64_t drape_vertices(const drape_world *world);
int64_t drape_triangles(const drape_world *world);
/* The first vertex (triangle) of cloth or obstacle k counts on from the
 * cloths: body k in 0 … n_cloths + n_obstacles, the last is the total; else
 * DRAPE_EARG. */
int64_t drape_first_vertex(const drape_world *world, int body);
int64_t drape_first_triangle(const drape_world *world, int body);
/* Copies of the current state: x, v [drape_vertices][3], v in m/s. Either
 * may be NULL. DRAPE_EARG without a world, DRAPE_EDEVICE where a device was
 * lost. */
int drape_read(const drape_world *world, double (*x)[3], double (*v)[3]);
/* Copies of the connectivity: tri [drape_triangles][3]. DRAPE_EARG without a
 * world or tri. */
int drape_read_triangles(const drape_world *world, int32_t (*tri)[3]);

/* Where the current state lies, to be read without a copy. It is the world's,
 * and valid until the next drape_step, drape_load or drape_destroy. On a
 * device it is complete in the order of `stream`: what the caller puts there
 * comes after it and before the next step; other streams wait by an event. */
typedef struct drape_view {
    const void *x, *v;       /* [vertices][3] m, m/s: float or double */
    const int32_t (*tri)[3]; /* [triangles] */
    int64_t vertices, triangles;
    int precision; /* 32: float, 64: double */
    int device;    /* CUDA's number of it; -1: memory of the host */
    void *stream;  /* cudaStream_t; NULL: of the reference */
} drape_view;
/* The first call on a device takes the triangles' memory there if nothing can
 * collide. DRAPE_OK, DRAPE_EARG without a world or view, DRAPE_ENOMEM,
 * DRAPE_EDEVICE. */
int drape_borrow(drape_world *world, drape_view *view);

/* Wakes a sleeping scene; NULL is allowed. */
void drape_wake(drape_world *world);
/* From the next step on; wakes. wind is copied. A world made without air stays
 * so: DRAPE_EARG; give it a density, drag or lift from the start. Ranges and
 * their statuses are those of a definition. */
int drape_set_wind(drape_world *world, const drape_wind *wind);

/* Rows of the plan into row[capacity]; returns how many there are. row may be
 * NULL if capacity is 0. DRAPE_EARG without a world, row or room below 0. */
int drape_plan(const drape_world *world, drape_plan_row *row, int capacity);

/* A world's streams and records, without what CUDA keeps for itself. Where a
 * scene has settled, a step allocates nothing. */
typedef struct drape_memory {
    size_t host_bytes, device_bytes; /* held now */
    size_t borrowed_bytes; /* of device_bytes, the solver's that contact uses
                              between solves */
    int64_t host_allocations, device_allocations; /* since drape_create */
} drape_memory;
/* DRAPE_OK, or DRAPE_EARG without a world or memory. */
int drape_count(const drape_world *world, drape_memory *memory);

/* A checkpoint through the caller's functions, which return 0 when all
 * bytes went through. A loaded world goes on bit for bit; it must have been
 * made from the same definition, but backend, threads, block, stream,
 * allocators, log and trace may be others. user may be NULL. DRAPE_EARG without
 * a world or a function, DRAPE_EIO, EMATCH, EDATA (a number that no step
 * gives), ENOMEM, EDEVICE: the world is unchanged. */
typedef int drape_write(void *user, const void *data, size_t bytes);
typedef int drape_read_bytes(void *user, void *data, size_t bytes);
int drape_save(const drape_world *world, drape_write *write, void *user);
int drape_load(drape_world *world, drape_read_bytes *read, void *user);

typedef struct drape_mesh {
    int64_t nv, nt;            /* vertices, triangles */
    const double (*x)[3];      /* [nv] m */
    const int32_t (*tri)[3];   /* [nt] vertices */
    const int32_t *group;      /* [nt], 0: an obstacle; NULL: none is */
    int threads;               /* to 4096; 0: as many as cores. Same bits. */
    drape_allocator allocator; /* zero: malloc and free */
} drape_mesh;
/* Intersecting pairs of triangles, decided exactly (spec/narrow/audit.md); two
 * obstacles' are not compared. The first `capacity` go to pair; *found counts
 * all, *degenerate (or NULL) triangles without area, which are in none, though
 * drape_create looks at them too.
 * DRAPE_OK also when more were found than fit, and pair may be NULL if capacity
 * is 0; DRAPE_EARG (NULL, a count, an index), EDATA, ENOMEM. */
int drape_audit(const drape_mesh *mesh, int64_t capacity, int32_t (*pair)[2],
                int64_t *found, int64_t *degenerate);

/* Whether a vertex x[0] and a face x[1..3] (kind 0), or two edges x[0]x[1]
 * and x[2]x[3] (kind 1), moving linearly from x0 to x1, touch in [0, 1]:
 * 1 and *toi (never late, at most 2^-30 early), 0, or DRAPE_EDATA where a
 * coordinate is not finite, DRAPE_EARG for another kind or a NULL. */
int drape_ccd(int kind, const double x0[4][3], const double x1[4][3],
              double *toi);

/* Called for each pair of primitives that touch: v f0 f1 f2 (kind 0) or
 * a0 a1 b0 b1 (kind 1), and when, as above. Other than 0 ends the query. */
typedef int drape_touch(void *user, int kind, const int32_t v[4], double toi);
/* Every vertex and face, and every two edges, of the mesh's triangles that
 * share no vertex and touch in [0, 1], as it moves linearly from x to x1
 * [nv]: each once, faces before edges, in the same order on every run.
 * group must be NULL. candidates, or NULL: pairs of each kind that were
 * decided exactly. DRAPE_EIO where touch ended it; DRAPE_EARG (NULL, a count,
 * an index), EDATA, ENOMEM. */
int drape_ccd_frames(const drape_mesh *mesh, const double (*x1)[3],
                     drape_touch *touch, void *user, int64_t candidates[2]);

/* One line a version: library, precisions, backends, certificate. */
const char *drape_info(void);
/* A few words for any number, also for one that is no status. */
const char *drape_status_text(int status);

#ifdef __cplusplus
}
#endif
#endif
