/* SPDX-License-Identifier: Apache-2.0 */
/* Changes of binary files that keep their shape. */
#ifndef FUZZ_DAMAGE_H
#define FUZZ_DAMAGE_H

#include "fuzz/draw.h"
#include "fuzz/fuzz.h"

/* Choices by a seed, for mutators; choices_free in the end. */
struct bytes damage_choices(uint64_t seed);
/* One change: a field of 1 to 8 bytes becomes a limit, a bit flips, a part is
 * copied over another, bytes go or come, or libFuzzer's own. head: where a
 * half of the changes is. The new size. */
size_t damage(struct bytes *b, uint8_t *data, size_t size, size_t most,
              size_t head);

/* A checkpoint's own check is made right again. */
void damage_repair(uint8_t *data, size_t size);
/* Whether that is the check of what the library saves. */
bool damage_repairs(const uint8_t *data, size_t size);

#endif
