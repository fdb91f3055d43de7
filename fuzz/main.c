/* SPDX-License-Identifier: Apache-2.0 */
/* Replays corpora without libFuzzer: `replay TARGET FILE...`. `replay --list`
 * prints all targets. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fuzz/fuzz.h"

size_t fuzz_plain(uint8_t *data, size_t size, size_t most)
{
    (void)data;
    (void)most;
    return size;
}

static void list(const struct target *t)
{
    for (; t->name; t++)
        printf("%s\n", t->name);
}

/* Returns the file's bytes, or NULL. As in libFuzzer, the input ends where its
 * memory ends, so that a sanitizer sees reads beyond it. */
static uint8_t *read_input(const char *path, size_t *size)
{
    FILE *f = fopen(path, "rb");
    uint8_t *data = NULL;
    if (!f)
        return NULL;
    if (fseek(f, 0, SEEK_END) == 0 && ftell(f) >= 0) {
        *size = (size_t)ftell(f);
        data = malloc(*size ? *size : 1);
        rewind(f);
        if (data)
            *size = fread(data, 1, *size, f);
    }
    fclose(f);
    return data;
}

static const char *replay(const struct target *t, const char *path)
{
    size_t size = 0;
    const char *slash = strrchr(path, '/');
    fuzz_kept = strncmp(slash ? slash + 1 : path, "hostile-", 8) != 0;
    uint8_t *data = read_input(path, &size);
    const char *failed =
        data ? t->run(t->name, data, size) : "cannot be opened";
    free(data);
    return failed;
}

/* Silences the targets' output. Returns the stream for the driver's own
 * messages. */
static FILE *silence(void)
{
    FILE *out = fdopen(dup(STDOUT_FILENO), "w");
    int nothing = open("/dev/null", O_WRONLY);
    dup2(nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    close(nothing);
    return out;
}

int main(int argc, char **argv)
{
    int passed = 0, failed = 0;
    if (argc > 1 && !strcmp(argv[1], "--list")) {
        list(fuzz_targets);
        list(fuzz_readers);
        return 0;
    }
    const struct target *t = argc > 1 ? fuzz_find(argv[1]) : NULL;
    if (!t) {
        fprintf(stderr, "usage: replay --list | TARGET FILE...\n");
        return 2;
    }
    FILE *out = silence();
    if (!out)
        return 3;
    for (int k = 2; k < argc; k++) {
        const char *what = replay(t, argv[k]);
        if (what)
            fprintf(out, "FAILED %s: %s\n", argv[k], what);
        failed += what != NULL;
        passed += what == NULL;
    }
    fprintf(out, "%d passed, %d failed\n", passed, failed);
    fclose(out);
    return failed || !passed;
}
