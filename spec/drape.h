/* SPDX-License-Identifier: Apache-2.0 */
/* drape: certified high-resolution cloth simulation (Tang et al. 2013).
 * This header is the whole public API. The pages that it names are in spec/.
 *
 * Use. Fill a drape_def, starting from drape_default; drape_create makes a
 * world of it; drape_step advances the world; drape_destroy releases it.
 *
 * Conventions. Units are SI. A position is [3] = x, y, z in metres, |x| ≤ 2^60;
 * which axis points up is the caller's choice. A field's comment gives its
 * meaning, [the shape] of an array, its unit, and its range; a field without a
 * range takes any number up to 2^60 in size. No function exits, prints, keeps
 * global state or starts a thread that was not asked for. Calls on one world
 * must not overlap in time; different worlds are independent, and may be
 * stepped by different threads at the same time.
 *
 * Errors. A fault has the same status in every function. It is DRAPE_EARG if a
 * pointer is NULL that must not be; if a count, an index or an enumerator is
 * out of its range; or if an allocator has only one of its two functions. A
 * number that is not finite, or is beyond 2^60, is DRAPE_EDATA (drape_ccd takes
 * all finite numbers); any other number out of its range is DRAPE_EARG. Arrays
 * must be as long as their counts say, which no function can check. After an
 * error all is as it was before the call, except that outputs may hold
 * anything. */
#ifndef DRAPE_H
#define DRAPE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define DRAPE_VERSION "0.1.0"
/* The same as numbers, for #if. */
#define DRAPE_VERSION_MAJOR 0
#define DRAPE_VERSION_MINOR 1
#define DRAPE_VERSION_PATCH 0

/* What a call returns: DRAPE_OK, or a negative status if it failed. */
enum drape_status {
    DRAPE_OK = 0,
    DRAPE_EARG = -1,    /* an argument is NULL or out of its range */
    DRAPE_EDATA = -2,   /* a number is not finite or beyond 2^60 */
    DRAPE_ENOMEM = -3,  /* an allocator returned NULL */
    DRAPE_EFULL = -4,   /* an output is too small. Stages return this status
                           to the pipeline; no function of this header does */
    DRAPE_ESTART = -5,  /* at the start cloth intersects itself, other cloth or
                           an obstacle, or a triangle without area touches
                           another triangle (narrow/audit.md §5) */
    DRAPE_EDEVICE = -6, /* this build or machine lacks the backend, or the
                           device has failed */
    DRAPE_EMATCH = -7,  /* the checkpoint or log is damaged, or belongs to
                           another definition, precision or format */
    DRAPE_EIO = -8,     /* a function of the caller's ended the call */
    DRAPE_ELIMIT = -9   /* the step would need more than the definition allows:
                           substeps beyond max_substeps */
};

/* How a step ended: 0, or a bitwise or of these. After a step without
 * DRAPE_TRAPPED no two triangles intersect that can collide: world/step.md §5,
 * §11. */
enum drape_outcome {
    DRAPE_UNCONVERGED = 1, /* the linear solver did not reach its tolerance */
    DRAPE_ZONES = 2,       /* impulses did not part all pairs, and impact zones
                              were used (contact/zones.md) */
    DRAPE_ROLLBACK = 4,    /* zones did not suffice either, and vertices were
                              put back (contact/rollback.md) */
    DRAPE_TRAPPED = 8,     /* the state at the end of the step intersects:
                              obstacles or pins that move left no room, or the
                              start intersected. Every step has this outcome
                              until no intersecting pair is left */
    DRAPE_DIVERGED = 16,   /* energy appeared from nothing, or a value was not
                              finite. The state and the time are those before
                              the step (cloth/dynamics.md §3) */
    DRAPE_ASLEEP = 32,     /* all cloths are asleep and no body moves: the step
                              was skipped */
    DRAPE_PASSED = 64      /* cloth went through something during the step,
                              which the response could not prevent; at the end
                              of the step nothing intersects */
};

/* How a cloth's motion is integrated. cloth/advance.md, cloth/implicit.md */
enum drape_integrator {
    DRAPE_EULER,    /* symplectic Euler, explicit, order 1 */
    DRAPE_MIDPOINT, /* explicit midpoint, order 2 */
    DRAPE_VERLET,   /* velocity Verlet, explicit, order 2 */
    DRAPE_RK4,      /* classical Runge–Kutta, explicit, order 4 */
    DRAPE_BW,       /* Baraff–Witkin 1998, implicit, order 1 */
    DRAPE_CK,       /* Choi–Ko 2002, semi-implicit BDF2, order 2 */
    DRAPE_BDF2      /* that formula, solved by Newton's method, order 2 */
};

/* The preconditioner of the conjugate gradients: block-Jacobi (solve/jacobi.md)
 * or geometric multigrid (solve/multigrid.md). */
enum drape_precond { DRAPE_JACOBI, DRAPE_MULTIGRID };
/* How the matrix of the linear system is stored. solve/matrix.md */
enum drape_matrix {
    DRAPE_CDF,    /* the paper's 17 diagonals of full 3 × 3 blocks */
    DRAPE_COMPACT /* the symmetric half, in symmetric blocks of 6 numbers */
};
/* Who computes the vector operations of the conjugate gradients. solve/pcg.md
 * §6 */
enum drape_solver {
    DRAPE_EXACT, /* drape's own code: the same bits on every machine */
    DRAPE_CUBLAS /* cuBLAS, as in the paper: it adds in an order of its own, so
                    the bits are not those of the reference */
};
/* What contacts do with an implicit integrator. contact/response.md */
enum drape_response {
    DRAPE_SOLVE,   /* they take part in the solve: contact/lagrange.md */
    DRAPE_IMPULSES /* they act after it, as in the paper and always with an
                      explicit integrator: repulsion, then rounds of impulses */
};
/* Where the stages run: on the CPU (ref/) or on an NVIDIA GPU (gpu/). The bits
 * are the same with DRAPE_EXACT. */
