/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 2, of forms within the range that the filter lets pass. */
#include "ref/narrow/split.c"
#include "eva/split.h"
int main(void)
{
    struct motion m;
    struct forms s;
    uint32_t toi;
    any_split_interval(&m, &s, &toi);
    return split_interval(&m, &s, &toi);
}
