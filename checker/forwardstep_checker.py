#!/usr/bin/env python3
# Checks a certificate of forwardstep against a scenario, without forwardstep.
#
#     python3 checker/forwardstep_checker.py CERTIFICATE.json SCENARIO.toml [--ignore-digests] [--json]
#
# The scenario is read here a second time: agents, edges, phases, delays, weights, gains, roots and motions come from its text,
# and so does the list of hypotheses that a certificate must speak about. The certificate only says where to look: windows and
# trees, bounds, pivots, subdivisions. What it says is held against the text, in exact arithmetic.
#
# For every hypothesis, and in all, there are three outcomes:
#
#     accepted         the claim is shown
#     rejected         the claim is not shown by its proof, contradicts the text, or is left out; with the place in the certificate
#     could not check  nothing is claimed, or this program knows no proof of it yet, or finds bounds that are too wide to tell
#
# The exit status is 0, 1 or 2 in this order. *Accepted* says that the claims of the certificate are right. A claim may be that a
# hypothesis is violated: then its witness was replayed, and the last line says so.
#
# What has to be trusted
#  1. Python and these parts of its standard library: ast, csv, fractions, hashlib, json, math (of whole numbers), re, tomllib, xml.etree,
#     collections, functools, itertools; and that its floats are doubles and printed by their shortest decimals: a number of a scenario is
#     the double next to it, as a run takes it. An infinite float stands for an end that is not known. No others are computed with.
#  2. This file: how it reads a scenario, which hypotheses it asks for (`requirements`), and the argument beside each `@rule`,
#     and beside the entries of `TEXT` and `NUMBERS`.
#  3. The mathematics behind the list: that the theorems follow from these hypotheses.
#  4. What a certificate marks as *given*: numbers that forwardstep drew at random. They are held against the bounds that the
#     scenario states and nothing else, and a claim that rests on them reaches to the end of the run only.
#     The edges of a random graph are given, too, and stay: they are held against the rule that draws them.
#  5. That a weight or a delay which is an irrational constant runs as the double next to it, which is what is judged here.
#  6. That forwardstep reads the scenario: what has no meaning it refuses, and this file looks at what a proof uses. Antiderivatives, of
#     immersion and invariance, have their regressors as slopes; an equation of a chain in feedback form has states up to its own, or to
#     the next, alone, and others have those of their order; lists which stand for vectors have as many entries as the robot needs, agents
#     that agree have as many axes as one another, and a table has no keys that are those of another design.
# What has not to be trusted: forwardstep, rounding of floating point (decimals are rational numbers here, functions are enclosed by
# rational Taylor sums that are rounded outwards), and digests (they only say which files were meant).

import argparse, ast, collections, csv, functools, hashlib, io, itertools, json, math, re, signal, sys, tomllib
import xml.etree.ElementTree as ElementTree
from fractions import Fraction
from pathlib import Path

sys.setrecursionlimit(5_000)
FORMAT, SHIPPED_ROBOTS = 1, Path(__file__).resolve().parent.parent / "crates" / "io" / "robots"
ACCEPTED, REJECTED, UNCHECKED, HOLDS, ON_RUN, VIOLATED = "accepted", "rejected", "could not check", "holds", "holds on [0, end]", "violated"
UNCLAIMED = ("watched during the run", "not shown", "not covered by the paper")

# What is larger is refused, so that nothing takes all memory, or hours.
MOST_BYTES, MOST_DIGITS, MOST_NESTED, MOST_NODES = 64 << 20, 4000, 256, 20_000
MOST_AGENTS, MOST_EDGES, MOST_CELLS, MOST_ROWS, MOST_DEGREE, MOST_POINTS, MOST_EXPANDED = 200_000, 1_000_000, 100_000, 64, 16, 300, 6

# A claim that is not shown: (words, where in the certificate).
class Rejected(Exception): outcome = REJECTED

def failed(error): raise error

def require(node, condition, words, value=None): return value if condition else failed(Rejected(words, node.place))

# Something that cannot be checked here.
class Undecided(Exception): outcome = UNCHECKED

# Something that has no value.
class Undefined(Undecided): pass

# A scenario that cannot be read, or has no meaning.
class Meaningless(Exception): outcome = REJECTED

# --- Numbers and documents

DECIMAL, RATIO = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?", re.ASCII), re.compile(r"-?\d+(/[1-9]\d*)?", re.ASCII)

# A decimal as the rational number that it is.
def decimal(text):
    plain = text.replace("_", "")
    if len(plain) > MOST_DIGITS or not DECIMAL.fullmatch(plain): raise ValueError(f"`{plain[:40]}` is no decimal of moderate length")
    return Fraction(plain)

# A value of the certificate with its place. What has the wrong type is rejected there.
class Node(collections.namedtuple("Node", "value place")):
    def typed(self, words, *kinds): return require(self, type(self.value) in kinds, f"must be {words}", self.value)

    def field(self, key):
        require(self, key in self.typed("an object", dict), f"lacks `{key}`")
        return Node(self.value[key], f"{self.place}.{key}")

    def optional(self, key): return self.field(key) if key in self.typed("an object", dict) else None

    # Refuses fields that nothing reads: what stands in a certificate counts.
    def only(self, *keys):
        for key in self.typed("an object", dict): require(self, key in keys, f"has `{key}`, which means nothing here")

    # All its fields.
    def fields(self, *keys): return self.only(*keys) or map(self.field, keys)

    def each(self): return [Node(value, f"{self.place}[{k}]") for k, value in enumerate(self.typed("a list", list))]

    def text(self): return self.typed("a text", str)

    def count(self): return self.typed("a whole number", int)

    # A whole number, a decimal in quotes, or "p/q" in quotes.
    def number(self):
        text = str(self.typed("a whole number, or a number in quotes", int, str))
        legible = len(text) <= MOST_DIGITS and (RATIO.fullmatch(text) or DECIMAL.fullmatch(text)) and abs(Fraction(text)) < 10**300
        require(self, legible, "is no decimal and no p/q of moderate length and size")
        return Fraction(text)

# The document as a node. Numbers in it are whole or stand in quotes, so that none is rounded on the way.
def read_certificate(text):
    def no(words): raise Rejected(words, "certificate")

    def no_number(word): no(f"{word[:40]} stands without quotes: it would be rounded, or is not a number")

    try:
        return Node(json.loads(
            text, object_pairs_hook=lambda items: dict(items) if len(dict(items)) == len(items) else no("an object has a key twice"),
            parse_int=lambda digits: int(digits) if len(digits) <= 30 else no("a whole number is too long"),
            parse_float=no_number, parse_constant=no_number), "certificate")
    except (RecursionError, ValueError) as error: no(f"is not JSON, or nested too deeply: {error}")

def read_toml(text):
    # What runs is the double next to a number, as its shortest decimal; formulas are texts, and are kept as they are written.
    try: return tomllib.loads(text, parse_float=lambda number: decimal(repr(float(decimal(number)))))
    except (RecursionError, ValueError) as error: raise Meaningless(f"is not TOML, or nested too deeply: {error}") from None

# `value`, which has a meaning under this condition.
def such(condition, words, value=None): return value if condition else failed(Meaningless(words))

def decided(condition, words, value=None): return value if condition else failed(Undecided(words))

# What enclosures show, refute, or leave open.
def settled(node, shown, refuted, words):
    require(node, shown or not refuted, words)
    decided(shown, f"is not decided here: {words}")

# A number of a scenario.
def exact(value, where):
    such(isinstance(value, (int, Fraction)) and not isinstance(value, bool), f"{where} must be a number")
    return such(isinstance(value, Fraction) or value.bit_length() <= 4 * MOST_DIGITS, f"{where} is too long", decimal(repr(float(value))))

def positive(value, where): return such((x := exact(value, where)) > 0, f"{where} must be positive", x)

def not_negative(value, where): return such((x := exact(value, where)) >= 0, f"{where} must not be negative", x)

# A table; one with keys that are not known here may mean something that is not known here.
def table(value, where, keys=None):
    such(isinstance(value, dict), f"{where} must be a table")
    for key in value if keys is not None else (): known(key, keys.split(), f"entries of {where}")
    return value

def listed(value, where): return such(isinstance(value, list) and value, f"{where} must be a list that is not empty", value)

# Whether they rise strictly.
def rising(times): return all(early < late for early, late in zip(times, times[1:]))

def pair(value): return such(isinstance(value, list) and len(value) == 2, "where a pair must be there is something else", value)

# The numbers and texts of a table or a list, each with the key that it stands under.
def leaves(value, key=""):
    if not isinstance(value, (dict, list)): return [(key, value)]
    return [leaf for k, each in (value.items() if isinstance(value, dict) else ((key, x) for x in value)) for leaf in leaves(each, k)]

def name_of(value, where): return such(isinstance(value, str), f"{where} must be a text", value)

# A word, or a table with one key: (key, what stands under it).
def choice(value, where):
    such(isinstance(value, str) or isinstance(value, dict) and len(value) == 1, f"{where} must be a word, or a table with one key")
    return (value, {}) if isinstance(value, str) else next(iter(value.items()))

# Scenarios may have kinds and keys from outside.
def known(kind, kinds, what, value=None): return decided(kind in kinds, f"{what} of the kind `{kind}` are not known", value)

# The same, of those that are known.
def chosen(value, where, kinds, what): return known((found := choice(value, where))[0], kinds, what, found)

# A number for a message.
def said(number): return str(number) if len(str(number)) <= 24 else f"{float(number):.9g}"

# --- Intervals with rational ends; an end that is not known is an infinite float

INF, WHOLE = math.inf, (-math.inf, math.inf)
FOR_EVER, LATE, LATER, END = (Fraction(0), INF), (Fraction(1), INF), (Fraction(1000_000), INF), (INF, INF)

def infinite(x): return isinstance(x, float) and decided(math.isinf(x), "a number was rounded", True)

def bits(x): return 0 if infinite(x) else x.numerator.bit_length() + x.denominator.bit_length()

# x, or a shorter number on the stated side of it, by less than one part in 2^150.
def rounded(x, upwards):
    if bits(x) <= 600: return x
    scale = Fraction(2) ** (160 - x.numerator.bit_length() + x.denominator.bit_length())
    return (math.ceil if upwards else math.floor)(x * scale) / scale

def span(*ends): return rounded(min(ends), False), rounded(max(ends), True)

def total(x, y):
    decided(not (infinite(x) and infinite(y)) or x == y, "∞ − ∞")
    return x if infinite(x) else y if infinite(y) else x + y

def product(x, y):
    return Fraction(0) if x == 0 or y == 0 else x * y if not (infinite(x) or infinite(y)) else INF if (x > 0) == (y > 0) else -INF

def add(a, b): return span(total(a[0], b[0]), total(a[1], b[1]))

def minus(a): return -a[1], -a[0]

# What is a limit at ∞ cannot be multiplied with what may come to zero; ends of intervals can.
def multiply(a, b):
    decided(not any(x in (END, (-INF, -INF)) and y[0] <= 0 <= y[1] for x, y in ((a, b), (b, a))), "0 · ∞")
    return span(*(product(x, y) for x in a for y in b))

def inverse(a):
    if a[0] <= 0 <= a[1]: raise (Undefined if a[0] == a[1] else Undecided)("a divisor may be zero")
    return span(*(Fraction(0) if infinite(x) else Fraction(1) / x for x in a))

def hull(a, b): return min(a[0], b[0]), max(a[1], b[1])

def common(*found): return max(low for low, _ in found), min(high for _, high in found)

def size(a): return max(abs(a[0]), abs(a[1]))

# term + term·ratio(1) + term·ratio(1)·ratio(2) + …, for ratios that fall below 1/2: the rest is at most twice the last.
def taylor(term, ratio):
    low, high, k = Fraction(0), Fraction(0), 1
    while abs(term) > Fraction(1, 1 << 200):
        low, high, exact_ = low + term, high + term, term * ratio(k)
        term = Fraction(math.floor(exact_ * (1 << 400)), 1 << 400)
        # What is cut off here is below 2^-400, and grows to less than 2^-380 in what follows.
        low, high, k = low - Fraction(1, 1 << 380), high + Fraction(1, 1 << 380), k + 1
    return span(low - Fraction(1, 1 << 198), high + Fraction(1, 1 << 198))

# |x| ≤ 1/2: x + s x³/3 + s² x⁵/5 + …, arctan for s = −1 and artanh for s = 1. The cut of x moves it by less than 2^-238.
def odd_series(x, sign):
    return taylor(x := Fraction(math.floor(x * (1 << 240)), 1 << 240), lambda k: sign * x * x * (2 * k - 1) / (2 * k + 1))

# By Machin's formula.
PI = add(multiply((16, 16), odd_series(Fraction(1, 5), -1)), multiply((-4, -4), odd_series(Fraction(1, 239), -1)))

# sin of a rational x: reduced by multiples of π, then Taylor; sin is 1-Lipschitz.
def sine_at(x):
    near = Fraction(math.floor((x - (n := round(x / PI[0])) * PI[0]) * (1 << 220)), 1 << 220)
    room, square = abs(n) * (PI[1] - PI[0]) + Fraction(1, 1 << 219), -near * near
    value = add(taylor(near, lambda k: square / (2 * k * (2 * k + 1))), (-room, room))
    return minus(value) if n % 2 else value

# sin of an interval, or cos, which is a quarter of a turn ahead: its ends, and 1 or −1 where a crest or a trough may lie inside.
def sine(a, turned):
    if infinite(a[0]) or infinite(a[1]) or a[1] - a[0] >= 7: return Fraction(-1), Fraction(1)
    if a == (0, 0): return (Fraction(turned),) * 2
    a = add(a, multiply(PI, (Fraction(1, 2),) * 2)) if turned else a
    low, high = hull(sine_at(a[0]), sine_at(a[1]))
    for extreme in (Fraction(-1), Fraction(1)):
        turns = [end / pi / 2 - extreme / 4 for end in a for pi in PI]
        if math.floor(max(turns)) >= math.ceil(min(turns)): low, high = min(low, extreme), max(high, extreme)
    return max(low, Fraction(-1)), min(high, Fraction(1))

@functools.lru_cache(MOST_CELLS)
def exp_at(x):
    if abs(x) > 1500: return (Fraction(2) ** 2000, INF) if x > 0 else (Fraction(0), Fraction(1, 1 << 2000))
    small = Fraction(math.floor(x / (1 << (halvings := math.ceil(abs(x)).bit_length() + 1)) * (1 << 240)), 1 << 240)
    # The cut of `small` moves exp by less than 2^-239.
    value = add(taylor(Fraction(1), lambda k: small / k), (Fraction(-1, 1 << 238), Fraction(1, 1 << 238)))
    for _ in range(halvings): value = multiply(value, value)
    return value

# x = m 2^k with 1/2 < m < 2; log m = 2 artanh((m − 1)/(m + 1)).
def log_at(x):
    m = x / Fraction(2) ** (k := x.numerator.bit_length() - x.denominator.bit_length())
    return add(multiply((2, 2), odd_series((m - 1) / (m + 1), 1)), multiply((2 * k, 2 * k), odd_series(Fraction(1, 3), 1)))

def sqrt_at(x):
    scale = 1 << max(0, 400 - x.numerator.bit_length() + x.denominator.bit_length())
    return Fraction(root := math.isqrt(math.floor(x * scale * scale)), scale), Fraction(root + (root * root != x * scale * scale), scale)

def tanh_at(x): return add((1, 1), multiply((-2, -2), inverse(add((1, 1), exp_at(2 * x)))))

# By odd symmetry, π/2 − atan 1/x beyond one, and atan x = 2 atan(x/(1 + √(1 + x²))).
def atan_at(x):
    if x < 0: return minus(atan_at(-x))
    if x > 1: return add(multiply(PI, (Fraction(1, 2),) * 2), minus(atan_at(Fraction(1) / x)))
    ends = [rounded(x / (1 + end), side) for end, side in zip(sqrt_at(1 + x * x), (True, False))]
    return multiply((2, 2), (odd_series(ends[1], -1)[0], odd_series(ends[0], -1)[1]))

def power(a, exponent):
    if exponent == 0: return (Fraction(1),) * 2
    if exponent.denominator == 1:
        n = decided(abs(exponent) * max(1 << 10, *map(bits, a)) <= 1 << 20, "a power is too large", abs(exponent.numerator))
        # An even power is one of |a|; now all of them rise.
        value = span(*(end**n for end in (magnitude(a) if n % 2 == 0 else a)))
        return inverse(value) if exponent < 0 else value
    if a[0] < 0 or a[0] == 0 > exponent: raise (Undefined if a[1] < 0 or a[1] == 0 > exponent else Undecided)("a base has no such power")
    if exponent == Fraction(1, 2): return function("sqrt", a)
    # What has no logarithm, or none that is finite.
    ends = [Fraction(0) if (x == 0) == (exponent > 0) else INF for x in a]
    by_logarithm = lambda x: function("exp", multiply((exponent,) * 2, function("log", (x, x))))
    return hull(*((end,) * 2 if x == 0 or infinite(x) else by_logarithm(x) for x, end in zip(a, ends)))

def magnitude(a): return (Fraction(0) if a[0] <= 0 <= a[1] else min(abs(a[0]), abs(a[1]))), size(a)

def function(name, a):
    if (name == "sqrt" and a[0] < 0) or (name == "log" and a[0] <= 0):
        raise (Undefined if a[1] < 0 or (name == "log" and a[1] == 0) else Undecided)(f"`{name}` may be of what it has no value for")
    if name in ("neg", "abs"): return minus(a) if name == "neg" else magnitude(a)
    if name in ("sin", "cos"): return sine(a, name == "cos")
    right, zero, one = multiply(PI, (Fraction(1, 2),) * 2), (Fraction(0),) * 2, (Fraction(1),) * 2
    at, low, high, known_ = {
        "exp": (exp_at, zero, (INF, INF), {0: one}), "log": (log_at, None, (INF, INF), {1: zero}), "sqrt": (sqrt_at, None, (INF, INF), {}),
        "tanh": (tanh_at, minus(one), one, {0: zero}), "atan": (atan_at, minus(right), right, {0: zero})}[name]
    return (ends := [known_.get(x) or ((low if x < 0 else high) if infinite(x) else at(x)) for x in a])[0][0], ends[1][1]

# --- Curves through points: at rest before the first and after the last; between them pieces of degree five, so that four derivatives
# --- are continuous at every point inside

# p(x + by) by powers of x, for a polynomial p by powers of x.
def moved(p, by): return [sum(math.comb(n, k) * p[n] * by ** (n - k) for n in range(k, len(p))) for k in range(len(p))]

# Pieces by powers of the time since each starts, of a curve that leaves the first point at rest with these coefficients of t³ and t⁴;
# and those of t and t² at the last point.
def shot(times, values, third, fourth):
    found, state = [], [values[0], Fraction(0), Fraction(0), third, fourth]
    for length, value in zip((late - early for early, late in zip(times, times[1:])), values[1:]):
        found.append([*state, (value - sum(c * length**k for k, c in enumerate(state))) / length**5])
        state = moved(found[-1], length)[:5]
    return found, state[1], state[2]

