/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes: reads a JSON file (app/scenes/README.md) into a drape_def. */
#ifndef APP_SCENE_SCENE_H
#define APP_SCENE_SCENE_H

#include "app/read/apart.h"
#include "app/read/mesh.h"
#include "app/scene/look.h"

#include <drape.h>
#include <stdio.h>

struct camera {
    double eye[3], target[3]; /* m; the same: chosen by the picture */
    double fov;               /* degrees, of the picture's height; 0: unset */
    double turn;              /* degrees a second, about the target */
    double sun[3];            /* towards it; 0: by the camera */
    double light;             /* strength of the sun */
    double floor[3];          /* colour, sRGB */
};

/* A seam of a garment, beside its points in def.seams. */
struct scene_seam {
    char *name;           /* of both edges */
    bool dart;            /* its edges are of one panel and meet */
    bool across;          /* garment_across */
    bool around;          /* garment_is_around */
    double cell;          /* m, side of the garment's cells */
    const double *length; /* [n] m, of the seam that each point stands for */
};

/* Particles of a panel's border that `drape sew` holds where they are once the
 * garment is worn. */
struct scene_attach {
    char *name;      /* of the panel and the label */
    int cloth;       /* the panel */
    bool world;      /* held there; else beside the nearest body, with it */
    double strength; /* N per metre of border, by which it is held at most; 0:
                        it holds whatever pulls */
    double until;    /* s after it is worn; INFINITY: it stays held */
    double spacing;  /* m of border a point */
    int64_t n;
    int32_t *particle; /* [n] */
};

struct scene {
    drape_def def;
    char file[4096]; /* path as given */
    char *name;
    int frames; /* to make */
    int steps_per_frame;
    double memory; /* GB that the library may hold */
    struct camera camera;
    /* Names, NULL-terminated: [n_cloths], [n_obstacles], [n_motions]. */
    char **cloth_name, **obstacle_name, **motion_name;
    struct look *cloth_look, *obstacle_look; /* as many */
    int **pin_from; /* [n_cloths][n_pins] index in the file's list of pins */
    struct scene_seam *seam;     /* [def.n_seams] */
    struct scene_attach *attach; /* [attaches] */
    int attaches;
    int hidden; /* of the cloths, the last of def's: they hold others, and no
                   file shows them */
    int garments, *garment_cloth; /* [garments + 1] where each one's cloths
                                     begin */
    bool *garment_sewn;           /* [garments] it begins where a mesh has it */
    bool unsewn; /* some seams are as far apart as their pattern places them */
    double particles;          /* sum over all cloths */
    int64_t degenerate;        /* obstacle triangles without area */
    struct parted_list parted; /* what of obstacles gives way */
    struct pool pool;          /* owns all that def points to */
    struct budget {
        size_t held, most;
    } budget;   /* of def.allocator */
    int status; /* of drape_create, in scene_create */
};

/* Reads a scene file. Returns APP_OK; or prints one line that says what is
 * wrong and returns the exit code. The caller calls scene_free in both cases.
 */
int scene_load(struct scene *scene, const char *file);
/* Reads a scene from a text of `size` bytes that ends with a 0. Messages name
 * it `file`, and relative paths in it begin in the folder of that file. */
int scene_load_text(struct scene *scene, const char *text, size_t size,
                    const char *file);
void scene_free(struct scene *scene);
/* Writes the scene's plain keys, given or default, as JSON. */
void scene_settings(FILE *out, const struct scene *scene);

/* Returns the integrator's name in a scene file. */
const char *scene_integrator(const struct scene *scene);

/* Options of the command line that replace settings of a scene; -1: the option
 * was not given. */
struct overrides {
    const char *backend; /* ref, gpu or NULL */
    int precision, threads, block, allow_intersecting;
};
/* Makes the world of a scene within the scene's limit of memory. Returns
 * APP_OK; or, if the library refuses, prints one line that says why and returns
 * the exit code. */
int scene_create(struct scene *scene, const struct overrides *overrides,
                 drape_world **world);
/* Says what of a scene has no effect on the world that was made of it. */
void scene_idle(const struct scene *scene, const struct overrides *overrides);

#endif
