/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the name that was probably meant by a wrong one. */
#ifndef APP_NEAREST_H
#define APP_NEAREST_H

/* The best of the names that were tried; `word` and zeros begin it. */
struct nearest {
    const char *word; /* the wrong name */
    const char *name; /* out: NULL where no name is near */
    int distance;     /* out: edits between them */
};
/* Tries a name: it is near if at most two edits (Levenshtein 1966) part it from
 * the word and not all of its letters change. The first of equals stays. */
void nearest_try(struct nearest *nearest, const char *name);

#endif