# (start, end, piece) of the curve that ends at rest: the last state is affine in what the first point leaves open.
@functools.cache
def curve(times, values):
    decided(len(times) <= MOST_POINTS, "a curve through so many points is not computed here")
    (_, v, a), (_, v_3, a_3), (_, v_4, a_4) = (shot(times, values, *map(Fraction, begin)) for begin in ((0, 0), (1, 0), (0, 1)))
    # One point leaves nothing open.
    determinant = (v_3 - v) * (a_4 - a) - (v_4 - v) * (a_3 - a) or 1
    third, fourth = ((v_4 - v) * a - (a_4 - a) * v) / determinant, ((a_3 - a) * v - (v_3 - v) * a) / determinant
    return [(-INF, times[0], [values[0]]), *zip(times, times[1:], shot(times, values, third, fourth)[0]), (times[-1], INF, [values[-1]])]

# What a polynomial keeps within from 0 to an end: its Bernstein coefficients.
def held(p, end):
    return span(*(sum(Fraction(math.comb(j, k), math.comb(len(p) - 1, k)) * p[k] * end**k for k in range(j + 1)) for j in range(len(p))))

# What a derivative of such a curve keeps within.
def along_points(times, values, order, t):
    found = []
    for start, end, piece in curve(times, values):
        if start <= t[1] and t[0] <= end:
            rate = functools.reduce(lambda p, _: [n * c for n, c in enumerate(p)][1:] + [Fraction(0)], range(order), piece)
            low = max(start, t[0])
            found.append(held(moved(rate, low - start), min(end, t[1]) - low) if rate[1:] else (rate[0],) * 2)
    return functools.reduce(hull, found)

# --- Formulas: ("number", q), ("pi",), ("e",), ("t",), ("f", name, a), (op, a, b) for + - * / min max, ("^", a, q); and ("points",
# --- times, values, order) for a derivative of a curve

FUNCTIONS = ("sin", "cos", "exp", "log", "sqrt", "abs", "tanh", "atan")
NUMBER = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}

# A formula as a tree. Python's own parser knows the same precedence: −t² is −(t²), 2^3^2 is 2^9. Numbers become texts before,
# _('0.1'), since it would round them.
def formula(text, names=("t",)):
    plain = name_of(text, "a formula")
    legible = len(plain) <= MOST_DIGITS and re.fullmatch(r"[\w\s.+*/^(),-]*", plain) and "**" not in plain and "//" not in plain
    such(legible, "a formula is too long, or has a character that no formula has")
    quoted = NUMBER.sub(lambda match: f"_('{match.group()}')", " ".join(plain.split()))
    try: return shaped(ast.parse(quoted.replace("^", "**"), mode="eval").body, names, 0)
    except (SyntaxError, RecursionError, MemoryError, ValueError): raise Meaningless(f"`{plain[:60]}` is no formula") from None

def shaped(node, names, depth):
    such(depth <= MOST_NESTED, "a formula is nested too deeply")

    def inner(part): return shaped(part, names, depth + 1)

    if type(node) is ast.Name and node.id in (*names, "pi", "e"): return (node.id,) if node.id in ("t", "pi", "e") else ("state", node.id)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.UAdd, ast.USub)):
        return inner(node.operand) if isinstance(node.op, ast.UAdd) else ("f", "neg", inner(node.operand))
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow): return "^", inner(node.left), constant(inner(node.right))
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS: return OPERATORS[type(node.op)], inner(node.left), inner(node.right)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        name = node.func.id
        if name == "_" and len(node.args) == 1 and isinstance(node.args[0], ast.Constant): return "number", decimal(str(node.args[0].value))
        arguments = [inner(argument) for argument in node.args]
        if name in FUNCTIONS and len(arguments) == 1: return "f", name, arguments[0]
        if name in ("min", "max") and len(arguments) > 1: return functools.reduce(lambda a, b: (name, a, b), arguments)
    raise Meaningless("a formula has something that no formula has")

# The same of what may be a number.
def motion_of(entry, where): return formula(entry) if isinstance(entry, str) else ("number", exact(entry, where))

# The formulas that a formula is made of.
def parts_of(tree): return [part for part in tree[1:] if isinstance(part, tuple)] if tree[0] != "points" else []

# What was found of a tree is kept with it, so that a part that stands in many places is looked at once. Of equal trees one is `unique`.
KEPT, unique = {}, functools.lru_cache(MOST_CELLS)(lambda tree: tree)

def once(of):
    def kept_(tree, *about):
        if len(KEPT) > MOST_CELLS: KEPT.clear()
        key = of, id(tree), *map(id, about)
        if key not in KEPT: KEPT[key] = of(tree, *about), tree, about
        return KEPT[key][0]
    return kept_

has_variable = once(lambda tree: tree[0] in ("t", "state", "points") or any(map(has_variable, parts_of(tree))))

COMBINED = {"+": add, "-": lambda a, b: add(a, minus(b)), "*": multiply, "/": lambda a, b: multiply(a, inverse(b)), "hull": hull,
            "min": lambda a, b: tuple(map(min, a, b)), "max": lambda a, b: tuple(map(max, a, b))}

def convolved(p, q): return [sum(p[i] * q[k - i] for i in range(len(p)) if 0 <= k - i < len(q)) for k in range(len(p) + len(q) - 1)]

# (P, Q) of a formula that is a quotient of polynomials in t, by coefficients from t⁰ on, with all its poles; else None.
@once
def quotient(tree):
    kind = tree[0]
    if kind in ("number", "t"): return ([tree[1]] if kind == "number" else [Fraction(0), Fraction(1)]), [Fraction(1)]
    if tree[:2] == ("f", "neg"): return quotient(("-", ZERO, tree[2]))
    parts = list(map(quotient, parts_of(tree)))
    if None in parts or kind not in "+-*/^" or kind == "^" and (tree[2].denominator > 1 or not 0 < abs(tree[2]) <= 8): return None
    first, last = parts[0], parts[-1]
    # Q²/(P Q) for the inverse of P/Q: no pole is lost.
    if kind == "/" or kind == "^" and tree[2] < 0: last = convolved(last[1], last[1]), convolved(*last)
    if kind == "-": last = [-x for x in last[0]], last[1]
    found = [functools.reduce(convolved, of, [Fraction(1)]) for of in zip(*([last] * abs(int(tree[2])) if kind == "^" else [first, last]))]
    if kind in "+-":
        crossed = convolved(first[0], last[1]), convolved(last[0], first[1])
        found[0] = [sum(pair_) for pair_ in itertools.zip_longest(*crossed, fillvalue=Fraction(0))]
    return found if max(map(len, found)) <= 2 * MOST_DEGREE else None

def trimmed(p): return trimmed(p[:-1]) if p and p[-1] == 0 else p

# P/Q for all t from a time on, or at ∞: by powers of u = 1/t both are polynomials in u, beside a power of t.
def far(p, q, t):
    over, under = (held(of[::-1] or [Fraction(0)], inverse(t)[1]) for of in (p, q))
    return multiply(multiply(over, inverse(under)), power(t, Fraction(len(p) - len(q))))

# A formula without the absolute values, the smaller and the larger ones that are decided by signs while t keeps within an interval.
@once
def resolved(tree, t):
    if tree[:2] == ("f", "abs") or tree[0] in ("min", "max"):
        a, b = (tree[2], negated(tree[2])) if tree[0] == "f" else tree[1:]
        low, high = attempt(enclose, tree[2] if tree[0] == "f" else ("-", a, b), t) or WHOLE
        if low > 0 or high < 0 or t[0] != t[1] and (low == 0 or high == 0): return resolved(a if (low >= 0) == (tree[0] != "min") else b, t)
    return tuple(resolved(part, t) if isinstance(part, tuple) else part for part in tree) if parts_of(tree) else tree

def by_quotient(tree, t):
    return far(*map(trimmed, decided((ratio := quotient(resolved(tree, t))) and any(ratio[1]), "is no quotient of polynomials", ratio)), t)

# The factors of a product; a divisor is one as a power.
def factors_of(tree):
    if tree[:2] == ("f", "neg"): return [("number", Fraction(-1)), *factors_of(tree[2])]
    if tree[0] == "/": return factors_of(tree[1]) + [("^", tree[2], Fraction(-1))]
    return factors_of(tree[1]) + factors_of(tree[2]) if tree[0] == "*" else [tree]

# The square of a formula, of what is a root, or a whole power of one, without that root.
def squared(tree):
    if tree[0] == "^": return ("^", tree[1], 2 * tree[2]) if tree[2].denominator == 2 else ("^", squared(tree[1]), tree[2])
    return tree[2] if tree[:2] == ("f", "sqrt") else ("^", tree, Fraction(2))

# A product of factors whose squares are quotients of polynomials is but for its sign the root of its square; the sign is that of its
# factors, all of which have a value. Others multiply it. In the end a sign is that from some time on: what comes to zero has one.
def rooted_out(tree, t):
    even, odd = ([part for part in factors_of(tree) if bool(quotient(squared(part))) == is_one] for is_one in (True, False))
    decided(even and even + odd != [tree], "is no product with a root")
    signs = [(Fraction(1 if a >= 0 else -1), Fraction(1 if b > 0 else -1)) for a, b in (enclose(x, LATER if t == END else t) for x in even)]
    whole = function("sqrt", COMBINED["max"](by_quotient(unique(functools.reduce(times, map(squared, even))), t), (Fraction(0),) * 2))
    return functools.reduce(multiply, signs + [enclose(part, t) for part in odd], whole)

# What a power of t bounds, and the exponential of a quotient of polynomials: of |p| ≤ c tⁿ and g ≤ −r t, r > 0, the product p exp(g)
# is at most c tⁿ exp(−r t), which falls from n/r on.
def damped(tree, t):
    powers, rest = ([part for part in factors_of(tree) if (part[:2] == ("f", "exp")) == is_one] for is_one in (True, False))
    falls = -enclose(("/", functools.reduce(plus, (part[2] for part in powers)), ("t",)), t)[1] if powers else 0
    over = (("/", unique(functools.reduce(times, rest, ONE)), ("^", ("t",), Fraction(n)) if n else ONE) for n in range(9))
    found = falls > 0 and next(((n, x) for n, p in enumerate(over) if not infinite(x := size(attempt(rooted_out, p, t) or WHOLE))), None)
    n, most = decided(found, "is not damped") or found
    if infinite(falls) or t == END: return (Fraction(0),) * 2
    start = max(t[0], n / falls)
    return hull(*(multiply((sign * most,) * 2, multiply((start**n,) * 2, exp_at(-falls * start))) for sign in (-1, 1)))

# The terms of a sum once products are multiplied out, or those with numbers alone, each a number and what it is multiplied with.
# Quotients of polynomials may stay whole.
@once
def weighed(tree, out=True, whole=False):
    kind, one = tree[0], (Fraction(1),) * 2
    if not has_variable(tree): return [(enclose(tree, WHOLE), ONE)]
    if tree[:2] == ("f", "neg"): return [(minus(x), p) for x, p in weighed(tree[2], out, whole)]
    if kind not in "+-*/" or whole and quotient(tree) or not out and kind in "*/" and all(map(has_variable, tree[1:])): return [(one, tree)]
    a, b = (weighed(x, out, whole) for x in (tree[1], ("^", tree[2], Fraction(-1)) if kind == "/" and has_variable(tree[2]) else tree[2]))
    if kind in "+-": return a + [(x if kind == "+" else minus(x), q) for x, q in b]
    decided(len(a) * len(b) <= 1000, "a formula has too many terms")
    return [(COMBINED[kind](x, y) if kind == "*" or q == ONE else x, unique(times(p, q))) for (x, p), (y, q) in itertools.product(a, b)]

# Sines and cosines of one angle together, whatever they are multiplied with: a sin φ + b cos φ keeps within ± √(a² + b²). The rest may
# tell more where its factors stay together.
def swinging(tree, t, out=True):
    found, terms = {}, weighed(tree, out, out)
    for by, part in decided(len(terms) > 1, "is no sum", terms):
        parts = factors_of(part)
        wave = next((x for x in parts if x[:2] in (("f", "sin"), ("f", "cos"))), None)
        if wave: parts.remove(wave)
        pair_ = found.setdefault(wave and repr(list(map(trimmed, quotient(wave[2]) or ())) or wave[2]), [(Fraction(0),) * 2] * 2)
        side = bool(wave and wave[1] == "cos")
        pair_[side] = add(pair_[side], multiply(by, enclose(functools.reduce(times, parts, ONE) if wave else part, t)))
    rest, most = found.pop(None, [(Fraction(0),) * 2])[0], sum(function("sqrt", square(pair_))[1] for pair_ in found.values())
    return decided(not infinite(most), "swings without bound", add(rest, (-most, most)))

# What a formula keeps within while t keeps within the interval `t`, or states within those of a table; at `END` what holds all its
# limit points as t → ∞. Intervals alone make ∞/∞ of t/(1 + t) for large t, 0 · ∞ of t exp(−t), and 2 of sin t − cos t.
@once
def enclose(tree, t):
    if t == FOR_EVER: return hull(enclose(tree, (Fraction(0), Fraction(1))), enclose(tree, LATE))
    plain = not isinstance(t, tuple) or t[1] != INF or t[0] <= 0 or not has_variable(tree)
    if plain or tree[0] in ("t", "points"): return in_one_pass(tree, t)
    more = (rooted_out, swinging, functools.partial(swinging, out=False), damped) if tree[0] in "+-*/" else ()
    ways = [found for found in (attempt(way, tree, t) for way in (in_one_pass, by_quotient, *more)) if found]
    decided(ways, "nothing bounds this")
    return common(*ways)

def attempt(of, *arguments):
    try: return of(*arguments)
    except Undecided: return None

def in_one_pass(tree, t):
    kind = tree[0]
    if kind in ("number", "t", "pi", "e"): return {"t": t, "pi": PI}.get(kind) or (exp_at(Fraction(1)) if kind == "e" else (tree[1],) * 2)
    if kind in ("f", "^"): return function(tree[1], enclose(tree[2], t)) if kind == "f" else power(enclose(tree[1], t), tree[2])
    if kind in ("state", "points"):
        return along_points(*tree[1:], t) if kind == "points" else t.get(tree[1], WHOLE) if isinstance(t, dict) else WHOLE
    return COMBINED[kind](enclose(tree[1], t), enclose(tree[2], t))

# The rational number that a formula without variables is: its enclosure, where that is one number.
def constant(tree):
    low, high = enclose(tree, WHOLE) if not has_variable(tree) else WHOLE
    return decided(low == high, "a constant is not rational, or has too many digits", low)

# The number that a formula is for all t ≥ 0, where one pass shows it.
def constant_for_ever(tree):
    low, high = (attempt(enclose, tree, FOR_EVER) or WHOLE) if has_variable(tree) else enclose(tree, WHOLE)
    decided(has_variable(tree) or float(low) == float(high), "a constant has too many digits")
    # What runs is the double next to it.
    return None if low != high and has_variable(tree) else decimal(repr(float(low)))

def plus(a, b): return b if a == ZERO else a if b == ZERO else ("+", a, b)

nodes = once(lambda tree: 1 + sum(map(nodes, parts_of(tree))))

# Nothing is dropped that may lack a value.
def times(a, b): return ZERO if ZERO in (a, b) and not partial(a) and not partial(b) else b if a == ONE else a if b == ONE else ("*", a, b)

# Whether a formula may lack a value somewhere.
partial = once(lambda tree: tree[0] in ("/", "^") or tree[:2] in (("f", "log"), ("f", "sqrt")) or any(map(partial, parts_of(tree))))

ZERO, ONE = ("number", Fraction(0)), ("number", Fraction(1))

# Whether a formula has a value, and bounded slopes on bounded sets, in every state; undecided where enclosures do not tell.
# So many derivatives of it are taken.
def everywhere(tree, taken=1):
    broken = tree[0] == "^" and tree[2].denominator > 1
    # Above one the slope of a power is bounded at zero, and above two that of its slope.
    low = enclose(tree[1] if broken else tree[2], WHOLE)[0] if broken or tree[:2] in (("f", "log"), ("f", "sqrt")) else INF
    decided(low > 0 or low == 0 and broken and tree[2] > taken, "a root or a logarithm may be of what is not positive")
    return (tree[0] not in ("/", "^") or enclose(tree, WHOLE) is not None) and all(everywhere(part, taken) for part in parts_of(tree))

def negated(tree): return tree if tree == ZERO else ("f", "neg", tree)

# x and c of √(c + x²), whose slope x' sin(atan(x/√c)) stays bounded beside all that its own derivatives are made of, whatever x does.
def root(tree):
    match tree:
        case "f", "sqrt", ("+", ("number", c), ("^", x, 2)) | ("+", ("^", x, 2), ("number", c)): return x, c

# By t, where there are no kinks. A quotient is a product with a power: its divisor is not squared again with every derivative.
@once
def derivative(tree):
    kind = decided(nodes(tree) <= MOST_NODES, "a derivative has too many terms", tree[0])
    if kind == "t" or not has_variable(tree): return ONE if kind == "t" else enclose(tree, WHOLE) and ZERO
    if kind == "points": return decided(tree[3] < 3, "a curve's third derivative jumps") or (*tree[:3], tree[3] + 1)
    a, *_, b = parts_of(tree) * 2
    da, db = derivative(a), derivative(b)
    if kind in "+-*": return plus(*(times(da, b), times(a, db)) if kind == "*" else (da, db if kind == "+" else negated(db)))
    if kind == "/" and not has_variable(b): return da if da == ZERO and inverse(enclose(b, WHOLE)) else ("/", da, b)
    if kind == "/": return plus(da if da == ZERO else ("/", da, b), negated(times(a, times(db, ("^", b, Fraction(-2))))))
    # No power below the first is made, whose slope would divide by what may be zero.
    if kind == "^": return times(da, ONE if tree[2] == 1 else times(("number", tree[2]), a if tree[2] == 2 else ("^", a, tree[2] - 1)))
    if (found := root(tree)) and found[1] > 0:
        return times(derivative(found[0]), ("f", "sin", ("f", "atan", ("/", found[0], ("f", "sqrt", ("number", found[1]))))))
    outer = {"neg": ("number", Fraction(-1)), "sin": ("f", "cos", a), "cos": ("f", "neg", ("f", "sin", a)), "exp": tree,
             "log": ("/", ONE, a), "sqrt": ("/", ("number", Fraction(1, 2)), tree), "tanh": ("-", ONE, ("^", tree, Fraction(2))),
             "atan": ("/", ONE, ("+", ONE, ("^", a, Fraction(2)))) if quotient(a) else ("^", ("f", "cos", tree), Fraction(2))}
    decided(kind == "f" and tree[1] in outer, "a derivative has kinks")
    return times(da, outer[tree[1]])

def limit(tree): return enclose(tree, END)

# Whether an operation is continuous where its parts may tend to, ∞ among it: it makes no ∞ − ∞, 0 · ∞, ∞/∞ or x/0, and does not turn
# for ever.
def joins(tree):
    ends = [attempt(limit, part) or WHOLE for part in parts_of(tree)] or [WHOLE]
    (far, zero), (far_, zero_) = ((any(map(infinite, end)), end[0] <= 0 <= end[1]) for end in (ends[0], ends[-1]))
    return not {"+": far and far_, "-": far and far_, "*": far and zero_ or zero and far_, "/": zero_ or far and far_,
                "^": zero and tree[0] == "^" and tree[2] < 0, "f": far and tree[:2] in (("f", "sin"), ("f", "cos"))}.get(tree[0], False)

