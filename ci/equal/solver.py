# SPDX-License-Identifier: Apache-2.0
"""What rewriting leaves, asked of Bitwuzla. + · ÷ √, and products and quotients of
integers of which none is constant, are uninterpreted functions; comparisons, signs,
conversions and bits are interpreted."""
import time

import floats
import words
from term import WIDTH, Unsupported, float_of, is_float, kids, order

try:
    import bitwuzla
except ImportError:
    bitwuzla = None

FORMAT = {"f32": "8 24", "f64": "11 53"}
INTEGER = {"and_bits": "bvand", "or_bits": "bvor", "xor_bits": "bvxor", "shl": "bvshl",
           "lshr": "bvlshr", "ashr": "bvashr", "joined": "concat", "eq": "=",
           "slt": "bvslt", "ult": "bvult"}
QUOTIENT = ("udiv", "urem", "sdiv", "srem")
NUMBER = {"neg": "fp.neg", "abs": "fp.abs", "<": "fp.lt", "<=": "fp.leq",
          "==": "fp.eq", "not": "not", "and": "and", "choice": "ite"}


def kind(sort):
    """A sort as SMT-LIB names it."""
    if sort == "b":
        return "Bool"
    if is_float(sort):
        return f"(_ FloatingPoint {FORMAT[sort]})"
    return f"(_ BitVec {sort[1]})"


def constant(term):
    """A constant number."""
    exponent = 8 if term.sort == "f32" else 11
    bits = format(term.args[0], f"0{WIDTH[term.sort]}b")
    if float_of(term.sort, term.args[0]) != float_of(term.sort, term.args[0]):
        return f"(_ NaN {FORMAT[term.sort]})"
    return f"(fp #b{bits[0]} #b{bits[1:1 + exponent]} #b{bits[1 + exponent:]})"


def never_negative(term, known):
    """Whether a number is not below 0 (it may be NaN), by its shape."""
    if term.id not in known:
        op, args = term.op, term.args
        of = [never_negative(a, known) for a in kids(term)] if op in (
            "+", "*", "/", "convert", "choice", "min", "max") else []
        known[term.id] = (
            op in ("abs", "sqrt")
            or (op == "float" and not floats.value(term) < 0)
            or (op in ("*", "/") and args[0] is args[1])
            or (op == "choice" and all(of[1:]))
            or (op != "choice" and bool(of) and all(of))
        )
    return known[term.id]


def is_difference(term):
    """Whether a term is the sum or the difference of two inputs."""
    def is_input(part):
        while part.op in ("neg", "convert"):
            part = part.args[0]
        return part.op == "number"
    return is_float(term.sort) and term.op == "+" and all(map(is_input, term.args))


def is_arithmetic(term):
    """Whether a term is a product, a quotient, a root, or a sum but of inputs."""
    return (is_float(term.sort) and term.op in ("+", "*", "/", "sqrt")
            and not is_difference(term))


def nearest(roots):
    """The terms that the roots are made of down to sums, products, quotients and roots,
    operands first."""
    return order(roots, lambda term: () if is_arithmetic(term) else kids(term))


def of_these(given, terms):
    """The parts of a condition that are made of these terms and constants."""
    known = {t.id for t in terms}
    parts = given.args if given.op == "and" else (given,)
    return [part for part in parts if all(
        t.id in known for t in nearest([part])
        if is_arithmetic(t) or t.op in ("leaf", "number"))]