enum drape_backend { DRAPE_REF, DRAPE_GPU };

/* What resists bending. cloth/cloth.md §4, §5, §7 */
enum drape_bending {
    DRAPE_TRIPLES, /* second differences of three particles in a row: they have
                      the stiffness `bend` at any size of cells */
    DRAPE_SPRINGS  /* the paper's springs between every second particle: weaker
                      than `bend` where curvature is small (cloth/cloth.md §5) */
};

/* The directions in which a tension can be measured. cloth/cloth.md §9 */
enum drape_table {
    DRAPE_WARP, /* along u */
    DRAPE_WEFT, /* along v */
    DRAPE_BIAS, /* at 45° to both */
    DRAPE_TABLES
};
enum { DRAPE_POINTS = 16 }; /* of a table, at most */

/* What cloth is made of. The numbers do not depend on the grid: cloth/cloth.md
 * §4 derives the constants of springs and triples from them. */
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
    /* Measured tensions, by enum drape_table: points (strain, N/m of width at
     * rest) of a strip whose sides are free. The origin is a point, too. Each
     * strain is at least 1e-6 above the one before it, and at most 10; forces
     * are > 0 and do not fall. A strain of 0 ends a table. A direction whose
     * table has no point is linear, by `stretch` and `shear`, which also resist
     * all compression. Tables need bending by triples. */
    double table[DRAPE_TABLES][DRAPE_POINTS][2];
} drape_material;

/* A rigid motion by keyframes. It takes a point X, as the definition places
 * it, to x(t) = p(t) + R(q(t)) (X - pivot) at time t. Between keys p is linear
 * in time and q is linear and then normalised, by the shorter way round; before
 * the first key and after the last the motion stands still.
 * world/kinematics.md §2 */
typedef struct drape_motion {
    int keys;                    /* number of keys, 1 … 2^24 */
    const double *time;          /* [keys] s, strictly ascending */
    const double (*position)[3]; /* [keys] p, m */
    const double (*rotation)[4]; /* [keys] q = w, x, y, z, of length 1 within
                                    1e-6; NULL: no rotation */
    double pivot[3];             /* the point that goes to p, m */
} drape_motion;

/* A particle of a cloth that does not move freely. Of several pins of one
 * particle the last holds. */
typedef struct drape_pin {
    int i, j;   /* the particle, 0 … m - 1 and 0 … n - 1; it has a cell */
    int motion; /* index into drape_def.motions of the motion that moves the
                   particle, or -1: the particle stays where it starts */
} drape_pin;

/* What a cell of a panel is. Its corners are counted counter-clockwise from the
 * one with the least i and j. */
enum drape_cell {
    DRAPE_CELL_ABSENT,
    DRAPE_CELL_REGULAR, /* all its corners are where the grid has them */
    DRAPE_CELL_RISING,  /* a corner was moved; divided from corner 0 to 2 */
    DRAPE_CELL_FALLING, /* a corner was moved; divided from corner 1 to 3 */
    DRAPE_CELL_WITHOUT  /* a triangle without corner `cell - DRAPE_CELL_WITHOUT`
                           of 0 … 3 */
};

/* An edge of a cell of a panel that is sewn to a shorter one, as where a skirt
 * is gathered: what is too long of it lies in tucks within the seam, so that it
 * rests at less than its length. panel/panel.md §2.2 */
typedef struct drape_ease {
    int32_t end[2]; /* particles, next to each other around a cell that is not
                       regular; of two such cells, it is an edge of both, and
                       each is convex by `rest` */
    double ratio;   /* its length at rest over that by `rest`, 0.5 … 1 */
} drape_ease;

/* A panel: a cloth of any outline, whose particles at the outline were moved
 * onto it. panel/panel.md */
typedef struct drape_panel {
    /* [m·n] m: the particles at rest, in the plane, along i and along j from
     * particle 0. A corner of a regular cell is where the grid has it, i·width
     * / (m-1) and j·height / (n-1), within 1e-6 of a cell; one of another cell
     * is less than a cell from there. */
    const double (*rest)[2];
    /* [(m-1)·(n-1)] enum drape_cell. A triangle of a cell has at least 0.05 of
     * the area of a regular cell. */
    const uint8_t *cell;
    const drape_ease *eases; /* [n_eases], the last one of an edge counts */
    int n_eases;             /* 0 … 10^6 */
} drape_panel;

/* A rectangular sheet: a grid of m × n particles, of which (i, j) is number
 * i + m·j, with (m-1)·(n-1) cells between them, of which (i, j) is number
 * i + (m-1)·j. cloth/cloth.md §1 */
typedef struct drape_cloth {
    int m, n; /* particles along i and along j, 2 … 32768 each */
    /* Size at rest along i and along j, m, > 0. The longer side of a cell is
     * less than √(stretch / shear) times the shorter one. */
    double width, height;
    drape_material material;
    /* [m·n] m: where the particles start; NULL: flat, by the next three. */
    const double (*x)[3];
    /* The place of particle 0, m, and the directions of i and of j, which are
     * of length 1 and at right angles within 1e-6. Not read if x is given. */
    double origin[3], u[3], v[3];
    const double (*velocity)[3]; /* [m·n] m/s, at the start; NULL: at rest */
    const uint8_t *hole; /* [m·n] 1: the particle is missing; NULL: none is */
    /* [(m-1)·(n-1)] 1: the cell is missing; NULL: none is. Holes and cuts
     * leave at least one cell. */
    const uint8_t *cut;
    const drape_pin *pins; /* [n_pins] */
    int n_pins;            /* 0 … m·n */
    int bending;           /* enum drape_bending */
    /* NULL: a rectangle. A panel has no holes and cuts, bending by triples and
     * an implicit integrator; a flat start is at its places at rest. */
    const drape_panel *panel;
} drape_cloth;

