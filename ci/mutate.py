# SPDX-License-Identifier: Apache-2.0
"""The faults that ci/mutants.py plants: finds the possible changes of a source
file by its tokens, and the lines that are equal in ref/ and gpu/."""
import os
import re

TOKEN = re.compile(r'''
    (?P<skip>//[^\n]*|/\*.*?\*/|\s+|\\\n)
  | (?P<preproc>^[ \t]*\#(?:[^\n\\]|\\\n|\\.)*)
  | (?P<text>"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*')
  | (?P<number>0[xX][0-9a-fA-F.]+(?:[pP][+-]?\d+)?
             | \.?\d[\w.]*(?:(?<=[eE])[+-]\d+)?)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<op><<=|>>=|\.\.\.|->|\+\+|--|<<|>>|[<>=!+\-*/%&|^]=|&&|\|\||::|.)
''', re.X | re.S | re.M)
SWAPS = {'+': '-', '-': '+', '*': '/', '/': '*', '%': '/', '&&': '||',
         '||': '&&', '+=': '-=', '-=': '+=', '++': '--', '--': '++',
         '<': '<=', '<=': '<', '>': '>=', '>=': '>', '==': '!=', '!=': '==',
         '<<': '>>', '>>': '<<', '&': '|', '|': '&', '|=': '='}
TURNS = {'<': '>=', '>=': '<', '>': '<=', '<=': '>'}
WORDS = {'true': 'false', 'false': 'true', 'break': 'continue',
         'least': 'most', 'most': 'least', 'real_min': 'real_max',
         'real_max': 'real_min', 'vec_min': 'vec_max', 'vec_max': 'vec_min',
         'add': 'sub', 'sub': 'add', 'vec_add': 'vec_sub',
         'vec_sub': 'vec_add'}
TWIN = re.compile(r'^(?:ref|gpu|vec|real|sym)_')


class Token:
    def __init__(self, kind, text, at, line):
        self.kind, self.text, self.at, self.line = kind, text, at, line


def tokens(source):
    found, line = [], 1
    for m in TOKEN.finditer(source):
        if m.lastgroup != 'skip':
            found.append(Token(m.lastgroup, m.group(), m.start(), line))
        line += m.group().count('\n')
    return found


class Edit:
    """One change: source[at:end] becomes new."""

    def __init__(self, line, at, end, new, what, key):
        self.line, self.at, self.end, self.new = line, at, end, new
        self.what, self.key = what, key


def is_value(t):
    return t.kind in ('name', 'number') or t.text in (')', ']')


def number_edits(t):
    m = re.fullmatch(r'(0x1)p([+-]?\d+)', t.text)
    if m:
        e = int(m.group(2))
        return [f'{m.group(1)}p{e - 2}', f'{m.group(1)}p{e + 2}']
    if re.fullmatch(r'\d+', t.text):
        n = int(t.text)
        return [str(n + 1), str(n - 1)] if n > 0 else ['1']
    if re.fullmatch(r'\d*\.\d+(?:e-?\d+)?', t.text):
        return [repr(float(t.text) * 2), repr(float(t.text) / 2)]
    return []


def token_edits(ts, k, source):
    t = ts[k]
    new = []
    if t.kind == 'op' and t.text in SWAPS and 0 < k < len(ts) - 1:
        # a binary operator has spaces around it, as clang-format puts them
        binary = source[t.at + len(t.text)].isspace() and is_value(ts[k - 1])
        if binary or t.text in ('++', '--'):
            new = [SWAPS[t.text]]
            new += [TURNS[t.text]] if t.text in TURNS else []
        elif t.text == '-':
            new = ['']
    elif t.text == '!':
        new = ['']
    elif t.kind == 'name' and t.text in WORDS:
        new = [WORDS[t.text]]
    elif t.kind == 'number':
        new = number_edits(t)
    end = t.at + len(t.text)
    return [Edit(t.line, t.at, end, n, f'{t.text} -> {n or "nothing"}',
                 (k, n)) for n in new]