# Whether a formula has one limit, which may be ∞.
@once
def settles(tree):
    tree, (low, high) = resolved(tree, END), attempt(limit, tree) or WHOLE
    return low == high or (low, high) != WHOLE and joins(tree) and all(map(settles, parts_of(tree)))

# Whether a formula that is continuous is so uniformly from a time on: it has a limit that is finite, or a bounded slope, or is made of
# what is so by what does not stretch, or by what has values on a bounded set, and is uniformly continuous there; √(c + x²) is
# uniformly continuous in x: its slope is bounded but near a root, where it is the root of what has a bounded one.
@once
def steady(tree, t):
    if (found := root(tree)) and steady(found[0], t): return True
    if not has_variable(tree) or tree[0] == "t" or settles(tree) and not any(map(infinite, limit(tree))): return True
    plain = tree[0] in ("+", "-", "min", "max") or tree[0] == "f" and tree[1] not in ("exp", "log")
    compact = all(finite(part, [t]) for part in parts_of(tree)) and attempt(in_one_pass, tree, t) is not None
    return (plain or compact) and all(steady(part, t) for part in parts_of(tree)) or finite(attempt(derivative, tree) or ("state", ""), [t])

# (q, n) of a constant q πⁿ, by the polynomials that it is made of with π as their variable.
def multiple(tree):
    turned_ = lambda part: ("t",) if part == ("pi",) else tuple(turned_(x) if isinstance(x, tuple) else x for x in part)
    p, q = map(trimmed, quotient(turned_(tree)) or ([], []))
    decided(p and q and not any(p[:-1] + q[:-1]), "an angle does not change, or not by a multiple of a power of π")
    return p[-1] / q[-1], len(p) - len(q)

# (unit, length): with t = unit · u the formula repeats when u grows by `length`, if every t stands in a sine or cosine of q t, or
# of q π t, plus a constant, for rational q. The unit is 1 where they are of π t, π where they are of t.
def period(tree):
    def rates(part):
        if part[0] == "f" and part[1] in ("sin", "cos") and has_variable(part[2]):
            slope = attempt(derivative, part[2]) or ("t",)
            if not has_variable(slope): return [multiple(slope)]
        decided(part[0] not in ("t", "state", "points"), "t stands outside of sines and cosines")
        return [rate for inner in parts_of(part) for rate in rates(inner)]

    found = rates(tree)
    decided(len({n for _, n in found}) == 1 and found[0][1] in (0, 1), "no common period is known")
    common = Fraction(math.gcd(*(q.numerator for q, _ in found)), math.lcm(*(q.denominator for q, _ in found)))
    return ((Fraction(1),) * 2 if found[0][1] == 1 else PI), 2 / common

# --- The scenario, read from its text

LAGRANGIAN, ARMS, MASS = ("planar_arm", "point_mass", "ship", "urdf"), ("planar_arm", "urdf"), ("point_mass",)
# Each law, the robots that it is made for, and the keys of its gains. What is not written is positive by default.
LAWS = {"adaptive": (LAGRANGIAN, "damping adaptation_gain"), "known": (LAGRANGIAN, "damping"),
    "linear_adaptive": (("chain", "vector_chain"), "gain_per_s adaptation_gain"), "linearising": (("chain", "vector_chain"), "gain_per_s"),
    "position_only": (MASS, "damping filter_per_s adaptation_gain"), "immersion": (("chain",), "gain_per_s adaptation_gain"),
    "thrust": (("vehicle", "rotorcraft"), "damping_per_s stiffness adaptation_gain estimate_start_kg"),
    "task_space": (ARMS, "damping adaptation_gain task_gain kinematic_gain torque_share reference_gain_per_s attitude_gain"),
    "attitude": (("spacecraft",), "error_gain_per_s2 rate_gain_per_s filter_gain_per_s damping"),
    "model_reference": (MASS, "filter_per_s adaptation_gain"),
    "adaptive_backstepping": (("strict_feedback", "pure_feedback"), "gains_per_s adaptation_gain"),
    "passivity_filter": (("spacecraft",), "error_gain_n_m filter_gain_per_s damping")}
MADE_FOR, GAINS = ({law: of[k] for law, of in LAWS.items()} for k in (0, 1))
# The first of those that are made for a robot.
USUAL_LAW = {robot: law for law, robots in reversed(MADE_FOR.items()) for robot in robots}
DIRECTIONS = {"ring": ("forward", "both"), "path": ("forward", "both"), "star": ("out", "in", "both"), "complete": ()}
BLIND, ROOTLESS = ("position_only", "model_reference"), ("task_space", "attitude", "passivity_filter")
CHAIN_LAWS, FIRST_ORDER = ("linearising", "linear_adaptive", "immersion", "adaptive_backstepping"), ("continuous", "observer")
LED = dict(differentiable="theorem-9", without_acceleration="remark-12", swarm="swarm", composite="composite", observer="leader-observer")

OTHER_SETTINGS = (" estimate_start estimate_start_kg floor design yaw thrust_start_n rate_bandwidth_per_s end_effector kinematic_start "
                  "bounds estimate_bounds determinant_floor antiderivatives null_space tip_velocity bias_m_s2")
REFERENCE = "roots_per_s exchange manipulability_gain filter_s acceleration_limit design coupling gain sign sign_period_s alpha beta"
DESIRED = "polynomial coupling_polynomial heard follows_target written_in nonlinear stable_because input_to_state_stable_because"
AGENT = "name count robot parameter_variation start reference law target enforce_limits"
CONTROL = "sample_hz computation_delay_s velocity noise quantisation torque_limit torque_rate_limit_per_s safe_command message_timeout_s"

# What a number in the table of a robot has to be, by its key wherever it stands.
SIGNS = {**dict.fromkeys("mass_kg length_m surge_kg sway_kg yaw_kg_m2 width".split(), positive),
         **dict.fromkeys("damping armature coulomb surge_n_s_m sway_n_s_m yaw_n_m_s gravity_m_s2".split(), not_negative)}

# A number, a diagonal or the rows of a matrix as the rows.
def matrix(value, n, where):
    stated = value if isinstance(value, list) else [value] * n
    rows = [row if isinstance(row, list) else [0] * k + [row] + [0] * (n - 1 - k) for k, row in enumerate(stated)]
    return [[exact(x, where) for x in row] for row in such(len(rows) == n, f"{where} has another number of entries", rows)]

# Whether there is such a robot. M is positive definite at all q, by a bound that does not depend on q: a mass is positive; the pivots
# of the inertia of a spacecraft or a rotorcraft are; the minors of a ship's are, in its body, where D + Dᵀ ⪰ 0; of a planar arm with
# a = I₁ + m₁c₁² and b = I₂ + m₂c₂² det M = (a + m₂l₁²) b − (m₂l₁c₂ cos q₂)² ≥ ab + m₂l₁²I₂. Rotors A ⪰ 0 turn M into M + A ⪰ M.
# Factors by which masses, lengths and inertias vary are positive, and change none of this. URDFs are judged where their M is used.
def possible(robot, body, start):
    of = collections.defaultdict(int, {"dimension": 1, "order": 1, **dict(leaves(body))})
    if robot in (*MASS, "vehicle", "rotorcraft") and "mass_kg" not in body: return False
    if robot == "ship":
        minor = of["sway_kg"] * of["yaw_kg_m2"] - of["sway_yaw_kg_m"] ** 2
        return of["surge_kg"] * minor > 0 and 4 * of["sway_n_s_m"] * of["yaw_n_m_s"] >= (of["sway_yaw_n_s"] + of["yaw_sway_n_s"]) ** 2
    if robot == "planar_arm":
        m, l_, c, i = planar(body)
        a, b = (i[k] + m[k] * c[k] ** 2 for k in (0, 1))
        return b > 0 and min(i) >= 0 and a * b + m[1] * l_[0] ** 2 * i[1] > 0
    if robot in ("spacecraft", "rotorcraft"):
        # Wheels turn what has some about every axis if their own axes span all directions.
        wheels = [[exact(x, "axis") for x in wheel.get("axis", [])] for wheel in body.get("wheels", [])] or matrix(1, 3, "axis")
        turns = {len(u) for u in wheels} == {3} and is_definite([[sum(u[i] * u[k] for u in wheels) for k in range(3)] for i in range(3)])
        spun = turns and all(map(any, wheels)) and len(start.get("spacecraft", {}).get("wheel_momentum_n_m_s", wheels)) == len(wheels)
        return spun and is_definite(matrix(body.get("inertia_kg_m2"), 3, "inertia_kg_m2"))
    return of["dimension"] in range(1, 101) and of["order"] in range(1, 256)

# An agent: its name, robot, law, roots, λ, target, and the entry of the file that it comes from, with its place.
class Agent:
    def __init__(self, name, index, entry, place):
        self.name, self.index, self.entry, self.place = name, index, entry, place
        self.robot, self.body = chosen(entry.get("robot"), f"{place}.robot", USUAL_LAW, "robots")
        table(self.body, f"{place}.robot.{self.robot}")
        self.enforced, self.pushes = entry.get("enforce_limits", False) is not False, []

    # The table of its law that has gains: of vehicles that of the design.
    def settings(self): return choice(self.gains.get("design", "differentiable"), "design")[1] if self.law == "thrust" else self.gains