/* How a mesh that deforms goes from one frame to the next. world/kinematics.md
 * §4 */
enum drape_between {
    DRAPE_LINEAR, /* every vertex in a straight line, evenly */
    DRAPE_CUBIC   /* by a cubic in time with a continuous velocity, at a frame
                     the mean one from the frame before to the frame after: a
                     vertex may swing out a little between two frames */
};

/* A triangle mesh that cloth collides with and does not push. The mesh may be
 * open, closed or non-manifold. It stands still, or moves by a motion, or
 * deforms by frames: the same triangles with their vertices at other places.
 * Whatever leads it, each vertex is at the place of its time where a step, or a
 * slice of one (world/step.md §7), ends, and goes there in a straight line:
 * what it would do in between does not count. */
typedef struct drape_obstacle {
    int64_t n_vertices, n_triangles; /* at least 1 each */
    const double (*x)[3];    /* [n_vertices] m; a motion maps it at time 0 too;
                                not used where there are frames */
    const int32_t (*tri)[3]; /* [n_triangles] its own vertices, from 0 */
    double friction; /* Coulomb coefficient, 0 … 1e6, as a material's */
    int motion;      /* index into drape_def.motions, -1: none */
    int frames;  /* number of frames, to 2^24, of a mesh that deforms, which has
                    no motion; 0: none, and the next four are not read */
    int between; /* enum drape_between */
    double frame_dt; /* s, > 0: frame k is at time k · frame_dt; not read if
                        frame_time is given */
    /* [frames] s, strictly ascending: the time of each frame; NULL: every
     * frame_dt from time 0 on. Before its time the first frame holds, and after
     * its time the last one. */
    const double *frame_time;
    const double (*frame)[3]; /* [frames][n_vertices] m */
} drape_obstacle;

/* A seam: particles of a cloth that are held to places on a cloth's edges.
 * seam/seam.md */
typedef struct drape_seam {
    int cloth[2]; /* of the particles, and of what they are held to; the two may
                     be one */
    int64_t n; /* points, at least 1, from one end of the seam to the other */
    const int32_t *particle;  /* [n] of cloth[0], i + m·j, none twice */
    const int32_t (*onto)[2]; /* [n] two particles of cloth[1], which may be
                                 equal; neither is the point's own particle */
    const double *part; /* [n] 0 … 1: the place is (1 - part) of the first and
                           part of the second */
    double
        strength; /* N, 0 … 1e9: a point pulls by no more, and gives way where
                     its target asks for more; 0: it holds whatever pulls */
} drape_seam;

/* Air that moves with one velocity everywhere. cloth/wind.md */
typedef struct drape_wind {
    double velocity[3]; /* m/s */
    double density;     /* kg/m³, ≥ 0; 0: there is no air */
    double drag, lift;  /* coefficients of a triangle along and across the
                           flow, 0 … 1e6 */
} drape_wind;

/* Where memory comes from: both functions, or zeros for the default. They are
 * called only within calls that were given the allocator or a world made with
 * it, and get `user` as it is here. */
typedef struct drape_allocator {
    /* Returns `bytes` of memory, aligned to 64 bytes on the host and to 256 on
     * a device, or NULL if there is none. */
    void *(*allocate)(void *user, size_t bytes);
    /* Takes back what `allocate` gave for this number of bytes. */
    void (*release)(void *user, void *p, size_t bytes);
    void *user; /* may be NULL */
} drape_allocator;

/* Called after each stage of a step. step: the steps done before this one.
 * stage: its name, static. digest: a 64-bit hash of the stage's main output in
 * stream order, the same on both backends. seconds: wall time since the stage
 * before, hashing aside. */
typedef void drape_trace(void *user, int64_t step, const char *stage,
                         uint64_t digest, double seconds);

/* Called within drape_create and drape_step with a line for people to read:
 * what was made, what failed and why, where memory grew. The line has no line
 * end, and is valid until the function returns. */
typedef void drape_log(void *user, const char *line);

/* A scene: bodies, forces, and how a step is computed. drape_create copies all
 * that a definition points to, except what `stream`, the allocators' `user`,
 * log_user and trace_user point to, which must outlive the world. Fill it by
 * drape_default first. */
