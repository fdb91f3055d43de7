/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the name that was probably meant by a wrong one. */
#ifndef APP_BASE_NEAREST_H
#define APP_BASE_NEAREST_H

/* The best of the names that were tried; `word` and zeros begin it. */
struct nearest {
    const char *word; /* the wrong name */
    const char *name; /* out: NULL where no name is near */
    int distance;     /* out: edits between them */
};
/* Tries a name: it is near if at most two edits (Levenshtein 1966), but for
 * capital letters, part it from the word and not all of its letters change. The
 * first of equals stays. */
void nearest_try(struct nearest *nearest, const char *name);

/* The next name, from row *k of a table on, that a word of other programs goes
 * by here, or NULL; *k moves on. *in: the key whose object has this name, or
 * NULL. app/base/hints.c */
const char *hint_name(const char *word, int *k, const char **in);
/* What is asked for by this word and drape cannot do yet: the end of the
 * sentence `drape cannot …`, or NULL. */
const char *hint_missing(const char *word);

#endif
