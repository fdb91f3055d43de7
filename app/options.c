/* SPDX-License-Identifier: Apache-2.0 */
/* The command line: messages and a table of options. */
#include "app/app.h"

#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int complain(int code, const char *format, ...)
{
    char line[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    /* text from a file must not break the line or control the terminal */
    for (char *p = line; *p; p++)
        if ((unsigned char)*p < 32 || *p == 127)
            *p = '?';
    fprintf(stderr, "drape: %s\n", line);
    return code;
}

/* Reads a decimal integer within the row's range, or returns APP_USAGE. */
static int read_int(const struct option *row, const char *text)
{
    char *end;
    errno = 0;
    long value = strtol(text, &end, 10);
    if (end == text || *end || errno || value < row->lo || value > row->hi)
        return complain(APP_USAGE,
                        "%s %s: expected a whole number from %ld "
                        "to %ld",
                        row->name, text, row->lo, row->hi);
    *(int *)row->out = (int)value;
    return APP_OK;
}

/* Reads the option at argv[*k] and its value; *k becomes the last argument
 * used.
 */
static int read_option(const struct option *table, int argc, char **argv,
                       int *k)
{
    const char *name = argv[*k];
    const struct option *row = table;
    while (row->name && strcmp(row->name, name) != 0)
        row++;
    if (!row->name)
        return complain(APP_USAGE, "%s: unknown option (try: drape help)",
                        name);
    if (row->type == OPTION_FLAG) {
        *(int *)row->out = 1;
        return APP_OK;
    }
    if (*k + 1 >= argc)
        return complain(APP_USAGE, "%s: expected a value after it", name);
    const char *value = argv[++*k];
    if (row->type == OPTION_INT)
        return read_int(row, value);
    if (!*value)
        return complain(APP_USAGE, "%s: expected a value, not an empty text",
                        name);
    *(const char **)row->out = value;
    return APP_OK;
}

int options_read(const struct option *table, int argc, char **argv,
                 int *positional)
{
    *positional = 0;
    bool ended = false;
    for (int k = 0; k < argc; k++) {
        if (!ended && strcmp(argv[k], "--") == 0) {
            ended = true;
            continue;
        }
        if (!*argv[k])
            return complain(APP_USAGE,
                            "argument %d: expected a name, not an empty text",
                            k + 1);
        if (ended || argv[k][0] != '-' || !argv[k][1]) {
            argv[(*positional)++] = argv[k];
            continue;
        }
        int status = read_option(table, argc, argv, &k);
        if (status != APP_OK)
            return status;
    }
    return APP_OK;
}
