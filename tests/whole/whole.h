/* SPDX-License-Identifier: Apache-2.0 */
/* Small whole scenes through the public API alone. Every build of the library
 * writes the same lines about them, whatever its compiler, its flags and its
 * threads. ci/flavour.sh compares the lines. */
#ifndef TESTS_WHOLE_H
#define TESTS_WHOLE_H

#include <spec/drape.h>
#include <stdint.h>
#include <stdio.h>

enum { CLOTHS = 2, OBSTACLES = 2, MOTIONS = 2, PINS = 4, KEPT = 32 };

/* A definition and all data that it points to. */
struct show {
    drape_def def;
    drape_cloth cloth[CLOTHS];
    drape_obstacle obstacle[OBSTACLES];
    drape_motion motion[MOTIONS];
    drape_pin pin[PINS];
    double time[MOTIONS][2], way[MOTIONS][2][3], turn[MOTIONS][2][4];
    int steps;
    /* called after each step; NULL: none */
    void (*between)(struct show *s, drape_world *world, int step);
    int left; /* allocations until memory runs out, for make_starved */
    void *kept[KEPT];
    int n_kept;
};

/* A scene: its name, and the function that fills a zeroed show. */
struct scene_row {
    const char *name;
    void (*make)(struct show *s);
};
extern const struct scene_row scene_rows[];
extern const int n_scene_rows;

/* Returns zeroed memory that lives as long as the show; ends the program if
 * there is none. */
void *show_keep(struct show *s, size_t bytes);
void show_free(struct show *s);

/* Each of these adds one body at the end of the show's list and returns it. */
drape_cloth *show_cloth(struct show *s, int m, int n, double cell, double y);
drape_obstacle *show_floor(struct show *s, double y, double side);
drape_obstacle *show_box(struct show *s, double y, double side);
drape_obstacle *show_ball(struct show *s, double y, double radius, int detail);
/* Adds a motion by `way` from time 0 to `end`, with a rotation about y; `half`
 * is the sine of half its angle. Returns the index of the motion. */
int show_motion(struct show *s, double end, const double way[3], double half);
/* Pins particle (i, j) of cloth 0. */
void show_pin(struct show *s, int i, int j, int motion);
/* The next number in [-1, 1) of a fixed pseudo-random sequence. */
double show_random(uint32_t *state);

/* Runs a scene in one precision and writes a digest of each stage of each step,
 * the reports and the states. Returns false if a run from a checkpoint ends in
 * another state. */
int show_play(const struct scene_row *row, int precision, int threads,
              FILE *out);
/* Writes the results of exact queries on random and on degenerate input. */
void show_queries(int threads, FILE *out);
/* Writes the messages by which wrong definitions are refused. */
void show_refusals(FILE *out);

#endif
