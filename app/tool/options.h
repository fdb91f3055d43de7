/* SPDX-License-Identifier: Apache-2.0 */
/* The commands, and how they read the command line. */
#ifndef APP_TOOL_OPTIONS_H
#define APP_TOOL_OPTIONS_H

#include "app/base/app.h"

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
int command_pattern(int argc, char **argv);
int command_sew(int argc, char **argv);
int command_untangle(int argc, char **argv);
int command_materials(int argc, char **argv);
int command_export(int argc, char **argv);
int command_view(int argc, char **argv);
int command_sweep(int argc, char **argv);
int command_fetch_models(int argc, char **argv);

/* Replaces the process by Python, which runs a command of that name. Returns
 * only if that fails: the exit code, after a line that says why. */
int become_python(char *name, int argc, char **argv);

#endif