def close(ts, k):
    """The token that closes the bracket at k, or None."""
    depth = 0
    for j in range(k, len(ts)):
        depth += ts[j].text in ('(', '[', '{')
        depth -= ts[j].text in (')', ']', '}')
        if depth == 0:
            return j
    return None


def declares(ts, a, b):
    """Whether the tokens from a to b are a type and a name."""
    return any(ts[k].kind == ts[k + 1].kind == 'name' for k in range(a, b)) or \
        b > a + 1 and ts[a].kind == 'name' and ts[a + 1].text == '*' and \
        ts[b].at == ts[b - 1].at + 1


def swap_edits(ts, k, source):
    """Two neighbours among the arguments of a call that opens at k."""
    if ts[k].text != '(' or k == 0 or ts[k - 1].kind != 'name':
        return []
    end = close(ts, k)
    if end is None or ts[k - 1].text in ('if', 'for', 'while', 'switch'):
        return []
    args, start, depth = [], k + 1, 0
    for j in range(k + 1, end + 1):
        depth += ts[j].text in ('(', '[', '{')
        depth -= ts[j].text in (')', ']', '}') and j < end
        if (ts[j].text == ',' and depth == 0) or j == end:
            args.append((start, j - 1))
            start = j + 1
    edits = []
    for (a, b), (c, d) in zip(args, args[1:]):
        if b < a or d < c:
            continue
        at, cut = ts[a].at, ts[b].at + len(ts[b].text)
        again, stop = ts[c].at, ts[d].at + len(ts[d].text)
        one, two = source[at:cut], source[again:stop]
        alike = ts[a].kind == ts[c].kind and (ts[a].kind != 'op' or
                                              ts[a].text == ts[c].text)
        if one != two and alike and not declares(ts, a, b) and \
                not declares(ts, c, d):
            edits.append(Edit(ts[a].line, at, stop,
                              two + source[cut:again] + one,
                              f'arguments swapped: {one}, {two}', (a, 'swap')))
    return edits


def drop_edits(ts, k, source):
    """The statement that begins at k, if it is no declaration."""
    starts = k and (ts[k - 1].text in (';', '{', '}', ')', ':', 'else') or
                    ts[k - 1].kind == 'preproc')
    if not starts or k + 1 >= len(ts) or \
            ts[k].kind != 'name' and ts[k].text != '*':
        return []
    first, follow = ts[k].text, ts[k + 1]
    if first in ('if', 'for', 'while', 'do', 'switch', 'case', 'else',
                 'static', 'struct', 'enum', 'default', 'typedef', 'template',
                 'const', 'UNROLL', 'extern'):
        return []
    if first == 'return' and follow.text != ';' or follow.kind == 'name':
        return []
    if [t.text for t in ts[k + 1:k + 3]] == ['(', '*'] and \
            [t.text for t in ts[k + 4:k + 6]] in ([')', '('], [')', '[']):
        return []  # declares a pointer to a function or to an array
    end, depth = k, 0
    while end < len(ts) and not (ts[end].text == ';' and depth == 0):
        depth += ts[end].text in ('(', '[', '{')
        depth -= ts[end].text in (')', ']', '}')
        if depth < 0:
            return []
        end += 1
    if end >= len(ts):
        return []
    does = any(t.text in ('(', '=', '++', '--', '+=', '-=', '|=', '*=', '&=')
               for t in ts[k:end])
    nested = any(ts[j].text == '{' and ts[j - 1].text == ')'
                 for j in range(k + 1, end))  # a loop behind a macro
    if nested or not does and first not in ('break', 'continue', 'return') or \
            ts[k].kind == 'name' and follow.text == '*':
        return []
    at, stop = ts[k].at, ts[end].at
    what = ' '.join(source[at:stop].split())
    return [Edit(ts[k].line, at, stop, '', f'dropped: {what}', (k, 'drop'))]


