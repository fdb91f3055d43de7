/* SPDX-License-Identifier: Apache-2.0 */
/* The entry points of libFuzzer. The target is chosen by the program's name:
 * there is one program and a link to it for each target. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fuzz/fuzz.h"

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most,
                               unsigned seed);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);

static const struct target *target;
static int out; /* a copy of standard error, which libFuzzer may close for
                   the target */

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    const char *name = (*argv)[0], *slash = strrchr(name, '/');
    (void)argc;
    out = dup(STDERR_FILENO);
    target = fuzz_find(slash ? slash + 1 : name);
    if (!target) {
        dprintf(out, "%s: no such target\n", name);
        exit(2);
    }
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *failed = target->run(target->name, data, size);
    if (failed) {
        dprintf(out, "FAILED %s: %s\n", target->name, failed);
        abort();
    }
    return 0;
}

size_t fuzz_plain(uint8_t *data, size_t size, size_t most)
{
    return LLVMFuzzerMutate(data, size, most);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most,
                               unsigned seed)
{
    return target->mutate ? target->mutate(data, size, most, seed)
                          : LLVMFuzzerMutate(data, size, most);
}
