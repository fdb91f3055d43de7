/* SPDX-License-Identifier: Apache-2.0 */
/* Estimates what a step costs from measured constants: speed.h. */
#include "app/tool/speed.h"

#include "app/base/app.h"
#include "app/base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The rows of bench/.../speed.csv, a literal each. */
static const char built_in[] =
#include "speed.inc"
    ;

static bool read_row(const char *line, struct speed *s)
{
    int end;
    int n = sscanf(line,
                   "%63[^,\n],%7[^,\n],%15[^,\n],%d,%d,%lf,%lf,%lf,%lf,%lf,%lf,"
                   "%lf,%d%n",
                   s->machine, s->backend, s->date, &s->threads, &s->bits,
                   &s->none[0], &s->none[1], &s->near[0], &s->near[1],
                   &s->near[2], &s->low, &s->high, &s->steps, &end);
    return n == 13 && (line[end] == '\n' || line[end] == '\0');
}

/* Reads rows from `line` on, which has this number in the file. */
static int read_rows(const char *name, const char *line, int number,
                     struct speed *rows, int room)
{
    int n = 0;
    for (; line && *line; n++) {
        if (n == room || !read_row(line, &rows[n])) {
            complain(APP_USAGE,
                     n == room ? "%s: line %d: more rows than can be read"
                               : "%s: line %d: expected a row of speed.csv, as "
                                 "bench/speed.py writes it",
                     name, number + n);
            return -1;
        }
        line = strchr(line, '\n');
        line = line ? line + 1 : NULL;
    }
    if (n > 0)
        return n;
    complain(APP_USAGE, "%s: no row of a machine", name);
    return -1;
}

int speed_read(const char *path, struct speed *rows, int room)
{
    size_t size;
    if (!path)
        return read_rows("speed.inc", built_in, 1, rows, room);
    char *text = file_read(path, &size);
    if (!text)
        return -1;
    const char *head = strchr(text, '\n'); /* the names of columns */
    int n = read_rows(path, head ? head + 1 : NULL, 2, rows, room);
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
