/* SPDX-License-Identifier: Apache-2.0 */
/* Sewing patterns in GarmentCode's JSON: app/patterns/README.md §1. */
#ifndef APP_READ_PATTERN_H
#define APP_READ_PATTERN_H

#include "app/base/curve.h"
#include "app/base/pool.h"

struct pattern_edge {
    struct curve curve; /* m, from its first end to its second by the file */
    char *label;        /* NULL: none */
    int end[2];         /* vertices */
    int stitch;         /* that it is a side of; -1: none */
};

/* An edge as the outline runs through it. */
struct pattern_turn {
    int edge;
    bool back; /* from the edge's second end to its first */
};

struct pattern_panel {
    char *name, *label;    /* label NULL: none */
    double at[3], turn[3]; /* m; degrees about x, then y, then z */
    int vertices, edges;
    double (*vertex)[2];       /* m */
    struct pattern_edge *edge; /* in the file's order */
    struct pattern_turn *loop; /* [edges] counter-clockwise */
    struct curve *outline;     /* [edges] their curves, as the loop runs */
};

struct pattern_side {
    int panel, edge;
};

struct pattern_stitch {
    struct pattern_side side[2];
    bool turned; /* the right side of one panel meets the wrong of the other */
};

struct pattern {
    const char *file;
    double unit; /* how many of the file's lengths make a metre */
    int panels, stitches;
    struct pattern_panel *panel;   /* in the order of the file's panel_order */
    struct pattern_stitch *stitch; /* in the file's order */
};

/* Reads a pattern and checks all that does not depend on cells. Returns
 * app_exit; a failure prints one line. All memory is the pool's. */
int pattern_load(struct pool *pool, const char *path, struct pattern *pattern);

/* What an edge is, as the file names it. */
extern const char *const pattern_types[];

/* The parts of pattern_load, each in its file. */
struct json;
struct json_t;
int pattern_read_panel(struct json *json, struct json_t *node,
                       struct pattern_panel *panel, bool absolute);
int pattern_close(struct json *json, struct pattern_panel *panel);
int pattern_read_stitches(struct json *json, struct json_t *node,
                          struct pattern *pattern);
/* Reads an object's keys as json_fields does. needed: NULL-terminated, those
 * that must be there and not null. */
struct json_key;
int pattern_members(struct json *json, struct json_t *node,
                    const struct json_key *keys, void *base,
                    const char *const *needed);

#endif
