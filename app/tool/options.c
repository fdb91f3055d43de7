/* SPDX-License-Identifier: Apache-2.0 */
/* The command line, by a table of options. */
#include "app/tool/options.h"
#include "app/base/nearest.h"

#include <errno.h>
#include <getopt.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Reads a decimal integer within the row's range, or returns APP_USAGE. */
static int read_int(const struct option_row *row, const char *text)
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

/* Reads a precision. */
static int read_bits(const struct option_row *row, const char *text)
{
    if (strcmp(text, "32") != 0 && strcmp(text, "64") != 0)
        return complain(APP_USAGE, "%s %s: expected 32 or 64", row->name, text);
    *(int *)row->out = atoi(text);
    return APP_OK;
}

/* Sets what the row points to; value is NULL for a flag. */
static int read_value(const struct option_row *row, const char *value)
{
    if (row->type == OPTION_FLAG)
        *(int *)row->out = 1;
    else if (row->type == OPTION_INT)
        return read_int(row, value);
    else if (row->type == OPTION_BITS)
        return read_bits(row, value);
    else if (!*value)
        return complain(APP_USAGE, "%s: expected a value, not an empty text",
                        row->name);
    else
        *(const char **)row->out = value;
    return APP_OK;
}

enum { ROWS_MOST = 30, QUIET = 255, FIRST = 256 };

/* The table in getopt's form: row k answers FIRST + k. */
static void make_longs(const struct option_row *table,
                       struct option longs[ROWS_MOST + 2])
{
    int k = 0;
    for (; table[k].name && k < ROWS_MOST; k++)
        longs[k] = (struct option){
            table[k].name + 2,
            table[k].type == OPTION_FLAG ? no_argument : required_argument,
            NULL, FIRST + k};
    longs[k] = (struct option){"quiet", no_argument, NULL, QUIET};
    longs[k + 1] = (struct option){0};
}

/* Refuses an option that is not in the table, or begins several names. */
static int refuse(const struct option_row *all, const char *text)
{
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
    struct nearest nearest = {.word = name};
    int begun = 0;
    for (const struct option_row *row = all; row->name; row++) {
        nearest_try(&nearest, row->name);
        begun += strncmp(row->name, name, strlen(name)) == 0;
    }
    nearest_try(&nearest, "--quiet");
    int k = 0;
    const char *in, *what = hint_missing(name);
    const char *other = hint_name(name, &k, &in);
    for (const struct option_row *row = all; other && row->name; row++)
        if (strcmp(row->name, other) == 0 || strcmp("--quiet", other) == 0)
            nearest = (struct nearest){name, other, 0};
    if (what)
        return complain(APP_USAGE,
                        "%s: unknown option: drape cannot %s yet "
                        "(spec/limits.md)",
                        name, what);
    if (begun > 1)
        return complain(APP_USAGE, "%s: is the beginning of %d options", name,
                        begun);
    if (nearest.name)
        return complain(APP_USAGE, "%s: unknown option; did you mean %s?", name,
                        nearest.name);
    return complain(APP_USAGE, "%s: unknown option (try: drape help)", name);
}

/* What getopt_long could not read: a value that lacks or is too much, or an
 * unknown option. `all` is what it was reading. */
static int explain(const struct option_row *table, int answer, char *const *all)
{
    if (answer == ':' && optopt >= FIRST)
        return complain(APP_USAGE, "%s: expected a value after it",
                        table[optopt - FIRST].name);
    if (optopt >= FIRST || optopt == QUIET)
        return complain(APP_USAGE, "%s: takes no value", all[optind - 1]);
    if (optopt) {
        const char name[] = {'-', (char)optopt, 0};
        return refuse(table, name);
    }
    return refuse(table, all[optind - 1]);
}

/* Reads all[1 … count) and gathers the positional arguments in argv, which all
 * is a copy of. */
static int read_all(const struct option_row *table, int count, char **all,
                    char **argv, int *positional)
{
    struct option longs[ROWS_MOST + 2];
    make_longs(table, longs);
    opterr = 0;
    optind = 0; /* glibc: begin anew */
    for (;;) {
        /* "-": positional arguments come in their order, as answer 1 */
        int answer = getopt_long(count, all, "-:", longs, NULL);
        int status = APP_OK;
        if (answer == -1)
            break;
        if (answer == 1 && !*optarg)
            status = complain(APP_USAGE,
                              "argument %d: expected a name, not an empty text",
                              optind - 1);
        else if (answer == 1)
            argv[(*positional)++] = optarg;
        else if (answer == QUIET)
            app_quiet = true;
        else if (answer >= FIRST)
            status = read_value(&table[answer - FIRST], optarg);
        else
            status = explain(table, answer, all);
        if (status != APP_OK)
            return status;
    }
    for (; optind < count; optind++) /* after `--` */
        argv[(*positional)++] = all[optind];
    return APP_OK;
}

int options_read(const struct option_row *table, int argc, char **argv,
                 int *positional)
{
    *positional = 0;
    char **all = calloc((size_t)argc + 2, sizeof *all);
    if (!all)
        return complain(APP_FAILED, "out of memory");
    for (int k = 0; k < argc; k++)
        all[k + 1] = argv[k];
    all[0] = "drape";
    int status = read_all(table, argc + 1, all, argv, positional);
    free(all);
    return status;
}

int options_none(const char *command, int argc, char **argv)
{
    static const struct option_row none[] = {{0}};
    int positional;
    int status = options_read(none, argc, argv, &positional);
    if (status == APP_OK && positional)
        return complain(APP_USAGE, "%s takes no argument", command);
    return status;
}
