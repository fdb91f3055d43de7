/* SPDX-License-Identifier: Apache-2.0 */
/* In place of the readers' targets where the tool's libraries are not
 * installed. */
#include "fuzz/fuzz.h"

const struct target fuzz_readers[] = {{NULL, NULL, NULL}};
