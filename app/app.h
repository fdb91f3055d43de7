/* SPDX-License-Identifier: Apache-2.0 */
/* Exit codes, messages and options, shared by the tool's commands. */
#ifndef APP_APP_H
#define APP_APP_H

#include <stdbool.h>
#include <stddef.h>

enum app_exit {
    APP_OK = 0,
    APP_FINDINGS = 1, /* audit found pairs, or a step is not clean */
    APP_USAGE = 2,    /* a wrong command line or bad input */
    APP_FAILED = 3,   /* disk, memory or device at run time */
    APP_INTERRUPTED = 130
};

/* Set by --quiet: errors alone are printed. */
extern bool app_quiet;

/* Prints "drape: …" as one line on standard error and returns code. A line of
 * code 0 is a note, which --quiet suppresses. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int complain(int code, const char *format, ...);

/* Prints to standard output what a command did, unless --quiet was given. */
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
void say(const char *format, ...);

/* A table of options. An argument that is not an option is positional. */
enum option_type { OPTION_FLAG, OPTION_INT, OPTION_BITS, OPTION_TEXT };
struct option_row {
    const char *name; /* with its dashes */
    enum option_type type;
    void *out;   /* int * or, of OPTION_TEXT, const char ** */
    long lo, hi; /* of OPTION_INT */
};
#define FLAG_OPTION(name, out)                                                 \
    {                                                                          \
        name, OPTION_FLAG, out, 0, 0                                           \
    }
#define INT_OPTION(name, out, lo, hi)                                          \
    {                                                                          \
        name, OPTION_INT, out, lo, hi                                          \
    }
#define BITS_OPTION(name, out)                                                 \
    {                                                                          \
        name, OPTION_BITS, out, 0, 0                                           \
    }
#define TEXT_OPTION(name, out)                                                 \
    {                                                                          \
        name, OPTION_TEXT, out, 0, 0                                           \
    }
/* Reads argv[0 … argc) by the table (its last row has no name) and getopt_long:
 * `--name value`, `--name=value`, and a name's beginning where it is unique.
 * Every table also has --quiet. Positional arguments move to the front of argv
 * and their number goes to *positional. APP_OK, or APP_USAGE after one line
 * that names the argument. */
int options_read(const struct option_row *table, int argc, char **argv,
                 int *positional);
/* Reads the arguments of a command that takes none but --quiet. APP_OK, or
 * APP_USAGE after one line. */
int options_none(const char *command, int argc, char **argv);

/* The commands. They take the arguments after the command's name and return
 * app_exit. */
int command_run(int argc, char **argv);
int command_plan(int argc, char **argv);
int command_audit(int argc, char **argv);
int command_render(int argc, char **argv);
int command_ccd(int argc, char **argv);
int command_convert(int argc, char **argv);
int command_materials(int argc, char **argv);
int command_export(int argc, char **argv);
int command_view(int argc, char **argv);
int command_fetch_models(int argc, char **argv);

#endif