typedef struct drape_def {
    int backend;   /* enum drape_backend */
    int precision; /* 32 or 64: bits of a number in the state */
    /* Threads of the reference, with the caller's, 0 … 4096; 0: as many as
     * there are processors. At most twice as many as processors are used, but
     * up to 8 always, and fewer if the system gives fewer. The threads exist
     * only during a call. The number changes no bit. */
    int threads;
    /* Threads of a thread block on the device: a multiple of 32 up to 256; 0:
     * 256. The number changes no bit. */
    int block;

    double dt;         /* length of a step, s, 1e-9 … 1e3 */
    double gravity[3]; /* m/s² */
    drape_wind wind;
    int integrator;     /* enum drape_integrator */
    int newton;         /* implicit: linear solves of a cloth's motion at most,
                           1 … 64; 0: 1 for Baraff–Witkin and Choi–Ko, as in
                           their papers, 4 for BDF2 */
    int max_substeps;   /* explicit: refuse (DRAPE_ELIMIT) beyond, ≥ 1 */
    int precond;        /* enum drape_precond */
    int matrix;         /* enum drape_matrix */
    int solver;         /* enum drape_solver; DRAPE_CUBLAS: backend gpu only */
    double tolerance;   /* of a solve: relative residual, 1e-15 … 1; where
                           contacts take part, of what is not in balance
                           (contact/lagrange.md §3.4) */
    int max_iterations; /* of the conjugate gradients in one solve, ≥ 1 */

    int self_collision; /* 1: cloth collides with cloth, its own and others'; 0:
                           with obstacles only */
    int response;       /* enum drape_response */
    int max_rounds;     /* rounds of collision impulses in a slice before the
                           fail-safe, 0 … 10000 (contact/response.md §4) */
    /* Most slices of a step, a power of two, 1 … 64; 1: a step is never cut. A
     * step is cut where it ends badly, and where things move far and contacts
     * are not solved with the cloths (world/step.md §7). */
    int max_slices;
    int allow_intersecting; /* 1: a start that intersects is accepted; 0: it is
                               DRAPE_ESTART */
    int sleep;              /* 1: cloths at rest are skipped until something
                               comes near, and steps in which all are
                               (sleep/sleep.md) */

    const drape_cloth *cloths;       /* [n_cloths] */
    int n_cloths;                    /* 1 … 4096 */
    const drape_obstacle *obstacles; /* [n_obstacles] */
    int n_obstacles;                 /* 0 … 4096 */
    const drape_motion *motions;     /* [n_motions], shared by pins and
                                        obstacles */
    int n_motions;                   /* 0 … 2^20 */
    /* All bodies together have fewer than 2^28 vertices and triangles each. */
    const drape_seam *seams; /* [n_seams]; they need an implicit integrator and
                                DRAPE_SOLVE */
    int n_seams; /* 0 … 2^20, with fewer than 2^28 points in all */

    drape_allocator allocator;        /* zeros: malloc and free */
    drape_allocator device_allocator; /* zeros: cudaMalloc and cudaFree */
    /* Of DRAPE_GPU: the cudaStream_t on which the world works, which must
     * outlive it; NULL: the world makes one. The world lives on the device that
     * is current in drape_create, and this device must be current in all later
     * calls on the world. */
    void *stream;
    drape_log *log; /* NULL: none */
    void *log_user;
    drape_trace *trace; /* NULL: none, and no digest is computed */
    void *trace_user;
} drape_def;

/* What was wrong with a definition: what, where, and what was expected. */
typedef struct drape_error {
    char text[256]; /* one line without a line end, ended by 0 */
} drape_error;

/* The parts into which a report divides the time of a step. */
enum drape_part {
    DRAPE_PART_INTEGRATION, /* forces and motion, without the solver */
    DRAPE_PART_SOLVER,      /* linear systems, those with contacts too */
    DRAPE_PART_BROAD,       /* queries of the broad phase */
    DRAPE_PART_PROXIMITY,   /* pairs near, repulsion, how far candidates move */
    DRAPE_PART_PENETRATION, /* narrow phase, impulses and fail-safe */
    DRAPE_PART_COUNT
};

/* The work that a step did, with that of slices which were taken again; what is
 * not in it was skipped. All is 0 in a step asleep. Both backends count the
 * same. world/step.md §10 */
typedef struct drape_work {
    int tries;          /* slices begun; the report's `slices` were kept */
    int solves;         /* linear systems solved, without and with contacts */
    int queries;        /* queries of the broad phase */
    int narrow;         /* runs of the narrow phase */
    int64_t boxes;      /* boxes of the BVH that queries refitted */
    int64_t boxes_kept; /* boxes that they left as they were: those of obstacles
                           that never move, or all where whole meshes are
                           apart */
    int64_t walked;     /* pairs of boxes that the walk visited */
    int64_t cleared;    /* pairs of boxes that meet and were not entered, as
                           tangent cones exclude contact (broad/cones.md) */
    int64_t near;       /* pairs of primitives given to proximity */
    int64_t later;      /* those of the report's `candidates` that were found in
                           rounds after the first */
} drape_work;

/* What a step did. Counts marked * include slices that were taken again; all
 * others are of the slices that were kept. */
typedef struct drape_step_report {
    int64_t step;       /* steps done since time 0, with this one unless it
                           diverged */
    double time;        /* s, at the end of the step */
    int outcome;        /* bitwise or of enum drape_outcome; 0: clean */
    int slices;         /* slices that make up the step, 1 … max_slices */
    int substeps;       /* most substeps of the integrator in a slice */
    int iterations;     /* * of the linear solver, all solves together */
    double residual;    /* relative, the largest: of solves without contacts,
                           and of what those with contacts left undone */
    int rounds;         /* * detections of penetration after the solves with
                           contacts, of which the last in a clean slice finds
                           no pair; 0 where nothing was near anything */
    int asleep;         /* cloths asleep at the end of the step */
    int64_t contacts;   /* pairs near, contact/proximity.md, last slice */
    int64_t impacts;    /* pairs found to penetrate, all rounds */
    int64_t candidates; /* * pairs given to the narrow phase, all rounds */
    int64_t zone_vertices, rolled_back; /* vertices that the fail-safe moved in
                                           zones, and that it put back */
    int64_t intersecting; /* intersecting pairs of triangles at the end of the
                             step, as drape_audit counts them; not 0 only with
                             DRAPE_TRAPPED */
    int64_t sewn; /* pairs that intersect beside a seam, which are not in
                     `intersecting` (seam/seam.md §5), where this step had to
                     count pairs; else 0 */
    double kinetic, elastic, potential; /* J, of all cloths, at the end of the
                                           step; potential: of gravity, 0 at the
                                           origin */
    double seconds[DRAPE_PART_COUNT];   /* * wall time of each part */
    drape_work work;                    /* * what was computed */
} drape_step_report;

/* A row of a world's plan: a stage, whether the scene uses it, and why. */
typedef struct drape_plan_row {
    const char *stage; /* name, static */
    int on;            /* 1: the scene uses the stage */
    const char *why;   /* a few words, static */
    size_t bytes;      /* of memory held now for the row's streams */
} drape_plan_row;

