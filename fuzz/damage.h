/* SPDX-License-Identifier: Apache-2.0 */
/* Mutates binary files so that most of their structure survives. */
#ifndef FUZZ_DAMAGE_H
#define FUZZ_DAMAGE_H

#include "fuzz/fuzz.h"
#include "fuzz/small.h"

/* Returns a stream of choices from a seed, for mutators. The caller frees it by
 * choices_free. */
struct bytes damage_choices(uint64_t seed);
/* Makes one change: a field of 1 to 8 bytes becomes a limit, a bit flips, a
 * part is copied over another part, bytes are inserted or removed, or libFuzzer
 * mutates plain bytes. Half of the changes are in the first `head` bytes.
 * Returns the new size. */
size_t damage(struct bytes *b, uint8_t *data, size_t size, size_t most,
              size_t head);

/* Whether the bytes, as far as they go, name the same format, precision and
 * world as the checkpoint `own`. Bytes that do not begin as a checkpoint pass.
 */
bool damage_matches(const uint8_t *data, size_t size, const uint8_t *own);
/* How many entries a whole checkpoint says that contacts carry on. */
int64_t damage_kept(const uint8_t *data);
/* Recomputes the checksum of a checkpoint. */
void damage_repair(uint8_t *data, size_t size);
/* Whether damage_repair would write the checksum that the library wrote. */
bool damage_repairs(const uint8_t *data, size_t size);

/* Makes world k: the first of a thousand worlds whose checkpoints can be
 * repaired, after k steps; every fourth is changed. From DAMAGE_PRESSED on its
 * contacts carry impulses on. *tape is its checkpoint. Returns NULL if there is
 * no such world. */
enum { DAMAGE_PRESSED = 8, DAMAGE_WORLDS = 10 };
drape_world *damage_world(struct small *s, unsigned k, struct tape *tape);

#endif
