/* SPDX-License-Identifier: Apache-2.0 */
/* Writes arbitrary texts and numbers as valid JSON. */
#include "app/base/text.h"

#include <math.h>

/* Returns the number of bytes of the first UTF-8 character, or 0 if the bytes
 * are not UTF-8: a wrong or missing continuation byte, an overlong form, a
 * surrogate, or a code point above 10FFFF (RFC 3629 §4). */
static int utf8_length(const unsigned char *c)
{
    if (c[0] < 0x80)
        return 1;
    int length = c[0] >= 0xf0 ? 4 : c[0] >= 0xe0 ? 3 : 2;
    if (c[0] < 0xc2 || c[0] > 0xf4)
        return 0;
    unsigned char lo = 0x80, hi = 0xbf;
    switch (c[0]) {
    case 0xe0:
        lo = 0xa0;
        break;
    case 0xed:
        hi = 0x9f;
        break;
    case 0xf0:
        lo = 0x90;
        break;
    case 0xf4:
        hi = 0x8f;
        break;
    }
    if (c[1] < lo || c[1] > hi)
        return 0;
    for (int k = 2; k < length; k++)
        if (c[k] < 0x80 || c[k] > 0xbf)
            return 0;
    return length;
}

void text_put(FILE *out, const char *text)
{
    const unsigned char *c = (const unsigned char *)text;
    fputc('"', out);
    while (*c) {
        int length = utf8_length(c);
        if (length == 0)
            fputs("\\ufffd", out);
        else if (*c == '"' || *c == '\\')
            fprintf(out, "\\%c", *c);
        else if (*c < 32 || *c == 127)
            fprintf(out, "\\u%04x", *c);
        else
            fwrite(c, 1, (size_t)length, out);
        c += length ? length : 1;
    }
    fputc('"', out);
}

void text_put_number(FILE *out, const char *format, double value)
{
    if (isfinite(value))
        fprintf(out, format, value);
    else
        fputs("null", out);
}