/* A scene that was made, and its state: opaque. */
typedef struct drape_world drape_world;

/* Fills a definition with defaults: the reference on one thread, 32 bits, dt
 * 1/60, gravity -9.81 along y, no air (drag 1 and lift 0.3 for when a density
 * is set), Baraff–Witkin, multigrid and the symmetric half, tolerance 1e-3, at
 * most 2000 iterations and 100000 substeps, self-collision, 16 rounds, 32
 * slices, sleep; no bodies. It never fails. NULL does nothing, as in the next
 * two functions. */
void drape_default(drape_def *def);
/* Fills a cloth with defaults: 101 × 101 particles, 1 m × 1 m, flat in the xz
 * plane, without holes, cuts or pins, of light cotton: density 0.2, stretch
 * 1000, shear 300, bend 1e-5, damping 1e-3, thickness 0.002, friction 0.3,
 * bending by triples. */
void drape_default_cloth(drape_cloth *cloth);
/* Fills an obstacle with defaults: friction 0.3, no motion, no frames, linear
 * between frames; no vertices or triangles yet. */
void drape_default_obstacle(drape_obstacle *obstacle);

/* Checks the whole definition and makes a world from it, at time 0. The caller
 * owns *world and ends it by drape_destroy. On failure *world is NULL, and
 * `error`, which may be NULL, says what was wrong and where: DRAPE_EARG,
 * DRAPE_EDATA, DRAPE_ENOMEM, DRAPE_ESTART, DRAPE_EDEVICE, DRAPE_ELIMIT. */
int drape_create(const drape_def *def, drape_world **world, drape_error *error);
/* Releases a world and all its memory. NULL does nothing. */
void drape_destroy(drape_world *world);

/* Advances a world by dt (world/step.md). DRAPE_OK: the step is done or, if its
 * outcome has DRAPE_DIVERGED, was given up; `report`, which may be NULL, says
 * what happened. DRAPE_EARG: world is NULL. DRAPE_ENOMEM: the next call may
 * succeed. DRAPE_EDATA: a motion leads beyond 2^60. DRAPE_EDEVICE. After an
 * error the state is that before the step. */
int drape_step(drape_world *world, drape_step_report *report);
/* Advances n ≥ 0 worlds by up to `steps` ≥ 0 steps each; each is listed once. A
 * world stops at a step that fails, or, with reports, that diverges; the others
 * go on. Every world has the bits that it has alone. Small worlds on a device
 * are advanced together: what several of them launch is one launch (gpu.md
 * §11). The others are stepped side by side. threads: of the host, at most 64;
 * 0: one a processor; the functions that worlds were given are called from all
 * of them, and allocators on small stacks. report: [n][steps], those of steps
 * that were not made are zeros; or NULL, which is faster. The seconds in
 * reports of worlds that are advanced together are of all of them. status: [n]
 * what the last drape_step of each world returned, or NULL. Returns DRAPE_OK,
 * or the first status that is not; or DRAPE_EARG (a number is negative, or a
 * world is NULL or listed twice) or DRAPE_ENOMEM, and nothing is done. */
int drape_step_many(drape_world *const *world, int n, int steps, int threads,
                    drape_step_report *report, int *status);

/* Return the number of vertices and of triangles of a scene. The vertices of
 * the cloths come first, in the definition's order, then those of the
 * obstacles; triangles likewise. Missing particles are vertices too.
 * DRAPE_EARG: world is NULL. */
int64_t drape_vertices(const drape_world *world);
int64_t drape_triangles(const drape_world *world);
/* Return where the vertices and the triangles of a body begin. Bodies 0 …
 * n_cloths - 1 are the cloths, the next n_obstacles the obstacles; body
 * n_cloths + n_obstacles gives the total. DRAPE_EARG: world is NULL, or there
 * is no such body. */
int64_t drape_first_vertex(const drape_world *world, int body);
int64_t drape_first_triangle(const drape_world *world, int body);
/* Returns the number of bodies, and sets *cloths, unless cloths is NULL, to the
 * number of cloths among them. DRAPE_EARG: world is NULL. */
int drape_bodies(const drape_world *world, int *cloths);
/* Copies the current state to x and v, [drape_vertices][3] each, m and m/s.
 * Either may be NULL. DRAPE_OK; DRAPE_EARG: world is NULL; DRAPE_EDEVICE. */
int drape_read(const drape_world *world, double (*x)[3], double (*v)[3]);
/* Copies the three vertices of each triangle to tri, [drape_triangles][3];
 * vertices count from the scene's first. They change with the bodies alone.
 * DRAPE_OK, or DRAPE_EARG: world or tri is NULL. */
int drape_read_triangles(const drape_world *world, int32_t (*tri)[3]);
/* Sets *step to the steps done since time 0, and *time to the time of the
 * state, s: those of the last step's report, and after drape_load or
 * drape_replay those of the world that was saved or recorded. Either pointer
 * may be NULL. DRAPE_OK, or DRAPE_EARG: world is NULL. */
int drape_clock(const drape_world *world, int64_t *step, double *time);
/* Copy what the next step will use: the material of a cloth, 0 … n_cloths - 1,
 * the wind, and gravity, [3] m/s², as they were defined, set, loaded or
 * replayed. The numbers are those that were given, not rounded to the world's
 * precision, so that a caller who sets one of them again keeps the others.
 * DRAPE_OK, or DRAPE_EARG: a pointer is NULL, or there is no such cloth. */
int drape_read_material(const drape_world *world, int cloth,
                        drape_material *material);
int drape_read_wind(const drape_world *world, drape_wind *wind);
int drape_read_gravity(const drape_world *world, double gravity[3]);

