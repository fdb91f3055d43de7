/* SPDX-License-Identifier: Apache-2.0 */
/* Estimates what a step costs from measured constants: speed.h. */
#include "app/speed.h"

#include "app/app.h"
#include "app/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The rows of ci/bench/.../speed.csv, a literal each. */
static const char built_in[] =
#include "speed.inc"
    ;

static bool read_row(const char *line, struct speed *s)
{
    int end = 0;
    int n = sscanf(line,
                   "%63[^,\n],%7[^,\n],%15[^,\n],%d,%d,%lf,%lf,%lf,%lf,%lf,%lf,"
                   "%lf,%d%n",
                   s->machine, s->backend, s->date, &s->threads, &s->bits,
                   &s->none[0], &s->none[1], &s->near[0], &s->near[1],
                   &s->near[2], &s->low, &s->high, &s->steps, &end);
    return n == 13 && (line[end] == '\n' || line[end] == '\0');
}

int speed_read(const char *path, struct speed *rows, int room)
{
    char *text = NULL;
    size_t size;
    if (path && !(text = file_read(path, &size)))
        return -1;
    int n = 0, number = 1;
    const char *line = text ? text : built_in;
    const char *head = text ? strchr(line, '\n') : NULL; /* the names */
    for (line = head ? head + 1 : line; line && *line && n < room; number++) {
        if (!read_row(line, &rows[n++])) {
            complain(APP_USAGE,
                     "%s: line %d: expected a row of speed.csv, as "
                     "ci/bench/speed.py writes it",
                     path ? path : "speed.inc", number + (head != NULL));
            free(text);
            return -1;
        }
        line = strchr(line, '\n');
        line = line ? line + 1 : NULL;
    }
    free(text);
    return n;
}

double speed_step(const struct speed *s, double particles, double contacts)
{
    double p = particles / 1e6, c = contacts / 1e6;
    if (contacts <= 0)
        return s->none[0] + s->none[1] * p;
    return s->near[0] + s->near[1] * p + s->near[2] * c;
}