class Script:
    """The definitions of terms in SMT-LIB, with what is known of the functions that
    are uninterpreted. whole: what sums, products, quotients and roots are made of is
    known; else each is a number of which nothing is known but these laws."""

    def __init__(self, roots, whole=True):
        self.names, self.functions, self.lines = {}, {}, []
        self.positive, self.users, self.products = {}, {}, {}
        self.whole = whole
        terms = order(roots) if whole else nearest(roots)
        for term in terms:
            for k in kids(term):
                self.users.setdefault(k.id, set()).add(term.id)
        for term in terms:
            self.add(term)
        for (*pair, bits), name in self.products.items():
            wide = self.products.get((*pair, 2 * bits))
            if wide:
                self.lines.append(f"(assert (= {name} ((_ extract {bits - 1} 0) {wide})))")

    def tied(self, term):
        """Whether the bits of an input are used otherwise than as this number."""
        return len(self.users.get(term.id, ())) > 1 or any(
            len(self.users.get(k.id, ())) > 1 for k in kids(term))

    def is_input(self, term):
        """Whether a number is an input whose bits nobody sees."""
        inner = term.args[0]
        if inner.op == "joined" and any(k.op != "leaf" for k in inner.args):
            return False
        return inner.op in ("leaf", "joined") and not self.tied(inner)

    def add(self, term):
        """Declares or defines a term."""
        op, name = term.op, f"t{term.id}"
        if op in ("true", "false"):
            name = op
        elif op == "float":
            name = constant(term)
        elif op == "int":
            name = f"(_ bv{term.args[0]} {term.sort[1]})"
        elif op == "leaf" or (op == "number" and self.is_input(term)):
            self.lines.append(f"(declare-const {name} {kind(term.sort)})")
        elif not self.whole and is_arithmetic(term):
            self.lines.append(f"(declare-const {name} {kind(term.sort)})")
            self.signs(term, name)
        elif op == "bits":
            self.lines.append(f"(declare-const {name} {kind(term.sort)})")
            self.lines.append(f"(assert (= ((_ to_fp {FORMAT[term.args[0].sort]}) "
                              f"{name}) {self.names[term.args[0].id]}))")
        else:
            text = self.text(term, [self.names[k.id] for k in kids(term)])
            self.lines.append(f"(define-fun {name} () {kind(term.sort)} {text})")
            self.names[term.id] = name
            self.laws(term, name)
        self.names[term.id] = name

    def text(self, term, inner):
        """An operation on operands."""
        op, sort = term.op, term.sort
        if op in QUOTIENT and term.args[1].op == "int":
            return f"(bv{op} {' '.join(inner)})"
        if op == "times" and all(map(words.is_choice_of_constants, term.args)):
            return f"(bvmul {' '.join(inner)})"
        if op not in (*INTEGER, *NUMBER, "sum", "convert", "number",
                                       "extend", "extend_signed", "cut"):
            function = "|" + " ".join([op, kind(sort), *(kind(k.sort)
                                                         for k in kids(term))]) + "|"
            sorts = " ".join(kind(k.sort) for k in kids(term))
            self.functions[function] = (f"(declare-fun {function} ({sorts}) "
                                        f"{kind(sort)})")
            return f"({function} {' '.join(inner)})" if inner else function
        if op == "sum":
            bits, (items, plus) = sort[1], term.args
            text = f"(_ bv{plus} {bits})"
            for name, (_, factor) in zip(inner, items):
                text = f"(bvadd {text} (bvmul (_ bv{factor} {bits}) {name}))"
            return text
        if op == "convert":
            return f"((_ to_fp {FORMAT[sort]}) RNE {inner[0]})"
        if op == "number":
            return f"((_ to_fp {FORMAT[sort]}) {inner[0]})"
        if op in ("extend", "extend_signed"):
            name = "zero_extend" if op == "extend" else "sign_extend"
            return f"((_ {name} {sort[1] - term.args[0].sort[1]}) {inner[0]})"
        if op == "cut":
            low = term.args[1]
            return f"((_ extract {low + sort[1] - 1} {low}) {inner[0]})"
        return f"({INTEGER.get(op) or NUMBER[op]} {' '.join(inner)})"

    def bound(self, inner, bits, name):
        """A product of integers that were widened is at most that of the largest."""
        most = 1
        for term in inner:
            most *= (1 << term.sort[1]) - 1
        if most < 1 << bits:
            self.lines.append(f"(assert (bvule {name} (_ bv{most} {bits})))")

    def laws(self, term, name):
        """What is known of a sum, a product, a quotient or a root."""
        op, sort = term.op, term.sort
        if op == "times":
            inner = [k.args[0] if k.op == "extend" else k for k in term.args]
            self.products[(*sorted(k.id for k in inner), sort[1])] = name
            self.bound(inner, sort[1], name)
        if not is_float(sort) or op not in ("+", "*", "/", "sqrt"):
            return
        inner = [self.names[k.id] for k in kids(term)]
        if op in ("+", "*") and term.args[0] is not term.args[1]:
            swapped = self.text(term, inner[::-1])
            self.lines.append(f"(assert (= {swapped} {name}))")
        if is_difference(term):
            zero, (x, y) = constant(floats.const(sort, 0.0)), inner
            self.lines += [
                f"(assert (= (fp.lt {zero} {name}) (fp.lt (fp.neg {x}) {y})))",
                f"(assert (= (fp.lt {name} {zero}) (fp.lt {y} (fp.neg {x}))))",
                f"(assert (= (fp.isNaN {name}) (or (fp.isNaN {x}) (fp.isNaN {y}) "
                f"(and (fp.isInfinite {x}) (= {x} (fp.neg {y}))))))"]
        self.signs(term, name)

    def signs(self, term, name):
        """That a number is never negative, where its shape shows it."""
        zero = constant(floats.const(term.sort, 0.0))
        if never_negative(term, self.positive):
            self.lines.append(f"(assert (not (fp.lt {name} {zero})))")


class Clock:
    """Stops the solver after so many seconds of the processor: a busy machine proves
    as much. What interrupts it, as prove.py's clock does, is raised after it has
    stopped."""

    def __init__(self, seconds):
        self.until, self.why = time.process_time() + seconds, None

    def __call__(self):
        try:
            return time.process_time() > self.until
        except Unsupported as why:
            self.why = why
            return True


def ask(text, seconds):
    """sat, unsat or unknown."""
    options = bitwuzla.Options()
    options.set(bitwuzla.Option.PRODUCE_MODELS, False)
    parser = bitwuzla.Parser(bitwuzla.TermManager(), options)
    parser.parse(text, True, False)
    solver, clock = parser.bitwuzla(), Clock(seconds)
    solver.configure_terminator(clock)
    result = str(solver.check_sat()).rsplit(".", 1)[-1].lower()
    if clock.why:
        raise clock.why
    return result


def none_differs(a, b, given, whole, seconds):
    """Whether the solver finds that no input that meets all conditions tells two terms
    apart."""
    script = Script([a, b, *given], whole)
    names = script.names
    text = ["(set-logic ALL)", *script.functions.values(), *script.lines,
            *(f"(assert {names[part.id]})" for part in given),
            f"(assert (not (= {names[a.id]} {names[b.id]})))"]
    return ask("\n".join(text), seconds) == "unsat"


def are_equal(a, b, given, seconds=10):
    """Whether two terms are equal for all inputs for which `given` holds; False where
    they are not, or where the solver does not know. What is equal whatever its sums and
    products are is found soon."""
    if bitwuzla is None:
        raise Unsupported("bitwuzla is not installed")
    terms = nearest([a, b])
    if any(map(is_arithmetic, terms)) and none_differs(
            a, b, of_these(given, terms), False, seconds / 4):
        return True
    return none_differs(a, b, [given], True, seconds)