/* Where the current state lies, to be read without a copy. The memory belongs
 * to the world; x and v are valid until the next drape_step,
 * drape_load, drape_replay, drape_set_positions or drape_destroy, and all until
 * a body is added or removed. On a device
 * the state is complete in the order of `stream`: what the caller puts on this
 * stream runs after it and before the next step. Work on other streams must
 * wait for an event on this one. */
typedef struct drape_view {
    const void *x, *v;       /* [vertices][3] m and m/s, of `precision` bits */
    const int32_t (*tri)[3]; /* [triangles] vertices of the scene */
    int64_t vertices, triangles;
    int precision; /* 32: x and v are of float, 64: of double */
    int device;    /* CUDA's number of the device; -1: host memory */
    void *stream;  /* the world's cudaStream_t; NULL for the reference */
} drape_view;
/* Fills a view. On a device on which nothing can collide, the first call
 * allocates memory for the triangles. DRAPE_OK; DRAPE_EARG: world or view is
 * NULL; DRAPE_ENOMEM, DRAPE_EDEVICE. */
int drape_borrow(drape_world *world, drape_view *view);

/* Two features in contact, sides A and B: a vertex and a face, or two edges,
 * of which one side is of cloth at least. The point of contact on A is the sum
 * of weight · x over A's vertices, on B minus that sum. */
typedef struct drape_contact {
    int32_t vertex[4]; /* of the scene: kind 0: A is vertex[0], B the face of
                          the other three; kind 1: A is the edge of the first
                          two, B that of the last two */
    int32_t kind;
    int32_t body[2];   /* of A and of B, as in drape_first_vertex */
    int32_t unused;    /* 0 */
    double weight[4];  /* those of A add to 1, those of B to -1 */
    double normal[3];  /* unit, from B to A */
    double gap;        /* m, along the normal, at the start of the slice */
    double impulse[3]; /* N·s, that A got from B in the slice, with friction */
} drape_contact;

/* The contacts of a step's last slice, which is the whole step unless its
 * report says otherwise. An impulse divided by dt is the mean force, and its
 * part across the normal is at most friction times the part along it, to the
 * tolerance, unless a solve failed (DRAPE_UNCONVERGED). A pair
 * that met again in the slice is listed once more, with its normal then. */
typedef struct drape_contact_list {
    int64_t n;
    const drape_contact *contact; /* [n] */
    const double (*impulse)[3];   /* [n_cloths + n_obstacles] N·s, what each
                                     body got from contacts in all */
    double dt;                    /* s, length of the slice */
} drape_contact_list;
/* Lends the list of pairs that were near or met in the last slice of the last
 * step that was not skipped; some push nothing (control/control.md §8): n
 * is 0 before the first step, after a step that failed, drape_load,
 * drape_set_positions or drape_set_velocities, or a change of bodies. The
 * memory belongs to the world and is valid until the next call of these two
 * functions, drape_step, a change of bodies or drape_destroy: host memory, or,
 * by the form `_device`, where drape_borrow says. Nothing is computed or kept
 * for a list that is not asked for. The impulses do not have what zones and
 * rollback change. DRAPE_OK; DRAPE_EARG: a pointer is NULL, or the integrator
 * is explicit; DRAPE_ENOMEM, DRAPE_EDEVICE.
 */
int drape_contacts(drape_world *world, drape_contact_list *list);
int drape_contacts_device(drape_world *world, drape_contact_list *list);

/* Wakes all cloths that are asleep, from the next step on. NULL does
 * nothing. */
void drape_wake(drape_world *world);
/* Sets the wind from the next step on, and wakes the scene. The wind is copied.
 * Ranges and statuses are those of a definition. A world that was made without
 * air takes memory for it here: DRAPE_ENOMEM or DRAPE_EDEVICE, and nothing has
 * changed. Without density, or without drag and lift, there is no wind,
 * whatever its velocity. control/control.md §1 */
int drape_set_wind(drape_world *world, const drape_wind *wind);

/* Live control: calls between two steps that change the world from the next
 * step on, and wake it (control/control.md). What they are given is copied. A
 * call that is refused changes nothing. Numbers are rounded once to the world's
 * precision. A checkpoint holds what was changed. The bodies change by
 * drape_add_cloth, drape_add_obstacle and drape_remove alone.
 *
 * Each call with vectors has two forms. The plain one reads binary64 on the
 * host. The form `_device` reads numbers of the world's precision where the
 * world lives, as drape_borrow shows: memory of its device, or host memory for
 * the reference. It reads them in the order of the world's stream, so what the
 * caller put on this stream before is seen; they may be changed after the call
 * in the same order. Besides the statuses named, calls return DRAPE_ENOMEM and
 * DRAPE_EDEVICE. */

/* Sets gravity, [3] m/s². DRAPE_OK; DRAPE_EARG: a pointer is NULL; DRAPE_EDATA.
 */
int drape_set_gravity(drape_world *world, const double gravity[3]);
/* Sets the material of a cloth, 0 … n_cloths - 1; positions and velocities
 * stay. Ranges and statuses are those of a definition; DRAPE_EARG also where
 * no springs fit it, as with cells too oblong or a table too soft (cloth.md §4,
 * §9); DRAPE_ELIMIT where an explicit
 * integrator would need more than max_substeps. */
int drape_set_material(drape_world *world, int cloth,
                       const drape_material *material);
/* Set the places, m, or the velocities, m/s, of the n vertices of the scene
 * from `first` on, all of which are of cloths; x and v are [n]. The entries of
 * pinned and of missing particles are not used. The world then steps as one
 * that was made in this state: it forgets its past (Choi–Ko, BDF2), what
 * contacts pressed with, and what it has learnt about slices. Positions that
 * intersect are DRAPE_ESTART, unless the definition allows an intersecting
 * start; `error`, which may be NULL, then names the bodies and the first pair.
 * DRAPE_OK; DRAPE_EARG: a range, or a pointer; DRAPE_EDATA. */
