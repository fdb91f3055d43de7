/* SPDX-License-Identifier: Apache-2.0 */
/* Replays corpora without libFuzzer: replay STAGE FILE... */
#include <stdio.h>

#include "fuzz/stage.h"

int main(int argc, char **argv)
{
    static uint8_t data[1 << 16];
    int passed = 0, failed = 0;
    for (int k = 2; k < argc; k++) {
        FILE *f = fopen(argv[k], "rb");
        size_t size = f ? fread(data, 1, sizeof data, f) : 0;
        const char *what =
            f ? fuzz_stage(argv[1], data, size) : "cannot be opened";
        if (f)
            fclose(f);
        if (what)
            printf("FAILED %s: %s\n", argv[k], what);
        failed += what != NULL;
        passed += what == NULL;
    }
    printf("%d passed, %d failed\n", passed, failed);
    return failed || !passed;
}
