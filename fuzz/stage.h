/* SPDX-License-Identifier: Apache-2.0 */
/* One fuzz input of one stage. */
#ifndef FUZZ_STAGE_H
#define FUZZ_STAGE_H

#include <stddef.h>
#include <stdint.h>

/* Runs the stage, a small scene if the name is `api`, or a query against the
 * oracles if it is `vf` or `ee`, in both precisions on these choices; else a
 * reader. NULL or what fails. */
const char *fuzz_stage(const char *name, const uint8_t *data, size_t size);
/* Reads the bytes as a file: `scene` or `mesh`. */
const char *fuzz_reader(const char *name, const uint8_t *data, size_t size);

#endif