int drape_set_positions(drape_world *world, int64_t first, int64_t n,
                        const double (*x)[3], drape_error *error);
int drape_set_positions_device(drape_world *world, int64_t first, int64_t n,
                               const void *x, drape_error *error);
int drape_set_velocities(drape_world *world, int64_t first, int64_t n,
                         const double (*v)[3]);
int drape_set_velocities_device(drape_world *world, int64_t first, int64_t n,
                                const void *v);
/* Sets which particles of a cloth are pinned, in place of all its pins so far:
 * particle [n], i + m·j each, none twice and none that is missing; n may be 0.
 * In the next step pin k goes in a straight line from where it is to x[k], m,
 * [n], and stays there until it is told otherwise; x NULL: all stay where they
 * are. A particle that is let go keeps the velocity with which it was led. The
 * list is on the host in both forms; a call that repeats it costs no more than
 * its targets. DRAPE_OK; DRAPE_EARG: an index, a count or a pointer;
 * DRAPE_EDATA; DRAPE_ELIMIT as in drape_set_material. */
int drape_set_pins(drape_world *world, int cloth, int64_t n,
                   const int32_t *particle, const double (*x)[3]);
int drape_set_pins_device(drape_world *world, int cloth, int64_t n,
                          const int32_t *particle, const void *x);
/* Tells an obstacle, 0 … n_obstacles - 1, where its vertices x, [its number of
 * vertices] m, are at the end of the next step. They go there in straight lines
 * and then stay until they are told otherwise; the obstacle's own motion or
 * frames hold no more. Cloth in the way is pushed as by any obstacle that
 * moves. DRAPE_OK; DRAPE_EARG: an index or a pointer; DRAPE_EDATA. */
int drape_set_obstacle(drape_world *world, int obstacle, const double (*x)[3]);
int drape_set_obstacle_device(drape_world *world, int obstacle, const void *x);
/* The same for a rigid pose: a vertex X of the definition, which has no frames,
 * goes to position + R (X - pivot), R by the quaternion rotation = w, x, y, z,
 * of length 1 within 1e-6; NULL: no rotation, and pivot 0. DRAPE_EARG also for
 * an obstacle with frames, or a wrong length. */
int drape_set_pose(drape_world *world, int obstacle, const double position[3],
                   const double rotation[4], const double pivot[3]);

/* Sets the targets of a seam, 0 … n_seams - 1: at the end of the next step and
 * from then on each particle minus its place is gap[k], m, [the seam's points];
 * gap NULL: 0. Within the step a target goes there in a straight line. At first
 * the target of each point is the gap that it starts with. DRAPE_OK;
 * DRAPE_EARG: world is NULL, or there is no such seam; DRAPE_EDATA. */
int drape_seam_target(drape_world *world, int seam, const double (*gap)[3]);
/* Copies what a seam is like now: gap, m, each particle minus its place, and
 * pull, N, the force that the seam put on each particle at the end of the last
 * step; [the seam's points], and either may be NULL. DRAPE_OK; DRAPE_EARG:
 * world is NULL, or there is no such seam; DRAPE_EDEVICE. */
int drape_seam_state(const drape_world *world, int seam, double (*gap)[3],
                     double (*pull)[3]);
/* Whether contact and the count of intersecting pairs pass over two triangles
 * of the scene, as they are sewn together (seam/seam.md §5): 1 or 0;
 * DRAPE_EARG: world is NULL, or there is no such triangle. So the pairs that
 * drape_audit finds can be divided. */
int drape_are_sewn(const drape_world *world, int64_t a, int64_t b);

/* Add a body to a world at its present time, with all the definition's rules
 * and ranges: the last of the cloths, or of the obstacles. Vertices and
 * triangles of later bodies, and the numbers of later bodies, move up behind
 * the new one's. A motion or frames hold as if the body had been there from
 * time 0: the obstacle is where they have it now, and a pin is led there in the
 * next step; motions are those of the definition. The other bodies, and what
 * the world has learnt, keep their bits. Costs as much as drape_create, and
 * while it runs the memory of both worlds; drape_view and drape_contact_list
 * end. Return the number of the cloth, or of the obstacle; DRAPE_EARG,
 * DRAPE_EDATA, DRAPE_ENOMEM, DRAPE_EDEVICE, DRAPE_ELIMIT; DRAPE_ESTART if the
 * new body intersects itself or another body, unless the definition allows an
 * intersecting start. `error`, which may be NULL, says what was wrong, by the
 * numbers that the bodies would have. A new cloth has no seams. */
int drape_add_cloth(drape_world *world, const drape_cloth *cloth,
                    drape_error *error);
int drape_add_obstacle(drape_world *world, const drape_obstacle *obstacle,
                       drape_error *error);
/* Removes a body, numbered as in drape_first_vertex, at the same cost; those
 * behind it move down. The world is then that of the definition without this
 * body and the seams that it is in, in the state that the others have: a
 * checkpoint of either goes on in the other; seams behind these move down, too.
 * DRAPE_OK; DRAPE_EARG: world is NULL, there is no such body, or it is the only
 * cloth; DRAPE_ENOMEM, DRAPE_EDEVICE. */
int drape_remove(drape_world *world, int body);

/* Writes the first `capacity` rows of the plan to row, and returns how many
 * rows there are. row may be NULL if capacity is 0. DRAPE_EARG: world is NULL,
 * capacity is below 0, or row is NULL otherwise. */
int drape_plan(const drape_world *world, drape_plan_row *row, int capacity);

/* Memory of a world's streams and records, without what the CUDA runtime keeps
 * for itself. Once a scene has settled, a step allocates nothing. */
