/* SPDX-License-Identifier: Apache-2.0 */
/* drape fetch-models: fetches the public statues of drape's own scenes, and the
 * queries of its numbers. A script does it, which is installed with the tool.
 */
#include "app/base/file.h"
#include "app/tool/options.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

/* Puts the folder of the tool's executable into folder. */
static bool own_folder(char folder[FILE_PATH])
{
    ssize_t n = readlink("/proc/self/exe", folder, FILE_PATH - 1);
    if (n <= 0)
        return false;
    folder[n] = 0;
    char *slash = strrchr(folder, '/');
    if (slash)
        *slash = 0;
    return slash != NULL;
}

/* Finds the script: where it is installed, beside the tool of the Python
 * package, or in the checkout whose build/ has the tool or a flavour of it. */
static bool find_script(const char *folder, char path[FILE_PATH])
{
    static const char *const places[] = {"../share/drape/data.sh",
                                         "../ci/data.sh", "../../ci/data.sh"};
    for (int k = 0; k < 3; k++)
        if (file_join(path, folder, places[k]) && file_exists(path))
            return true;
    return false;
}

int command_fetch_models(int argc, char **argv)
{
    char folder[FILE_PATH], script[FILE_PATH];
    const char *from = "";
    const struct option_row options[] = {TEXT_OPTION("--from", &from), {0}};
    int positional;
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (positional != 1)
        return complain(APP_USAGE, "fetch-models: expected one DIR");
    if (!own_folder(folder) || !find_script(folder, script))
        return complain(APP_FAILED,
                        "fetch-models: share/drape/data.sh is not beside the "
                        "folder of this tool");
    /* a name that begins with a dash is a folder, too */
    execlp("sh", "sh", "--", script, argv[0], from, folder, (char *)NULL);
    return complain(APP_FAILED, "fetch-models: sh cannot be started: %s",
                    strerror(errno));
}