def edits_of(source):
    ts = tokens(source)
    found, depth = [], 0
    for k, t in enumerate(ts):
        depth += t.text == '{'
        depth -= t.text == '}'
        if t.kind == 'preproc':
            m = re.match(r'\s*#define \w+ (0x1p[+-]?\d+|\d+)\b', t.text)
            for new in number_edits(Token('number', m.group(1), 0, 0)) \
                    if m else []:
                at = t.at + m.start(1)
                found.append(Edit(t.line, at, at + len(m.group(1)), new,
                                  f'{m.group(1)} -> {new}', (k, new)))
        elif depth > 0:
            found += token_edits(ts, k, source) + swap_edits(ts, k, source)
            found += drop_edits(ts, k, source)
    return found


# Lines that are equal in ref/ and gpu/

def normal(line):
    """The tokens of a line, as they read alike in ref/ and in gpu/."""
    drop = ('__device__', 'static', 'inline', '(real)')
    return tuple(TWIN.sub('', t.text) for t in tokens(line)
                 if t.text not in drop)


def line_edits(line):
    """What can be changed in a line taken alone, by place and change."""
    ts = tokens(line)
    found = {}
    for k in range(len(ts)):
        if ts[k].kind == 'preproc':
            continue
        for e in token_edits(ts, k, line) + swap_edits(ts, k, line) + \
                (drop_edits([Token('op', ';', -1, 0)] + ts, k + 1, line)
                 if k == 0 else []):
            found[(k, TWIN.sub('', e.key[1]))] = e
    return found


def twins_of(ref, sources):
    """Mutants of a file of ref/ and of the lines of gpu/ that read like it."""
    stem = os.path.splitext(os.path.basename(ref))[0]
    files = [f for f in sources if f.startswith('gpu/') and
             os.path.splitext(os.path.basename(f))[0] == stem]
    theirs = {}
    for f in files:
        for n, line in enumerate(sources[f].splitlines(keepends=True)):
            theirs.setdefault(normal(line), []).append((f, n))
    mine, code = {}, {t.line - 1 for t in tokens(sources[ref])}
    for n, line in enumerate(sources[ref].splitlines(keepends=True)):
        if n in code:  # and no comment
            mine.setdefault(normal(line), []).append(n)
    mutants = []
    for key, lines in mine.items():
        there = theirs.get(key, [])
        if len(key) < 5 or len(lines) != 1 or len(there) != 1:
            continue
        here = sources[ref].splitlines(keepends=True)[lines[0]]
        f, n = there[0]
        other = line_edits(sources[f].splitlines(keepends=True)[n])
        for place, e in line_edits(here).items():
            if place in other:
                mutants.append(Mutant('both', [(ref, lines[0], e),
                                               (f, n, other[place])], here))
    return mutants


class Mutant:
    """Changes of lines: (file, line from 0, edit whose places are in it)."""

    def __init__(self, kind, changes, text):
        self.kind, self.changes, self.text = kind, changes, text.strip()

    def name(self):
        where = ', '.join(f'{f}:{n + 1}' for f, n, _ in self.changes)
        return f'{self.kind} {where}: {self.changes[0][2].what}'

    def apply(self, sources):
        """The changed files: name, text."""
        for f, n, e in self.changes:
            source = sources[f]
            at = 0
            if n >= 0:
                lines = source.splitlines(keepends=True)
                at = sum(map(len, lines[:n]))
            yield f, source[:at + e.at] + e.new + source[at + e.end:]


def mutants_of(path, sources):
    lines = sources[path].splitlines()
    kind = path.split('/')[0]
    for e in edits_of(sources[path]):
        start = sum(len(x) + 1 for x in lines[:e.line - 1])
        moved = Edit(e.line, e.at - start, e.end - start, e.new, e.what, e.key)
        yield Mutant(kind, [(path, e.line - 1, moved)], lines[e.line - 1])
