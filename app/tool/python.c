/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the commands that are written in Python
 * (python/drape): the process replaces itself by a Python interpreter. */
#include "app/tool/options.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The Python program that runs the command named by its first argument, whose
 * forms have a hyphen behind the command's own name. It takes the working
 * directory out of the module path, so that a file that lies there cannot stand
 * in for one of Python's own modules. */
static char program[] =
    "import sys\n"
    "sys.path[:] = [p for p in sys.path if p]\n"
    "try:\n"
    "    from drape.__main__ import main\n"
    "except ImportError as error:\n"
    "    name = sys.argv[1].partition('-')[0]\n"
    "    print(f'drape: {name}: python3 cannot import the package drape "
    "({error}). In its source: make venv, then build/venv/bin/drape "
    "{name}', file=sys.stderr)\n"
    "    sys.exit(3)\n"
    "sys.exit(main(sys.argv[1:]))\n";

int become_python(char *name, int argc, char **argv)
{
    char **words = calloc((size_t)argc + 6, sizeof *words);
    if (!words)
        return complain(APP_FAILED, "out of memory");
    words[0] = "python3";
    words[1] = "-c";
    words[2] = program;
    int count = 3;
    words[count++] = name;
    if (app_quiet) /* it may have stood before the command */
        words[count++] = "--quiet";
    if (argc)
        memcpy(words + count, argv, (size_t)argc * sizeof *words);
    execvp(words[0], words);
    int fault = errno;
    free(words);
    return complain(
        APP_FAILED,
        "%.*s: python3 cannot be started: %s; this command is part of "
        "the Python package drape",
        (int)strcspn(name, "-"), name, strerror(fault));
}

/* Checks the arguments, so that a wrong command line is refused as by any other
 * command, whether or not there is Python. The package reads them again. */
static int check(const struct option_row *table, int argc, char **argv,
                 const char *expected)
{
    int positional;
    char **copy = calloc((size_t)argc + 1, sizeof *copy);
    if (!copy)
        return complain(APP_FAILED, "out of memory");
    for (int k = 0; k < argc; k++)
        copy[k] = argv[k];
    int status = options_read(table, argc, copy, &positional);
    free(copy);
    if (status == APP_OK && positional != 1)
        return complain(APP_USAGE, "%s", expected);
    return status;
}

int command_export(int argc, char **argv)
{
    const char *to = NULL;
    int every;
    const struct option_row options[] = {
        TEXT_OPTION("--to", &to),
        INT_OPTION("--every", &every, 1, 1000000),
        {0}};
    int status =
        check(options, argc, argv, "export: expected one DIR, a run's");
    if (status == APP_OK && !to)
        status = complain(APP_USAGE, "export: expected --to FILE");
    return status == APP_OK ? become_python("export", argc, argv) : status;
}

int command_view(int argc, char **argv)
{
    const char *host;
    int port, paused;
    const struct option_row options[] = {INT_OPTION("--port", &port, 0, 65535),
                                         FLAG_OPTION("--paused", &paused),
                                         TEXT_OPTION("--host", &host),
                                         {0}};
    int status = check(options, argc, argv,
                       "view: expected one DIR, a run's, SCENE.json, or MESH");
    return status == APP_OK ? become_python("view", argc, argv) : status;
}

int command_sweep(int argc, char **argv)
{
    const char *text;
    int number, flag;
    const struct option_row options[] = {
        TEXT_OPTION("--out", &text),
        TEXT_OPTION("--set", &text),
        TEXT_OPTION("--draw", &text),
        INT_OPTION("--count", &number, 1, 1000000),
        INT_OPTION("--seed", &number, 0, 1000000000),
        INT_OPTION("--frames", &number, 0, 1000000),
        INT_OPTION("--every", &number, 0, 1000000),
        INT_OPTION("--workers", &number, 1, 100000),
        FLAG_OPTION("--sew", &flag),
        TEXT_OPTION("--on", &text),
        TEXT_OPTION("--option", &text),
        {0}};
    int status = check(options, argc, argv, "sweep: expected one SCENE.json");
    return status == APP_OK ? become_python("sweep", argc, argv) : status;
}
