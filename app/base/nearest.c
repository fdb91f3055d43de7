/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the name that was probably meant by a wrong one. */
#include "app/base/nearest.h"

#include <ctype.h>
#include <string.h>

enum { LONGEST = 32, MOST_EDITS = 2 };

/* Returns the edit distance of two words (Levenshtein 1966), whose capital
 * letters count as small ones; LONGEST if a word is longer than any name. */
static int distance(const char *a, const char *b)
{
    int m = (int)strlen(a), n = (int)strlen(b), row[LONGEST + 1];
    if (m > LONGEST || n > LONGEST)
        return LONGEST;
    for (int j = 0; j <= n; j++)
        row[j] = j;
    for (int i = 1; i <= m; i++) {
        int corner = row[0];
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            int x = tolower((unsigned char)a[i - 1]);
            int y = tolower((unsigned char)b[j - 1]);
            int changed = corner + (x != y);
            corner = row[j];
            int added = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            row[j] = changed < added ? changed : added;
        }
    }
    return row[n];
}

void nearest_try(struct nearest *nearest, const char *name)
{
    int d = distance(nearest->word, name);
    if (d > MOST_EDITS || d >= (int)strlen(name) ||
        (nearest->name && d >= nearest->distance))
        return;
    nearest->name = name;
    nearest->distance = d;
}
