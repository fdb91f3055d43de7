/* SPDX-License-Identifier: Apache-2.0 */
/* What a step costs on machines where steps were measured: a constant, so much
 * a particle and so much a contact. */
#ifndef APP_TOOL_SPEED_H
#define APP_TOOL_SPEED_H

#include <stddef.h>

/* A row of bench/MACHINE/speed.csv, which bench/speed.py writes. */
struct speed {
    char machine[64], backend[8], date[16];
    int threads, bits; /* threads 0: a device */
    double none[2];    /* nothing touches: ms, ms a million particles */
    double near[3];    /* else: the same, and ms a million contacts */
    double low, high;  /* measured by estimated: 10th and 90th percentile */
    int steps;         /* that were measured */
};

/* Reads the rows of a file, or with NULL those that drape was built with; up to
 * `room`. Returns how many, at least 1; -1 after one line of error: the file
 * cannot be read, has no row, too many, or one that is none. */
int speed_read(const char *path, struct speed *rows, int room);

/* The estimate of a step, ms. */
double speed_step(const struct speed *speed, double particles, double contacts);

#endif
