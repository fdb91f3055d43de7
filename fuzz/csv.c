/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes `drape ccd` with any bytes as a file of queries: there is one answer a
 * query, and the line endings of another system give the same answers. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/tool/options.h"
#include "fuzz/files.h"

/* Runs the command with its output in a file. Returns the exit code. */
static int run(const char *kind, char **answers, size_t *size)
{
    char path[FILES_PATH], file[FILES_PATH], option[] = "--kind", what[3];
    snprintf(what, sizeof what, "%s", kind);
    files_path("queries.csv", path);
    char *argv[] = {option, what, path, NULL};
    fflush(stdout);
    int kept = dup(STDOUT_FILENO);
    FILE *out = fopen(files_path("answers", file), "wb");
    if (kept < 0 || !out || dup2(fileno(out), STDOUT_FILENO) < 0)
        abort();
    int code = command_ccd(3, argv);
    fflush(stdout);
    dup2(kept, STDOUT_FILENO);
    close(kept);
    fclose(out);
    *answers = files_read("answers", size);
    return code;
}

/* Whether each line of the output is `0`, or `1` and a time in [0, 1]. *lines
 * is the number of lines. */
static bool sound(const char *text, long *lines)
{
    for (*lines = 0; *text; ++*lines) {
        double toi = 0;
        char end = 0;
        if (strncmp(text, "0\n", 2) != 0 &&
            (sscanf(text, "1 %lf%c", &toi, &end) != 2 || end != '\n' ||
             !(toi >= 0 && toi <= 1)))
            return false;
        text = strchr(text, '\n') + 1;
    }
    return true;
}

/* Returns the same text with carriage returns. The caller frees the result. */
static char *other_ends(const uint8_t *data, size_t size, size_t *other)
{
    char *text = malloc(2 * size + 1);
    *other = 0;
    for (size_t k = 0; text && k < size; k++) {
        if (data[k] == '\n')
            text[(*other)++] = '\r';
        text[(*other)++] = (char)data[k];
    }
    return text;
}

static const char *compare(const uint8_t *data, size_t size, const char *kind)
{
    char *answers = NULL, *again = NULL;
    size_t bytes = 0, more = 0, other = 0;
    long lines = 0, ends = 0;
    files_write("queries.csv", data, size);
    int code = run(kind, &answers, &bytes);
    char *text = other_ends(data, size, &other);
    files_write("queries.csv", text, other);
    int same = run(kind, &again, &more);
    const char *failed = NULL;
    for (size_t k = 0; k < size; k++)
        ends += data[k] == '\n';
    if (code != APP_OK && code != APP_FINDINGS && code != APP_USAGE)
        failed = "an exit code that there is not";
    else if (!answers || strlen(answers) != bytes || !sound(answers, &lines))
        failed = "an answer that there is not";
    else if (code != APP_USAGE && (lines == 0 || lines != (ends + 1) / 8))
        failed = "not an answer a query";
    else if (code != same || bytes != more || memcmp(answers, again, bytes))
        failed = "other line ends, other answers";
    free(answers);
    free(again);
    free(text);
    return failed;
}

const char *fuzz_csv(const char *name, const uint8_t *data, size_t size)
{
    (void)name;
    const char *failed = compare(data, size, "vf");
    return failed ? failed : compare(data, size, "ee");
}
