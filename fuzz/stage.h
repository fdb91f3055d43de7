/* SPDX-License-Identifier: Apache-2.0 */
/* One fuzz input of one stage. */
#ifndef FUZZ_STAGE_H
#define FUZZ_STAGE_H

#include <stddef.h>
#include <stdint.h>

/* Runs the stage, or a small scene if the name is `api`, in both precisions
 * on these choices; NULL or what fails. */
const char *fuzz_stage(const char *name, const uint8_t *data, size_t size);

#endif