typedef struct drape_memory {
    size_t host_bytes, device_bytes; /* held now */
    size_t borrowed_bytes; /* part of device_bytes: memory of the solver that
                              contact uses between solves */
    int64_t host_allocations, device_allocations; /* since drape_create */
} drape_memory;
/* Fills memory. DRAPE_OK, or DRAPE_EARG: world or memory is NULL. */
int drape_count(const drape_world *world, drape_memory *memory);

/* The caller's writer and reader of a checkpoint: each returns 0 if all bytes
 * were written, or read. */
typedef int drape_write(void *user, const void *data, size_t bytes);
typedef int drape_read_bytes(void *user, void *data, size_t bytes);
/* drape_save writes a checkpoint of the state; drape_load replaces the state by
 * one. A loaded world continues with the same bits as the saved one. It must
 * have been made from the same definition, of which backend, threads, block,
 * stream, allocators, log and trace may differ. user may be NULL. DRAPE_OK;
 * DRAPE_EARG: world or the function is NULL; DRAPE_EIO: the function did not
 * return 0; DRAPE_ENOMEM, DRAPE_EDEVICE; and of drape_load DRAPE_EMATCH, and
 * DRAPE_EDATA: the checkpoint holds a number that no step gives. After an error
 * the world is as before. */
int drape_save(const drape_world *world, drape_write *write, void *user);
int drape_load(drape_world *world, drape_read_bytes *read, void *user);

/* drape_record writes the state now, as a checkpoint, and then each call that
 * changes the world (steps, waking, wind, live control with the bodies that
 * come and go, loading) after it was made, by `write`; `write` NULL ends that.
 * A write that fails ends the record, changes nothing else, and makes the next
 * drape_record return DRAPE_EIO. The log is in the machine's byte order.
 * DRAPE_OK; DRAPE_EARG: world is NULL; DRAPE_EIO. */
int drape_record(drape_world *world, drape_write *write, void *user);
/* Makes the recorded calls again, up to and with the next step, on a world of
 * the same definition, of which may differ what may differ in drape_load; the
 * bits are those of the recorded world. Returns 1 after a step, of which
 * `report`, which may be NULL, says what it did; 0 where `read` had no further
 * call; DRAPE_EARG: world or read is NULL; DRAPE_EIO: the log ends within a
 * call; DRAPE_EMATCH: the log is damaged or of another world, or the step did
 * not end as recorded; or the status of a call. */
int drape_replay(drape_world *world, drape_read_bytes *read, void *user,
                 drape_step_report *report);

/* A triangle mesh for the functions that need no world. Nothing of it is kept
 * after the call. Computation is in binary64. */
typedef struct drape_mesh {
    int64_t nv, nt;            /* vertices and triangles, < 2^31 each; in
                                  drape_ccd_frames < 2^29 */
    const double (*x)[3];      /* [nv] m */
    const int32_t (*tri)[3];   /* [nt] vertices, 0 … nv - 1 */
    const int32_t *group;      /* [nt] 0: of an obstacle; NULL: none is */
    int threads;               /* as in drape_def, 0 … 4096 */
    drape_allocator allocator; /* zeros: malloc and free */
} drape_mesh;
/* Finds the intersecting pairs of triangles of a mesh, exactly
 * (narrow/audit.md). Two triangles of group 0 are not compared. The first
 * `capacity` pairs, ascending, go to pair, which may be NULL if capacity is 0;
 * *found is the number of all pairs, which may be larger. *degenerate, unless
 * degenerate is NULL, is the number of triangles without area; they are in no
 * pair (but drape_create looks at them: narrow/audit.md §5). DRAPE_OK;
 * DRAPE_EARG: a pointer, a count or an index; DRAPE_EDATA, DRAPE_ENOMEM. */
int drape_audit(const drape_mesh *mesh, int64_t capacity, int32_t (*pair)[2],
                int64_t *found, int64_t *degenerate);

/* Decides exactly whether two primitives that move linearly from x0 at time 0
 * to x1 at time 1 touch (narrow/narrow.md): vertex 0 and face 1 2 3 (kind 0),
 * or edges 0 1 and 2 3 (kind 1). Coordinates are finite, of any size. Returns 1
 * and sets *toi, in 0 … 1, to at most 2^-30 before the first touch and never
 * after it; 0: they do not touch; DRAPE_EARG: another kind, or NULL;
 * DRAPE_EDATA. */
int drape_ccd(int kind, const double x0[4][3], const double x1[4][3],
              double *toi);

/* Called for each pair that touches, of vertex v[0] and face v[1] v[2] v[3]
 * (kind 0) or of edges v[0] v[1] and v[2] v[3] (kind 1), with toi as above.
 * Another return value than 0 ends the query. */
typedef int drape_touch(void *user, int kind, const int32_t v[4], double toi);
/* Finds every vertex and face, and every two edges, of a mesh's triangles that
 * share no vertex and touch while the mesh moves linearly from mesh->x at time
 * 0 to x1 [nv] m at time 1. Each pair is reported once, vertices and faces
 * before edges, in the same order on every run. mesh->group must be NULL.
 * candidates, which may be NULL, gets the numbers of vertex-face and of
 * edge-edge pairs that were decided. user may be NULL. DRAPE_OK; DRAPE_EIO:
 * `touch` ended the query; DRAPE_EARG: a pointer, a count or an index;
 * DRAPE_EDATA, DRAPE_ENOMEM. */
int drape_ccd_frames(const drape_mesh *mesh, const double (*x1)[3],
                     drape_touch *touch, void *user, int64_t candidates[2]);

/* Returns a static text of four lines: the version, the precisions of each
 * backend, and what the certificate says of this code. */
const char *drape_info(void);
/* Returns a few static words for a status, and for any other number too. */
const char *drape_status_text(int status);

#ifdef __cplusplus
}
#endif
#endif
