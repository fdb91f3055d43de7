/* SPDX-License-Identifier: Apache-2.0 */
/* Built in place of the targets of the tool's readers where the tool's
 * libraries are not installed. */
#include "fuzz/fuzz.h"

const struct target fuzz_readers[] = {{NULL, NULL, NULL}};
