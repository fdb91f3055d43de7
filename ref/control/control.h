/* SPDX-License-Identifier: Apache-2.0 */
/* Live control: the caller's changes between two steps, for either backend.
 * Arguments that need no world to be checked have been checked.
 * spec/control/control.md */
#ifndef REF_CONTROL_H
#define REF_CONTROL_H

#include "ref/world/state.h"

struct given;

/* §1, §2 */
void control_gravity(struct world *w, const double gravity[3]);
/* DRAPE_OK; DRAPE_ENOMEM or DRAPE_EDEVICE if a world that had no air has no
 * memory for it: then nothing has changed. */
int control_wind(struct world *w, const drape_wind *wind);
/* DRAPE_OK; DRAPE_EARG if the cells are too oblong for the material;
 * DRAPE_ELIMIT if it needs more substeps than max_substeps. */
int control_material(struct world *w, int cloth, const drape_material *m);
/* §2 DRAPE_OK; DRAPE_EDATA; DRAPE_ESTART and a text if the positions intersect;
 * DRAPE_ENOMEM, DRAPE_EDEVICE. Vertices first … first + n - 1 are of cloths. */
int control_positions(struct world *w, int64_t first, int64_t n, struct given x,
                      drape_error *error);
int control_velocities(struct world *w, int64_t first, int64_t n,
                       struct given v);

/* §4 DRAPE_OK; DRAPE_EARG for a particle that is out of range, missing or named
 * twice; DRAPE_EDATA, DRAPE_ELIMIT, DRAPE_ENOMEM, DRAPE_EDEVICE. */
int control_pins(struct world *w, int cloth, int64_t n, const int32_t *particle,
                 struct given x);
/* §5 DRAPE_OK, DRAPE_EDATA, DRAPE_ENOMEM, DRAPE_EDEVICE. */
int control_obstacle(struct world *w, int obstacle, struct given x);
/* §5 `motion` has one key. Also DRAPE_EARG for an obstacle with frames. */
int control_pose(struct world *w, int obstacle, const drape_motion *motion);

/* seam.md §4: the points of seam k; -1: there is no such seam. */
int64_t control_seam_points(const struct world *w, int seam);
/* Sets the targets of seam k, of n points. gap: [n], NULL: 0. DRAPE_OK,
 * DRAPE_EARG, DRAPE_EDATA or DRAPE_EDEVICE. */
int control_seam_target(struct world *w, int seam, int64_t n,
                        const double (*gap)[3]);
/* Reads seam k; gap and pull may be NULL. DRAPE_OK, DRAPE_EARG, DRAPE_EDEVICE.
 */
int control_seam_state(const struct world *w, int seam, double (*gap)[3],
                       double (*pull)[3]);
/* seam.md §5: whether triangles a and b of the scene are sewn together. */
bool control_are_sewn(const struct world *w, int32_t a, int32_t b);

/* Copies bytes from the backend's memory to the host. DRAPE_OK or
 * DRAPE_EDEVICE. */
int control_fetch(struct world *w, void *host, const void *there, size_t bytes);

/* §3: called when a step begins, and when it has been computed or has failed.
 */
void control_begin(struct world *w);
void control_end(struct world *w, bool failed);

/* §6: the part of a checkpoint that only a changed world has: words of eight
 * bytes. Returns its size, 0 for a world that is as defined; writes it to
 * `out` unless that is NULL. */
int64_t control_pack(const struct world *w, uint8_t *out);
/* Whether a part of this size, which anybody may have made, fits the world. */
bool control_fits(const struct world *w, const uint8_t *in, int64_t bytes);
/* Whether a part that fits says that the caller moves an obstacle. */
bool control_is_targeted(const struct world *w, const uint8_t *in,
                         int64_t bytes, int obstacle);
/* The largest size of a part that can fit. */
int64_t control_most(const struct world *w);
/* Makes the world as the part says; bytes: 0 for a world as defined. The part
 * fits. to: [nv] on the host, targets that were set for the next step, or
 * NULL; x: [nv] on the host, the state. DRAPE_OK, or DRAPE_ENOMEM and nothing
 * has changed; DRAPE_EDATA if a material does not go with the cloth. */
int control_unpack(struct world *w, const uint8_t *in, int64_t bytes,
                   const vec *to, const vec *x);

/* §9.2: makes an edited world, which has the state of the old world, as that
 * was changed. DRAPE_OK, DRAPE_ENOMEM or DRAPE_EDEVICE. */
int control_inherit(struct world *w, const struct edited *edited);

#define CONTROL_OPS                                                            \
    {                                                                          \
        control_gravity, control_material, control_positions,                  \
            control_velocities, control_pins, control_obstacle, control_pose,  \
            control_fetch, control_seam_points, control_seam_target,           \
            control_seam_state, control_are_sewn                               \
    }

/* For the files of live control alone. */

/* A step has ended: the targets of seams are where the next one starts. */
void control_end_seams(struct world *w);

/* Takes the streams of §3. Some may have been taken by an earlier call that
 * then ran out of memory. DRAPE_OK or DRAPE_ENOMEM. */
int control_take_targets(struct world *w);
/* Marks in fixed [count] the missing particles and n pins. DRAPE_OK, or
 * DRAPE_EARG for a particle that is out of range, missing or named twice. */
int control_mark(const struct cloth *c, int64_t n, const int32_t *particle,
                 uint8_t *fixed);
/* Takes the streams of n pins and copies their particles. DRAPE_OK or
 * DRAPE_ENOMEM. */
int control_make_pins(struct world *w, int64_t n, const int32_t *particle,
                      struct caller_pins *pins);
void control_drop_pins(struct world *w, struct caller_pins *pins);

/* Brings the streams of cloth k, which changed on the host, up to date,
 * and the numbers of the scene that depend on them. */
void control_tell_cloth(struct world *w, int k);
/* Converts n given vectors into `to`, a stream of the backend, through the
 * host's stream `stage`, or takes `old` if none are given. DRAPE_OK or
 * DRAPE_EDATA. */
int control_take(struct world *w, struct given a, int64_t n, vec *stage,
                 vec *to);

#endif
