/* SPDX-License-Identifier: Apache-2.0 */
/* Public data that is no part of the project, as ci/data.sh lays it out:
 * models/, ccd/queries/ and ccd/frames/ in the folder that the environment
 * variable DRAPE_DATA names. A test without its data is skipped. */
#ifndef TESTS_DATA_H
#define TESTS_DATA_H

#include <stdio.h>
#include <stdlib.h>

/* Ends the reason of a test that is skipped without its data. */
#define FETCHED " (sh ci/data.sh DIR fetches it; set DRAPE_DATA=DIR)"

/* The folder; build/data where DRAPE_DATA is not set. */
static inline const char *data_home(void)
{
    const char *home = getenv("DRAPE_DATA");
    return home && *home ? home : "build/data";
}

/* A file of the folder, open for reading; NULL if there is none. */
static inline FILE *data_open(const char *name)
{
    char path[512];
    int n = snprintf(path, sizeof path, "%s/%s", data_home(), name);
    return n < (int)sizeof path ? fopen(path, "r") : NULL;
}

#endif
