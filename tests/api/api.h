/* SPDX-License-Identifier: Apache-2.0 */
/* Helpers shared by the tests of the API's refusals. */
#ifndef TESTS_API_H
#define TESTS_API_H

#include "tests/api/guest.h"

/* Integers out of range: -1, and the extremes of the type. */
extern const int api_extremes[];
extern const int64_t api_wide[];
enum { EXTREMES = 3 };

#define REFUSES(call)                                                          \
    do {                                                                       \
        EXPECT((call) == DRAPE_EARG);                                          \
        ran(1);                                                                \
    } while (0)
/* The call is refused for each of these values of `lvalue`. */
#define REFUSES_EACH(values, lvalue, call)                                     \
    for (int k_ = 0; k_ < EXTREMES; k_++) {                                    \
        lvalue = (values)[k_];                                                 \
        REFUSES(call);                                                         \
    }

/* The scene of tests/api/guest.h, with a pin and a motion of two keys. */
struct input {
    struct guest g;
    drape_pin pin;
    drape_motion motion;
    double time[2], position[2][3], rotation[2][4], frame[8][3];
};

/* The arguments of the calls. */
struct api {
    struct input input;
    drape_world *world;
    drape_mesh mesh;
    double x[4][3];
    const double (*at)[3]; /* x */
    int32_t tri[1][3];
};

void api_input(struct input *d);

/* Numbers that no definition has. */
extern const double api_wrong[];
enum { WRONG = 4 };

/* A writer that fails, and a reader of a file of zeros. */
drape_write api_write_none;
drape_read_bytes api_read_zeros;

/* Faults that drape_create refuses; in tests/api/api_create.c. */
const char *api_call_create(struct api *a);
/* Faults that the calls on a mesh refuse; in tests/api/api_mesh.c. */
const char *api_call_audit(struct api *a);
const char *api_call_ccd(struct api *a);
const char *api_call_frames(struct api *a);
/* Faults that live control refuses; in tests/api/api_control.c. */
const char *api_call_gravity(struct api *a);
const char *api_call_material(struct api *a);
const char *api_call_state(struct api *a);
const char *api_call_pins(struct api *a);
const char *api_call_obstacle(struct api *a);
const char *api_call_bodies(struct api *a);
const char *api_call_contacts(struct api *a);
const char *api_call_log(struct api *a);

#endif
