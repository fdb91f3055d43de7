/* SPDX-License-Identifier: Apache-2.0 */
/* One fuzz target for each row of spec/stages.def: the fuzzer's bytes are the
 * choices of the stage's generator. `api` runs whole steps, `vf` and `ee` one
 * query of the narrow phase. */
#include "fuzz/fuzz.h"

#include "tests/base/case.h"

extern const struct stage stages_table_32[], stages_table_64[];
const char *scene_random_32(struct bytes *b);
const char *scene_random_64(struct bytes *b);

const char *soak_query_32(struct bytes *b, int kind);
const char *soak_query_64(struct bytes *b, int kind);

struct build {
    const struct stage *stages;
    const char *(*scene)(struct bytes *b); /* whole steps: the name `api` */
    const char *(*query)(struct bytes *b, int kind); /* `vf` and `ee` */
};

/* Returns the stage's row, or the last row, which has no name. */
static const struct stage *find(const struct stage *s, const char *name)
{
    while (s->name && strcmp(s->name, name) != 0)
        s++;
    return s;
}

static const char *run(const struct build *build, const char *name,
                       struct bytes *b)
{
    if (strcmp(name, "api") == 0)
        return build->scene(b);
    if (strcmp(name, "vf") == 0 || strcmp(name, "ee") == 0)
        return build->query(b, name[0] == 'e');
    return case_run(find(build->stages, name), b, FAULT_NONE, true).failed;
}

const char *fuzz_stage(const char *name, const uint8_t *data, size_t size)
{
    enum { WORDS = 1 << 14 };
    static uint32_t words[WORDS];
    static const struct build builds[2] = {
        {stages_table_32, scene_random_32, soak_query_32},
        {stages_table_64, scene_random_64, soak_query_64}};
    size_t n = size / sizeof *words < WORDS ? size / sizeof *words : WORDS;
    const char *failed = NULL;
    if (n)
        memcpy(words, data, n * sizeof *words);
    for (int k = 0; k < 2 && !failed; k++) {
        struct bytes b = {.data = words, .n_data = n, .size = -1};
        failed = run(&builds[k], name, &b);
        choices_free(&b);
    }
    return failed;
}
