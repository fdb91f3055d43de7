/* SPDX-License-Identifier: Apache-2.0 */
/* Checks JSON strictly by RFC 8259, because cJSON accepts more than that. */
#include <string.h>

#include "fuzz/files.h"

struct text {
    const unsigned char *at, *end;
};

static bool value(struct text *t, int depth);

static void space(struct text *t)
{
    while (t->at < t->end && *t->at && strchr(" \t\r\n", *t->at))
        t->at++;
}

static bool take(struct text *t, char c)
{
    if (t->at == t->end || *t->at != (unsigned char)c)
        return false;
    t->at++;
    return true;
}

static bool digits(struct text *t)
{
    const unsigned char *from = t->at;
    while (t->at < t->end && *t->at >= '0' && *t->at <= '9')
        t->at++;
    return t->at > from;
}

static bool number(struct text *t)
{
    take(t, '-');
    if (!take(t, '0') && !digits(t))
        return false;
    if (take(t, '.') && !digits(t))
        return false;
    if (!take(t, 'e') && !take(t, 'E'))
        return true;
    if (!take(t, '+'))
        take(t, '-');
    return digits(t);
}

static bool word(struct text *t, const char *is)
{
    while (*is)
        if (!take(t, *is++))
            return false;
    return true;
}

static bool escape(struct text *t)
{
    if (t->at == t->end || !*t->at || !strchr("\"\\/bfnrtu", *t->at))
        return false;
    if (*t->at++ != 'u')
        return true;
    for (int k = 0; k < 4; k++, t->at++)
        if (t->at == t->end || !*t->at ||
            !strchr("0123456789abcdefABCDEF", *t->at))
            return false;
    return true;
}

/* Reads a UTF-8 character beyond ASCII whose first byte is c: the shortest
 * form, no surrogate, at most U+10FFFF. */
static bool character(struct text *t, unsigned char c)
{
    static const unsigned long least[4] = {0, 0x80, 0x800, 0x10000};
    int more = c >= 0xf0 ? 3 : c >= 0xe0 ? 2 : 1;
    unsigned long code = c & (0x3fu >> more);
    if (c < 0xc0 || c > 0xf7 || t->end - t->at < more)
        return false;
    for (int k = 0; k < more; k++, t->at++) {
        if ((*t->at & 0xc0) != 0x80)
            return false;
        code = code << 6 | (*t->at & 0x3f);
    }
    return code >= least[more] && code <= 0x10ffff &&
           (code < 0xd800 || code > 0xdfff);
}

static bool string(struct text *t)
{
    if (!take(t, '"'))
        return false;
    while (t->at < t->end && *t->at != '"') {
        unsigned char c = *t->at++;
        if (c < 32 || (c == '\\' && !escape(t)) ||
            (c > 127 && !character(t, c)))
            return false;
    }
    return take(t, '"');
}

/* Reads the rest of a list or object after its opening bracket. */
static bool items(struct text *t, int depth, char end)
{
    space(t);
    if (take(t, end))
        return true;
    do {
        space(t);
        if (end == '}') {
            if (!string(t))
                return false;
            space(t);
            if (!take(t, ':'))
                return false;
        }
        if (!value(t, depth))
            return false;
    } while (take(t, ','));
    return take(t, end);
}

static bool value(struct text *t, int depth)
{
    bool good;
    space(t);
    if (t->at == t->end || depth > 64)
        return false;
    switch (*t->at) {
    case '{':
        t->at++;
        good = items(t, depth + 1, '}');
        break;
    case '[':
        t->at++;
        good = items(t, depth + 1, ']');
        break;
    case '"':
        good = string(t);
        break;
    case 't':
        good = word(t, "true");
        break;
    case 'f':
        good = word(t, "false");
        break;
    case 'n':
        good = word(t, "null");
        break;
    default:
        good = number(t);
    }
    space(t);
    return good;
}

bool strict_json(const char *text, size_t size)
{
    struct text t = {(const unsigned char *)text,
                     (const unsigned char *)text + size};
    return value(&t, 0) && t.at == t.end;
}
