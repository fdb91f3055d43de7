/* SPDX-License-Identifier: Apache-2.0 */
/* The fuzz targets: one table, which the driver, libFuzzer and the scripts
 * read. */
#ifndef FUZZ_FUZZ_H
#define FUZZ_FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* Runs one input: NULL, or what does not hold. */
typedef const char *fuzz_run(const char *name, const uint8_t *data,
                             size_t size);
/* Changes an input of at most `most` bytes in place and returns its new size;
 * `size` itself where only a change of plain bytes makes sense. */
typedef size_t fuzz_mutate(uint8_t *data, size_t size, size_t most,
                           uint64_t seed);

struct target {
    const char *name;
    fuzz_run *run;
    fuzz_mutate *mutate; /* NULL: libFuzzer's own, on bytes */
};

/* All of them; the last has no name. Those of the tool's readers are apart, as
 * the tool is not built everywhere. */
extern const struct target fuzz_targets[], fuzz_readers[];
/* NULL where there is none of that name. */
const struct target *fuzz_find(const char *name);

/* The stages of spec/stages.def; whole steps if the name is `api`, a query
 * against the oracles if it is `vf` or `ee`. fuzz/stage.c */
fuzz_run fuzz_stage;
/* The functions of spec/drape.h. fuzz/create.c, calls.c, queries.c, load.c */
fuzz_run fuzz_create, fuzz_scale, fuzz_calls, fuzz_twins, fuzz_audit, fuzz_ccd,
    fuzz_ccd_frames, fuzz_text, fuzz_load;
fuzz_mutate load_mutate;

/* libFuzzer's change of plain bytes, where libFuzzer is. */
size_t fuzz_plain(uint8_t *data, size_t size, size_t most);

#endif
