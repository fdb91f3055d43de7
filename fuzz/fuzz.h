/* SPDX-License-Identifier: Apache-2.0 */
/* The table of fuzz targets, which the driver, libFuzzer and the scripts
 * share. */
#ifndef FUZZ_FUZZ_H
#define FUZZ_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Runs one input. Returns NULL or the check that failed. */
typedef const char *fuzz_run(const char *name, const uint8_t *data,
                             size_t size);
/* Mutates an input in place, to at most `most` bytes. Returns the new size, or
 * `size` itself to ask for libFuzzer's plain mutation. */
typedef size_t fuzz_mutate(uint8_t *data, size_t size, size_t most,
                           uint64_t seed);

struct target {
    const char *name;
    fuzz_run *run;
    fuzz_mutate *mutate; /* NULL: libFuzzer's own mutation */
};

/* All targets; the last entry has no name. The targets of the tool's readers
 * have their own table, as the tool is not built everywhere. */
extern const struct target fuzz_targets[], fuzz_readers[];
/* Set by the driver that replays corpora: an input that begins as a checkpoint,
 * or as a log with a state, has to be of this format and of the target's world,
 * as any other is refused at the first comparison and tests nothing behind it.
 */
extern bool fuzz_kept;
/* Returns the target of that name, or NULL. */
const struct target *fuzz_find(const char *name);

/* A stage of spec/stages.def; whole steps if the name is `api`; a query against
 * the oracles if the name is `vf` or `ee`. fuzz/stage.c */
fuzz_run fuzz_stage;
/* The functions of spec/drape.h. fuzz/create.c, calls.c, many.c, queries.c,
 * load.c, replay.c */
fuzz_run fuzz_create, fuzz_scale, fuzz_calls, fuzz_twins, fuzz_many, fuzz_audit,
    fuzz_ccd, fuzz_ccd_frames, fuzz_text, fuzz_load, fuzz_replay;
fuzz_mutate load_mutate, replay_mutate;

/* Mutates plain bytes as libFuzzer does. In builds without libFuzzer it changes
 * nothing. */
size_t fuzz_plain(uint8_t *data, size_t size, size_t most);

#endif
