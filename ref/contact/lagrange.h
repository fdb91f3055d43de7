/* SPDX-License-Identifier: Apache-2.0 */
/* The motion of all cloths with their contacts in one slice: an augmented
 * Lagrangian method, on either backend. spec/contact/lagrange.md */
#ifndef REF_LAGRANGE_H
#define REF_LAGRANGE_H

#include "ref/base/backend.h"
#include "ref/contact/coulomb.h"
#include "ref/solve/joint.h"

struct pairs;
struct sewn;

/* seam.md §3: κ, of the stretch of the weaker cloth. */
#define SEAM_SOFT R(0.1)

/* What a point holds together: Σ c u is u[v0] - (c1 u[v1] + c2 u[v2]). */
struct seam_point {
    int32_t v[3];   /* vertices: the particle, and the two of its place */
    real c[2];      /* weights of the place, ≥ 0, which add to 1 exactly */
    real stiffness; /* N/m, of seam.md §3 */
    real strength;  /* N, the greatest pull; 0: none is too great */
};

/* seam.md §6: bends across a seam: Σ c x over its vertices. */
struct seam_hinge {
    int32_t v[4], point; /* its vertices, and the point of the seam */
    real c[4];           /* weights, which add to 0; c[1] = -1 */
    real shape;          /* 1/m², stiffness for a moment of 1 N·m */
    real stiffness;      /* N/m */
    real behind;         /* m, from the seam to the rows behind it */
};

/* The seams of a world. first, cloth and made lie on the host, all other
 * arrays in the memory of the backend. */
struct seams {
    const drape_seam *made;         /* [count] the definition's */
    int count;                      /* seams */
    int64_t n;                      /* points of all seams */
    int64_t *first;                 /* [count + 1] first point of each */
    int (*cloth)[2];                /* [count] */
    const struct seam_point *point; /* [n] */
    int64_t n_hinges;
    const struct seam_hinge *hinge; /* [n_hinges], by point */
    vec *from, *to; /* [n] m, targets at the start and the end of a step */
    vec *pull;      /* [n] N, on the particle, at the start of the slice */
    vec *next;      /* [n] N, at its end; scratch before that */
    struct contact *aside; /* [n + n_hinges] scratch, while contacts change */

    struct sewn *grids; /* of multigrid; NULL: none, or another solver */

    /* seam.md §5: the particles that are sewn to vertex i are those at start[i]
     * … start[i + 1] - 1 of `sewn`, ascending. */
    int64_t n_start, n_sewn; /* nv + 1, or 0 where there is no seam */
    const int32_t *start;    /* [n_start] */
    const int32_t *sewn;     /* [n_sewn] */
};

/* The points at the start of a slice, which become contacts of coulomb.md; and
 * what the loop found. */
struct seam {
    int64_t n, n_hinges;
    const struct seam_point *point; /* [n] */
    const struct seam_hinge *hinge; /* [n_hinges] */
    const vec *x0;                  /* [nv] m */
    const real *w;                  /* [nv] 1/kg */
    const vec *target;       /* [n] m, the gap asked for at the slice's end */
    const vec *pull;         /* [n] N */
    real dt, tau;            /* s */
    struct contact *contact; /* [n + n_hinges] out of seam_open */
    vec *next;               /* [n] N, out of seam_close */
};

/* The contacts that the seams of a world are in the loop. */
static inline int64_t seams_contacts(const struct seams *s)
{
    return s->n + s->n_hinges;
}

struct lagrange {
    struct coulomb law;  /* its streams; contacts are the response's */
    struct joint joint;  /* the linear systems */
    vec *rest;           /* [nc] N·s, what the motion without contact lacks */
    sym *bound[2];       /* [nv] kg, of law and of the preconditioner */
    int held;            /* which of them is the preconditioner's */
    vec *jump;           /* [nc] m/s, of struck contacts, §5; NULL: not kept */
    sym *bare;           /* [nv] 0: no contact's part, for the system of jump */
    int32_t *none;       /* [nv + 1] 0: no contact's lists, likewise */
    struct pool kept[2]; /* struct kept: of the state, and of this slice */
    int64_t n_kept[2];
    struct pool resting; /* struct kept: of cloths that are asleep */
    int64_t n_resting;
    int64_t cap;     /* contacts that the scratch is for */
    bool begun;      /* the cloths' motion of this slice is the loop's alone */
    bool solved;     /* the loop has run in this slice */
    bool struck;     /* jump holds what contacts struck */
    bool newton;     /* springs are linearised anew at each iterate, §4 */
    int solves;      /* out: linear systems of this slice */
    int iterations;  /* out: of their solves */
    int renewals;    /* out */
    int outcome;     /* out: or of enum drape_outcome */
    double residual; /* out: what is not in balance, relative, §3.4 */
    double seconds;  /* out */
};

/* Of a slice that was tried before nothing stays: where the next one meets
 * nothing there is no solve that would replace it. */
void lagrange_forget(struct world *w);
/* Begins a slice whose contacts take part from the start: the cloths are where
 * they go by themselves, unsolved. DRAPE_OK or the status of a stage. */
int lagrange_begin(struct world *w);
/* Response's solve; user is the world. near: pairs near at the slice's start.
 */
int lagrange_solve(void *user, const struct pairs *close);
/* Keeps the end of the motion for the past of BDF2 (implicit.md §4): what
 * rounds of impulses change then is a jump. */
void lagrange_note(struct world *w);
/* The slice becomes the state. */
void lagrange_commit(struct world *w);

#endif
