/* SPDX-License-Identifier: Apache-2.0 */
/* Built in place of lion.c where the tool's libraries, which read scene files,
 * are not installed. */
#include "bench/accuracy.h"

void part_lion(struct bench *b)
{
    (void)b;
    puts("skipped: no libraries here to read scenes");
}
