/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth as a scene's file describes it, and its definition for the library.
 */
#ifndef APP_SCENE_CLOTH_H
#define APP_SCENE_CLOTH_H

#include "app/read/json.h"
#include "app/scene/look.h"
#include "app/scene/shapes.h"

#include <drape.h>

/* A disc x, y, r or a rectangle x0, y0, x1, y1 at rest; r < 0: none. */
struct region {
    double disc[3], rect[4];
};
struct regions {
    struct region *list;
    int count;
};
struct pin {
    int edge, motion;    /* edge: 0 … 3, -1: none */
    int outline;         /* of a panel: the pattern's edge, -1: none */
    double at[2], every; /* m at rest */
};
/* A cloth that is a panel of a sewing pattern. The library's part is the first,
 * as Python finds the others by it. */
struct cloth_panel {
    drape_panel panel;
    uint8_t *cell;             /* [(m - 1) (n - 1)] the panel's */
    const double (*placed)[3]; /* [m n] m, where the pattern places it */
    double at[2];              /* m, in the pattern: rest is from there */
    uint8_t *there;            /* [m n] 1: there is such a particle */
    int32_t (*edge)[2]; /* [m n] edges of the pattern's panel that the particle
                           is on, -1: none */
    int edges;          /* of the panel */
};
struct cloth {
    drape_cloth out;
    struct cloth_panel *panel; /* NULL: a rectangle */
    char *name;
    struct look look;
    double particles[2], size[2], velocity[3];
    struct start start;
    struct regions holes, cuts;
    struct pin *pins;
    int n_pins;
    int *pin_from; /* [out.n_pins] index in pins of the pin it comes from */
};

/* How edges with a label are held: the key `attach` of a garment. */
struct attach_key {
    char *label;
    int world, hard;        /* 1 each: not to a body; by any force */
    double strength, until; /* struct scene_attach */
};
struct attach_list {
    struct attach_key *key; /* [count] */
    int count;
    bool given; /* false: what a garment is held by of itself */
};

/* A garment as a scene's file describes it. */
struct garment_key {
    char *pattern, *name, *sewn;
    double cell, at[3];
    drape_material material;
    struct look look;
    struct attach_list attach;
    /* out: */
    int cloths, seams, helds;
    struct cloth *cloth;       /* [cloths] */
    drape_seam *seam;          /* [seams] cloths from 0 */
    struct scene_seam *about;  /* [seams] */
    struct scene_attach *held; /* [helds] cloths from 0 */
};

/* Reads the key `attach`; out: struct attach_list. */
json_reader read_attach;
/* Refuses a label that no edge has. Returns app_exit. */
struct pattern;
int attach_check(struct json *json, const struct pattern *pattern,
                 const struct attach_list *list);
/* Finds the particles of a garment, whose cloths and seams are made, that are
 * held. Returns app_exit; a failure prints one line. */
struct garment;
int attach_garment(struct json *json, const struct garment *garment,
                   struct garment_key *key);

/* Fills cloth->out's start, holes, cuts and pins. Returns app_exit; a fault in
 * the description prints one line. */
int cloth_sew(struct json *json, struct cloth *cloth);

/* Reads the key `panel` of a cloth and cuts the panel; out: struct cloth. Sets
 * its particles and its size. */
json_reader read_panel;

/* Keeps in the pool what a cloth needs of a panel that was cut, and sets the
 * cloth's particles and size. APP_OK, or APP_FAILED after one line. */
struct garment_panel;
int panel_keep(struct pool *pool, const struct garment_panel *p,
               struct cloth *cloth);
/* Adds to a panel that is kept what a seam eases. Returns app_exit. */
struct cut;
struct cut_seam;
int panel_ease(struct pool *pool, const struct cut *cut,
               const struct cut_seam *seam, struct cloth_panel *panel);
/* Puts into path the place of a file that the scene names, which begins in the
 * scene's folder. what: the key. APP_OK, or APP_USAGE after one line. */
int find_beside(struct json *json, const char *what, const char *name,
                char path[4096]);
/* Reads a material; out: drape_material. */
json_reader read_material;

#endif
