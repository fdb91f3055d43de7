/* SPDX-License-Identifier: Apache-2.0 */
/* What libFuzzer calls; built once a stage with -DTARGET="name". */
#include <stdio.h>
#include <stdlib.h>

#include "fuzz/stage.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *failed = fuzz_stage(TARGET, data, size);
    if (failed) {
        fprintf(stderr, "%s: %s\n", TARGET, failed);
        abort();
    }
    return 0;
}
