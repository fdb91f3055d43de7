/* SPDX-License-Identifier: Apache-2.0 */
/* Stands in for app/read/assimp.c where assimp is not installed. */
#include "app/read/import.h"

#include <string.h>
#include <unistd.h>

_Noreturn void import_child(const char *path, const char *clip, int out)
{
    struct import_reply reply = {.magic = IMPORT_MAGIC};
    (void)path;
    (void)clip;
    strcpy(reply.error, "this build of drape has no assimp and reads PLY and "
                        "OFF only");
    ssize_t sent = write(out, &reply, sizeof reply);
    _exit(sent == (ssize_t)sizeof reply ? 0 : 1);
}
