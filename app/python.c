/* SPDX-License-Identifier: Apache-2.0 */
/* drape export and drape view, which are written in Python (python/drape): the
 * tool becomes their interpreter. */
#include "app/app.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Runs the package's command of the first argument. Modules of the working
 * directory are not taken for Python's own. */
static char program[] =
    "import sys\n"
    "sys.path[:] = [p for p in sys.path if p]\n"
    "try:\n"
    "    from drape.__main__ import main\n"
    "except ImportError as error:\n"
    "    print(f'drape: {sys.argv[1]}: python3 cannot import the package drape "
    "({error}); install its wheel', file=sys.stderr)\n"
    "    sys.exit(3)\n"
    "sys.exit(main(sys.argv[1:]))\n";

/* Returns only after a failure. */
static int become_python(char *name, int argc, char **argv)
{
    char **words = calloc((size_t)argc + 5, sizeof *words);
    if (!words)
        return complain(APP_FAILED, "out of memory");
    words[0] = "python3";
    words[1] = "-c";
    words[2] = program;
    words[3] = name;
    if (argc)
        memcpy(words + 4, argv, (size_t)argc * sizeof *words);
    execvp(words[0], words);
    int fault = errno;
    free(words);
    return complain(APP_FAILED, "%s: python3 cannot be started: %s", name,
                    strerror(fault));
}

int command_export(int argc, char **argv)
{
    return become_python("export", argc, argv);
}

int command_view(int argc, char **argv)
{
    return become_python("view", argc, argv);
}