# κ of a real root −κ as (κ, 0), and (a, b), (a, −b) of a pair −a ± b i; real ones first, so that κ₀ is the first where there is one.
# Those of p² + β p + α may be irrational: real ones are rounded towards the axis, pairs away from the real one.
def roots_of(body):
    found = []
    if "alpha" in body:
        alpha, half = positive(body["alpha"], "alpha"), positive(body.get("beta", 1), "beta") / 2
        near = Fraction(math.isqrt(abs((apart := half * half - alpha).numerator) * 10**60 // apart.denominator) + (apart != 0), 10**30)
        return [(alpha, 0)] if "beta" not in body else [(half - near, 0), (half + near, 0)] if apart >= 0 else [(half, near)] * 2
    for root in listed(body["roots_per_s"], "roots_per_s") if "roots_per_s" in body else []:
        paired = root if isinstance(root, dict) else {"real": root, "imaginary": 0}
        a, b = (exact(table(paired, "roots_per_s", "real imaginary").get(key), key) for key in ("real", "imaginary"))
        found += [(a, b), (a, -b)] if root is paired else [(a, b)]
    return sorted(found, key=lambda root: root[1] != 0)

# `to` hears `source`; the weight is a rational number, or the text of a formula.
Edge = collections.namedtuple("Edge", "source to weight delay")

# A polynomial in p by its coefficients from p⁰ on: these without the leading one, which is 1, or its roots.
def polynomial(file):
    if isinstance(file, list): return [exact(c, "polynomial") for c in file] + [Fraction(1)]
    factors = [[a * a + b * b, 2 * a, 1] if b else [a, 1] for a, b in roots_of(file) if b >= 0]
    zeros = such(exact(zeros := file.get("integrators", 0), "integrators") in range(256), "there are too many integrators", zeros)
    return functools.reduce(convolved, [[0, 1]] * int(zeros) + factors, [Fraction(1)])

# The first column of the array of Routh up to the first entry that is not positive: there is none if and only if all roots of the
# polynomial lie to the left of the axis.
def routh(coefficients):
    above, row, column = coefficients[::-2], coefficients[-2::-2], [coefficients[-1]]
    while len(column) < len(coefficients) and column[-1] > 0:
        column.append(row[0] if row else Fraction(0))
        if column[-1] > 0:
            above, row = row, [a - above[0] / column[-1] * b for a, b in itertools.zip_longest(above[1:], row[1:], fillvalue=Fraction(0))]
    return column

# Desired dynamics as the design of the paper that they are: p K(p) beside weights of K(p), or K(p) with a target, K by its roots; and
# before it whether they are one, and the polynomial of those that are none. Of (a5) the root κ₀ that `heard` is of stands first.
def designed(key, body):
    if key != "desired": return False, None, (key, body)
    own, coupled = (body[part] if isinstance(body.get(part), dict) else {} for part in ("polynomial", "coupling_polynomial"))
    roots, heard, tracks = roots_of(own), [exact(number, "heard") for number in body.get("heard", [])], body.get("follows_target", False)
    zeros, told, places = own.get("integrators", 0), "position_velocity" if heard[1:] else "position", body.get("written_in", "measured")
    product = polynomial({"roots_per_s": own["roots_per_s"]})[0] if roots else None
    same = zeros == 1 and not coupled.get("integrators", 0) and sorted(roots_of(coupled)) == sorted(roots) and places == "measured"
    other = lambda root: not heard[1:] or isinstance(root, dict) or exact(root, "a root") * heard[1] != product
    agrees = same and heard[:1] in ([], [product]) and (not heard[1:] or not heard[2:] and not all(map(other, own["roots_per_s"])))
    if not (roots and (alone(body) and not zeros if tracks else agrees and "nonlinear" not in body)):
        return False, polynomial(body["polynomial"]), (key, body)
    return True, None, ("tracking" if tracks else "consensus", {"roots_per_s": sorted(own["roots_per_s"], key=other), "exchange": told})

# Whether nothing but its polynomial and a target enters such dynamics.
def alone(body): return body.get("follows_target", False) and not (body.get("heard") or {"coupling_polynomial", "nonlinear"} & set(body))

class Scenario:
    # `given` are the edges that were drawn, graph by graph.
    def __init__(self, text, folder, given=()):
        self.file, self.folder, self.inputs, self.agents, self.given = read_toml(text), folder, {}, [], iter(given)
        file = table(self.file, "the scenario", "format title time agents reference leader law start network control "
                     "external_wrenches solver goal")
        such(file.get("format") == 2, "`format` must be 2")
        self.end_s = positive(table(file.get("time"), "time").get("end_s"), "time.end_s")
        self.desired, self.polynomial, (self.reference, body) = designed(*choice(file.get("reference"), "reference"))
        self.body = table(body, "reference", DESIRED if self.reference == "desired" else REFERENCE)
        known(self.reference, ("consensus", "pure_integral", "backstepping", "leader", "tracking", "desired"), "reference dynamics")
        self.entries = {f"agents[{k}]": table(x, "agents", AGENT) for k, x in enumerate(listed(file.get("agents"), "agents"))}
        for place, entry in self.entries.items(): self.populate(entry, place)
        self.leader, self.motion, self.names = None, None, [agent.name for agent in self.agents]
        if self.reference == "leader": self.lead(table(file.get("leader"), "leader", "name motion agent"))
        self.index = {name: k for k, name in enumerate(self.names)}
        such(len(self.index) == len(self.names), "two agents have the same name")
        for agent in self.agents:
            agent.roots, agent.manipulability, agent.tracks, agent.target = self.design(agent.place, agent.index == self.leader)
            such(self.suits(agent), f"the law of {agent.name} does not go with these reference dynamics, or with so few roots")
        self.control = table(file["control"], "control", CONTROL) if "control" in file else None
        self.read_network()
        if self.body.get("follows_target") and not self.used(): self.reference = "tracking"
        self.pairs = [{(edge.source, edge.to): edge for edge in graph} for graph in self.graphs]
        self.read_pushes()

    def populate(self, entry, place):
        name, number = name_of(entry.get("name"), f"{place}.name"), exact(entry.get("count", 1), f"{place}.count")
        such(number.denominator == 1 and 1 <= number <= MOST_AGENTS, f"{place}.count must be a whole number of agents")
        names = [f"{name}-{k}" for k in range(1, int(number) + 1)] if "count" in entry else [name]
        such(len(self.agents) + len(names) <= MOST_AGENTS, "there are too many agents")
        such(0 <= exact(entry.get("parameter_variation", {}).get("relative", 0), "relative") <= Fraction(9, 10), "robots vary by too much")
        starts = [x for x in entry.get("start", {}).values() if isinstance(x, list) and x and isinstance(x[0], list)]
        such(all(len(x) == len(names) for x in starts), f"{place} has another number of starts than of agents")
        for each in names:
            agent = Agent(each, len(self.agents), entry, place)
            agent.law, law = chosen(entry.get("law", self.file.get("law", USUAL_LAW[agent.robot])), "law", MADE_FOR, "laws")
            agent.gains = table(law, f"law.{agent.law}", GAINS[agent.law] + OTHER_SETTINGS)
            such(agent.robot in MADE_FOR[agent.law], f"the law `{agent.law}` is not made for `{agent.robot}`")
            self.agents.append(agent)
        for key, x in leaves(agent.body):
            # Gravity of a URDF has a direction.
            if key in SIGNS and (agent.robot, key) != ("urdf", "gravity_m_s2"): SIGNS[key](x, f"{place}: {key}")
        most = {"planar_arm": 5, "point_mass": 1, "ship": 9}.get(agent.robot, len(agent.body.get("parameters", [])))
        given = [key for key, _ in leaves(law.get("estimate_start", 0))].count("given")
        such(given in (0, most) or agent.robot == "urdf" or {"damping", "friction"} & {*agent.body}, f"{place}: not all estimates")
        such(possible(agent.robot, agent.body, entry.get("start", {})), f"{place}: no robot has such an inertia, or such wheels")

    # The leader is an agent, or one vertex more.
    def lead(self, leader):
        if "agent" not in leader:
            self.motion = self.trajectory(leader.get("motion"), "leader.motion")
            self.names.append(name_of(leader.get("name", "leader"), "leader.name"))
        such(leader.get("agent", self.names[-1]) in self.names, "there is no agent of the name of the leader")
        self.leader = self.names.index(leader.get("agent", self.names[-1]))

    # Roots, λ, whether there is a target to follow, and the target of the agents of an entry: their own, else those of all. Who leads
    # shares nothing with those that follow.
    @functools.cache
    def design(self, place, leads):
        key, own = choice(entry["reference"], "reference") if "reference" in (entry := self.entries[place]) else (None, {})
        such(key in (None, "tracking" if leads else self.reference), f"{place} states reference dynamics of another kind")
        own = ({} if leads or self.reference == "leader" else self.body) | table(own, "reference")
        tracks = leads or self.reference == "tracking" or self.body.get("follows_target", False)
        target = self.trajectory(entry["target"], f"{place}.target") if "target" in entry else None
        return roots_of(own), not_negative(own.get("manipulability_gain", 0), "manipulability_gain"), tracks, target

    # Whether the law of an agent is made for its reference dynamics, and these are of the order that it needs, or its plant has.
    def suits(self, agent):
        kind, order = "tracking" if agent.tracks else self.reference, len(agent.body.get("regressors", "")) or agent.body.get("order", 2)
        order = {"position_only": 3, "thrust": 4 if design_of(agent) in ("differentiable", "adaptive") else 3}.get(agent.law, order)
        made = "tracking" if agent.law in (*ROOTLESS, BLIND[1]) else "consensus" if agent.law == "thrust" else "consensus tracking desired"
        fit = kind in made and (kind != "consensus" or self.exchange() == "position") or agent.law in ("adaptive", "known")
        n = len(self.polynomial) - 1 if self.polynomial else len(agent.roots) + (kind == "consensus")
        return fit and (n >= order or agent.law in ("adaptive", "known", *ROOTLESS) and not self.polynomial and kind != "pure_integral")

    def exchange(self):
        told = {"leader": "position_velocity", "backstepping": "position"}.get(self.reference, self.body.get("exchange"))
        return such(told in ("position", "position_velocity"), "`exchange` has another value", told)

    # Motions: for each axis a formula, or a curve through points

    def trajectory(self, file, where):
        kind, body = choice(file, where)
        if kind == "formulas": return [motion_of(entry, where) for entry in listed(body, where)]
        if kind == "sinusoids": return [self.waves(table(entry, where), where) for entry in listed(body, where)]
        known(kind, ("points", "csv"), "motions")
        if kind == "csv":
            cells = [{key: decimal(cell) for key, cell in row.items()} for row in self.csv(table(body, where).get("file"))]
            body = {"times_s": [row.pop("t_s") for row in cells], "positions": [[*row.values()] for row in cells]}
        times = [exact(t, f"{where}.times_s") for t in listed(table(body, where).get("times_s"), where)]
        rows = [[exact(x, f"{where}.positions") for x in listed(row, where)] for row in listed(body.get("positions"), where)]
        such(rising(times) and [*map(len, rows)] == [len(rows[0])] * len(times), f"{where}: times must rise, each with as many entries")
        return [("points", tuple(times), tuple(row[axis] for row in rows), 0) for axis in range(len(rows[0]))]

    # offset + Σ amplitude · sin(rate · t + phase), as a formula.
    @staticmethod
    def waves(entry, where):
        tree = "number", exact(entry.get("offset", 0), where)
        for wave in entry.get("waves", []):
            size, rate, phase = (("number", exact(table(wave, where).get(key, default), f"{where}.{key}"))
                                 for key, default in (("amplitude", None), ("rad_per_s", None), ("phase_rad", 0)))
            tree = plus(tree, times(size, ("f", "sin", plus(times(rate, ("t",)), phase))))
        return tree

    # The text of a file that the scenario names: beside it, in `inputs` beside it, or among the shipped robots.
    def text_of(self, name):
        places = [folder / name for folder in (self.folder, self.folder / "inputs", SHIPPED_ROBOTS) if (folder / name).is_file()]
        decided(places, f"the file `{name}` is not found beside the scenario")
        self.inputs[name], text = read(places[0])
        return text

    def csv(self, name):
        rows = [row for row in csv.reader(io.StringIO(self.text_of(name))) if row and not row[0].lstrip().startswith("#")]
        such(rows and all(len(row) <= len(rows[0]) for row in rows), f"the table `{name}` has rows that are longer than its first")
        return [dict(zip(map(str.strip, rows[0]), map(str.strip, row + [""] * (len(rows[0]) - len(row))))) for row in rows[1:]]

    def read_network(self):
        such("network" in self.file or self.reference == "tracking" or self.body.get("follows_target", False), "`network` is missing")
        self.coupling, network = None, self.file.get("network", {"edges": []})
        table(network, "network", "weight delay link_delays coupling edges switching phases")
        self.weight, self.delay = self.read_weight(network.get("weight", 1)), self.read_delay(network.get("delay", {"constant_s": 0}))
        self.links = {(link.source, link.to): link.delay for link in map(self.edge, network.get("link_delays", []))}
        if "coupling" in network:
            form, scale = chosen(network["coupling"], "coupling", ("saturated", "tanh", "rational"), "couplings")
            self.coupling = form, positive(scale, "coupling")
        such(("edges" in network) != ("phases" in network), "the network must have either `edges` or `phases`")
        phases = listed(network["phases"], "phases") if "phases" in network else [{"edges": network["edges"]}]
        self.graphs = [self.edges(table(phase, "phases", "dwell_s edges").get("edges")) for phase in phases]
        turns = network.get("switching", "repeat") if "phases" in network else "once"
        self.switching, body = chosen(turns, "switching", ("repeat", "once", "log", "random"), "switching")
        if self.switching == "random":
            self.dwell = [positive(x, "dwell_s") for x in pair(table(body, "switching").get("dwell_s"))]
            such(self.dwell[0] <= self.dwell[1], "`dwell_s` must rise")
        elif self.switching == "log":
            self.logged = self.log(self.csv(table(body, "switching", "file").get("file")), "phase")
            such(all(phase in range(1, len(phases) + 1) for phase, *_ in self.logged), "a log has a phase that is none")
            # The last may be cut short by the end of the table.
            self.dwell = [end - start for _, start, end in self.logged[:-1] or self.logged]
        else: self.dwell = [positive(phase.get("dwell_s"), "dwell_s") for phase in (phases if self.switching == "repeat" else phases[:-1])]

    # (entry, from when, until when) of the rows of a log; the last of them is the end.
    def log(self, rows, key):
        times, entries = [decimal(row["t_s"]) for row in rows], [row.get(key) for row in rows]
        such(len(rows) > 1 and times[0] == 0 and rising(times), "a log must begin at 0 and rise")
        such(all(entries[:-1]) and not entries[-1] and times[-1] >= self.end_s, "a log must end with an empty line, and not before the run")
        return [(decimal(entry), start, end) for entry, start, end in zip(entries, times, times[1:])]

    # A rational number, or the text of a formula that is not shown to be one for ever, as 2 + 0 t is.
    def read_weight(self, value):
        same_ = constant_for_ever(formula(value) if isinstance(value, str) else ("number", exact(value, "weight")))
        return value if same_ is None else positive(same_, "weight")

    # (kind, its table, its text): equal texts are one delay.
    def read_delay(self, value):
        kind, body = choice(value, "delay")
        same_ = constant_for_ever(formula(body)) if kind == "formula_s" else None
        kind, body = (kind, body) if same_ is None else ("constant_s", not_negative(same_, "delay"))
        return kind, body, repr((kind, body))

    def edges(self, value):
        rule, body = (None, {}) if isinstance(value, list) else choice(value, "edges")
        body = table(body, "edges", "direction among centre weight delay file in_degree seed")
        found = [self.edge(entry) for entry in value] if rule is None else self.ruled(rule, body)
        pairs = {(edge.source, edge.to) for edge in found}
        such(len(pairs) == len(found) and all(a != b != self.leader for a, b in pairs), "an edge stands twice, to itself, or to the leader")
        return [edge._replace(delay=edge.delay or self.links.get((edge.source, edge.to)) or self.delay) for edge in found]

    def vertex(self, name): return such(name_of(name, "an agent") in self.index, f"there is no agent `{name}`", self.index.get(name))

    def edge(self, entry):
        entry = dict(zip(("from", "to"), pair(entry))) if isinstance(entry, list) else table(entry, "an edge", "from to weight delay")
        return Edge(self.vertex(entry.get("from")), self.vertex(entry.get("to")), *self.terms(entry))

    def terms(self, entry):
        weight = self.read_weight(entry["weight"]) if "weight" in entry else self.weight
        return weight, self.read_delay(entry["delay"]) if "delay" in entry else None

    def ruled(self, rule, body):
        if rule == "csv":
            rows = [{key: cell for key, cell in row.items() if cell} for row in self.csv(body.get("file"))]
            for row in rows:
                row |= {"weight": Fraction(row["weight"])} if DECIMAL.fullmatch(row.get("weight", "")) else {}
                row |= {"delay": {"constant_s": decimal(row.pop("delay_s"))}} if "delay_s" in row else {}
            return [self.edge(row) for row in rows]
        known(rule, (*DIRECTIONS, "random"), "edges")
        members = [self.vertex(name) for name in listed(body["among"], "among")] if "among" in body else list(range(len(self.agents)))
        direction, n = body.get("direction"), len(members)
        if rule == "random": return self.drawn_edges(members, exact(body.get("in_degree"), "in_degree"), body)
        such(rule != "complete" or n * n * len(self.file["network"].get("phases", "1")) <= MOST_EDGES, "there are too many edges")
        after = members[1:] + members[:1] * (rule == "ring" and n > 1)
        sources = [self.vertex(body.get("centre"))] if rule == "star" else members
        pairs = list(zip(members, after)) if rule in ("ring", "path") else [(a, b) for a in sources for b in members if a != b]
        such(direction in (None, *DIRECTIONS[rule]), "`direction` is not one of the rule")
        back = [(b, a) for a, b in pairs]
        return [Edge(a, b, *self.terms(body)) for a, b in dict.fromkeys({"both": pairs + back, "in": back}.get(direction, pairs))]

    # Everybody hears as many others as the rule says; whom, is given.
    def drawn_edges(self, members, in_degree, body):
        node, able = next(self.given, None), set(members)
        decided(node is not None, "the edges of a random graph are drawn, and not given")
        pairs = [tuple(self.index.get(name.text()) for name in ends.each()) for ends in node.each()]
        fit = all(len(ends) == 2 and able.issuperset(ends) and ends[0] != ends[1] for ends in pairs) and len(set(pairs)) == len(pairs)
        heard = collections.Counter(to for _, to in pairs) if fit else {}
        require(node, fit and all(heard[to] == in_degree for to in members), "are not edges that the rule can draw")
        return [Edge(*ends, *self.terms(body)) for ends in pairs]

    # What acts from outside: for every agent the end of each push, infinite where there is none

    def read_pushes(self):
        for push in self.file.get("external_wrenches", []):
            push = table(push, "external_wrenches", "on from_s for_s by")
            begins = not_negative(push.get("from_s", 0), "from_s")
            ends = begins + positive(push["for_s"], "for_s") if "for_s" in push else INF
            acting = [(max(begins, first), min(ends, last), trees, kind) for first, last, trees, kind in self.courses(push.get("by"))]
            for name in listed(push.get("on"), "on"):
                meant = [agent for agent in self.agents if name in (agent.name, agent.entry["name"])]
                such(meant, f"there is no agent `{name}`")
                for agent in meant: agent.pushes += [each for each in acting if each[0] < each[1]]

    # From when until when the tables of a push have values; (0, ∞) for formulas, which follow, and what kind it is.
    def courses(self, by):
        kind, body = choice(by, "by")
        keys = ("force_n", "torque_n_m") if kind == "wrench" else ("target", "target_rad", "target_m")
        parts = kind == "wrench" or kind.startswith("virtual_spring")
        for file in [table(body, "by")[key] for key in keys if key in body] if parts else [body]:
            form, rows = choice(file, "by") if not isinstance(file, list) else ("formulas", file)
            known(form, ("rows", "csv", "formulas"), "courses")
            times = [Fraction(0), INF]
            if form == "rows": times = [exact(t, "times_s") for t in listed(table(rows, "rows").get("times_s"), "times_s")]
            if form == "csv": times = [decimal(row.get("t_s", "")) for row in self.csv(table(rows, "csv").get("file"))]
            yield min(times), max(times), [motion_of(x, "by") for x in rows] if form == "formulas" else [], kind

    def used(self): return [edge for graph in self.graphs for edge in graph]

    def varying(self): return sorted({edge.weight for edge in self.used() if isinstance(edge.weight, str)})

    # Whether one graph, with its weights and delays, or whatever these are, is in force in all phases, or in some.
    def fixed(self, phases=None, delays=True):
        graphs = [{(e.source, e.to, e.weight, delays and e.delay[2]) for e in self.graphs[k]} for k in phases or range(len(self.graphs))]
        return all(graph == graphs[0] for graph in graphs)

    # The phases that are in force again and again, or for ever.
    def recurring(self): return [len(self.graphs) - 1] if self.switching == "once" else list(range(len(self.graphs)))

    # The same where what comes after the run is known.
    def for_ever(self): return decided(self.switching != "log", "what comes after a log is not known", self.recurring())

    # What (110) works over: whether graphs take turns, or links delay.
    def over(self):
        turns, late = not self.fixed(), any(rule_range(edge.delay)[1] != 0 for edge in self.used())
        return "" if turns == late else "-switching" if turns else "-late"

    # Whether all edges among agents lead both ways with the same weight.
    def mutual(self, graph):
        among = {(edge.source, edge.to, edge.weight) for edge in graph if self.leader not in (edge.source, edge.to)}
        return all((to, source, weight) in among for source, to, weight in among)

    # Whether the torque that a law asks for may not be applied.
    def limited(self):
        c, steps = self.control or {}, exact(table((self.control or {}).get("quantisation", {}), "quantisation").get("torque", 0), "torque")
        return steps or {"torque_limit", "torque_rate_limit_per_s"} & {*c} or any(a.enforced or "rotors" in a.body for a in self.agents)

    # [from, to, phase] of the certificate as numbers; None for who is unknown.
    def triple(self, node):
        parts = require(node, len(node.each()) == 3, "must be [from, to, phase]", node.each())
        return [self.index.get(part.text()) for part in parts[:2]] + [parts[2].count() - 1]

    # The edge that such a triple means.
    def edge_at(self, node):
        *ends, phase = self.triple(node)
        require(node, 0 <= phase < len(self.graphs) and tuple(ends) in self.pairs[phase], "is no edge of this phase")
        return self.pairs[phase][tuple(ends)]

# The bytes of a file and its text.
def read(path):
    try:
        such(path.stat().st_size <= MOST_BYTES, f"{path} is too large")
        return (data := path.read_bytes()), data.decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error: raise Meaningless(f"{path} cannot be read: {error}") from None

# --- Which theorem speaks, and what it asks for

def design_of(agent): return choice(agent.gains.get("design", "differentiable"), "design")[0]

def treated(agent):
    if agent.law == "thrust": return f"thrust {design_of(agent)}"
    return agent.law.replace("_", " ") if agent.law in BLIND + ROOTLESS else "chain" if agent.law in CHAIN_LAWS else "lagrangian"

# Of tips with more than a position, or with more joints than coordinates.
def extension(agent):
    posed = agent.law == "task_space" and table(agent.gains.get("end_effector", {}), "end_effector").get("follows") == "pose"
    return "-pose" if posed else "-redundant" if "null_space" in agent.gains else ""

def theorem(scenario):
    tracking, agents = scenario.reference == "tracking", scenario.agents
    if scenario.reference == "desired": return "desired-dynamics"
    if scenario.reference == "leader": return (LED | {"continuous": "theorem-8" + scenario.over()}).get(scenario.body.get("design"), "none")
    if len(kinds := {treated(agent) for agent in agents}) > 1: return "targets" if tracking else "mixture"
    tip = "tip-velocity" if any("tip_velocity" in agent.gains for agent in agents) else "theorem-6" + max(map(extension, agents))
    named = {"thrust continuous": "continuous-thrust", "thrust differentiable": "theorem-4", "thrust adaptive": "theorem-5",
             "thrust by_acceleration": "thrust-by-acceleration", "attitude": "theorem-7", "passivity filter": "passivity-filter",
             "task space": tip, "chain": "chains-track" if tracking else "chains-agree",
             "position only": "position-only-tracks" if tracking else "remark-7", "model reference": "model-reference"}
    if (kind := kinds.pop()) in named or tracking: return named.get(kind, "robots-track")
    velocities, order, how = scenario.exchange() == "position_velocity", max(len(agent.roots) for agent in agents), scenario.reference
    if how == "consensus" and len({len(agent.roots) for agent in agents}) > 1: return "theorem-3-own-orders"
    if how != "consensus": return how if how == "backstepping" else "theorem-1" if velocities else "remark-3"
    if not velocities or order == 1: return "theorem-3-first-order" if velocities else "theorem-3-positions"
    return "theorem-2" if order == 2 and all(agent.roots == agents[0].roots for agent in agents) else "theorem-3-velocities"

# The hypotheses that a certificate must speak about: (id, name of an agent, or "" for the whole).
def requirements(scenario):
    agents, reference, design, control = scenario.agents, scenario.reference, scenario.body.get("design"), scenario.control
    agreeing, leading = reference in ("consensus", "pure_integral", "backstepping"), reference == "leader"
    turns, late = (leading and design in (*FIRST_ORDER, "composite") and scenario.over() == each for each in ("-switching", "-late"))
    kinds = {treated(agent) for agent in agents if agent.index != scenario.leader}
    tips, flying, chains, lagrangian, adaptive = ([agent for agent in agents if agent.law in laws] for laws in (
        ("task_space",), ("thrust",), CHAIN_LAWS, ("adaptive", "known"), ("linear_adaptive", "adaptive_backstepping")))
    designs = [{design_of(agent) for agent in flying if agent.robot == robot} for robot in ("vehicle", "rotorcraft")]
    asked = [(agreeing, "spanning-tree"), (agreeing or reference == "desired", "dwell-time bounded-delays"), (flying, "nonzero-thrust"),
        (reference in ("consensus", "pure_integral"), "real-roots"), (reference == "pure_integral" or leading and not turns, "fixed-graph"),
        (reference == "consensus", "common-order" if len({len(a.roots) for a in agents}) == 1 else "own-orders"),
        (scenario.coupling and such((reference, scenario.exchange()) == ("consensus", "position"), "unlike it", 1), "coupling-sector"),
        (agreeing and scenario.exchange() == "position_velocity", "common-first-root"), (any(a.pushes for a in agents), "pushes-end"),
        (agreeing and any(a.manipulability > 0 for a in agents), "manipulability"), ({"continuous"} in designs, "known-masses"),
        (leading, "bounded-leader sign-gain set-valued-sign shared-design " + ("bounded-delays" if late else "no-delay")),
        (leading, "leader-in-every-graph dwell-time" if turns else "leader-reaches-all"),
        (leading and (late or design not in (*FIRST_ORDER, "composite", "swarm")), "constant-weights"), (lagrangian, "positive-gains"),
        (rooted(scenario) or leading and design != "swarm", "hurwitz"), (design == "swarm", "printed-design mutual-weights swarm-coupling"),
        (reference != "tracking" and scenario.varying(), "bounded-weights"), (any("rotors" in a.body for a in flying), "every-wrench"),
        (len(kinds) > 1 and not all(a.tracks for a in agents), "one-kind"), ("thrust by_acceleration" in kinds, "unbiased-acceleration"),
        (True, " ".join(f"{a.law.replace('_', '-')}-gains" for a in agents if treated(a) == a.law.replace("_", " "))),
        (any(each - {"continuous"} for each in designs), "thrust-gains"), (lagrangian or tips, "uniform-inertia"),
        (any(a.robot == "rotorcraft" for a in agents), "angular-velocity"), (frictions(scenario), "smooth-friction"),
        (chains, "defined-terms input-factor " + ("chain-adaptation" if any(a.law != "linearising" for a in chains) else "chain-gains")),
        (any(a.body.get("parameters") for a in adaptive), "bounded-regressors"), (scenario.polynomial, "desired-dynamics"),
        (any(a.pushes and a.robot.endswith("feedback") for a in chains), "matched-disturbance"), (control is not None, "continuous-time"),
        (any(not a.tracks for a in lagrangian) or tips, "bounded-dynamics"), (reference == "backstepping", "measured-derivative"),
        (any(map(bounds_of, agents)), "parameters-within-bounds"),
        (True, "applied-torque" + " desired-design" * scenario.desired), (control is not None and inexact(control), "exact-measurements"),
        (control is not None and "message_timeout_s" in control, "messages-in-time")]
    found = {(each, "") for condition, ids in asked if condition for each in ids.split()}
    for a in agents:
        tip, filtered, posed, turns = a.law == "task_space", a.law == "passivity_filter", extension(a) == "-pose", a.robot == "spacecraft"
        own = [(a.target, "bounded-target"), (a.target and (turns or posed), "nonzero-quaternion"), (posed, "start-attitude"),
               (turns and not (filtered and still(a)), "known-momentum"), (filtered, "target-at-rest"), (tip, "regular-jacobian"),
               (tip and a.robot == "planar_arm", "target-within-reach"), (tip and a.robot == "urdf", "certain-regressor"),
               (tip and "bounds" in a.gains, "lengths-within-bounds")]
        found |= {(each, a.name) for condition, each in own if condition}
    return found

# Whether each entry of a target is a constant.
def still(agent): return all(attempt(constant_for_ever, derivative(tree)) == 0 for tree in agent.target or [])

# Who follows a target by roots.
def rooted(scenario): return [a for a in scenario.agents if a.tracks and a.law not in ROOTLESS and not scenario.polynomial]

# Whether measurements have noise, steps, or come from a filter.
def inexact(control):
    parts = [(table(control.get(k, {}), k), entry) for k in ("noise", "quantisation") for entry in ("position", "velocity", "tip_velocity")]
    return choice(control.get("velocity", "measured"), "velocity")[0] != "measured" or any(exact(x.get(k, 0), k) > 0 for x, k in parts)

# Hypotheses that only a run can show, or that the paper does not cover whenever they are asked for: no claim is right.
NEVER = ("one-kind", "measured-derivative", "printed-design", "nonzero-thrust", "angular-velocity", "every-wrench",
         "bounded-regressors", "regular-jacobian", "continuous-time", "exact-measurements")
# --- Rules: each shows some kinds of proof of some hypotheses. Their parameters are the fields of the proof. A rule gives whether what
# --- is shown holds for all time where that is not plain. `WITNESSES` show that a hypothesis is violated.
RULES = {}
WITNESSES = ("cut", "unheard", "instant", "factor", "null-vector", "below", "limit", "loses-all", "diverges", "no-value", "out-of-reach",
             "unmoved", "no-routh", "half-turn", "outside", "left-null", "fades", "vanishes", "changes-sign", "starts-below", "older")

def rule(ids, kinds): return lambda check: RULES.update(dict.fromkeys(itertools.product(ids.split(), kinds.split()), check)) or check

# One entry of the certificate.
class Claim:
    def __init__(self, scenario, entry):
        entry.only("id", "agents", "answer", "proof")
        self.scenario, self.entry, self.proof = scenario, entry, entry.optional("proof")
        self.id, self.answer = entry.field("id").text(), entry.field("answer").text()
        self.agents = [name.text() for name in entry.field("agents").each()]
        require(entry.field("agents"), all(name in scenario.index for name in self.agents), "names somebody unknown")
        self.own = [scenario.agents[scenario.index[name]] for name in self.agents if scenario.index[name] < len(scenario.agents)]
        require(entry.field("answer"), self.answer in (HOLDS, ON_RUN, VIOLATED, *UNCLAIMED), "is no answer")

    # (outcome, words).
    def judge(self):
        require(self.entry, self.proof is None or self.answer not in UNCLAIMED, "has a proof, and claims nothing")
        decided(self.answer not in UNCLAIMED, f"nothing is claimed: {self.answer}")
        require(self.entry.field("answer"), self.id not in NEVER or self.answer == VIOLATED, "is a claim that nothing before a run shows")
        decided(self.proof is not None, "there is no proof")
        decided(self.id in {each for each, _ in RULES}, "no proof of it is known here")
        self.kind = kind = self.proof.field("kind").text()
        check = RULES.get((self.id, kind))
        require(self.proof.field("kind"), check is not None, f"is no proof of `{self.id}`")
        fields = check.__code__.co_varnames[1:check.__code__.co_argcount]
        self.proof.only("kind", *fields)
        needed_ = len(fields) - len(check.__defaults__ or ())
        found = check(self, *map(self.proof.field, fields[:needed_]), *map(self.proof.optional, fields[needed_:]))
        shown = (VIOLATED,) if kind in WITNESSES else (HOLDS, ON_RUN) if found in (None, True) else (ON_RUN,)
        require(self.entry.field("answer"), self.answer in shown, f"is more than the proof shows: {' or '.join(shown)}")
        told = [f"{key} {str(self.proof.value[key])[:40]}" for key in fields if isinstance(self.proof.value.get(key), (int, str))]
        return ACCEPTED, ", ".join([kind, *told])

# Follows an arborescence: triples [from, to, phase] of edges that exist, each from who has been reached; all are.
def reach(scenario, node, root, allowed):
    reached = {scenario.index.get(root.text())}
    require(root, None not in reached, "is no vertex")
    for step in node.each():
        *ends, phase = scenario.triple(step)
        require(step, phase in allowed, "is of a phase outside of the window")
        require(step, tuple(ends) in scenario.pairs[phase], "is no edge of this phase")
        require(step, ends[0] in reached, "leads from an agent that has not been reached")
        reached.add(ends[1])
    require(node, len(reached) == len(scenario.names), "does not reach everybody")

# Windows that follow each other along a sequence of phases, each with a tree; where they end.
def tiled(claim, windows, sequence):
    ends = [0]
    for window in windows.each():
        stated, root, arborescence = window.fields("phases", "root", "arborescence")
        phases, at = [phase.count() - 1 for phase in stated.each()], ends[-1]
        require(stated, phases == sequence[at:at + len(phases)], "are not the phases that follow")
        # No edge leads to a leader, so that a root from which everybody is reached is the leader where there is one.
        reach(claim.scenario, arborescence, root, {*phases})
        ends.append(at + len(phases))
    return require(windows, len(ends) > 1, "must be some", ends)

# Windows tile whole periods: any stretch of time twice as long as the longest of them holds a whole one. Where each phase has a tree of
# its own, the order does not matter.
@rule("spanning-tree leader-reaches-all leader-in-every-graph", "windows every-phase")
def tiling(claim, windows):
    scenario, phases, single = claim.scenario, claim.scenario.for_ever(), claim.kind == "every-phase"
    ordered = (scenario.switching != "random" or len(scenario.graphs) == 1) and claim.id != "leader-in-every-graph"
    require(claim.proof, single or ordered, "is of no drawn schedule")
    lengths = [len(window.field("phases").each()) for window in windows.each()]
    require(windows, not single or lengths == [1] * len(phases), "must be one for each phase")
    require(windows, sum(lengths) % len(phases) == 0 and sum(lengths) <= MOST_CELLS, "must cover whole periods")
    tiled(claim, windows, phases * (sum(lengths) // len(phases)))

# (phase, from when, until when) of a drawn sequence that is given.
def drawn(scenario, given):
    # Drawn in floating point: a dwell may leave its bounds by a part of 10^9.
    (low, high), room, found, start = scenario.dwell, Fraction(1, 10**9), [], Fraction(0)
    for entry in given.each():
        phase, until_s = entry.fields("phase", "until_s")
        found.append((phase.count(), start, start := until_s.number()))
        require(entry, 1 <= found[-1][0] <= len(scenario.graphs), "is no phase")
        require(entry, low * (1 - room) <= start - found[-1][1] <= high * (1 + room), "lasts shorter or longer than the scenario allows")
    return require(given, start >= scenario.end_s, "ends before the run", found)

# Such a sequence, or that of a log, tiled by windows up to the end of the run but for a rest that is no longer than is stated.
@rule("spanning-tree leader-reaches-all", "drawn logged")
def along(claim, windows, longest_s, given=None):
    scenario, kind = claim.scenario, claim.kind
    require(claim.proof, (scenario.switching, given is None) == (("random", False) if kind == "drawn" else ("log", True)), f"is not {kind}")
    sequence = drawn(scenario, given) if given else scenario.logged
    t, ends = [Fraction(0), *(end for *_, end in sequence)], tiled(claim, windows, [int(phase) - 1 for phase, *_ in sequence])
    # How long they are, and how long one waits for the phase that completes a window, or in vain.
    longest, wait = map(max, zip(*([t[b] - t[a], t[b - 1] - t[a]] for a, b in zip(ends, ends[1:])), [scenario.end_s - t[ends[-1]]] * 2))
    require(longest_s, longest <= longest_s.number() and 2 * wait <= scenario.end_s, "is exceeded, or one waits for half of the run")
    return False

# Groups of agents that hear nobody outside of their own in some phases, if they are disjoint.
def closed(scenario, nodes, phases):
    groups = [{scenario.index.get(name.text()) for name in node.each()} for node in nodes]
    for node, group in zip(nodes, groups): require(node, group and None not in group, "must name agents")
    place = {agent: k for k, group in enumerate(groups) for agent in group}
    for phase, (source, to) in ((phase, ends) for phase in phases for ends in scenario.pairs[phase] if ends[1] in place):
        words = f"is not closed: {scenario.names[to]} hears {scenario.names[source]} in phase {phase + 1}"
        require(nodes[place[to]], place.get(source) == place[to], words)
    return groups

# Two disjoint groups, or one without the leader, that hear no agent outside themselves in what recurs: no tree, for ever.
@rule("spanning-tree leader-reaches-all", "cut")
def cut(claim, groups):
    sets, leader = closed(claim.scenario, groups.each(), claim.scenario.for_ever()), claim.scenario.leader
    if claim.id == "leader-reaches-all": require(groups, len(sets) == 1 and leader not in sets[0], "must be one group without the leader")
    else: require(groups, len(sets) > 1 and sum(map(len, sets)) == len(set().union(*sets)), "must be two or more that are disjoint")

# In this phase, which recurs, a group without the leader does not.
@rule("leader-in-every-graph", "unheard")
def unheard(claim, phase, group):
    require(phase, phase.count() - 1 in claim.scenario.for_ever(), "does not recur")
    require(group, claim.scenario.leader not in closed(claim.scenario, [group], [phase.count() - 1])[0], "must name agents alone")

@rule("dwell-time", "shortest-phase")
def shortest_phase(claim, shortest_s):
    require(shortest_s, 0 < shortest_s.number() <= min(claim.scenario.dwell, default=0), "is not below the shortest phase")
    return claim.scenario.switching != "log"

# Those whose M, C and g the proofs use: of each entry one, like which all are.
def robots(scenario): return {a.place: a for a in scenario.agents if a.law in ("adaptive", "known", "task_space")}.values()

MOVING = ("revolute", "continuous", "prismatic")

# For what reads the URDF of an agent, as (agent, XML, what is locked).
def of_urdf(reader):
    def guarded(scenario, agent):
        text = re.sub(r"\sxmlns=(\"[^\"]*\"|'[^']*')", "", scenario.text_of(agent.body["file"]))
        try: return reader(agent, ElementTree.fromstring(text), table(agent.body.get("locked", {}), "lock"))
        except (ElementTree.ParseError, AttributeError, TypeError, LookupError, RecursionError, ValueError):
            raise Undecided("a URDF cannot be read here") from None
    return guarded

# Three numbers of an element of a URDF.
def numbers(element, key, usual="0 0 0"):
    return [decimal(x) for x, _ in zip((usual if element is None else element.get(key, usual)).split(), range(3), strict=True)]

def parallel(a, b): return all(a[k - 2] * b[k - 1] == a[k - 1] * b[k - 2] for k in range(3))

# For every joint of a URDF that moves: whether it slides, its axis, the axes that those above it turn about, its friction, and of each
# body that it moves with its link, up to the next joints, mass, pivots of the central inertia, centre, and that inertia, unless its own
# frame is turned. To an axis that something turns, be it a joint or a placement, the axis of that turn is added: one that is parallel
# to all is where it was, seen from each link.
@of_urdf
def links(agent, root, locked):
    def body(link):
        if (inertial := link.find("inertial")) is None: return 0, [0] * 3, [0] * 3, None
        rows = [[decimal(inertial.find("inertia").get(f"i{k}", "0")) for k in row.split()] for row in ("xx xy xz", "xy yy yz", "xz yz zz")]
        centre, turns = (numbers(inertial.find("origin"), key) for key in ("xyz", "rpy"))
        return decimal(inertial.find("mass").get("value")), pivots(rows), centre, None if any(turns) else rows

    def visit(name, own, above):
        own.append(bodies[name])
        for joint in (joint for joint in joints if joint.find("parent").get("link") == name):
            kind, child, axis = joint.get("type"), joint.find("child").get("link"), numbers(joint.find("axis"), "xyz", "1 0 0")
            such(kind in (*MOVING, "fixed") and any(axis), "a joint is of a kind that no robot here has")
            moves, rubs = kind != "fixed" and joint.get("name") not in locked, (of.get("friction", "0") for of in joint.findall("dynamics"))
            placed_ = [[i == k for i in range(3)] for k, angle in enumerate(numbers(joint.find("origin"), "rpy")) if angle and above]
            if moves: found.append((kind == "prismatic", axis, above + placed_, sum(map(decimal, rubs)), []))
            visit(child, found[-1][-1] if moves else own, above + placed_ + [axis] * (kind in MOVING[:2] and bool(moves or above)))

    bodies, joints, found = {link.get("name"): body(link) for link in root.findall("link")}, root.findall("joint"), []
    for name in set(bodies) - {joint.find("child").get("link") for joint in joints}: visit(name, [], [])
    return found

# A joint of a URDF: `locked` is where it stands if it is.
Joint = collections.namedtuple("Joint", "kind moves locked axis rpy xyz")

# The joints of a URDF from the tip to the base.
@of_urdf
def path(agent, root, locked):
    joints, link, found = {of.find("child").get("link"): of for of in root.findall("joint")}, agent.gains["end_effector"]["link"], []
    while link in joints:
        origin, link, angle = (joint := joints.pop(link)).find("origin"), joint.find("parent").get("link"), locked.get(joint.get("name"))
        found.append(Joint(joint.get("type"), joint.get("type") in MOVING and angle is None, exact(angle or 0, "locked"),
                           numbers(joint.find("axis"), "xyz", "1 0 0"), numbers(origin, "rpy"), numbers(origin, "xyz")))
    return found

NOWHERE, BASIS = [(Fraction(0),) * 2] * 3, [[(Fraction(i == k),) * 2 for i in range(3)] for k in range(3)]

def dot(a, b): return functools.reduce(add, map(multiply, a, b))

def cross(a, b): return [add(multiply(a[k - 2], b[k - 1]), minus(multiply(a[k - 1], b[k - 2]))) for k in range(3)]

def square(entries): return functools.reduce(add, (power(x, Fraction(2)) for x in entries))

def unit(axis): return [multiply((x, x), inverse(function("sqrt", square((x, x) for x in axis)))) for x in axis]

# A vector, turned about one of length one: a cos φ + u × a sin φ + u (u·a) (1 − cos φ).
def turned(at, u, angle):
    sin, cos = sine((angle,) * 2, False), sine((angle,) * 2, True)
    along = multiply(dot(u, at), add((1, 1), minus(cos)))
    return [add(add(multiply(cos, x), multiply(sin, y)), multiply(along, z)) for x, y, z in zip(at, cross(u, at), u)]

# A direction of a link as the one that carries it sees it: turned by the joint, then by roll, pitch and yaw.
def carried(at, joint, angle):
    turns = [(unit(joint.axis), angle)] if joint.kind != "prismatic" and angle != 0 else []
    return functools.reduce(lambda at, turn: turned(at, *turn), [*turns, *zip(BASIS, joint.rpy)], at)

# A place of it: what slides moves it first.
def placed(at, joint, angle):
    if joint.kind == "prismatic" and angle != 0: at = [add(x, multiply((angle,) * 2, u)) for x, u in zip(at, unit(joint.axis))]
    return [add(x, (own, own)) for x, own in zip(carried(at, joint, angle), joint.xyz)]

# Where the first joint that moves is, and the translations from each to the next and to the tip, as the links that carry them see them.
def translations(scenario, agent):
    found, at = [], [(exact(x, "at_m"),) * 2 for x in agent.gains["end_effector"].get("at_m", [0] * 3)]
    decided(len(at) == 3, "the place of a tool has no three coordinates")
    for joint in path(scenario, agent):
        found, at = ([*at, *found], NOWHERE) if joint.moves else (found, at)
        at = placed(at, joint, joint.locked)
    return at, found

# Where the first joint that moves is, and the squares of the least and the largest distance from it to the tip, which no posture leaves:
# what the longest length exceeds all others by, and all together.
def outstretched(scenario, agent):
    decided(all(joint.kind != "prismatic" for joint in path(scenario, agent)), "a joint that slides carries the tip")
    (at, found), axes = translations(scenario, agent), agent.gains["end_effector"].get("coordinates", "xyz")
    parts = [function("sqrt", square(found[k:k + 3])) for k in range(0, len(found), 3)]
    most = functools.reduce(add, parts)
    # The distance along two axes may be smaller, and what is reached there is another.
    least = decided(len(axes) == 3, "reach along two axes is not known", [max(2 * x[k] - most[1 - k] for x in parts) for k in (0, 1)])
    return [at["xyz".index(axis)] for axis in axes], tuple(x * abs(x) for x in least), multiply(most, most)

# q at the start, where the text has it as numbers: one list for each of those that share a table, or one for all.
def posture(scenario, agent):
    for file, sharing in ((agent.entry, [one for one in scenario.agents if one.entry is agent.entry]), (scenario.file, scenario.agents)):
        for value in (file["start"][key] for key in ("position_rad", "position_m", "position") if key in file.get("start", {})):
            decided(isinstance(value, list), "a start is drawn")
            return [exact(x, "start") for x in (value[sharing.index(agent)] if isinstance(value[0], list) else value)]
    raise Undecided("a start is not stated")

# The joints from the tip to the base, each with where it stands at the start.
def standing(scenario, agent):
    angles, upright = posture(scenario, agent), Joint("revolute", True, 0, [0, 0, 1], [0] * 3, [0] * 3)
    joints = [upright] * 2 if agent.robot == "planar_arm" else path(scenario, agent)
    decided(len(angles) == sum(joint.moves for joint in joints), "not every joint carries the tip")
    return [(joint, angles.pop() if joint.moves else joint.locked) for joint in joints]

# Columns of the rotation matrix of a tip at the start.
def rotation(scenario, agent): return functools.reduce(lambda at, stood: [carried(x, *stood) for x in at], standing(scenario, agent), BASIS)

# The lengths that may be uncertain: of a planar arm, of a tool, or of all that moves.
def lengths(scenario, agent):
    share = exact(agent.entry.get("parameter_variation", {}).get("relative", 0), "relative")
    if agent.robot == "planar_arm": return [(x * (1 - share), x * (1 + share)) for x in planar(agent.body)[1]]
    return translations(scenario, agent)[1][0 if agent.gains["end_effector"].get("uncertain", "tool") == "chain" else -3:]

# The same as a law starts from them.
def estimated(scenario, agent):
    kind, body = choice(agent.gains.get("kinematic_start", {"scaled": Fraction(6, 5)}), "kinematic_start")
    if kind not in ("zero", "true", "scaled"): return [(exact(x, kind),) * 2 for x in listed(body, kind)]
    return [multiply((exact(body, kind) if kind == "scaled" else Fraction(kind == "true"),) * 2, x) for x in lengths(scenario, agent)]

# Columns of the estimated Jacobian of a tip at the start: its place in the base, and of a pose how the link turns.
def jacobian(scenario, agent):
    columns, tip, learnt = [], table(agent.gains.get("end_effector", {}), "end_effector"), estimated(scenario, agent)
    still = translations(scenario, agent)[1][:-len(learnt)] + learnt if tip else sum(([x, *NOWHERE[1:]] for x in learnt), [])
    at, rows = NOWHERE, tip.get("coordinates", "xyz") if tip else "xy"
    for joint, angle in standing(scenario, agent):
        if joint.moves:
            u, slides, at, still = unit(joint.axis), joint.kind == "prismatic", list(map(add, at, still[-3:])), still[:-3]
            columns.append((u, NOWHERE) if slides else (cross(u, at), u))
            at = [add(x, multiply((angle * slides,) * 2, own)) for x, own in zip(at, u)]
        columns, at = [[carried(part, joint, angle) for part in column] for column in columns], carried(at, joint, angle)
    return [[place["xyz".index(k)] for k in rows] + (turn if tip.get("follows") == "pose" else []) for place, turn in columns[::-1]]

# The kinds of friction at the joints of robots where there is some.
def frictions(scenario):
    kinds = ("ignore", "dry", "smooth")
    stated = [(a, *chosen(a.body["friction"], "friction", kinds, "frictions")) for a in scenario.agents if "friction" in a.body]
    forces = lambda a, body: body["coulomb"] if "coulomb" in body else [force for *_, force, _ in links(scenario, a)]
    return {kind for a, kind, body in stated for _, force in leaves(forces(a, body)) if exact(force, "coulomb") and kind != "ignore"}

# M is positive definite at every q if no body has a negative mass or inertia, and every joint moves some: T = 0 leaves them at rest, and
# from the base on no joint can move without moving what has mass, if it slides, or turning what has a central inertia I ≻ 0, or one
# with uᵀ I u > 0 for its axis u, or a mass beside the axis. It is so uniformly if M repeats with the angles, and depends on nothing
# else; or if every link that moves has mass and a central inertia ≻ 0, with all that is fixed to it: 2 T ≥ μ Σ(|vᵢ|² + |ωᵢ|²), and
# these bound q̇ for all q: |q̇ᵢ| ≤ |ωᵢ| + |ωₚ|, or ≤ |vᵢ| + |vₚ| + rᵢ |ωₚ| where i slides on p.
def solid(scenario, agent):
    slides, axis, *_, end = (found := links(scenario, agent))[-1]
    possible = all(mass >= 0 and min(inertia) >= 0 and len(inertia) == 3 for *_, bodies in found for mass, inertia, *_ in bodies)
    whole = all(any(mass > 0 and min(inertia) > 0 for mass, inertia, *_ in bodies) for *_, bodies in found)
    felt = all(any(mass > 0 if slides else min(inertia) > 0 for mass, inertia, *_ in bodies) or not slides and about(axis, bodies[0]) > 0
               or bodies[0][0] > 0 and not parallel(axis, bodies[0][2]) for slides, axis, *_, bodies in found)
    # A link at an end that is nothing, or a point or a line on the axis that it turns about, moves without effort.
    seen = lambda k, body: body[1] != [0] * 3 if slides or k > 0 or not body[3] else about(axis, body) != 0
    moves = all(mass >= 0 for *_, bodies in found for mass, *_ in bodies) and any(
        seen(k, body) or body[0] and (slides or k > 0 or not parallel(axis, body[2])) for k, body in enumerate(end))
    return moves and not decided(possible and (whole or felt and not swung(found)), "a link of a URDF may have no inertia of its own")

# uᵀ I u of a central inertia I that is seen from the link of an axis u; else zero.
def about(axis, body): return sum(a * x * b for a, row in zip(axis, body[3] or ()) for x, b in zip(row, axis))

# Whether the travel of a joint that slides enters velocities: where one above it turns about another direction. About its own, what
# turns keeps its distance from the axis, and gravity pulls by a constant along it.
def swung(found): return any(slides and not all(parallel(axis, turn) for turn in above) for slides, axis, above, *_ in found)

# q enters C and g by sines and cosines of angles, and by such travel.
def unturned(scenario, agent): return agent.robot != "urdf" or not swung(links(scenario, agent)) or decided(False, "a slide may be turned")

# Masses, lengths, centres of mass and central inertias of a planar arm.
def planar(body):
    of = {key: [exact(x, key) for x in pair(body[key])] for key in ("mass_kg", "length_m", "com_m", "inertia_kg_m2") if key in body}
    m, l_ = of["mass_kg"], of["length_m"]
    return m, l_, of.get("com_m", [x / 2 for x in l_]), of.get("inertia_kg_m2", [m[k] * l_[k] ** 2 / 12 for k in (0, 1)])

# A share on either side of a parameter, or all from zero to twice a friction, holds it; bounds that are given have to.
def bounds_of(agent): return agent.settings().get("estimate_bounds" if agent.law == "task_space" else "bounds")

def in_bounds(agent):
    kind, body = chosen(bounds_of(agent) or {"within": 1}, "bounds", ("within", "given"), "bounds")
    if kind == "within": return exact(body, "within") > 0
    own = agent.body.get("parameters", [agent.body["mass_kg"]] if agent.robot == "point_mass" else [])
    plain = own and "parameter_variation" not in agent.entry and not {"damping", "friction"} & set(agent.body)
    decided(plain, "the parameters of this robot are not computed here")
    low, high, own = ([exact(x, "bounds") for x in listed(each, "bounds")] for each in (body["lower"], body["upper"], own))
    return len(low) == len(own) == len(high) and all(a <= x <= b for a, x, b in zip(low, own, high))

# Lengths that are uncertain within the bounds that their estimates keep.
def lengths_hold(scenario, agent):
    bounds, true = table(agent.gains["bounds"], "bounds", "lower_m upper_m"), lengths(scenario, agent)
    lower, upper = ([exact(x, "bounds") for x in listed(bounds[key], key)] for key in ("lower_m", "upper_m"))
    return len(lower) == len(true) == len(upper) and all(low <= x[0] and x[1] <= high for low, x, high in zip(lower, true, upper))

# Nothing sits on a tool: its place enters the Jacobian of the tip, and neither M nor C nor g. What does not turn holds no length.
def certain(scenario, agent):
    kinds = [joint.kind for joint in path(scenario, agent) if joint.moves]
    return agent.gains["end_effector"].get("uncertain", "tool") == "tool" or {*kinds[1:]} <= {"prismatic"}

# Backstepping takes one fewer of a strict-feedback chain than it has equations, and as many of a pure-feedback chain.
def derivatives(a): return max(1, len(a.body.get("regressors", "")) - (a.robot == "strict_feedback")) if "_feedback" in a.robot else 1

def terms(body): return [formula(text, STATES) for _, text in leaves(body) if isinstance(text, str)]

# α and β of the reference dynamics of a leader: p + α, or p² + β p + α.
def coefficients(scenario):
    roots, design = roots_of(scenario.body), scenario.body.get("design")
    such(len(roots) == 1 + (design != "continuous") and (design != "observer" or "alpha" not in scenario.body), "not roots of the design")
    such(min(roots)[0] > 0 and not (design in FIRST_ORDER and any(b for _, b in roots)), "`roots_per_s` must be positive")
    if "alpha" in scenario.body: return positive(scenario.body["alpha"], "alpha"), positive(scenario.body.get("beta", 1), "beta")
    (a, b), (c, d) = roots[0], roots[-1]
    return (a, Fraction(1)) if design in FIRST_ORDER else (a * c - b * d, a + c)

# The chain that is named.
def find(claim, agent):
    named = (one for one in claim.scenario.agents if one.name == agent.text() and one.law in CHAIN_LAWS)
    return next(named, None) or require(agent, False, "is no chain")

# In this state, x1, x2, … or x, dx, d2x, … or x1, x2, dx1, dx2, …, a term of the agent has no value.
@rule("defined-terms", "no-value")
def no_value(claim, agent, state):
    of = find(claim, agent)
    found = states_of(state, len(of.body["psi"]) if of.robot == "vector_chain" else 0)
    for term in terms(of.body):
        try: enclose(term, found)
        except Undecided as reason:
            if isinstance(reason, Undefined): return
    raise Undecided("whether a term has a value in this state is not decided here")

# States by their letters; of several axes those of each.
def states_of(state, axes=0):
    at, letters = [(entry.number(),) * 2 for entry in state.each()], [f"{d}x{k + 1}" for d in RATES for k in range(axes)] or STATES
    return dict(zip(letters, at)) | dict(zip((f"{d}x" for d in RATES), at))

RATES = ["", "d"] + [f"d{k}" for k in range(2, 256)]
STATES = [f"x{k}" for k in range(1, 256)] + [f"{d}x" for d in RATES] + [f"{d}x{k}" for d in RATES[1:16] for k in range(1, 33)]

# With equal moments of inertia ΔωᵀM S(Δω) ω_d vanishes for whatever target.
def rests(agent):
    return still(agent) or (rows := matrix(agent.body["inertia_kg_m2"], 3, "inertia_kg_m2")) == matrix(rows[0][0], 3, "inertia_kg_m2")

# Delays that are one number, however they are written.
def all_constant(scenario):
    # The last graph recurs, whatever the order, and a delay that does not repeat stays at its last value.
    ends = lambda of: of.get("values_s", [])["period_s" not in of and -1:] or of.get("value_s") or [of.get("min_s"), of.get("max_s")]
    told = lambda kind, of: kind not in ("formula_s", "packets", "log", "hold_log") and not of.get("amplitude_s")
    same = lambda kind, of: kind == "constant_s" or told(kind, of) and len({*ends(of)}) == 1
    return scenario.fixed(scenario.recurring()) and all(not isinstance(e.weight, str) and same(*e.delay[:2]) for e in scenario.graphs[-1])

# What follows from the text alone, by (id, kind): from the scenario, and the agents that the claim names.
TEXT = {(each, "text"): so for each, so in {
    "unbiased-acceleration": lambda s, _: not any(any(agent.settings().get("bias_m_s2", [])) for agent in s.agents),
    "uniform-inertia": lambda s, _: all([a.robot != "urdf" or solid(s, a) for a in robots(s)]),
    "bounded-dynamics": lambda s, _: robots(s) and all(unturned(s, agent) for agent in robots(s)),
    "defined-terms": lambda s, _: all(everywhere(term, derivatives(a)) for a in s.agents if a.law in CHAIN_LAWS for term in terms(a.body)),
    # (30) has a vertex for every derivative of every agent: no order of one meets that of another.
    "own-orders": lambda s, _: all(a.roots for a in s.agents), "no-delay": lambda s, _: all(rule_range(e.delay)[1] == 0 for e in s.used()),
    # α, β and γ stand once; a continuous design has the mass of its plant; without torques from outside h_I is that of the start.
    "shared-design": lambda s, _: s.reference == "leader", "certain-regressor": lambda s, own: all(certain(s, a) for a in own),
    "known-masses": lambda s, _: all(design_of(a) == "continuous" for a in s.agents if a.law == "thrust"),
    "known-momentum": lambda _, own: not any(a.pushes for a in own), "parameters-within-bounds": lambda s, _: all(map(in_bounds, s.agents)),
    "target-at-rest": lambda _, own: all(map(rests, own)), "lengths-within-bounds": lambda s, own: all(lengths_hold(s, a) for a in own),
    "applied-torque": lambda s, _: not s.limited(), "desired-design": lambda s, _: s.desired,
    "smooth-friction": lambda s, _: frictions(s) <= {"smooth"}, "mutual-weights": lambda s, _: all(map(s.mutual, s.graphs))}.items()} | {
    ("lengths-within-bounds", "outside"): lambda s, own: not all(lengths_hold(s, agent) for agent in own),
    ("parameters-within-bounds", "outside"): lambda s, _: not all(map(in_bounds, s.agents)),
    # Of (3) and (23) delays may jump with the phases.
    ("fixed-graph", "one-graph"): lambda s, _: s.fixed(delays=False) and not s.varying() if s.reference == "pure_integral" else s.fixed(),
    ("common-first-root", "constant"): lambda s, _: all_constant(s), ("constant-weights", "text"): lambda s, _: not s.varying(),
    ("input-factor", "factor-away"): lambda s, _: all(max(low, -high) >= floor for _, (low, high), floor in factors(s)),
    ("nonzero-thrust", "starts-below"): lambda s, _: any(starts_below(agent) for agent in s.agents if agent.law == "thrust"),
    ("start-attitude", "half-turn"): lambda s, own: scalar_part(s, own)[1] <= 0, ("dwell-time", "never-switches"): lambda s, _: s.fixed(),
    # Every entry comes to zero as t grows, and the norm with it.
    ("nonzero-quaternion", "fades"): lambda _, own: all(limit(tree) == (0, 0) for tree in quaternion(own))}

def by_text(claim): require(claim.proof, TEXT[claim.id, claim.kind](claim.scenario, claim.own), "is not so by the text")

RULES |= dict.fromkeys(TEXT, by_text)

# The pieces of time that `range` and `cells` name: [0, ∞), or as many of a period of the formula, of the run, or until a time
# from which on one more takes all that is left. Up to a time alone counts what no edge follows any more.
def pieces(node, tree, end_s=None):
    kind = node.field("range").text()
    require(node.field("range"), kind in ("for-ever", "period", "tail") or kind == "run" and end_s, "is of no known kind")
    if kind == "for-ever": return [FOR_EVER]
    length = node.field("until_s").number() if kind == "tail" else end_s
    (unit, length), cells = period(tree) if kind == "period" else ((Fraction(1),) * 2, length), node.field("cells").count()
    require(node.field("cells"), 0 < cells <= MOST_CELLS and length > 0, "must be some, up to a time that is positive")
    return [multiply(unit, (length * k / cells, length * (k + 1) / cells)) for k in range(cells)] + [(length, INF)] * (kind == "tail")

# Checks, piece by piece, that a formula keeps within limits, as what is stated has to: within what is stated, or, where what is found
# here is wider, within the limits all the same. No value that is seen may lie outside of what is stated. Gives the last piece.
def enclosed(claim, node, tree, limits, words, end_s=False):
    node.only("range", "cells", "until_s", "within", "edge")
    within, doubt = node.field("within"), ""
    ends = [end.number() for end in within.each()]
    require(within, len(ends) == 2, "must have two ends")
    require(within, limits(*ends), words)
    fits = lambda found: ends[0] <= found[0] and found[1] <= ends[1]
    for piece in pieces(node, tree, end_s):
        found = enclose(tree, piece)
        if fits(found) or fits(found := common(found, attempt(straight, tree, piece) or WHOLE)): continue
        for t in (piece[0] + (2**k - 1 if infinite(piece[1]) else (piece[1] - piece[0]) * k / 8) for k in range(9)):
            low, high = attempt(enclose, tree, (t, t)) or WHOLE
            require(within, low <= ends[1] and ends[0] <= high, f"does not hold [{said(low)}, {said(high)}], seen at t = {said(t)} s")
        if not limits(*found): doubt = f"[{said(found[0])}, {said(found[1])}], found from t = {said(piece[0])} s on, decides nothing"
    return decided(not doubt, doubt, piece)

# The same by the slope: between the ends, where it has one sign; else from the middle on, with an error of the square of the length.
def straight(tree, piece):
    (a, b), slope = decided(not infinite(piece[1]), "has no middle", piece), enclose(derivative(tree), piece)
    if slope[0] >= 0 or slope[1] <= 0: return hull(enclose(tree, (a, a)), enclose(tree, (b, b)))
    return add(enclose(tree, ((a + b) / 2,) * 2), multiply(slope, ((a - b) / 2, (b - a) / 2)))

# Encloses the formulas of all edges within limits, each named by an edge; whether for ever, and all are uniformly continuous. What
# no edge follows any more from the last switch on counts until then, instead of the run, where it is continuous.
def formulas(claim, node, limits, words):
    scenario, found = claim.scenario, {None: True}
    stay = {followed(claim, edge) for k in scenario.recurring() for edge in scenario.graphs[k]}
    for entry in node.each():
        # What is constant, though by a formula, needs no enclosure.
        if (text := followed(claim, scenario.edge_at(entry.field("edge")))) is None: continue
        last = enclosed(claim, entry, tree := formula(text), limits, f"lets `{text}` {words}", text not in stay and sum(scenario.dwell))
        # A formula that repeats, and has a value everywhere, is uniformly continuous.
        found[text] = text not in stay or entry.field("range").text() == "period" or steady(resolved(tree, END), last)
        decided(found[text] or claim.answer != HOLDS, f"whether `{text}` is uniformly continuous is not decided here")
    for text in {followed(claim, edge) for edge in scenario.used()}: require(node, text in found, f"lacks `{text}`")
    return all(found.values())

# The formula that the weight or delay of an edge follows, as a text; else None.
def followed(claim, edge):
    if claim.id == "bounded-weights": return edge.weight if isinstance(edge.weight, str) else None
    return edge.delay[1] if edge.delay[0] == "formula_s" else None

# What every value of a delay reaches, and what none exceeds, by the parameters of its rule; 0 and None where the rule does not say.
@once
def rule_range(delay):
    kind, body, _ = delay
    if kind == "constant_s": return (not_negative(body, kind),) * 2
    if kind in ("formula_s", "log", "hold_log"): return 0, None
    if kind in ("piecewise_constant", "random_hold"):
        keys = ("hold_s", "value_s") if kind == "random_hold" else ("times_s", "values_s")
        times, values = ([not_negative(x, key) for x in listed(table(body, kind).get(key), key)] for key in keys)
        rises = rising([*times, exact(body.get("period_s", times[-1] + 1), "period_s")]) and times[0] == 0
        rises = 0 < times[0] <= times[-1] if kind == "random_hold" else rises
        such(rises and len(times) == len(values), f"`{keys[0]}` must rise, and have as many entries as `{keys[1]}`")
        return min(values), max(values)
    mean, swing, low, high, latency, jitter = (not_negative(table(body, kind).get(key, 0), key) for key in (
        "mean_s", "amplitude_s", "min_s", "max_s", "latency_s", "jitter_s"))
    period_s = positive(body.get("period_s"), "period_s")
    if kind in ("sinusoid", "saw_tooth"):
        such(swing <= mean and low <= high, "a delay may be negative")
        return (mean - swing, mean + swing) if kind == "sinusoid" else (low, high)
    known(kind, ("packets",), "delays")
    loss = choice(body["loss"], "loss")[1] if "loss" in body else {"probability": 0}
    lost = 0 if 0 in (loss.get("probability"), loss.get("enter")) else 1 if loss.get("leave") == 1 else loss.get("most_consecutive")
    return latency, None if lost is None else (not_negative(lost, "most_consecutive") + 1) * period_s + latency + jitter

# The largest held value of a log, or age of what is heard on a link whose packets are: the newest that has arrived; before the
# first, t.
def logged(scenario, edge):
    names, newest, worst = (scenario.names[edge.source], scenario.names[edge.to]), Fraction(0), Fraction(0)
    body = table(edge.delay[1], "log", "file hold")
    rows = [row for row in scenario.csv(body.get("file")) if (row.get("from"), row.get("to")) == names]
    if edge.delay[0] == "hold_log":
        held = scenario.log([row for row in rows if decimal(row["hold"]) == exact(body.get("hold", 1), "hold")], "delay_s")
        return max(not_negative(value, "delay_s") for value, *_ in held)
    packets = [(decimal(row["send_s"]), decimal(row["delay_s"])) for row in rows if row.get("delay_s")]
    for arrives, sent in sorted((sent + delay, sent) for sent, delay in packets):
        if arrives <= scenario.end_s and sent > newest: worst, newest = max(worst, arrives - newest), sent
    # An age as large as the run is bounded by that alone.
    return such(2 * (worst := max(worst, scenario.end_s - newest)) <= scenario.end_s, "nothing is seen to arrive again", worst)

# What the worst age of drawn packets is at least, whatever is drawn. Ages count from zero until something arrives, which was sent at
# `first` or later. If it was at `first`, what is heard next was sent a period or more after it, and until that arrives, or the run
# ends, the first is heard; if it was later, by a period or more, one waited for it at least as long.
def least_age(body, end_s):
    first, latency, apart = (not_negative(body.get(key, 0), key) for key in ("first_s", "latency_s", "period_s"))
    loss = choice(body["loss"], "loss")[1]
    # A link that turns bad whenever it is good lets no two packets in a row through, and not the first.
    if loss.get("enter") == 1: first, apart = first + apart, 2 * apart
    return end_s if loss.get("probability") == 1 else max(min(first + latency, end_s), min(first + apart + latency, end_s) - first)

# A rule bounds its delay for ever, an enclosure a formula; logs and drawn packets do up to the end of the run.
@rule("bounded-delays", "delays")
def delays(claim, bound_s, enclosures, given):
    scenario, largest, most = claim.scenario, Fraction(0), bound_s.number()
    always = formulas(claim, enclosures, lambda low, high: 0 <= low and high <= most, "become negative, or exceed the bound")
    ages = {(a.text(), b.text()): worst_s for a, b, worst_s in (entry.fields("from", "to", "worst_s") for entry in given.each())}
    for edge in {(edge.source, edge.to, edge.delay[2]): edge for edge in scenario.used() if edge.delay[0] != "formula_s"}.values():
        (kind, body, _), worst = edge.delay, rule_range(edge.delay)[1]
        if kind in ("log", "hold_log"): worst, always = logged(scenario, edge), False
        elif worst is None:
            require(given, (link := (scenario.names[edge.source], scenario.names[edge.to])) in ages, f"lacks the link of {link}")
            worst, always = ages[link].number(), False
            # An age as large as the run is bounded by that alone.
            require(ages[link], least_age(body, scenario.end_s) <= worst <= scenario.end_s / 2, "is out of range")
        largest = max(largest, worst)
    return require(bound_s, largest <= most, f"is exceeded: a delay may reach {said(largest)} s", always)

# Heard at samples, a message is up to a period older than its delay.
@rule("messages-in-time", "ages")
def in_time(claim, bound_s):
    ends = [rule_range(edge.delay)[1] for edge in claim.scenario.used()]
    decided(None not in ends, "the bound of a delay does not follow from its rule")
    late = max(ends, default=0) + 1 / positive(claim.scenario.control.get("sample_hz"), "sample_hz")
    least = exact(claim.scenario.control["message_timeout_s"], "message_timeout_s")
    require(bound_s, late <= bound_s.number() <= least, f"must lie between {said(late)} and {said(least)}")

# What is heard over an edge that recurs is always older than what counts.
@rule("messages-in-time", "older")
def older(claim, edge):
    youngest, most = rule_range(claim.scenario.edge_at(edge).delay)[0], exact(claim.scenario.control["message_timeout_s"], "a time-out")
    require(edge, claim.scenario.triple(edge)[2] in claim.scenario.recurring() and youngest > most, "may carry what is in time")

@rule("bounded-weights", "weights")
def weights(claim, enclosures): return formulas(claim, enclosures, lambda low, high: 0 < low and high < INF, "vanish")

# A weight of zero is too small, a delay of zero is not.
def too_small(claim, node, low, high, words):
    zero = claim.id == "bounded-weights"
    settled(node, high < 0 or zero and high == 0, high < INF and (low > 0 or low == 0 and not zero), f"{words} [{said(low)}, {said(high)}]")

# The formula of an edge that some edge follows at all late times, or again and again: what others do while they are not there says nothing.
def lasting(claim, edge, how=all):
    text, graphs = followed(claim, claim.scenario.edge_at(edge)), [claim.scenario.graphs[k] for k in claim.scenario.recurring()]
    return formula(require(edge, how(text in [followed(claim, e) for e in graph] for graph in graphs), "is not always there", text))

# A time at which a weight is not positive, or a delay is negative.
@rule("bounded-weights bounded-delays", "below")
def below(claim, t_s, edge):
    require(t_s, t_s.number() >= 0, "is before the start")
    too_small(claim, t_s, *enclose(lasting(claim, edge), (t_s.number(),) * 2), "is no such time:")

# As t → ∞ a weight comes to zero, becomes negative or exceeds every bound; a delay exceeds every bound or becomes negative.
@rule("bounded-weights bounded-delays", "limit")
def far_away(claim, edge):
    tree = lasting(claim, edge, any)
    # It exceeds every bound again and again, in one direction or the other: for that the edge has to be there always.
    lasting(claim, edge) if grows(tree) else too_small(claim, edge, *limit(tree), "stays near")

@rule("bounded-delays", "loses-all")
def loses_all(claim, edge):
    found, stays = claim.scenario.edge_at(edge), claim.scenario.triple(edge)[2] in claim.scenario.recurring()
    how, loss = choice(found.delay[1].get("loss", "never"), "loss") if found.delay[0] == "packets" else (None, {})
    require(edge, stays and (how, loss.get("probability"), rule_range(found.delay)[1]) == ("random", 1, None), "does not lose every packet")

# v within ± a else ± a, a tanh(v/a), v/(1 + |v|/a): odd, continuous, never falling, between 0 and v, for any a > 0.
@rule("coupling-sector", "form")
def coupling(claim, form, size): require(form, (form.text(), size.number()) == claim.scenario.coupling, "is not that of the scenario")

# Everybody, or a leader, has roots, whose real parts are bounded.
def left_of(bound, scenario, agents):
    of = [agent.roots for agent in agents] + ([roots_of(scenario.body)] if scenario.reference == "leader" else [])
    return of and all(of) and 0 < bound <= min(map(min, of))[0]

# Whether all pushes have ended, or come to zero by their formulas and stay there, and had bounded values until then. A hand holds at zero.
# The square of a torque τ has a finite integral where τ and t τ are bounded: V̇ ≤ −sᵀKs + sᵀτ leaves s square-integrable.
def ended(scenario, t):
    gone = lambda trees, kind: trees and kind[:7] != "virtual" and t >= 0 and all(enclose(tree, (t, INF)) == (0, 0) for tree in trees)
    fades = lambda agent, trees, kind: trees and agent.law in ("adaptive", "known") and kind in ("torque_n_m", "force_n", "effort") and all(
        finite(tree, [FOR_EVER]) and finite(resolved(times(("t",), tree), END), [END]) for tree in trees)
    kept_ = lambda trees, until: decided(all(finite(tree, [until]) for tree in trees), "a push may be unbounded", True)
    return all((end <= t or gone(trees, kind) or fades(agent, trees, kind)) and kept_(trees, (first, max(first, min(end, t))))
               for agent in scenario.agents for first, end, trees, kind in agent.pushes)

# Numbers of the text, or bounds of such. Agents that agree need real roots; those that follow need roots to the left of the axis.
NUMBERS = {"real-roots": (lambda s, x: left_of(x, s, s.agents) and not any(b for agent in s.agents for _, b in agent.roots),
                   "is not a positive bound below all roots, or an agent has no roots, or a root is complex"),
    "hurwitz": (lambda s, x: left_of(x, s, rooted(s)), "is not a positive bound below all roots, or there are none"),
    "manipulability": (lambda s, x: x == max(agent.manipulability for agent in s.agents), "is not the largest gain"),
    "common-order": (lambda s, x: all(len(agent.roots) == x for agent in s.agents), "is not the order of all agents"),
    "pushes-end": (ended, "comes before the end of a push")}

@rule(" ".join(NUMBERS), "number")
def number(claim, value): require(value, NUMBERS[claim.id][0](claim.scenario, value.number()), NUMBERS[claim.id][1])

@rule("desired-dynamics", "routh no-routh")
def hurwitz(claim, column):
    decided(claim.scenario.polynomial and alone(claim.scenario.body), "the polynomial is not all of these dynamics")
    found = routh(claim.scenario.polynomial)
    require(column, [entry.number() for entry in column.each()] == found, "is not the first column of the array")
    require(column, (found[-1] > 0) == (claim.kind == "routh"), "shows the opposite")

# κ₀ is the same within each class, and all edges that recur lead within a class or to a later one: cycles stay within classes.
@rule("common-first-root", "classes")
def common_first_root(claim, classes):
    scenario, groups = claim.scenario, [[name.text() for name in group.each()] for group in classes.each()]
    require(classes, sorted(sum(groups, [])) == sorted(scenario.names), "must hold every agent, and each once")
    place = {name: k for k, group in enumerate(groups) for name in group}
    for node, group in zip(classes.each(), groups):
        require(node, len({tuple(scenario.agents[scenario.index[name]].roots[:1]) for name in group}) == 1, "has agents whose κ₀ differ")
    at, edges = [place[name] for name in scenario.names], [edge for phase in scenario.recurring() for edge in scenario.pairs[phase]]
    require(classes, all(at[source] <= at[to] for source, to in edges), "are not in order: an edge leads back")

# The pivots of A = L D Lᵀ, in rational numbers, up to the first that is negative, or zero beside what is not: A ⪰ 0 if there is none.
def pivots(rows):
    if not rows or rows[0][0] < 0 or rows[0][0] == 0 and any(rows[0]): return [row[0] for row in rows[:1]]
    (pivot, *right), *below_ = rows
    return [pivot, *pivots([[x - row[0] / (pivot or 1) * y for x, y in zip(row[1:], right)] for row in below_])]

# A symmetric matrix is positive definite if and only if all pivots are positive.
def is_definite(rows): return rows == [list(column) for column in zip(*rows)] and len(pivots(rows)) == len(rows) and min(pivots(rows)) > 0

# What is stated are the pivots, or less: those of a matrix that is larger by what is positive semidefinite are larger.
def definite(node, rows, stated):
    such(0 < len(rows) <= MOST_ROWS and all(len(row) == len(rows) for row in rows), "a gain is not a square matrix of moderate size")
    require(node, rows == [list(column) for column in zip(*rows)], "is not of a symmetric matrix")
    require(stated, [0 < x.number() <= y for x, y in zip(stated.each(), pivots(rows))] == [True] * len(rows), "are not positive pivots")

ASKED_OF = {"positive-gains": ("adaptive", "known"), "chain-gains": CHAIN_LAWS, "chain-adaptation": CHAIN_LAWS} | {
    f"{law.replace('_', '-')}-gains": (law,) for law in (*BLIND, *ROOTLESS, "thrust")}

# Numbers are positive, matrices are by their pivots; a mass that is not adapted is the true one.
@rule(" ".join(ASKED_OF), "definite")
def gains(claim, matrices):
    stated = {(who.text(), gain.text()): column for who, gain, column in (one.fields("agent", "gain", "pivots") for one in matrices.each())}
    keys = [(agent, key) for agent in claim.scenario.agents if agent.law in ASKED_OF[claim.id] for key in GAINS[agent.law].split()]
    for agent, key in keys: gain_is_positive(claim, agent, key, agent.settings().get(key), matrices, stated)

# One gain of one agent: a number, a diagonal, a matrix, or a bandwidth times scales that are positive.
def gain_is_positive(claim, agent, key, value, matrices, stated):
    kind = "bandwidth_per_s" if value is None else "gain"
    if isinstance(value, dict): kind, value = chosen(value, key, ("gain", "bandwidth_per_s"), "gains")
    if kind == "bandwidth_per_s" and key == "damping" and agent.robot == "urdf":
        # The scales of K are the diagonal of M(q₀); those of Γ are positive by how they are made.
        require(claim.proof, solid(claim.scenario, agent), f"{agent.name} may have a joint without inertia")
    if value == 0 and key == "adaptation_gain" and agent.law in (*BLIND, "thrust"):
        true = agent.settings().get("estimate_start_kg") == agent.body.get("mass_kg") and "parameter_variation" not in agent.entry
        require(claim.proof, true, f"{agent.name} keeps a wrong mass")
    elif isinstance(value, list) and value and isinstance(value[0], list):
        require(matrices, (agent.name, key) in stated, f"lacks `{key}` of {agent.name}")
        definite(matrices, [[exact(x, key) for x in listed(row, key)] for row in value], stated[agent.name, key])
    elif value is not None:
        entries = [exact(x, key) for x in (value if isinstance(value, list) else [value])]
        require(claim.proof, entries and min(entries) > 0, f"{agent.name} has a gain `{key}` that is not positive")

# How many derivatives of a target a law needs, or the order of what follows it.
def needed(agent, polynomial):
    order = len(agent.roots) if agent.law in CHAIN_LAWS else max(len(agent.roots), 2)
    known_ = {"position_only": 3, "task_space": 2, "attitude": 2, "thrust": 4 if design_of(agent) in ("differentiable", "adaptive") else 3}
    return len(polynomial) - 1 if polynomial else known_.get(agent.law, order)

# For each motion of a claim its axes, for ever or in the end, and the lowest and the highest derivative that has to be bounded.
def motions_of(claim, t=FOR_EVER):
    paths = lambda trees: [resolved(tree, t) for tree in trees or []]
    if claim.id == "bounded-leader":
        require(claim.proof, claim.scenario.motion is not None, "is of no motion")
        return [(paths(claim.scenario.motion), 1, 3)]
    # A formation may travel, and a robot whose M, C and g are bounded wherever it is: so is its Y with q̇_d and q̈_d.
    linear = not claim.scenario.polynomial or alone(claim.scenario.body)
    level = lambda a: linear and a.law in ("adaptive", "known") and attempt(unturned, claim.scenario, a)
    return [(paths(a.target), 0 if a.tracks and not level(a) else 1, needed(a, claim.scenario.polynomial)) for a in claim.own]

# Curves through points are polynomials on finitely many pieces and constant elsewhere; derivatives of formulas are enclosed, on
# [0, ∞) at once or on the stretch that is stated.
@rule("bounded-target bounded-leader", "derivatives")
def bounded(claim, order, stretch):
    stretch.only("range", "cells", "until_s")
    motions = motions_of(claim)
    require(order, order.count() >= max(most for _, _, most in motions), "is too low for a law")
    decided(all(most <= 3 or tree[0] != "points" for paths, _, most in motions for tree in paths), "a curve's third derivative jumps")
    # Agents of one entry share a target.
    for tree, lowest, most in {(unique(tree), lowest, most) for paths, lowest, most in motions for tree in paths if tree[0] != "points"}:
        for k in range(most + 1):
            if k >= lowest and not finite(tree, [FOR_EVER]):
                settled(stretch, finite(tree, pieces(stretch, tree)), attempt(grows, tree), f"does not bound derivative {k}")
            tree = derivative(tree)

# A sine or cosine of what goes beyond every bound comes to 1 again and again.
def repeats(tree): return tree[:2] in (("f", "sin"), ("f", "cos")) and endless(tree[2]) or attempt(period, tree) is not None

def endless(tree): return attempt(limit, tree) in ((INF, INF), (-INF, -INF))

# Whether a formula exceeds every bound. Of each term P is what does not repeat, and S is what does: the P of one term exceeds every bound,
# its S is not always zero, and beside it all others vanish.
def grows(tree):
    if tree[:2] in (("f", "abs"), ("f", "neg")): return grows(tree[2])
    split = lambda part, of: functools.reduce(times, (x for x in factors_of(part) if repeats(x) == of), ONE)
    found = [(by, split(part, False), split(part, True)) for by, part in weighed(tree) if by != (0, 0)]
    beside = lambda p, others: all(attempt(limit, ("/", q, p)) == (0, 0) and finite(s, [FOR_EVER]) for _, q, s in others)
    ahead = lambda k, by, p, s: (by[0] > 0 or by[1] < 0) and endless(p) and swings(s) and beside(p, found[:k] + found[k + 1:])
    return endless(tree) or any(ahead(k, *term) for k, term in enumerate(found))

# Whether a formula repeats, or stays, and differs from zero at one of some times.
def swings(tree):
    values = (attempt(enclose, tree, (Fraction(3 * k, 7),) * 2) or WHOLE for k in range(8))
    return (not has_variable(tree) or repeats(tree)) and any(low > 0 or high < 0 for low, high in values)

# A derivative, or the motion itself of who tracks it, goes beyond every bound as t → ∞.
@rule("bounded-target bounded-leader", "diverges")
def diverges(claim, motion, axis, order):
    motions = motions_of(claim, END)
    require(motion, 1 <= motion.count() <= len(motions), "is no motion")
    paths, lowest, most = motions[motion.count() - 1]
    require(axis, 1 <= axis.count() <= len(paths) and paths[axis.count() - 1][0] != "points", "is no axis with a formula")
    require(order, lowest <= order.count() <= most, "is of no derivative that a law uses")
    tree = functools.reduce(lambda tree, _: derivative(tree), range(order.count()), paths[axis.count() - 1])
    require(order, not finite(tree, [FOR_EVER]), "stays bounded")
    decided(grows(tree), "whether a derivative exceeds every bound is not decided here")

# Whether a formula is shown to be bounded on each of some stretches.
def finite(tree, stretches): return not any(infinite(end) for stretch in stretches for end in attempt(enclose, tree, stretch) or WHOLE)

# What drives who follows a leader, axis by axis, must stay below γ: α q̇ + q̈, α q̇ + β q̈ + d³q, or d³q.
def drive(claim, at=FOR_EVER):
    scenario, design = claim.scenario, claim.scenario.body.get("design")
    require(claim.proof, scenario.motion is not None, "is of no motion")
    (alpha, beta), gamma = coefficients(scenario), positive(scenario.body.get("gain"), "gain")
    factors = {**dict.fromkeys(FIRST_ORDER, (0, alpha, 1, 0)), "swarm": (0, 0, 0, 1)}.get(design, (0, alpha, beta, 1))
    rates = [itertools.accumulate((derivative,) * 3, lambda inner, of: of(inner), initial=resolved(tree, at)) for tree in scenario.motion]
    # What has no weight is left out: a product with zero would keep the sum from being a quotient of polynomials.
    sums = [functools.reduce(plus, (times(("number", Fraction(by)), tree) for by, tree in zip(factors, each) if by)) for each in rates]
    return [(tree, (-gamma,) * 2, (gamma,) * 2) for tree in sums]

# A value of the sign is solved for so often that the error that stays is small, about h sup|ξ̇₀|/α: h κ₀, or h √(κ₀κ₁), ≤ 0.01, and beside
# what the leader moves. For a pair the response swings: its absolute integral is coth(π a/(2 b))/α < (1 + b/a)/α. (110) and (119) read
# motions, which show too late what the sign did where torques come late or velocities are filtered.
@rule("set-valued-sign", "text")
def set_valued(claim):
    s, body, control = claim.scenario, claim.scenario.body, claim.scenario.control or {}
    h = 1 / positive(control.get("sample_hz"), "sample_hz") if control else positive(body.get("sign_period_s", Fraction(1, 1000)), "period")
    (alpha, _), (a, b), within = coefficients(s), roots_of(body)[0], lambda tree: attempt(enclose, tree, FOR_EVER) or WHOLE
    swing, mean = (1, a) if body.get("design") in FIRST_ORDER else (1 + abs(b) / a,) * 2
    lags = exact(control.get("computation_delay_s", 0), "delay") > 0 or control.get("velocity", "measured") != "measured"
    often = 10_000 * h * h * alpha * mean <= 1 and h < s.end_s and not (lags and body.get("design") in ("continuous", "differentiable"))
    require(claim.proof, body.get("sign", "implicit") == "implicit" and often, "is not so by the text")
    driven = max((min(size(within(tree)), gamma[0]) for tree, _, gamma in drive(claim)), default=0) if s.motion else 0
    moved_ = max((high - low for low, high in map(within, s.motion or [])), default=0)
    decided(100 * h * swing * driven <= alpha * moved_, "an error may stay that is not small beside what the leader moves")

def squares(trees): return functools.reduce(plus, [("^", tree, Fraction(2)) for tree in trees])

def quaternion(own):
    return decided(len(paths := [tree for agent in own for tree in agent.target or []]) in (4, 7), "is of no quaternion", paths[-4:])

# The square of how far a target is from where the reach of a tip is counted.
def reached(claim, _=FOR_EVER):
    agent, = claim.own
    if agent.robot == "planar_arm":
        first, second = lengths(claim.scenario, agent)
        return [(squares(agent.target), square([add(first, minus(second))]), square([add(first, second)]))]
    base, least, most = outstretched(claim.scenario, agent)
    away = [plus(tree, ("f", "neg", ("hull", *(("number", end) for end in at)))) for tree, at in zip(agent.target, base)]
    return [(squares(away), least, most)]

# The law takes a smallest singular value of 10^-6 of the largest for zero, and the largest is at most the root of the sum of all squares.
@rule("regular-jacobian", "left-null")
def singular(claim, vector):
    u, columns = [entry.number() for entry in vector.each()], jacobian(claim.scenario, *claim.own)
    require(vector, any(u) and len(u) == len(columns[0]), "is zero, or has another length")
    taken = square([dot([(x, x) for x in u], column) for column in columns])
    require(vector, 10**12 * taken[1] <= square(itertools.chain(*columns))[0] * sum(x * x for x in u), "is not taken to zero")

# What has to stay strictly between two numbers: (formula, what holds the lower one, what holds the upper one).
LIMITS = {"sign-gain": drive, "target-within-reach": reached, "nonzero-quaternion": lambda claim, _=FOR_EVER: [
    (squares(quaternion(claim.own)), (Fraction(0),) * 2, (INF, INF))]}

@rule("sign-gain target-within-reach nonzero-quaternion", "bounds distance norm")
def kept(claim, bounds=None, bound=None):
    limits, entries = LIMITS[claim.id](claim), bounds.each() if bounds else [bound] if bound else []
    require(claim.proof, len(entries) == len(limits), "must have one bound for each axis")
    for entry, (tree, least, most) in zip(entries, limits):
        inside = lambda low, high: least[1] < low and high < most[0] or decided(low <= least[0] or most[1] <= high, "lengths vary", False)
        enclosed(claim, entry, tree, inside, f"leaves ({said(least[1])}, {said(most[0])})")

@rule("sign-gain target-within-reach", "instant out-of-reach")
def left(claim, t_s, axis=None):
    limits, k = LIMITS[claim.id](claim, (t_s.number(),) * 2), axis.count() if axis else 1
    require(t_s, 1 <= k <= len(limits) and t_s.number() >= 0, "comes before the start, or is of no axis")
    tree, least, most = limits[k - 1]
    low, high = enclose(tree, (t_s.number(),) * 2)
    settled(t_s, high <= least[0] or low >= most[1], least[1] < low and high < most[0], f"is no time outside: [{said(low)}, {said(high)}]")

# The square of the scalar part Δq_o of the error of an attitude at the start. With R of the tip, p = (v, o) of the target, and
# a = (R₃₂ − R₂₃, R₁₃ − R₃₁, R₂₁ − R₁₂), 4 Δq_o² = 1 + tr R_dᵀR says 4 pᵀp Δq_o² = pᵀp + (o² − vᵀv) tr R + 2 vᵀR v + 2 o vᵀa.
def scalar_part(scenario, own):
    r = [[("hull", *(("number", end) for end in entry)) for entry in column] for column in rotation(scenario, *own)]
    (*v, o), sums = quaternion(own), functools.partial(functools.reduce, plus)
    crossed = sums([times(times(x, y), r[j][i]) for i, x in enumerate(v) for j, y in enumerate(v)])
    apart = sums([times(v[k], ("-", r[k - 2][k - 1], r[k - 1][k - 2])) for k in range(3)])
    whole = sums([squares(v), squares([o]), times(("-", squares([o]), squares(v)), sums([r[k][k] for k in range(3)])),
                  times(("number", Fraction(2)), plus(crossed, times(o, apart)))])
    return enclose(("/", whole, times(("number", Fraction(4)), plus(squares(v), squares([o])))), (Fraction(0),) * 2)

@rule("start-attitude", "apart")
def start_apart(claim, least):
    require(least, 0 < least.number() and least.number() ** 2 <= scalar_part(claim.scenario, claim.own)[0], "is not shown: may be smaller")

@rule("nonzero-quaternion", "vanishes")
def vanishes(claim, at_s):
    at, trees = at_s.number(), quaternion(claim.own)
    require(at_s, at >= 0 and all(enclose(tree, (at, at)) == (0, 0) for tree in trees), "is no time at which all entries are zero")

# A formula without a number that it is multiplied with.
def core(tree): return weighed(tree)[0][1] if len(weighed(tree)) == 1 else tree

# An entry has both signs within a stretch on which it is continuous, having values throughout; the others are zero for ever, or a number
# times the same formula.
@rule("nonzero-quaternion", "changes-sign")
def changes_sign(claim, entry, from_s, to_s):
    k, start, end, trees = entry.count() - 1, from_s.number(), to_s.number(), quaternion(claim.own)
    require(entry, k in range(4), "is no entry")
    require(entry, all(attempt(enclose, tree, FOR_EVER) == (0, 0) or core(tree) == core(trees[k]) for tree in trees), "is not the only one")
    require(to_s, 0 <= start < end and all(finite(tree, [(start, end)]) for tree in trees), "ends no stretch on which all have values")
    (a, b), (c, d) = (enclose(trees[k], (t, t)) for t in (start, end))
    require(entry, b < 0 < c or d < 0 < a, "has one sign")

# One entry keeps away from zero.
@rule("nonzero-quaternion", "entry-away")
def entry_away(claim, entry, bound):
    require(entry, 1 <= entry.count() <= 4, "is no entry")
    enclosed(claim, bound, quaternion(claim.own)[entry.count() - 1], lambda low, high: low > 0 or high < 0, "holds zero")

# k λ > β + κ⁴/(2 (β² − α) (β − κ)), which grows with κ, the smaller root: L − (`least`/k) 1 of the followers is positive definite.
@rule("swarm-coupling", "definite")
def swarm(claim, least, pivots):
    scenario, ((small, turn), (large, _)) = claim.scenario, sorted(roots_of(claim.scenario.body))
    require(claim.proof, scenario.fixed() and not scenario.varying() and turn == 0 < small, "is for real roots and a Laplacian that stays")
    # Roots of α and β are rounded towards the axis, by at most 10⁻³⁰.
    alpha, beta, kappa = positive(scenario.body.get("alpha", small * large), "alpha"), small + large, small + Fraction(1, 10**30)
    require(least, least.number() >= beta + kappa**4 / (2 * (beta * beta - alpha) * (beta - kappa)), "is too little for these roots")
    followers, gain = [k for k in range(len(scenario.names)) if k != scenario.leader], positive(scenario.body.get("coupling"), "coupling")
    rows = [[-least.number() / gain if i == j else Fraction(0) for j in followers] for i in followers]
    for to, edge in ((followers.index(edge.to), edge) for edge in scenario.graphs[0]):
        rows[to][to] += edge.weight
        if edge.source in followers: rows[to][followers.index(edge.source)] -= edge.weight
    definite(claim.proof, rows, pivots)

# For every chain what encloses the factor of its input in every state, and the floor. Of a matrix its smallest singular value: once rows
# have the sign of the diagonal, that is at least the smallest eigenvalue of the symmetric part, which Gershgorin's discs bound.
def factors(scenario, state=None):
    for agent in (one for one in scenario.agents if one.law in CHAIN_LAWS):
        # Of a pure-feedback chain it is a product of slopes, which are not computed here: no state refutes it, and nothing shows it.
        psi = {"strict_feedback": "1", "pure_feedback": "slope"}.get(agent.robot, agent.body.get("psi", "1"))
        decided(state or psi != "slope", "the slopes of a pure-feedback chain are not computed here")
        within = regular(psi) if isinstance(psi, list) else enclose(formula(psi, [*STATES, "slope"]), states_of(state) if state else WHOLE)
        yield agent.name, within, positive(agent.gains.get("floor", Fraction(1, 1000)), "floor")

# Or by the determinant: the product of the m − 1 other singular values is at most the power m − 1 of their quadratic mean.
def regular(psi):
    such(all(len(row) == len(psi) for row in psi), "ψ is not square")
    a, m = [[enclose(formula(entry, STATES), WHOLE) for entry in row] for row in psi], len(psi)
    others = [sum(size(a[i][j]) + size(a[j][i]) for j in range(m) if j != i) for i in range(m)]
    least, norm = min(max(row[i][0], -row[i][1]) - others[i] / 2 for i, row in enumerate(a)), sum(size(x) ** 2 for row in a for x in row)
    if m <= MOST_EXPANDED and norm > 0 and not infinite(norm):
        least = max(least, sqrt_at(magnitude(determinant(a))[0] ** 2 * (Fraction(m - 1) / norm) ** (m - 1))[0])
    return least, INF

def determinant(rows):
    minors = [determinant([row[:k] + row[k + 1:] for row in rows[1:]]) for k in range(len(rows))]
    parts = [multiply(entry, minus(minor) if k % 2 else minor) for k, (entry, minor) in enumerate(zip(rows[0] if rows else [], minors))]
    return functools.reduce(add, parts) if rows else (Fraction(1),) * 2

# In this state, or in all.
@rule("input-factor", "factor")
def small_factor(claim, agent, state=None):
    require(agent, agent.text() in [n for n, x, by in factors(claim.scenario, state) if size(x) < by], "has no factor below its floor")

# An equation without a slope along its next state while the others are 0.7.
@rule("input-factor", "unmoved")
def unmoved(claim, agent, equation):
    own, k = find(claim, agent), equation.count()
    require(agent, own.robot == "pure_feedback", "is no pure-feedback chain")
    known, rows = own.body.get("known", []), own.body.get("regressors", [])
    require(equation, 0 < k < len(known), "is none that a next state moves")
    for text in [known[k - 1], *(rows[k - 1] if rows else [])]:
        plain = re.sub(r"\bx(\d+)\b", lambda state: "t" if int(state[1]) == k + 1 else "0.7", str(text))
        require(equation, size(enclose(derivative(formula(plain)), WHOLE)) == 0, f"is moved by x{k + 1}")

# A vector that ψ makes shorter than its floor allows, in this state or in all.
@rule("input-factor", "null-vector")
def null_vector(claim, agent, vector, state=None):
    own, x, within = find(claim, agent), [(entry.number(),) * 2 for entry in vector.each()], states_of(state) if state else WHOLE
    psi, floor = own.body.get("psi"), positive(own.gains.get("floor", Fraction(1, 1000)), "floor")
    require(agent, isinstance(psi, list) and all(len(row) == len(psi) == len(x) for row in psi), "has no matrix ψ of this size")
    image = [dot([enclose(formula(entry, STATES), within) for entry in row], x) for row in psi]
    require(vector, square(image)[1] < floor**2 * square(x)[0], "is taken neither to zero nor close to it")

# Whether a thrust starts at a floor that ends the run, or below: the weight where nothing else is said, and a tenth of that.
def starts_below(agent):
    mass = decided("parameter_variation" not in agent.entry, "is drawn", agent.settings().get("estimate_start_kg", agent.body["mass_kg"]))
    weight, floor = exact(mass, "mass") * exact(agent.body.get("gravity_m_s2", Fraction(981, 100)), "gravity"), agent.gains.get("floor", {})
    start, stops = (exact(of.get(key, weight / by), key) for of, key, by in ((agent.gains, "thrust_start_n", 1), (floor, "stops_n", 10)))
    return "kept" not in floor and start <= stops

# --- The whole certificate

# All outcomes: a list of (id, agents, answer, outcome, words, place).
def check(certificate_text, scenario_text, folder, digests=True):
    found = []
    try:
        document = read_certificate(certificate_text)
        document.only("format", "producer", "scenario", "theorem", "hypotheses", "agreement", "given_edges")
        require(document.field("format"), document.field("format").count() == FORMAT, f"must be {FORMAT}")
        given = document.optional("given_edges")
        scenario = Scenario(scenario_text, folder, given.each() if given else ())
        require(document, next(scenario.given, None) is None, "gives edges of a graph that is not drawn")
        asked, spoken = requirements(scenario), set()
        require(document.field("theorem"), document.field("theorem").text() == theorem(scenario), f"must be {theorem(scenario)}")
        found += [outcome(scenario, entry, asked, spoken) for entry in document.field("hypotheses").each()]
        found += [(each, [agent] if agent else [], "", REJECTED, "is left out", "") for each, agent in sorted(asked - spoken)]
        if (agreement := document.optional("agreement")) is not None:
            unique = any(one[0] == "spanning-tree" and one[2] != VIOLATED and one[3] == ACCEPTED for one in found)
            require(agreement, unique, "is of a network whose spanning tree is not shown")
            agreed(scenario, agreement)
            found.append(("agreement", [], HOLDS, ACCEPTED, "uᵀL = 0 and Σu = 1", ""))
        if digests: same(document.field("scenario"), scenario_text, scenario.inputs)
        return found
    except (Rejected, Meaningless, Undecided) as error: failure = (error.outcome, *error.args, "")[:3]
    except (RecursionError, MemoryError, ArithmeticError, ValueError, TypeError, LookupError, AttributeError, OSError, csv.Error) as error:
        failure = REJECTED, f"cannot be checked in this form ({type(error).__name__}: {str(error)[:80]})", ""
    return [*found, ("certificate", [], "", *failure)]

# The outcome of one entry. Each hypothesis is spoken about once.
def outcome(scenario, entry, asked, spoken):
    claim = Claim(scenario, entry)
    for key in [(claim.id, name) for name in claim.agents or [""]]:
        # These may be spoken about robot by robot.
        require(entry, claim.id in "uniform-inertia hurwitz desired-dynamics nonzero-thrust".split() or key not in spoken, "speaks twice")
        # What is known of the reach of a URDF depends on where its tip is; and a formula may be seen to be a constant here alone.
        require(entry, key in asked or claim.id in ("target-within-reach", "bounded-weights"), "is not asked for by this scenario")
        spoken.add(key)
    try: return claim.id, claim.agents, claim.answer, *claim.judge(), ""
    except (Rejected, Meaningless, Undecided) as error: return claim.id, claim.agents, claim.answer, *(error.outcome, *error.args, "")[:3]

# The shares u with uᵀL = 0 and Σu = 1 of a fixed network: what each agent's start counts in the value agreed upon. A spanning tree
# leaves one such u, and none of its entries is negative.
def agreed(scenario, node):
    influence, = node.fields("influence")
    stated = {entry[0].text(): entry[1].number() for entry in map(Node.each, influence.each()) if len(entry) == 2}
    require(influence, set(stated) == set(scenario.names) and len(influence.each()) == len(stated), "must be [agent, share] of everybody")
    require(node, scenario.fixed() and not scenario.varying(), "is of no fixed network")
    shares, flow = [stated[name] for name in scenario.names], [Fraction(0)] * len(scenario.names)
    for edge in scenario.graphs[0]:
        flow[edge.to] += shares[edge.to] * edge.weight
        flow[edge.source] -= shares[edge.to] * edge.weight
    require(influence, sum(shares) == 1, "must be shares of one")
    require(influence, not any(flow), "is no left null vector of the Laplacian")

# Digests only say which files were meant.
def same(node, text, inputs):
    _, digest, files = node.fields("name", "sha256", "inputs")
    require(digest, digest.text() == hashlib.sha256(text.encode()).hexdigest(), "is not that of the scenario")
    for file, own in (entry.fields("file", "sha256") for entry in files.each()):
        require(own, (data := inputs.get(file.text())) is None or hashlib.sha256(data).hexdigest() == own.text(), "is not that of the file")

def main(arguments=None):
    parser = argparse.ArgumentParser(description="Check a certificate of forwardstep against a scenario, without forwardstep.")
    for file in ("certificate", "scenario"): parser.add_argument(file, type=Path)
    parser.add_argument("--ignore-digests", action="store_true", help="whether the files are those that were meant does not count")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    options = parser.parse_args(arguments)
    try:
        certificate, scenario = (read(path)[1] for path in (options.certificate, options.scenario))
        found = check(certificate, scenario, options.scenario.resolve().parent, not options.ignore_digests)
    except Meaningless as error: found = [("certificate", [], "", REJECTED, str(error), "")]
    whole = max((entry[3] for entry in found), key=(ACCEPTED, UNCHECKED, REJECTED).index, default=UNCHECKED)
    violated = list(dict.fromkeys(entry[0] for entry in found if entry[2:4] == (VIOLATED, ACCEPTED)))
    for each, agents, answer, result, words, place in () if options.json else found:
        about = (f" of {', '.join(agents)}" if agents else "") + (f", {answer}" if answer else "")
        print(f"{result}: {each}{about}: {words}{f' ({place})' if place else ''}")
    entries = [dict(zip(("id", "agents", "answer", "outcome", "words", "place"), entry)) for entry in found]
    summary = f"all in all: {whole}{'; violated: ' + ', '.join(violated) if violated else ''}"
    print(json.dumps({"outcome": whole, "violated": violated, "entries": entries}) if options.json else summary)
    return (ACCEPTED, REJECTED, UNCHECKED).index(whole)

if __name__ == "__main__":
    if hasattr(signal, "SIGPIPE"): signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # Who reads may close before the end.
    sys.stdout.reconfigure(errors="backslashreplace")
    sys.exit(main())
