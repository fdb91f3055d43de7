/* SPDX-License-Identifier: Apache-2.0 */
/* The tables of spec/stages.def and tests/tests.def. Compiled once for each
 * precision. */
#include "tests/base/harness.h"

#include "gpu/run/gpu.h"
#include "tests/base/stages.h"

#define STAGE(room, file, X, rule)                                             \
    static int ref_call_##X(void *s)                                           \
    {                                                                          \
        return ref_##X(s);                                                     \
    }                                                                          \
    static int gpu_call_##X(struct gpu *g, void *s)                            \
    {                                                                          \
        return gpu_##X(g, s);                                                  \
    }                                                                          \
    static void gen_call_##X(struct bytes *b, void *s)                         \
    {                                                                          \
        gen_##X(b, s);                                                         \
    }                                                                          \
    static const char *prop_call_##X(const void *s)                            \
    {                                                                          \
        return prop_##X(s);                                                    \
    }
#include "spec/stages.def"
#undef STAGE

#define STAGE(room, file, X, rule)                                             \
    {#X,           REAL_BITS,  sizeof(struct X), ref_call_##X,                 \
     gpu_call_##X, fields_##X, gen_call_##X,     prop_call_##X},
const struct stage stages_table[] = {
#include "spec/stages.def"
    {NULL, 0, 0, NULL, NULL, NULL, NULL, NULL}};
#undef STAGE

#define TEST(X) {#X, test_##X},
const struct test tests_table[] = {
#include "tests/tests.def"
    {NULL, NULL}};
#undef TEST
