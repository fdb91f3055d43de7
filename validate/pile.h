/* SPDX-License-Identifier: Apache-2.0 */
/* Several cloths and what they touch in one world: what the parts layers, grip,
 * belt, impact and converge are made of. spec/validation.md §13 */
#ifndef VALIDATE_PILE_H
#define VALIDATE_PILE_H

#include "validate/validate.h"

enum { PILE_CLOTHS = 32, PILE_BODIES = 2, PILE_MOTIONS = 4, PILE_KEYS = 32 };

/* Filled by pile_make and the functions that add; pile_start makes the world.
 */
struct pile {
    drape_def def;
    drape_material material; /* of cloths that are added */
    drape_cloth cloth[PILE_CLOTHS];
    drape_obstacle obstacle[PILE_BODIES];
    drape_motion motion[PILE_MOTIONS];
    double (*place[PILE_CLOTHS])[3]; /* of cloths, where they start */
    double (*speed[PILE_CLOTHS])[3]; /* how fast they start */
    drape_pin *pin[PILE_CLOTHS];
    double (*corner[PILE_BODIES])[3];
    int32_t (*face[PILE_BODIES])[3];
    double time[PILE_MOTIONS][PILE_KEYS]; /* of motions */
    double way[PILE_MOTIONS][PILE_KEYS][3];
    drape_world *world;
    double (*x)[3], (*u)[3]; /* of all vertices, after the last step */
    drape_contact_list list; /* after pile_contacts */
    drape_step_report report;
    int64_t steps, iterations;
};

/* A way to integrate, of those that are implicit. */
struct scheme {
    const char *name;
    int integrator, newton;
};
enum { SCHEMES = 4 };
extern const struct scheme schemes[SCHEMES];

/* An empty pile with the defaults of the library; only sleep is off. */
void pile_make(const struct validate *v, struct pile *p,
               const struct scheme *how, double dt);
/* Adds m × n particles in square cells of side h, level, whose corner is at
 * `at`, i along x and j along z. Returns its number. */
int pile_sheet(struct pile *p, int m, int n, double h, const double at[3]);
/* Pins a particle; motion: -1 or a number. */
void pile_pin(struct pile *p, int cloth, int i, int j, int motion);
/* Adds an obstacle of so many vertices and triangles, which the caller writes
 * to p->corner and p->face. Returns its number. */
int pile_body(struct pile *p, int vertices, int triangles, double friction);
/* Adds a level square of 12 m in two triangles at height 0. */
int pile_floor(struct pile *p, double friction);
/* Adds a box between two corners. */
int pile_box(struct pile *p, const double lo[3], const double hi[3],
             double friction);
/* Adds the mantle of a drum along z of this radius and half length: so many
 * facets, whose edges are on the round drum. */
int pile_drum(struct pile *p, double radius, double half, int facets,
              double friction);
/* Adds a motion that goes by 0 until `from`, then at this velocity until `to`,
 * after it has sped up for `ramp`. Returns its number. */
int pile_motion(struct pile *p, double from, double to, double ramp,
                const double velocity[3]);
/* Makes the world. False after a line on standard error. */
bool pile_start(struct pile *p);
/* One step; false: it failed or diverged, or there is no world. */
bool pile_step(struct pile *p);
/* Steps until this time since the start. */
bool pile_until(struct pile *p, double time);
/* Reads p->list of the last step. */
bool pile_contacts(struct pile *p);
/* The mean of positions, or of velocities, of a cloth by mass. */
void pile_mean(const struct pile *p, int cloth, double (*of)[3], double out[3]);
/* What a cloth weighs, kg. */
double pile_mass(const struct pile *p, int cloth);
/* The thickness that counts in contact: at most half a cell. */
double pile_thickness(const struct pile *p, int cloth);
void pile_free(struct pile *p);

/* A row of which up to SIZES values follow; its bar holds at all sizes. */
struct property pile_row(const char *part, const char *name, const char *unit,
                         double theory, double bar);

#endif
