/* SPDX-License-Identifier: Apache-2.0 */
/* The contacts of a run, which --contacts asks for: a PLY file of points a
 * frame, and the impulse that each body got in each step, for report.json. */
#ifndef APP_WRITE_CONTACTS_H
#define APP_WRITE_CONTACTS_H

#include <drape.h>
#include <stdbool.h>
#include <stdio.h>

/* What each body got from contacts in the last slice of each step. */
struct impulses {
    bool on;       /* contacts are asked for */
    int bodies;    /* of the world */
    int64_t first; /* the first step of this list: those before it, which a
                      checkpoint brought, are not known */
    int64_t count, room;
    double *row; /* [count][1 + 3 bodies] the slice's length, s, then N·s */
};

/* Whether a scene's world tells contacts. APP_OK, or APP_USAGE after one line.
 */
int contacts_known(int integrator, const char *file);
/* Appends the impulses of the world's last step. Returns app_exit; a failure
 * prints one line. */
int contacts_add(struct impulses *list, drape_world *world);
void contacts_free(struct impulses *list);
/* Writes the impulses of step k, from 0, as a member of an object, if they are
 * known. */
void contacts_put(FILE *out, const struct impulses *list, int64_t k);
/* Writes the contacts of the world's last step as directory/contacts_<k>.ply,
 * of vertices at x. Returns app_exit; a failure prints one line. */
int contacts_save(drape_world *world, const char *directory, int k,
                  const double (*x)[3]);

#endif
