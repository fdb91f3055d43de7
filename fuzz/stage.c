/* SPDX-License-Identifier: Apache-2.0 */
/* One source, one fuzz target a row of spec/stages.def: the fuzzer's bytes
 * are the choices of the stage's generator. */
#include "fuzz/stage.h"

#include "tests/case.h"

extern const struct stage stages_table_32[], stages_table_64[];

static const char *run(const struct stage *s, const char *name,
                       const uint8_t *data, size_t size)
{
    enum { WORDS = 1 << 14 };
    static uint32_t words[WORDS];
    size_t n = size / sizeof *words < WORDS ? size / sizeof *words : WORDS;
    if (n)
        memcpy(words, data, n * sizeof *words);
    while (s->name && strcmp(s->name, name))
        s++;
    if (!s->name)
        return "no such stage";
    struct bytes b = {.data = words, .n_data = n, .size = -1};
    const char *failed = case_run(s, &b, FAULT_NONE).failed;
    choices_free(&b);
    return failed;
}

const char *fuzz_stage(const char *name, const uint8_t *data, size_t size)
{
    const char *failed = run(stages_table_32, name, data, size);
    return failed ? failed : run(stages_table_64, name, data, size);
}
