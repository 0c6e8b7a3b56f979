#!/usr/bin/env python3
"""Checks a certificate of forwardstep against a scenario, without forwardstep.

    python3 checker/forwardstep_checker.py CERTIFICATE.json SCENARIO.toml [--ignore-digests] [--json]

The scenario is read here a second time: agents, edges, phases, delays, weights, gains, roots and motions come from its text,
and so does the list of hypotheses that a certificate must speak about. The certificate only says where to look: windows and
trees, bounds, pivots, subdivisions. What it says is held against the text, in exact arithmetic.

For every hypothesis, and in all, there are three outcomes:

    accepted         the claim is shown
    rejected         the claim is not shown by its proof, contradicts the text, or is left out; with the place in the certificate
    could not check  nothing is claimed, or this program knows no proof of it yet

The exit status is 0, 1 or 2 in this order. *Accepted* says that the claims of the certificate are right. A claim may be that a
hypothesis is violated: then its witness was replayed, and the last line says so.

What has to be trusted
 1. Python and these parts of its standard library: ast, csv, fractions, hashlib, json, tomllib, xml.etree.
 2. This file: how it reads a scenario, which hypotheses it asks for (`requirements`), and the argument beside each `@rule`.
 3. The mathematics behind the list: that the theorems follow from these hypotheses.
 4. What a certificate marks as *given*: numbers that forwardstep drew at random. They are held against the bounds that the
    scenario states and nothing else, and a claim that rests on them reaches to the end of the run only.
What has not to be trusted: forwardstep, floating point (decimals are rational numbers here, functions are enclosed by rational
Taylor sums that are rounded outwards), and digests (they only say which files were meant).
"""

import argparse
import ast
import collections
import csv
import functools
import hashlib
import io
import json
import math
import re
import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from fractions import Fraction
from pathlib import Path

FORMAT = 1
SHIPPED_ROBOTS = Path(__file__).resolve().parent.parent / "crates" / "io" / "robots"
ACCEPTED, REJECTED, UNCHECKED = "accepted", "rejected", "could not check"
HOLDS, ON_RUN, VIOLATED = "holds", "holds on [0, end]", "violated"
UNCLAIMED = ("watched during the run", "not shown", "not covered by the paper")

# What is larger is refused, so that nothing takes all memory.
MOST_BYTES, MOST_DIGITS, MOST_NESTED = 64 << 20, 4000, 256
MOST_AGENTS, MOST_EDGES, MOST_CELLS, MOST_ROWS = 10_000, 1_000_000, 100_000, 64

class Rejected(Exception):
    """A claim that is not shown; `place` is where in the certificate."""

    def __init__(self, words, place=""):
        super().__init__(words)
        self.words, self.place = words, place

class Undecided(Exception):
    """Something that cannot be checked here."""

class Meaningless(Exception):
    """A scenario that cannot be read, or has no meaning."""

# --- Numbers and documents

DECIMAL = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?", re.ASCII)
RATIO = re.compile(r"-?\d+(/[1-9]\d*)?", re.ASCII)

def decimal(text):
    """A decimal as the rational number that it is."""
    plain = text.replace("_", "")
    if len(plain) > MOST_DIGITS or not DECIMAL.fullmatch(plain):
        raise ValueError(f"`{plain[:40]}` is not a finite decimal of moderate length")
    return Fraction(plain)

class Node:
    """A value of the certificate with its place. What has the wrong type is rejected there."""

    def __init__(self, value, place):
        self.value, self.place = value, place

    def reject(self, words):
        raise Rejected(words, self.place)

    def typed(self, kind, words):
        if not isinstance(self.value, kind) or isinstance(self.value, bool):
            self.reject(f"must be {words}")
        return self.value

    def field(self, key):
        if key not in self.typed(dict, "an object"):
            self.reject(f"lacks `{key}`")
        return Node(self.value[key], f"{self.place}.{key}")

    def optional(self, key):
        return self.field(key) if key in self.typed(dict, "an object") else None

    def only(self, *keys):
        """Refuses fields that nothing reads: what stands in a certificate counts."""
        for key in self.typed(dict, "an object"):
            if key not in keys:
                self.reject(f"has `{key}`, which means nothing here")

    def each(self):
        return [Node(value, f"{self.place}[{k}]") for k, value in enumerate(self.typed(list, "a list"))]

    def text(self):
        return self.typed(str, "a text")

    def count(self):
        return self.typed(int, "a whole number")

    def number(self):
        """A whole number, a decimal in quotes, or "p/q" in quotes."""
        text = str(self.typed((int, str), "a whole number, or a number in quotes"))
        if len(text) > MOST_DIGITS or not (RATIO.fullmatch(text) or DECIMAL.fullmatch(text)):
            self.reject("is no decimal and no p/q of moderate length")
        return Fraction(text)

def read_certificate(text):
    """The document as a node. Numbers in it are whole or stand in quotes, so that none is rounded on the way."""

    def no(words):
        raise Rejected(words, "certificate")

    def pairs(items):
        found = dict(items)
        if len(found) < len(items):
            no("an object has a key twice")
        return found

    try:
        return Node(json.loads(
            text, object_pairs_hook=pairs,
            parse_float=lambda number: no(f"{number[:40]} stands without quotes: it would be rounded"),
            parse_constant=lambda word: no(f"{word} is not a number"),
            parse_int=lambda digits: int(digits) if len(digits) <= 30 else no("a whole number is too long")), "certificate")
    except RecursionError:
        no("is nested too deeply")
    except ValueError as error:
        no(f"is not JSON: {error}")

def read_toml(text):
    try:
        return tomllib.loads(text, parse_float=decimal)
    except (RecursionError, ValueError) as error:
        raise Meaningless(f"is not TOML, or nested too deeply: {error}") from None

def such(condition, words):
    if not condition:
        raise Meaningless(words)

def exact(value, where):
    """A number of a scenario."""
    such(isinstance(value, (int, Fraction)) and not isinstance(value, bool), f"{where} must be a number")
    such(isinstance(value, Fraction) or value.bit_length() <= 4 * MOST_DIGITS, f"{where} is too long")
    return Fraction(value)

def positive(value, where):
    such(exact(value, where) > 0, f"{where} must be positive")
    return Fraction(value)

def not_negative(value, where):
    such(exact(value, where) >= 0, f"{where} must not be negative")
    return Fraction(value)

def table(value, where, keys=None):
    """A table; one with keys that are not known here may mean something that is not known here."""
    such(isinstance(value, dict), f"{where} must be a table")
    for key in value if keys is not None else ():
        known(key, keys.split(), f"entries of {where}")
    return value

def listed(value, where):
    such(isinstance(value, list) and value, f"{where} must be a list that is not empty")
    return value

def pair(value):
    such(isinstance(value, list) and len(value) == 2, "where a pair must be there is something else")
    return value

def name_of(value, where):
    such(isinstance(value, str), f"{where} must be a text")
    return value

def choice(value, where):
    """A word, or a table with one key: (key, what stands under it)."""
    if isinstance(value, str):
        return value, {}
    if isinstance(value, dict) and len(value) == 1:
        return next(iter(value.items()))
    raise Meaningless(f"{where} must be a word, or a table with one key")

def known(kind, kinds, what):
    """Scenarios may have kinds and keys from outside."""
    if kind not in kinds:
        raise Undecided(f"{what} of the kind `{kind}` are not known")

def said(number):
    """A number for a message."""
    return str(number) if len(str(number)) <= 24 else f"{float(number):.9g}"

# --- Intervals with rational ends; an end that is not known is an infinite float

INF = math.inf
WHOLE = (-INF, INF)

def infinite(x):
    return isinstance(x, float)

def rounded(x, upwards):
    """x, or a shorter number on the stated side of it, by less than one part in 2^150."""
    if infinite(x) or x.numerator.bit_length() + x.denominator.bit_length() <= 600:
        return x
    shift = 160 - (x.numerator.bit_length() - x.denominator.bit_length())
    scale = Fraction(1 << shift) if shift >= 0 else Fraction(1, 1 << -shift)
    scaled = x * scale
    return (math.ceil(scaled) if upwards else math.floor(scaled)) / scale

def span(low, high):
    return rounded(low, False), rounded(high, True)

def total(x, y):
    return x if infinite(x) else y if infinite(y) else x + y

def product(x, y):
    if x == 0 or y == 0:
        return Fraction(0)
    if infinite(x) or infinite(y):
        return INF if (x > 0) == (y > 0) else -INF
    return x * y

def add(a, b):
    return span(total(a[0], b[0]), total(a[1], b[1]))

def minus(a):
    return -a[1], -a[0]

def multiply(a, b):
    ends = [product(x, y) for x in a for y in b]
    return span(min(ends), max(ends))

def inverse(a):
    if a[0] <= 0 <= a[1]:
        raise Undecided("a divisor may be zero")
    ends = [Fraction(0) if infinite(x) else 1 / x for x in a]
    return span(min(ends), max(ends))

def hull(a, b):
    return min(a[0], b[0]), max(a[1], b[1])

def size(a):
    return max(abs(a[0]), abs(a[1]))

def taylor(term, ratio):
    """term + term·ratio(1) + term·ratio(1)·ratio(2) + …, for ratios that fall below 1/2: the rest is at most twice the last."""
    low, high, k = Fraction(0), Fraction(0), 1
    while abs(term) > Fraction(1, 1 << 200):
        low, high, exact_ = low + term, high + term, term * ratio(k)
        term = Fraction(math.floor(exact_ * (1 << 400)), 1 << 400)
        # What is cut off here is below 2^-400, and grows to less than 2^-380 in what follows.
        low, high, k = low - Fraction(1, 1 << 380), high + Fraction(1, 1 << 380), k + 1
    return span(low - Fraction(1, 1 << 198), high + Fraction(1, 1 << 198))

def arctan_small(x):
    """|x| ≤ 1/2: x − x³/3 + …, whose rest is at most the next term."""
    total_, power_, k = Fraction(0), x, 0
    while abs(power_) > Fraction(1, 1 << 200):
        total_ += power_ / (2 * k + 1)
        power_, k = Fraction(math.floor(-power_ * x * x * (1 << 600)), 1 << 600), k + 1
    room = Fraction(1, 1 << 180)
    return span(total_ - room, total_ + room)

# By Machin's formula.
PI = add(multiply((16, 16), arctan_small(Fraction(1, 5))), multiply((-4, -4), arctan_small(Fraction(1, 239))))

def sine_at(x, turned):
    """sin x, or cos x where `turned`, of a rational x: reduced by multiples of π, then Taylor; sin is 1-Lipschitz."""
    half = Fraction(1, 2) if turned else Fraction(0)
    n = round(x / PI[0] + half)
    near = x + (half - n) * PI[0]
    room = abs(half - n) * (PI[1] - PI[0])
    near = Fraction(math.floor(near * (1 << 220)), 1 << 220)
    room += Fraction(1, 1 << 219)
    square = -near * near
    value = taylor(near, lambda k: square / (2 * k * (2 * k + 1)))
    value = add(value, (-room, room))
    return minus(value) if n % 2 else value

def sine(a, turned):
    """sin of an interval, or cos: its ends, and 1 or −1 where a crest or a trough may lie inside."""
    if infinite(a[0]) or infinite(a[1]) or a[1] - a[0] >= 7:
        return Fraction(-1), Fraction(1)
    low, high = hull(sine_at(a[0], turned), sine_at(a[1], turned))
    # Crests of cos are at 2kπ, of sin at 2kπ + π/2; troughs are π further.
    for crest, shift in ((True, 0), (False, 1)):
        at = Fraction(shift) + (0 if turned else Fraction(1, 2))
        turns = [(end / pi - at) / 2 for end in a for pi in PI]
        if math.floor(max(turns)) >= math.ceil(min(turns)):
            low, high = (low, Fraction(1)) if crest else (Fraction(-1), high)
    return max(low, Fraction(-1)), min(high, Fraction(1))

def exp_at(x):
    if abs(x) > 1500:
        return (Fraction(2) ** 2000, INF) if x > 0 else (Fraction(0), Fraction(1, 1 << 2000))
    halvings = max(0, math.ceil(abs(x)).bit_length() + 1)
    small = x / (1 << halvings)
    small = Fraction(math.floor(small * (1 << 240)), 1 << 240)
    value = taylor(Fraction(1), lambda k: small / k)
    # The cut of `small` moves exp by less than 2^-239.
    value = add(value, (Fraction(-1, 1 << 238), Fraction(1, 1 << 238)))
    for _ in range(halvings):
        value = multiply(value, value)
    return value

def log_at(x):
    """x = m 2^k with 1 ≤ m < 2; log m = 2 artanh((m − 1)/(m + 1)), whose rest is at most the next term times 9/8."""

    def of(m):
        u = (m - 1) / (m + 1)
        u = Fraction(math.floor(u * (1 << 240)), 1 << 240)
        square, power, value, k = u * u, u, Fraction(0), 0
        while power > Fraction(1, 1 << 210):
            value += power / (2 * k + 1)
            power = Fraction(math.floor(power * square * (1 << 300)), 1 << 300)
            k += 1
        return 2 * value - Fraction(1, 1 << 180), 2 * value + Fraction(1, 1 << 180)

    k = x.numerator.bit_length() - x.denominator.bit_length()
    m = x / Fraction(2) ** k
    if m < 1:
        k, m = k - 1, 2 * m
    return add(of(m), multiply((k, k), of(Fraction(2))))

def sqrt_at(x):
    scale = 1 << max(0, 400 - x.numerator.bit_length() + x.denominator.bit_length())
    root = math.isqrt(math.floor(x * scale * scale))
    return Fraction(root, scale), Fraction(root + 1, scale)

def tanh_at(x):
    decay = exp_at(-2 * abs(x))
    value = multiply(add((1, 1), minus(decay)), inverse(add((1, 1), decay)))
    return minus(value) if x < 0 else value

def atan_at(x):
    """By odd symmetry, π/2 − atan 1/x beyond one, and atan x = 2 atan(x/(1 + √(1 + x²)))."""
    if x < 0:
        return minus(atan_at(-x))
    if x > 1:
        return add(multiply(PI, (Fraction(1, 2),) * 2), minus(atan_at(1 / x)))
    root = sqrt_at(1 + x * x)
    ends = [rounded(x / (1 + end), side) for end, side in zip(root, (True, False))]
    return multiply((2, 2), (arctan_small(ends[1])[0], arctan_small(ends[0])[1]))

def power(a, exponent):
    if exponent.denominator == 1:
        n = abs(exponent.numerator)
        if n > 1000:
            raise Undecided("an exponent is too large")
        if n % 2 == 0:
            # An even power is one of |a|; now all of them rise.
            a = magnitude(a)
        value = span(a[0] ** n, a[1] ** n)
        return inverse(value) if exponent < 0 else value
    if a[0] < 0 or (a[0] == 0 and exponent < 0):
        raise Undecided("a base may be negative, or zero, under a broken exponent")
    if exponent == Fraction(1, 2):
        return function("sqrt", a)
    if infinite(a[1]):
        return Fraction(0), INF
    at = [(Fraction(0),) * 2 if x == 0 else function("exp", multiply((exponent,) * 2, function("log", (x, x)))) for x in a]
    return hull(*at)

def magnitude(a):
    return (Fraction(0) if a[0] <= 0 <= a[1] else min(abs(a[0]), abs(a[1]))), size(a)

def function(name, a):
    if (name == "sqrt" and a[0] < 0) or (name == "log" and a[0] <= 0):
        raise Undecided(f"`{name}` may be of what it has no value for")
    if name in ("neg", "abs"):
        return minus(a) if name == "neg" else magnitude(a)
    if name in ("sin", "cos"):
        return sine(a, name == "cos")
    at, low, high = {
        "exp": (exp_at, Fraction(0), INF),
        "log": (log_at, None, INF),
        "sqrt": (sqrt_at, None, INF),
        "tanh": (tanh_at, Fraction(-1), Fraction(1)),
        "atan": (atan_at, -PI[1] / 2, PI[1] / 2),
    }[name]
    return (low if infinite(a[0]) else at(a[0])[0]), (high if infinite(a[1]) else at(a[1])[1])

# --- Formulas: ("number", q), ("pi",), ("e",), ("t",), ("f", name, a), (op, a, b) for + - * / min max, ("^", a, q)

FUNCTIONS = ("sin", "cos", "exp", "log", "sqrt", "abs", "tanh", "atan")
NUMBER = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}

def formula(text, names=("t",)):
    """A formula as a tree. Python's own parser knows the same precedence: −t² is −(t²), 2^3^2 is 2^9. Numbers become texts before,
    _('0.1'), since it would round them."""
    plain = name_of(text, "a formula")
    if len(plain) > MOST_DIGITS or not re.fullmatch(r"[\w\s.+*/^(),-]*", plain) or "**" in plain or "//" in plain:
        raise Meaningless("a formula is too long, or has a character that no formula has")
    quoted = NUMBER.sub(lambda match: f"_('{match.group()}')", " ".join(plain.split()))
    try:
        return shaped(ast.parse(quoted.replace("^", "**"), mode="eval").body, names, 0)
    except (SyntaxError, RecursionError, MemoryError, ValueError):
        raise Meaningless(f"`{plain[:60]}` is no formula") from None

def shaped(node, names, depth):
    such(depth <= MOST_NESTED, "a formula is nested too deeply")

    def inner(part):
        return shaped(part, names, depth + 1)

    if isinstance(node, ast.Name) and node.id in names:
        return ("t",) if node.id == "t" else ("state", node.id)
    if isinstance(node, ast.Name) and node.id in ("pi", "e"):
        return (node.id,)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.UAdd, ast.USub)):
        return inner(node.operand) if isinstance(node.op, ast.UAdd) else ("f", "neg", inner(node.operand))
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        return "^", inner(node.left), constant(inner(node.right))
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        return OPERATORS[type(node.op)], inner(node.left), inner(node.right)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        name = node.func.id
        if name == "_" and len(node.args) == 1 and isinstance(node.args[0], ast.Constant):
            return "number", quantity(str(node.args[0].value))
        arguments = [inner(argument) for argument in node.args]
        if name in FUNCTIONS and len(arguments) == 1:
            return "f", name, arguments[0]
        if name in ("min", "max") and len(arguments) > 1:
            return functools.reduce(lambda a, b: (name, a, b), arguments)
    raise Meaningless("a formula has something that no formula has")

def quantity(text):
    try:
        return decimal(text)
    except ValueError as error:
        raise Meaningless(str(error)) from None

def has_variable(tree):
    return tree[0] in ("t", "state") or any(isinstance(part, tuple) and has_variable(part) for part in tree[1:])

COMBINED = {
    "+": add, "-": lambda a, b: add(a, minus(b)), "*": multiply, "/": lambda a, b: multiply(a, inverse(b)),
    "min": lambda a, b: (min(a[0], b[0]), min(a[1], b[1])), "max": lambda a, b: (max(a[0], b[0]), max(a[1], b[1])),
}

def enclose(tree, t):
    """What a formula keeps within while its variable keeps within the interval `t`."""
    kind = tree[0]
    if kind in ("number", "t", "pi", "e"):
        return {"t": t, "pi": PI}.get(kind) or ((tree[1],) * 2 if kind == "number" else exp_at(Fraction(1)))
    if kind == "f":
        return function(tree[1], enclose(tree[2], t))
    if kind == "^":
        return power(enclose(tree[1], t), tree[2])
    if kind == "state":
        return WHOLE
    return COMBINED[kind](enclose(tree[1], t), enclose(tree[2], t))

def constant(tree):
    """The rational number that a formula without variables is: its enclosure, where that is one number."""
    low, high = enclose(tree, WHOLE) if not has_variable(tree) else WHOLE
    if low != high:
        raise Undecided("a constant is not rational, or has too many digits")
    return low

def plus(a, b):
    return b if a == ZERO else a if b == ZERO else ("+", a, b)

def times(a, b):
    """Nothing is dropped that may lack a value."""
    plain = ZERO in (a, b) and not partial(a) and not partial(b)
    return ZERO if plain else b if a == ONE else a if b == ONE else ("*", a, b)

def partial(tree):
    """Whether a formula may lack a value somewhere."""
    own = tree[0] in ("/", "^") or tree[:2] in (("f", "log"), ("f", "sqrt"))
    return own or any(isinstance(part, tuple) and partial(part) for part in tree[1:])

ZERO, ONE = ("number", Fraction(0)), ("number", Fraction(1))

def everywhere(tree):
    """Whether a formula has a value, and bounded slopes on bounded sets, in every state; undecided where enclosures do not tell."""
    broken = tree[0] == "^" and tree[2].denominator > 1
    partly = broken or tree[:2] in (("f", "log"), ("f", "sqrt"))
    if partly and enclose(tree[1] if broken else tree[2], WHOLE)[0] <= 0:
        raise Undecided("a root or a logarithm may be of what is not positive")
    if tree[0] in ("/", "^"):
        enclose(tree, WHOLE)
    return all(everywhere(part) for part in tree[1:] if isinstance(part, tuple))

def derivative(tree):
    """By t, where there are no kinks."""
    kind = tree[0]
    if not has_variable(tree):
        return ZERO
    if kind == "t":
        return ONE
    if kind in "+-":
        a, b = derivative(tree[1]), derivative(tree[2])
        return plus(a, b if kind == "+" or b == ZERO else ("f", "neg", b))
    if kind == "*":
        return plus(times(derivative(tree[1]), tree[2]), times(tree[1], derivative(tree[2])))
    if kind == "/" and not has_variable(tree[2]):
        return "/", derivative(tree[1]), tree[2]
    if kind == "/":
        top = plus(times(derivative(tree[1]), tree[2]), ("f", "neg", times(tree[1], derivative(tree[2]))))
        return "/", top, ("^", tree[2], Fraction(2))
    if kind == "^":
        return times(derivative(tree[1]), times(("number", tree[2]), ("^", tree[1], tree[2] - 1)))
    if kind == "f":
        name, a = tree[1], tree[2]
        outer = {
            "neg": ("number", Fraction(-1)),
            "sin": ("f", "cos", a),
            "cos": ("f", "neg", ("f", "sin", a)),
            "exp": tree,
            "log": ("/", ONE, a),
            "sqrt": ("/", ("number", Fraction(1, 2)), tree),
            "tanh": ("-", ONE, ("^", tree, Fraction(2))),
            "atan": ("/", ONE, ("+", ONE, ("^", a, Fraction(2)))),
        }.get(name)
        if outer is not None:
            return times(derivative(a), outer)
    raise Undecided("a derivative has kinks")

def uniform(tree):
    """Whether a formula is shown to be uniformly continuous on [0, ∞), and what it keeps within there.

    Sums, and functions with a bounded slope, keep uniform continuity; products of bounded factors do; so do functions that are
    continuous on the closed bounded range of their argument, and a quotient whose divisor keeps away from zero."""
    within = enclose(tree, (Fraction(0), INF))
    kind = tree[0]
    if not has_variable(tree) or kind == "t":
        return True, within
    if kind == "f":
        inner, of = uniform(tree[2])
        lipschitz = tree[1] in ("neg", "sin", "cos", "tanh", "atan", "abs", "sqrt")
        bounded = not infinite(of[0]) and not infinite(of[1])
        return inner and (lipschitz or (bounded and tree[1] in ("exp", "log"))), within
    parts = [uniform(part) for part in tree[1:] if isinstance(part, tuple)]
    inner = all(part for part, _ in parts)
    if kind in ("+", "-", "min", "max"):
        return inner, within
    bounded = all(not infinite(end) for _, of in parts for end in of)
    by_number = kind in "*/" and not has_variable(tree[2]) or kind == "*" and not has_variable(tree[1])
    return inner and (bounded or by_number), within

def multiple(tree):
    """(q, n) of a constant q πⁿ."""
    if tree[0] == "pi":
        return Fraction(1), 1
    if tree[0] in ("*", "/"):
        (a, n), (b, m) = multiple(tree[1]), multiple(tree[2])
        return (a * b, n + m) if tree[0] == "*" else (a / b, n - m)
    if tree[:2] == ("f", "neg"):
        a, n = multiple(tree[2])
        return -a, n
    value = constant(tree)
    if value == 0:
        raise Undecided("an angle does not change")
    return value, 0

def period(tree):
    """(unit, length): with t = unit · u the formula repeats when u grows by `length`, if every t stands in a sine or cosine of
    q t, or of q π t, plus a constant, for rational q. The unit is 1 where they are of π t, π where they are of t."""

    def rates(part):
        if part[0] == "f" and part[1] in ("sin", "cos") and has_variable(part[2]):
            slope = derivative(part[2])
            if has_variable(slope):
                raise Undecided("an angle is not linear in t")
            return [multiple(slope)]
        if part[0] in ("t", "state"):
            raise Undecided("t stands outside of sines and cosines")
        return [rate for inner in part[1:] if isinstance(inner, tuple) for rate in rates(inner)]

    found = rates(tree)
    if len({n for _, n in found}) != 1 or found[0][1] not in (0, 1):
        raise Undecided("no common period is known")
    common = Fraction(math.gcd(*(q.numerator for q, _ in found)), math.lcm(*(q.denominator for q, _ in found)))
    return ((Fraction(1),) * 2 if found[0][1] == 1 else PI), 2 / common

# --- The scenario, read from its text

USUAL_LAW = {
    "planar_arm": "adaptive", "point_mass": "adaptive", "ship": "adaptive", "urdf": "adaptive", "vehicle": "thrust",
    "rotorcraft": "thrust", "spacecraft": "attitude", "chain": "linear_adaptive",
    "strict_feedback": "adaptive_backstepping", "pure_feedback": "adaptive_backstepping",
}
LAGRANGIAN = ("planar_arm", "point_mass", "ship", "urdf")
MADE_FOR = {
    "adaptive": LAGRANGIAN, "known": LAGRANGIAN, "position_only": ("point_mass",), "thrust": ("vehicle", "rotorcraft"),
    "task_space": ("planar_arm", "urdf"), "attitude": ("spacecraft",), "linearising": ("chain",),
    "linear_adaptive": ("chain",), "immersion": ("chain",),
    "adaptive_backstepping": ("strict_feedback", "pure_feedback"),
}
CHAIN_LAWS = ("linearising", "linear_adaptive", "immersion", "adaptive_backstepping")
DESIGNS = ("continuous", "differentiable", "without_acceleration", "swarm")

# The gains of each law, by their keys. What is not written is positive by default.
GAINS = {
    "adaptive": ("damping", "adaptation_gain"), "known": ("damping",),
    "task_space": ("damping", "adaptation_gain", "task_gain", "kinematic_gain", "torque_share", "reference_gain_per_s"),
    "attitude": ("error_gain_per_s2", "rate_gain_per_s", "filter_gain_per_s", "damping"),
    "position_only": ("damping", "filter_per_s", "adaptation_gain"),
    "thrust": ("damping_per_s", "stiffness", "adaptation_gain", "estimate_start_kg"),
    "linearising": ("gain_per_s",), "linear_adaptive": ("gain_per_s", "adaptation_gain"),
    "immersion": ("gain_per_s", "adaptation_gain"), "adaptive_backstepping": ("gains_per_s", "adaptation_gain"),
}
OTHER_SETTINGS = (" estimate_start estimate_start_kg floor design yaw thrust_start_n rate_bandwidth_per_s end_effector kinematic_start "
                  "bounds determinant_floor antiderivatives")
AGENT = "name count robot parameter_variation start reference law target enforce_limits"
CONTROL = ("sample_hz computation_delay_s velocity noise quantisation torque_limit torque_rate_limit_per_s safe_command "
           "message_timeout_s")

class Agent:
    """An agent: its name, robot, law, roots, λ, target, and the entry of the file that it comes from."""

    def __init__(self, name, index, entry, place):
        self.name, self.index, self.entry, self.place = name, index, entry, place
        self.robot, self.body = choice(entry.get("robot"), f"{place}.robot")
        known(self.robot, USUAL_LAW, "robots")
        table(self.body, f"{place}.robot.{self.robot}")
        self.enforced = entry.get("enforce_limits", False) is not False
        self.roots, self.manipulability, self.pushes = [], Fraction(0), []
        self.target = None

    def settings(self):
        """The table of its law that has gains: of vehicles that of the design."""
        if self.law != "thrust":
            return self.gains
        return table(choice(self.gains.get("design", "differentiable"), "design")[1], "design")

# `to` hears `source`; the weight is a rational number, or the text of a formula.
Edge = collections.namedtuple("Edge", "source to weight delay")

class Scenario:
    def __init__(self, text, folder):
        self.file, self.folder, self.inputs = read_toml(text), folder, {}
        file = table(self.file, "the scenario", "format title time agents reference leader law start network control "
                     "external_wrenches solver goal")
        such(file.get("format") == 2, "`format` must be 2")
        self.end_s = positive(table(file.get("time"), "time").get("end_s"), "time.end_s")
        self.reference, body = choice(file.get("reference"), "reference")
        self.body = table(body, "reference", "roots_per_s exchange manipulability_gain filter_s acceleration_limit design coupling "
                          "gain sign sign_period_s")
        known(self.reference, ("consensus", "pure_integral", "backstepping", "leader", "tracking"), "reference dynamics")
        self.agents = []
        for number, entry in enumerate(listed(file.get("agents"), "agents")):
            self.populate(table(entry, "agents", AGENT), f"agents[{number}]")
        self.leader, self.motion = None, None
        names = [agent.name for agent in self.agents]
        if self.reference == "leader":
            names += self.lead(table(file.get("leader"), "leader", "name motion agent"), names)
        self.names = names
        self.index = {name: k for k, name in enumerate(names)}
        such(len(self.index) == len(names), "two agents have the same name")
        for agent in self.agents:
            self.design(agent)
        self.control = table(file["control"], "control", CONTROL) if "control" in file else None
        self.read_network()
        self.pairs = [{(edge.source, edge.to) for edge in graph} for graph in self.graphs]
        self.read_pushes()

    def populate(self, entry, place):
        name = name_of(entry.get("name"), f"{place}.name")
        names = [name]
        if "count" in entry:
            number = exact(entry["count"], f"{place}.count")
            such(number.denominator == 1 and 1 <= number <= MOST_AGENTS, f"{place}.count must be a whole number of agents")
            names = [f"{name}-{k}" for k in range(1, int(number) + 1)]
        such(len(self.agents) + len(names) <= MOST_AGENTS, "there are too many agents")
        for each in names:
            agent = Agent(each, len(self.agents), entry, place)
            agent.law, law = choice(entry.get("law", self.file.get("law", USUAL_LAW[agent.robot])), "law")
            known(agent.law, MADE_FOR, "laws")
            agent.gains = table(law, f"law.{agent.law}", " ".join(GAINS[agent.law]) + OTHER_SETTINGS)
            such(agent.robot in MADE_FOR[agent.law], f"the law `{agent.law}` is not made for `{agent.robot}`")
            self.agents.append(agent)

    def lead(self, leader, names):
        """The names that the leader adds to the vertices."""
        if "agent" in leader:
            such(leader["agent"] in names, "there is no agent of the name of the leader")
            self.leader = names.index(leader["agent"])
            return []
        self.motion = self.trajectory(leader.get("motion"), "leader.motion")
        self.leader = len(names)
        return [name_of(leader.get("name", "leader"), "leader.name")]

    def design(self, agent):
        """Roots, λ and the target of one agent: its own, else those of all. Who leads shares nothing with those that follow."""
        leads = agent.index == self.leader
        key, own = choice(agent.entry["reference"], "reference") if "reference" in agent.entry else (None, {})
        common = "tracking" if leads else self.reference
        such(key in (None, common), f"{agent.name} states reference dynamics of another kind")
        shared = {} if leads or self.reference == "leader" else self.body
        roots = table(own, "reference").get("roots_per_s", shared.get("roots_per_s", []))
        if roots != []:
            agent.roots = [exact(root, "roots_per_s") for root in listed(roots, "roots_per_s")]
        agent.manipulability = not_negative(
            own.get("manipulability_gain", shared.get("manipulability_gain", 0)), "manipulability_gain")
        agent.tracks = leads or self.reference == "tracking"
        if "target" in agent.entry:
            agent.target = self.trajectory(agent.entry["target"], f"target of {agent.name}")

    def exchange(self):
        if self.reference in ("consensus", "pure_integral"):
            such(self.body.get("exchange") in ("position", "position_velocity"), "`exchange` has another value than there are")
            return self.body["exchange"]
        return "position_velocity" if self.reference == "leader" else "position"

    # Motions: for each axis a formula, or ("points", t, x)

    def trajectory(self, file, where):
        kind, body = choice(file, where)
        if kind == "formulas":
            return [formula(entry) if isinstance(entry, str) else ("number", exact(entry, where)) for entry in listed(body, where)]
        if kind == "sinusoids":
            return [self.waves(table(entry, where), where) for entry in listed(body, where)]
        if kind == "points":
            times = [exact(t, f"{where}.times_s") for t in listed(table(body, where).get("times_s"), where)]
            rows = [[exact(x, f"{where}.positions") for x in listed(row, where)] for row in listed(body.get("positions"), where)]
        elif kind == "csv":
            table_ = self.csv(table(body, where).get("file"))
            such(table_ and "t_s" in table_[0], f"{where}: the table lacks rows, or the column `t_s`")
            times = [quantity(row["t_s"]) for row in table_]
            rows = [[quantity(cell) for key, cell in row.items() if key != "t_s"] for row in table_]
        known(kind, ("points", "csv"), "motions")
        such(len(rows) == len(times) and len({len(row) for row in rows}) == 1, f"{where} must have as many entries for every time")
        such(all(early < late for early, late in zip(times, times[1:])), f"{where}: times must rise")
        return [("points", times, [row[axis] for row in rows]) for axis in range(len(rows[0]))]

    @staticmethod
    def waves(entry, where):
        """offset + Σ amplitude · sin(rate · t + phase), as a formula."""
        tree = "number", exact(entry.get("offset", 0), where)
        for wave in entry.get("waves", []):
            size, rate, phase = (("number", exact(table(wave, where).get(key, default), f"{where}.{key}"))
                                 for key, default in (("amplitude", None), ("rad_per_s", None), ("phase_rad", 0)))
            tree = plus(tree, times(size, ("f", "sin", plus(times(rate, ("t",)), phase))))
        return tree

    def text_of(self, name):
        """The text of a file that the scenario names: beside it, in `inputs` beside it, or among the shipped robots."""
        name = name_of(name, "file")
        for place in (self.folder / name, self.folder / "inputs" / name, SHIPPED_ROBOTS / name):
            if place.is_file():
                self.inputs[name] = read_bytes(place)
                return decoded(self.inputs[name])
        raise Undecided(f"the file `{name}` is not found beside the scenario")

    def csv(self, name):
        rows = [row for row in csv.reader(io.StringIO(self.text_of(name))) if row and not row[0].lstrip().startswith("#")]
        such(rows and all(len(row) <= len(rows[0]) for row in rows), f"the table `{name}` has rows that are longer than its first")
        head = [key.strip() for key in rows[0]]
        return [dict(zip(head, (cell.strip() for cell in row + [""] * (len(head) - len(row))))) for row in rows[1:]]

    def read_network(self):
        self.graphs, self.dwell, self.switching, self.coupling = [[]], [], "once", None
        network = self.file.get("network")
        if network is None:
            if self.reference != "tracking":
                raise Meaningless("`network` is missing")
            return
        network = table(network, "network", "weight delay coupling edges switching phases")
        self.weight, self.delay = self.read_weight(network.get("weight", 1)), self.read_delay(network.get("delay", {"constant_s": 0}))
        if "coupling" in network:
            form, scale = choice(network["coupling"], "coupling")
            known(form, ("saturated", "tanh", "rational"), "couplings")
            self.coupling = form, positive(scale, "coupling")
        such(("edges" in network) != ("phases" in network), "the network must have either `edges` or `phases`")
        if "edges" in network:
            self.graphs = [self.edges(network["edges"])]
            return
        phases = [table(phase, "phases", "dwell_s edges") for phase in listed(network["phases"], "phases")]
        self.graphs = [self.edges(phase.get("edges")) for phase in phases]
        self.switching, body = choice(network.get("switching", "repeat"), "switching")
        if self.switching == "random":
            self.dwell = [positive(x, "dwell_s") for x in pair(table(body, "switching").get("dwell_s"))]
            such(self.dwell[0] <= self.dwell[1], "`dwell_s` must rise")
            return
        known(self.switching, ("repeat", "once"), "switching")
        counted = phases if self.switching == "repeat" else phases[:-1]
        self.dwell = [positive(phase.get("dwell_s"), "dwell_s") for phase in counted]

    def read_weight(self, value):
        tree = formula(value) if isinstance(value, str) else ("number", exact(value, "weight"))
        return value if has_variable(tree) else positive(constant(tree), "weight")

    def read_delay(self, value):
        """(kind, its table, its text): equal texts are one delay."""
        kind, body = choice(value, "delay")
        return kind, body, repr((kind, body))

    def edges(self, value):
        rule, body = (None, {}) if isinstance(value, list) else choice(value, "edges")
        body = table(body, "edges", "direction among centre weight delay file")
        found = [self.edge(entry) for entry in value] if rule is None else self.ruled(rule, body)
        pairs = {(edge.source, edge.to) for edge in found}
        if len(pairs) < len(found) or any(a == b for a, b in pairs) or any(b == self.leader for _, b in pairs):
            raise Meaningless("an edge stands twice, leads from an agent to itself, or to the leader")
        return found

    def vertex(self, name):
        such(name_of(name, "an agent of an edge") in self.index, f"there is no agent `{name}`")
        return self.index[name]

    def edge(self, entry):
        if isinstance(entry, list) and len(entry) == 2:
            return Edge(self.vertex(entry[0]), self.vertex(entry[1]), self.weight, self.delay)
        entry = table(entry, "an edge", "from to weight delay")
        return Edge(self.vertex(entry.get("from")), self.vertex(entry.get("to")), *self.terms(entry))

    def terms(self, entry):
        weight = self.read_weight(entry["weight"]) if "weight" in entry else self.weight
        return weight, self.read_delay(entry["delay"]) if "delay" in entry else self.delay

    def ruled(self, rule, body):
        if rule == "csv":
            rows = [{key: cell for key, cell in row.items() if cell} for row in self.csv(body.get("file"))]
            for row in rows:
                row |= {"weight": Fraction(row["weight"])} if DECIMAL.fullmatch(row.get("weight", "")) else {}
                row |= {"delay": {"constant_s": quantity(row.pop("delay_s"))}} if "delay_s" in row else {}
            return [self.edge(row) for row in rows]
        members = [self.vertex(name) for name in listed(body["among"], "among")] if "among" in body else list(range(len(self.agents)))
        direction, n = body.get("direction"), len(members)
        if rule in ("ring", "path"):
            pairs = list(zip(members, members[1:])) + ([(members[-1], members[0])] if rule == "ring" and n > 1 else [])
            pairs += [(b, a) for a, b in pairs] if direction == "both" else []
            allowed = (None, "forward", "both")
        elif rule == "star":
            centre = self.vertex(body.get("centre"))
            others = [member for member in members if member != centre]
            pairs = [(centre, other) for other in others] if direction in (None, "out", "both") else []
            pairs += [(other, centre) for other in others] if direction in ("in", "both") else []
            allowed = (None, "out", "in", "both")
        elif rule == "complete":
            such(n * n <= MOST_EDGES, "there are too many edges")
            pairs, allowed = [(a, b) for a in members for b in members if a != b], (None,)
        else:
            raise Undecided(f"edges by the rule `{rule}` are not known")
        such(direction in allowed, "`direction` is not one of the rule")
        return [Edge(a, b, *self.terms(body)) for a, b in dict.fromkeys(pairs)]

    # What acts from outside: for every agent the end of each push, infinite where there is none

    def read_pushes(self):
        members = collections.defaultdict(list)
        for agent in self.agents:
            for name in {agent.name, agent.entry["name"]}:
                members[name].append(agent)
        for push in self.file.get("external_wrenches", []):
            push = table(push, "external_wrenches", "on from_s for_s by")
            begins = not_negative(push.get("from_s", 0), "from_s")
            ends = begins + positive(push["for_s"], "for_s") if "for_s" in push else INF
            for name in listed(push.get("on"), "on"):
                such(name_of(name, "on") in members, f"there is no agent `{name}`")
                for agent in members[name]:
                    for first, last in self.courses(push.get("by")):
                        if max(begins, first) < min(ends, last):
                            agent.pushes.append(min(ends, last))

    def courses(self, by):
        """From when until when the tables of a push have values; (0, ∞) for formulas."""
        kind, body = choice(by, "by")
        files = [body]
        if kind == "wrench":
            files = [table(body, "by")[key] for key in ("force_n", "torque_n_m") if key in body]
        elif kind.startswith("virtual_spring"):
            files = [table(body, "by")[key] for key in ("target", "target_rad", "target_m") if key in body]
        for file in files:
            if isinstance(file, list):
                yield Fraction(0), INF
                continue
            form, rows = choice(file, "by")
            if form == "rows":
                times = [exact(t, "times_s") for t in listed(table(rows, "rows").get("times_s"), "times_s")]
            elif form == "csv":
                times = [quantity(row.get("t_s", "")) for row in self.csv(table(rows, "csv").get("file"))]
            else:
                raise Undecided(f"courses of the form `{form}` are not known")
            yield min(times), max(times)

    def used(self):
        return [edge for graph in self.graphs for edge in graph]

    def varying(self):
        return sorted({edge.weight for edge in self.used() if isinstance(edge.weight, str)})

    def fixed(self):
        """Whether one graph, with its weights, is in force for ever."""
        graphs = [{(edge.source, edge.to, edge.weight) for edge in graph} for graph in self.graphs]
        return all(graph == graphs[0] for graph in graphs)

    def recurring(self):
        """The phases that are in force again and again, or for ever."""
        return [len(self.graphs) - 1] if self.switching == "once" else list(range(len(self.graphs)))

    def mutual(self, graph):
        """Whether all edges among agents lead both ways with the same weight."""
        among = {(edge.source, edge.to, edge.weight) for edge in graph if self.leader not in (edge.source, edge.to)}
        return all((to, source, weight) in among for source, to, weight in among)

    def limited(self):
        """Whether the torque that a law asks for may not be applied."""
        control = self.control or {}
        steps = exact(table(control.get("quantisation", {}), "quantisation").get("torque", 0), "torque")
        limits = [key for key in ("torque_limit", "torque_rate_limit_per_s") if key in control]
        return bool(limits) or steps != 0 or any(agent.enforced for agent in self.agents)

    def triple(self, node):
        """[from, to, phase] of the certificate as numbers; None for who is unknown."""
        parts = node.each()
        require(node, len(parts) == 3, "must be [from, to, phase]")
        return [self.index.get(part.text()) for part in parts[:2]] + [parts[2].count() - 1]

def read_bytes(path):
    try:
        such(path.stat().st_size <= MOST_BYTES, f"{path} is too large")
        return path.read_bytes()
    except OSError as error:
        raise Meaningless(f"{path} cannot be read: {error.strerror}") from None

def decoded(data):
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        raise Meaningless("a file is not UTF-8") from None

# --- Which theorem speaks, and what it asks for

def design_of(agent):
    return choice(agent.gains.get("design", "differentiable"), "design")[0]

def treated(agent):
    kinds = {"position_only": "position only", "task_space": "task space", "attitude": "attitude", "thrust": "thrust"}
    kind = kinds.get(agent.law, "chain" if agent.law in CHAIN_LAWS else "lagrangian")
    return f"thrust {design_of(agent)}" if kind == "thrust" else kind

def theorem(scenario):
    tracking, agents = scenario.reference == "tracking", scenario.agents
    if scenario.reference == "leader":
        return dict(zip(DESIGNS, ("theorem-8", "theorem-9", "remark-12", "swarm"))).get(scenario.body.get("design"), "no design")
    kinds = {treated(agent) for agent in agents}
    if len(kinds) > 1:
        return "targets" if tracking else "mixture"
    named = {"thrust continuous": "continuous-thrust", "thrust differentiable": "theorem-4", "thrust adaptive": "theorem-5",
             "task space": "theorem-6", "attitude": "theorem-7", "chain": "chains-track" if tracking else "chains-agree",
             "position only": "position-only-tracks" if tracking else "remark-7"}
    kind = kinds.pop()
    if kind in named or tracking:
        return named.get(kind, "robots-track")
    velocities, order = scenario.exchange() == "position_velocity", max(len(agent.roots) for agent in agents)
    if scenario.reference == "consensus" and len({len(agent.roots) for agent in agents}) > 1:
        return "theorem-3-own-orders"
    if scenario.reference != "consensus":
        return "backstepping" if scenario.reference == "backstepping" else "theorem-1" if velocities else "remark-3"
    if not velocities or order == 1:
        return "theorem-3-first-order" if velocities else "theorem-3-positions"
    same_ = all(agent.roots == agents[0].roots for agent in agents)
    return "theorem-2" if order == 2 and same_ else "theorem-3-velocities"

def requirements(scenario):
    """The hypotheses that a certificate must speak about: (id, name of an agent, or "" for the whole)."""
    agents, reference = scenario.agents, scenario.reference
    laws, robots = {agent.law for agent in agents}, {agent.robot for agent in agents}
    found = set()

    def ask(condition, *ids):
        found.update((each, "") for each in ids if condition)

    agreeing = reference in ("consensus", "pure_integral", "backstepping")
    ask(agreeing, "spanning-tree", "dwell-time", "bounded-delays")
    ask(reference in ("consensus", "pure_integral"), "real-roots")
    ask(reference == "consensus", "common-order" if len({len(agent.roots) for agent in agents}) == 1 else "own-orders")
    ask(reference in ("pure_integral", "leader"), "fixed-graph")
    ask(reference == "backstepping", "measured-derivative")
    ask(agreeing and scenario.coupling is not None, "coupling-sector")
    ask(agreeing and scenario.exchange() == "position_velocity", "common-first-root")
    ask(agreeing and any(agent.manipulability > 0 for agent in agents), "manipulability")
    ask(reference == "leader", "bounded-leader", "sign-gain", "leader-reaches-all", "no-delay", "set-valued-sign", "shared-design")
    ask(reference == "leader" and scenario.body.get("design") in DESIGNS[1:3], "constant-weights")
    ask(reference == "leader" and scenario.body.get("design") == "swarm", "printed-design", "mutual-weights", "swarm-coupling")
    ask(reference != "tracking" and scenario.varying(), "bounded-weights")
    ask(any(agent.pushes for agent in agents), "pushes-end")
    led = {treated(agent) for agent in agents if agent.index != scenario.leader}
    ask(len(led) > 1 and reference != "tracking", "one-kind")
    for law in laws & {"position_only", "task_space", "attitude"}:
        ask(True, f"{law.replace('_', '-')}-gains")
    flying = [agent for agent in agents if agent.law == "thrust"]
    for robot in ("vehicle", "rotorcraft"):
        designs = {design_of(agent) for agent in flying if agent.robot == robot}
        ask(designs == {"continuous"}, "known-masses")
        ask(designs - {"continuous"}, "thrust-gains")
    ask(flying, "nonzero-thrust")
    ask("rotorcraft" in robots, "angular-velocity")
    ask(any("rotors" in agent.body for agent in flying), "every-wrench")
    chains = [agent for agent in agents if agent.law in CHAIN_LAWS]
    estimates = any(agent.law != "linearising" for agent in chains)
    ask(chains, "defined-terms", "input-factor", "chain-adaptation" if estimates else "chain-gains")
    gradient = [agent for agent in chains if agent.law in ("linear_adaptive", "adaptive_backstepping")]
    ask(any(agent.body.get("parameters") for agent in gradient), "bounded-regressors")
    ask(any(agent.pushes and agent.robot != "chain" for agent in chains), "matched-disturbance")
    robots_ = [agent for agent in agents if agent.law in ("adaptive", "known")]
    ask(robots_, "positive-gains")
    ask(any(agent.tracks for agent in robots_), "real-roots")
    ask(robots_ or "task_space" in laws, "uniform-inertia")
    ask(any(not agent.tracks for agent in robots_) or "task_space" in laws, "bounded-dynamics")
    ask(True, "applied-torque")
    control = scenario.control
    if control is not None:
        ask(True, "continuous-time")
        ask(inexact(control), "exact-measurements")
        ask("message_timeout_s" in control, "messages-in-time")
    for agent in agents:
        of = {"task_space": ["regular-jacobian", *LATER], "attitude": ["known-momentum"]}.get(agent.law, [])
        of += ["bounded-target"] if agent.target else []
        of += ["nonzero-quaternion"] if agent.target and agent.law == "attitude" else []
        of += ["certain-regressor"] if agent.law == "task_space" and agent.robot == "urdf" else []
        of += ["lengths-within-bounds"] if agent.law == "task_space" and "bounds" in agent.gains else []
        found.update((each, agent.name) for each in of)
    return found

def inexact(control):
    """Whether measurements have noise, steps, or come from a filter."""
    velocity = choice(control.get("velocity", "measured"), "velocity")[0]
    parts = [(table(control.get(key, {}), key), entry) for key in ("noise", "quantisation") for entry in ("position", "velocity")]
    return velocity != "measured" or any(exact(part.get(entry, 0), entry) > 0 for part, entry in parts)

# A hypothesis for which this format has no proof yet; and one that may be spoken about robot by robot.
LATER, SEVERAL = ("target-within-reach",), ("uniform-inertia",)
# Hypotheses that only a run can show, or that the paper does not cover whenever they are asked for: no claim is right.
NEVER = ("one-kind", "measured-derivative", "printed-design", "nonzero-thrust", "angular-velocity", "every-wrench",
         "bounded-regressors", "regular-jacobian", "continuous-time", "exact-measurements")
# --- Rules: each shows one kind of proof of some hypotheses. Their parameters are the fields of the proof. A rule gives words,
# --- and whether what is shown holds for all time where that is not plain. `WITNESSES` show that a hypothesis is violated.
RULES = {}
WITNESSES = ("cut", "instant", "factor")

def rule(ids, kind):
    def note(check):
        RULES.update({(each, kind): check for each in ids.split()})
        return check
    return note

class Claim:
    """One entry of the certificate."""

    def __init__(self, scenario, entry):
        entry.only("id", "agents", "answer", "proof")
        self.scenario, self.entry, self.proof = scenario, entry, entry.optional("proof")
        self.id, self.answer = entry.field("id").text(), entry.field("answer").text()
        self.agents = [name.text() for name in entry.field("agents").each()]
        require(entry.field("agents"), all(name in scenario.index for name in self.agents), "names somebody unknown")
        require(entry.field("answer"), self.answer in (HOLDS, ON_RUN, VIOLATED, *UNCLAIMED), "is no answer")

    def judge(self):
        """(outcome, words)."""
        if self.answer in UNCLAIMED:
            require(self.entry, self.proof is None, "has a proof, and claims nothing")
            return UNCHECKED, f"nothing is claimed: {self.answer}"
        require(self.entry.field("answer"), self.id not in NEVER, "is a claim that nothing before a run shows")
        if self.proof is None or self.id not in {each for each, _ in RULES}:
            return UNCHECKED, "there is no proof" if self.proof is None else "no proof of it is known here"
        kind = self.proof.field("kind").text()
        check = RULES.get((self.id, kind))
        require(self.proof.field("kind"), check is not None, f"is no proof of `{self.id}`")
        fields = check.__code__.co_varnames[1:check.__code__.co_argcount]
        self.proof.only("kind", *fields)
        try:
            found = check(self, *(self.proof.field(field) for field in fields))
        except Undecided as reason:
            return UNCHECKED, str(reason)
        words, always = found if isinstance(found, tuple) else (found, True)
        shown = (VIOLATED,) if kind in WITNESSES else (HOLDS, ON_RUN) if always else (ON_RUN,)
        require(self.entry.field("answer"), self.answer in shown, f"is more than the proof shows: {' or '.join(shown)}")
        return ACCEPTED, words

def require(node, condition, words):
    if not condition:
        node.reject(words)

def reach(scenario, node, root, allowed):
    """Follows an arborescence: triples [from, to, phase] of edges that exist, each from who has been reached; all are."""
    reached = {scenario.index.get(root.text())}
    require(root, None not in reached, "is no vertex")
    for step in node.each():
        *ends, phase = scenario.triple(step)
        require(step, phase in allowed, "is of a phase outside of the window")
        require(step, tuple(ends) in scenario.pairs[phase], "is no edge of this phase")
        require(step, ends[0] in reached, "leads from an agent that has not been reached")
        reached.add(ends[1])
    require(node, len(reached) == len(scenario.names), "does not reach everybody")

def tiled(claim, windows, sequence):
    """Windows that follow each other along a sequence of phases, each with a tree; where they end."""
    ends = [0]
    for window in windows.each():
        window.only("phases", "root", "arborescence")
        phases = [phase.count() - 1 for phase in window.field("phases").each()]
        at = ends[-1]
        require(window.field("phases"), phases == sequence[at:at + len(phases)], "are not the phases that follow")
        # No edge leads to a leader, so that a root from which everybody is reached is the leader where there is one.
        reach(claim.scenario, window.field("arborescence"), window.field("root"), phases)
        ends.append(at + len(phases))
    require(windows, len(ends) > 1, "must be some")
    return ends

@rule("spanning-tree leader-reaches-all", "windows")
def tiling(claim, windows):
    """Windows tile whole periods: any stretch of time twice as long as the longest of them holds a whole one."""
    scenario, phases = claim.scenario, claim.scenario.recurring()
    require(claim.proof, scenario.switching != "random" or len(scenario.graphs) == 1, "is of no drawn schedule")
    covered = sum(len(window.field("phases").each()) for window in windows.each())
    require(windows, covered % len(phases) == 0 and covered <= MOST_CELLS, "must cover whole periods")
    tiled(claim, windows, phases * (covered // len(phases)))
    return f"{len(windows.each())} windows tile {covered} phases, each with a spanning tree"

@rule("spanning-tree leader-reaches-all", "every-phase")
def every_phase(claim, windows):
    """Each phase that recurs has a tree of its own: the order does not matter."""
    phases = claim.scenario.recurring()
    ends = tiled(claim, windows, phases)
    require(windows, ends == list(range(len(phases) + 1)), "must be one for each phase")
    return f"each of {len(phases)} graphs has a spanning tree"

@rule("spanning-tree leader-reaches-all", "drawn")
def along_draw(claim, given, windows, longest_s):
    """A drawn sequence up to the end of the run, tiled by windows but for a rest that is no longer than is stated."""
    scenario = claim.scenario
    require(claim.proof, scenario.switching == "random", "is of a schedule that is not drawn")
    # Drawn in floating point: a dwell may leave its bounds by a part of 10^9.
    low, high = scenario.dwell[0] * (1 - Fraction(1, 10**9)), scenario.dwell[1] * (1 + Fraction(1, 10**9))
    sequence, times = [], [Fraction(0)]
    for entry in given.each():
        entry.only("phase", "until_s")
        sequence.append(entry.field("phase").count() - 1)
        times.append(entry.field("until_s").number())
        require(entry, 0 <= sequence[-1] < len(scenario.graphs), "is no phase")
        require(entry, low <= times[-1] - times[-2] <= high, "lasts shorter or longer than the scenario allows")
    require(given, times[-1] >= scenario.end_s, "ends before the run")
    ends = tiled(claim, windows, sequence)
    lengths = [times[b] - times[a] for a, b in zip(ends, ends[1:])] + [scenario.end_s - times[ends[-1]]]
    require(longest_s, max(lengths) <= longest_s.number(), "is exceeded by a window, or by what is left after the last")
    return f"{len(ends) - 1} windows of at most {said(longest_s.number())} s tile the given sequence", False

@rule("spanning-tree leader-reaches-all", "cut")
def cut(claim, groups):
    """Two disjoint groups, or one without the leader, that hear nobody outside themselves in what recurs: no tree, for ever."""
    scenario = claim.scenario
    sets = [{scenario.index.get(name.text()) for name in group.each()} for group in groups.each()]
    require(groups, sets and all(sets) and None not in set().union(*sets), "must name agents")
    if claim.id == "leader-reaches-all":
        require(groups, len(sets) == 1 and scenario.leader not in sets[0], "must be one group without the leader")
    else:
        disjoint = sum(map(len, sets)) == len(set().union(*sets))
        require(groups, len(sets) >= 2 and disjoint, "must be two or more that are disjoint")
    for phase in scenario.recurring():
        for source, to in scenario.pairs[phase]:
            heard = any(to in group and source not in group for group in sets)
            require(groups, not heard, f"are not closed: {scenario.names[to]} hears {scenario.names[source]} in phase {phase + 1}")
    return f"{len(sets)} closed groups"

@rule("dwell-time", "never-switches")
@rule("fixed-graph", "one-graph")
def fixed_graph(claim):
    require(claim.proof, claim.scenario.fixed(), "is not so: the graphs differ")
    steady = claim.scenario.reference != "pure_integral" or not claim.scenario.varying()
    require(claim.proof, steady or claim.id == "dwell-time", "is not so: a weight varies")
    return "one graph for ever"

@rule("dwell-time", "shortest-phase")
def shortest_phase(claim, shortest_s):
    dwell = claim.scenario.dwell
    require(shortest_s, dwell and 0 < shortest_s.number() <= min(dwell), "is not below the shortest phase")
    return f"phases last {said(shortest_s.number())} s at least"

def robots(scenario):
    """Those whose M, C and g the proofs use. A tree would have to be read from its file."""
    found = [agent for agent in scenario.agents if agent.law in ("adaptive", "known", "task_space")]
    if any(agent.robot == "urdf" for agent in found):
        raise Undecided("the inertias of a URDF are not read here yet")
    return found

def definite_inertia(agent):
    """M is positive definite at all q, by a bound that does not depend on q: a mass is positive; the minors of a ship's are, in its
    body; of a planar arm with a = I₁ + m₁c₁² and b = I₂ + m₂c₂² det M = (a + m₂l₁²) b − (m₂l₁c₂ cos q₂)² ≥ ab + m₂l₁²I₂."""
    if agent.robot == "point_mass":
        return exact(agent.body.get("mass_kg"), "mass_kg") > 0
    if agent.robot == "ship":
        of = table(agent.body.get("inertia"), "inertia")
        m_11, m_22, m_23, m_33 = (exact(of.get(key, 0), key) for key in ("surge_kg", "sway_kg", "sway_yaw_kg_m", "yaw_kg_m2"))
        return min(m_11, m_22) > 0 and m_22 * m_33 > m_23 ** 2
    pair = {key: [exact(x, key) for x in listed(agent.body[key], key)] for key in agent.body if key != "gravity_m_s2"}
    m, l_ = pair["mass_kg"], pair["length_m"]
    c, i = pair.get("com_m", [x / 2 for x in l_]), pair.get("inertia_kg_m2", [m[k] * l_[k] ** 2 / 12 for k in (0, 1)])
    a, b = (i[k] + m[k] * c[k] ** 2 for k in (0, 1))
    return min(m + l_ + [b]) > 0 and min(i) >= 0 and a * b + m[1] * l_[0] ** 2 * i[1] > 0

def terms(body):
    held = body.values() if isinstance(body, dict) else body if isinstance(body, list) else []
    return [formula(body, STATES)] if isinstance(body, str) else [term for each in held for term in terms(each)]

def set_valued(scenario):
    """A value of the sign is solved for so often that the error that stays, about h sup|ξ̇₀|/α, is small: h κ₀, or h √(κ₀κ₁), ≤ 0.01."""
    h = exact(scenario.body.get("sign_period_s", Fraction(1, 1000)), "sign_period_s")
    h = h if scenario.control is None else 1 / positive(scenario.control.get("sample_hz"), "sample_hz")
    roots = [exact(root, "roots_per_s") for root in listed(scenario.body.get("roots_per_s"), "roots_per_s")]
    return scenario.body.get("sign", "implicit") == "implicit" and 10_000 * h * h * roots[0] * roots[-1] <= 1 and h < scenario.end_s

STATES = [f"x{k}" for k in range(1, 9)] + ["x", "dx"] + [f"d{k}x" for k in range(2, 9)]
TEXT = {
    "uniform-inertia": lambda scenario, _: all([definite_inertia(agent) for agent in robots(scenario)]),
    # q enters by sines and cosines of angles at most.
    "bounded-dynamics": lambda scenario, _: bool(robots(scenario)),
    "defined-terms": lambda scenario, _: all(everywhere(term) for agent in scenario.agents if agent.law in CHAIN_LAWS
                                             for term in terms(agent.body)),
    # (30) has a vertex for every derivative of every agent: no order of one meets that of another.
    "own-orders": lambda scenario, _: all(agent.roots for agent in scenario.agents),
    "mutual-weights": lambda scenario, _: all(scenario.mutual(graph) for graph in scenario.graphs),
    "constant-weights": lambda scenario, _: not scenario.varying(),
    "no-delay": lambda scenario, _: all(rule_bound(edge.delay) == 0 for edge in scenario.used()),
    "applied-torque": lambda scenario, _: not scenario.limited(),
    # α, β and γ stand once; a continuous design has the mass of its plant; without torques from outside h_I is that of the start.
    "shared-design": lambda scenario, _: scenario.reference == "leader",
    "known-masses": lambda scenario, _: all(design_of(a) == "continuous" for a in scenario.agents if a.law == "thrust"),
    "known-momentum": lambda scenario, names: not any(a.pushes for a in scenario.agents if a.name in names),
    "set-valued-sign": lambda scenario, _: set_valued(scenario),
}

@rule(" ".join(TEXT), "text")
def by_text(claim):
    require(claim.proof, TEXT[claim.id](claim.scenario, claim.agents), "is not so by the text")
    return "as the text says"

def pieces(node, tree, end_s):
    """The pieces of time that `range` and `cells` name: [0, ∞), or as many of a period of the formula, or of the run."""
    kind, unit, length = node.field("range").text(), (Fraction(1),) * 2, end_s
    if kind == "for-ever":
        return [(Fraction(0), INF)]
    if kind == "period":
        unit, length = period(tree)
    elif kind != "run":
        node.field("range").reject("must be `for-ever`, `period` or `run`")
    cells = node.field("cells").count()
    require(node.field("cells"), 0 < cells <= MOST_CELLS, "must be some")
    return [multiply(unit, (length * k / cells, length * (k + 1) / cells)) for k in range(cells)]

def enclosed(node, tree, end_s):
    """Checks that a formula keeps within what is stated, piece by piece; (low, high)."""
    node.only("range", "cells", "within", "edge")
    ends = [end.number() for end in node.field("within").each()]
    require(node.field("within"), len(ends) == 2, "must have two ends")
    for piece in pieces(node, tree, end_s):
        found = enclose(tree, piece)
        words = f"does not hold [{said(found[0])}, {said(found[1])}], found from t = {said(piece[0])} s on"
        require(node.field("within"), ends[0] <= found[0] and found[1] <= ends[1], words)
    return tuple(ends)

def lasts(node):
    return node.field("range").text() != "run"

def formulas(claim, node, text_of):
    """Enclosures of formulas, each named by an edge: {text: (low, high, whether for ever and uniformly continuous)}."""
    found = {}
    for entry in node.each():
        *ends, phase = claim.scenario.triple(entry.field("edge"))
        graph = claim.scenario.graphs[phase] if 0 <= phase < len(claim.scenario.graphs) else []
        texts = [text_of(edge) for edge in graph if [edge.source, edge.to] == ends]
        require(entry.field("edge"), texts and texts[0] is not None, "is no edge with a formula")
        tree = formula(texts[0])
        within = enclosed(entry, tree, claim.scenario.end_s)
        # A formula that repeats, and has a value everywhere, is uniformly continuous.
        found[texts[0]] = *within, entry.field("range").text() == "period" or (lasts(entry) and uniform(tree)[0])
    return found

def rule_bound(delay):
    """What no value of a delay exceeds by the parameters of its rule; None where the rule does not say."""
    kind, body, _ = delay
    if kind == "constant_s":
        return not_negative(body, kind)
    if kind in ("formula_s", "log"):
        return None
    if kind == "piecewise_constant":
        return max(not_negative(value, kind) for value in listed(table(body, kind).get("values_s"), kind))
    if kind == "random_hold":
        return max(not_negative(value, kind) for value in pair(table(body, kind).get("value_s")))
    keys = ("mean_s", "amplitude_s", "min_s", "max_s", "latency_s", "jitter_s")
    mean, swing, low, high, latency, jitter = (not_negative(table(body, kind).get(key, 0), key) for key in keys)
    period_s = positive(body.get("period_s"), "period_s")
    if kind in ("sinusoid", "saw_tooth"):
        such(swing <= mean and low <= high, "a delay may be negative")
        return mean + swing if kind == "sinusoid" else high
    known(kind, ("packets",), "delays")
    loss = choice(body["loss"], "loss")[1] if "loss" in body else {"probability": 0}
    lost = loss.get("most_consecutive")
    if 0 in (loss.get("probability"), loss.get("enter")):
        lost = 0
    elif loss.get("leave") == 1:
        lost = 1
    return None if lost is None else (not_negative(lost, "most_consecutive") + 1) * period_s + latency + jitter

def logged(scenario, edge):
    """The largest age of what is heard on a link whose packets are logged: the newest that has arrived; before the first, t."""
    names, newest, worst = (scenario.names[edge.source], scenario.names[edge.to]), Fraction(0), Fraction(0)
    rows = [row for row in scenario.csv(table(edge.delay[1], "log").get("file")) if (row.get("from"), row.get("to")) == names]
    packets = [(quantity(row["send_s"]), quantity(row["delay_s"])) for row in rows if row.get("delay_s")]
    for arrives, sent in sorted((sent + delay, sent) for sent, delay in packets):
        if arrives <= scenario.end_s and sent > newest:
            worst, newest = max(worst, arrives - newest), sent
    return max(worst, scenario.end_s - newest)

@rule("bounded-delays", "delays")
def delays(claim, bound_s, enclosures, given):
    """A rule bounds its delay for ever, an enclosure a formula; logs and drawn packets do up to the end of the run."""
    scenario, always, largest, ages = claim.scenario, True, Fraction(0), {}
    shown = formulas(claim, enclosures, lambda edge: edge.delay[1] if edge.delay[0] == "formula_s" else None)
    for entry in given.each():
        entry.only("from", "to", "worst_s")
        ages[entry.field("from").text(), entry.field("to").text()] = entry.field("worst_s")
    for edge in {(edge.source, edge.to, edge.delay[2]): edge for edge in scenario.used()}.values():
        kind, body, _ = edge.delay
        worst = rule_bound(edge.delay)
        if kind == "formula_s":
            require(enclosures, body in shown and shown[body][0] >= 0, f"lacks `{body}`, or lets it become negative")
            worst, always = shown[body][1], always and shown[body][2]
        elif kind == "log":
            worst, always = logged(scenario, edge), False
        elif worst is None:
            link = scenario.names[edge.source], scenario.names[edge.to]
            require(given, link in ages, f"lacks the link from {link[0]} to {link[1]}")
            worst, always = ages[link].number(), False
            require(ages[link], worst >= not_negative(body.get("latency_s"), "latency_s"), "is below the latency")
        largest = max(largest, worst)
    require(bound_s, largest <= bound_s.number(), f"is exceeded: a delay may reach {said(largest)} s")
    return f"no delay exceeds {said(bound_s.number())} s", always

@rule("messages-in-time", "ages")
def in_time(claim, bound_s):
    """Heard at samples, a message is up to a period older than its delay."""
    ends = [rule_bound(edge.delay) for edge in claim.scenario.used()]
    if None in ends:
        raise Undecided("the bound of a delay does not follow from its rule")
    late = max(ends, default=0) + 1 / positive(claim.scenario.control.get("sample_hz"), "sample_hz")
    least = exact(claim.scenario.control["message_timeout_s"], "message_timeout_s")
    require(bound_s, late <= bound_s.number() <= least, f"must lie between {said(late)} and {said(least)}")
    return f"no message is older than {said(bound_s.number())} s"

@rule("bounded-weights", "weights")
def weights(claim, enclosures):
    shown = formulas(claim, enclosures, lambda edge: edge.weight if isinstance(edge.weight, str) else None)
    for text in claim.scenario.varying():
        require(enclosures, text in shown and shown[text][0] > 0, f"lacks `{text}`, or lets it come to zero")
    words = (f"{text} keeps within [{said(low)}, {said(high)}]" for text, (low, high, _) in shown.items())
    return "; ".join(words), all(shown[text][2] for text in claim.scenario.varying())

@rule("coupling-sector", "form")
def coupling(claim, form, size):
    """v within ± a else ± a, a tanh(v/a), v/(1 + |v|/a): odd, continuous, never falling, between 0 and v, for any a > 0."""
    require(form, (form.text(), size.number()) == claim.scenario.coupling, "is not that of the scenario")
    return f"{form.text()} with {said(size.number())}"

@rule("real-roots manipulability common-order pushes-end", "number")
def number(claim, value):
    agents, stated = claim.scenario.agents, value.number()
    if claim.id == "real-roots":
        roots = [root for agent in agents for root in agent.roots]
        require(value, roots and 0 < stated <= min(roots), "is not a positive bound below all roots")
        agreeing = claim.scenario.reference in ("consensus", "pure_integral")
        rooted = [a for a in agents if agreeing or (a.tracks and a.law in ("adaptive", "known"))]
        require(claim.proof, all(a.roots for a in rooted), "is not so: an agent has no roots")
    elif claim.id == "manipulability":
        require(value, stated == max(agent.manipulability for agent in agents), "is not the largest gain")
    elif claim.id == "common-order":
        require(value, all(len(agent.roots) == stated for agent in agents), "is not the order of all agents")
    else:
        require(value, all(end <= stated for agent in agents for end in agent.pushes), "comes before the end of a push")
    return said(stated)

@rule("common-first-root", "constant")
def all_constant(claim):
    scenario = claim.scenario
    steady = len(scenario.graphs) == 1 and not scenario.varying()
    require(claim.proof, steady and all(edge.delay[0] == "constant_s" for edge in scenario.used()), "is not so by the text")
    return "graph, weights and delays are constant"

@rule("common-first-root", "classes")
def common_first_root(claim, classes):
    """κ₀ is the same within each class, and all edges lead within a class or to a later one: so cycles stay within classes."""
    scenario, place = claim.scenario, {}
    for k, group in enumerate(classes.each()):
        for name in group.each():
            require(name, name.text() in scenario.index and name.text() not in place, "is no agent, or stands twice")
            place[name.text()] = k
        first = {tuple(scenario.agents[scenario.index[name.text()]].roots[:1]) for name in group.each()}
        require(group, len(first) == 1, "has agents whose κ₀ differ")
    require(classes, len(place) == len(scenario.names), "must hold every agent")
    at = [place[name] for name in scenario.names]
    require(classes, all(at[edge.source] <= at[edge.to] for edge in scenario.used()), "are not in order: an edge leads back")
    return f"{len(classes.each())} classes in order"

def pivots(rows):
    """The pivots of A = L D Lᵀ, in rational numbers, up to the first that is not positive."""
    a, found = [list(row) for row in rows], []
    for k in range(len(a)):
        found.append(a[k][k])
        if found[-1] <= 0:
            break
        for i in range(k + 1, len(a)):
            factor = a[i][k] / a[k][k]
            for j in range(k, len(a)):
                a[i][j] -= factor * a[k][j]
    return found

def definite(node, rows, stated):
    """A symmetric matrix is positive definite if and only if all pivots are positive."""
    n = len(rows)
    such(n <= MOST_ROWS and all(len(row) == n for row in rows), "a gain is not a square matrix of moderate size")
    require(node, all(rows[i][j] == rows[j][i] for i in range(n) for j in range(i)), "is not of a symmetric matrix")
    found = pivots(rows)
    require(stated, [pivot.number() for pivot in stated.each()] == found, "are not the pivots of the matrix")
    require(stated, len(found) == n and min(found) > 0, "are not all positive")

ASKED_OF = {"positive-gains": ("adaptive", "known"), "task-space-gains": ("task_space",), "attitude-gains": ("attitude",),
            "position-only-gains": ("position_only",), "thrust-gains": ("thrust",), "chain-gains": CHAIN_LAWS,
            "chain-adaptation": CHAIN_LAWS}

@rule(" ".join(ASKED_OF), "definite")
def gains(claim, matrices):
    """Numbers are positive, matrices are by their pivots; a mass that is not adapted is the true one."""
    stated = {}
    for entry in matrices.each():
        entry.only("agent", "gain", "pivots")
        stated[entry.field("agent").text(), entry.field("gain").text()] = entry
    keys = [(agent, key) for agent in claim.scenario.agents if agent.law in ASKED_OF[claim.id] for key in GAINS[agent.law]]
    for agent, key in keys:
        gain_is_positive(claim, agent, key, agent.settings().get(key), matrices, stated)
    return f"{len(keys)} gains"

def gain_is_positive(claim, agent, key, value, matrices, stated):
    """One gain of one agent: a number, a diagonal, a matrix, or a bandwidth times scales that are positive."""
    bandwidth = value is None and agent.robot == "urdf"
    if isinstance(value, dict):
        kind, value = choice(value, key)
        known(kind, ("gain", "bandwidth_per_s"), "gains")
        bandwidth = kind == "bandwidth_per_s"
    if bandwidth and key == "damping":
        # The scales of K are the diagonal of M(q₀); those of Γ are positive by how they are made.
        require(claim.proof, heavy(claim.scenario, agent), f"{agent.name} may have a joint without inertia")
    if value == 0 and key == "adaptation_gain" and agent.law in ("position_only", "thrust"):
        true = agent.settings().get("estimate_start_kg") == agent.body.get("mass_kg") and "parameter_variation" not in agent.entry
        require(claim.proof, true, f"{agent.name} keeps a wrong mass")
    elif isinstance(value, list) and value and isinstance(value[0], list):
        require(matrices, (agent.name, key) in stated, f"lacks `{key}` of {agent.name}")
        entry = stated[agent.name, key]
        definite(entry, [[exact(x, key) for x in listed(row, key)] for row in value], entry.field("pivots"))
    elif value is not None:
        entries = [exact(x, key) for x in (value if isinstance(value, list) else [value])]
        require(claim.proof, entries and min(entries) > 0, f"{agent.name} has a gain `{key}` that is not positive")

def heavy(scenario, agent):
    """Whether the diagonal of M(q) is positive: each joint carries a body with mass and, if it turns, with inertia ≻ 0."""
    if agent.robot != "urdf":
        return True  # Their tables have positive masses and inertias by definition.
    try:
        root = ElementTree.fromstring(scenario.text_of(agent.body.get("file")))
        bodies = {}
        for link in root.findall("link"):
            inertial = link.find("inertial")
            if inertial is not None:
                entries = (decimal(inertial.find("inertia").get(key, "0")) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
                xx, yy, zz, xy, xz, yz = entries
                bodies[link.get("name")] = decimal(inertial.find("mass").get("value")), pivots([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        joints = [(j.get("name"), j.get("type"), j.find("parent").get("link"), j.find("child").get("link")) for j in root.findall("joint")]
    except (ElementTree.ParseError, AttributeError, TypeError, ValueError):
        raise Undecided("a URDF cannot be read here") from None
    locked = table(agent.body.get("locked", {}), "locked")

    def carries(link, turns, depth=0):
        mass, inertia = bodies.get(link, (0, [0]))
        own = mass > 0 and (not turns or (len(inertia) == 3 and min(inertia) > 0))
        return own or depth < 200 and any(carries(child, turns, depth + 1) for _, _, parent, child in joints if parent == link)

    moving = [j for j in joints if j[1] in ("revolute", "continuous", "prismatic") and j[0] not in locked]
    return all(carries(child, kind != "prismatic") for _, kind, _, child in moving)

def needed(agent):
    """How many derivatives of a target a law needs, four at most."""
    if agent.law == "thrust":
        return 3 if design_of(agent) == "continuous" else 4
    least = len(agent.roots) if agent.law in CHAIN_LAWS else max(len(agent.roots), 2)
    return min({"position_only": 3, "task_space": 2, "attitude": 2}.get(agent.law, least), 4)

@rule("bounded-target bounded-leader", "derivatives")
def bounded(claim, order, stretch):
    """Curves through points are polynomials on finitely many pieces and constant elsewhere; derivatives of formulas are enclosed,
    on [0, ∞) at once or on the stretch that is stated."""
    stretch.only("range", "cells")
    scenario, always = claim.scenario, True
    agents = [scenario.agents[scenario.index[name]] for name in claim.agents]
    motions = [(agent.target or [], 0 if agent.tracks else 1, needed(agent)) for agent in agents]
    if claim.id == "bounded-leader":
        require(claim.proof, scenario.motion is not None, "is of no motion")
        motions = [(scenario.motion, 1, 3)]
    require(order, motions and order.count() >= max(most for _, _, most in motions), "is too low for a law")
    if any(most > 3 and tree[0] == "points" for paths, _, most in motions for tree in paths):
        raise Undecided("the third derivative of a curve through points jumps")
    for tree, lowest, most in ((tree, lowest, most) for paths, lowest, most in motions for tree in paths if tree[0] != "points"):
        for k in range(most + 1):
            if k >= lowest and not finite(tree, [(Fraction(0), INF)]):
                require(stretch, finite(tree, pieces(stretch, tree, scenario.end_s)), f"does not bound derivative {k}")
                always = always and lasts(stretch)
            tree = derivative(tree)
    return f"up to derivative {order.count()}", always

def finite(tree, stretches):
    """Whether a formula is shown to be bounded on each of some stretches."""
    try:
        return not any(infinite(end) for stretch in stretches for end in enclose(tree, stretch))
    except Undecided:
        return False

def drive(claim):
    """What γ must exceed, axis by axis: α q̇ + q̈, α q̇ + β q̈ + d³q, or d³q, as formulas."""
    scenario, design = claim.scenario, claim.scenario.body.get("design")
    require(claim.proof, scenario.motion is not None, "is of no motion")
    roots = [positive(root, "roots_per_s") for root in listed(scenario.body.get("roots_per_s"), "roots_per_s")]
    such(len(roots) == (1 if design == "continuous" else 2), "`roots_per_s` has not as many entries as the design needs")
    factors = {"continuous": (roots[0], 1, 0), "swarm": (0, 0, 1)}.get(design, (math.prod(roots), sum(roots), 1))
    if any(tree[0] == "points" for tree in scenario.motion):
        raise Undecided("the bound of a curve through points cannot be checked yet")
    found = []
    for tree in scenario.motion:
        whole = ZERO
        for factor in factors:
            tree = derivative(tree)
            whole = plus(whole, times(("number", Fraction(factor)), tree))
        found.append(whole)
    return found, positive(scenario.body.get("gain"), "gain")

@rule("sign-gain", "bounds")
def sign_gain(claim, bounds):
    trees, gamma = drive(claim)
    require(bounds, len(bounds.each()) == len(trees), "must be one for each axis")
    for entry, tree in zip(bounds.each(), trees):
        require(entry.field("within"), size(enclosed(entry, tree, claim.scenario.end_s)) < gamma, f"reaches γ = {said(gamma)}")
    return f"the drive stays below γ = {said(gamma)}", all(lasts(entry) for entry in bounds.each())

@rule("sign-gain", "instant")
def sign_gain_instant(claim, t_s, axis):
    trees, gamma = drive(claim)
    require(axis, 1 <= axis.count() <= len(trees), "is no axis")
    require(t_s, 0 <= t_s.number() <= claim.scenario.end_s, "is outside of the run")
    found = enclose(trees[axis.count() - 1], (t_s.number(),) * 2)
    require(t_s, max(found[0], -found[1]) >= gamma, "is no time at which γ is reached")
    return f"at t = {said(t_s.number())} s the drive is {said(found[0])}"

@rule("swarm-coupling", "definite")
def swarm(claim, pivots):
    """k λ > β + κ⁴/(2 (β² − α) (β − κ)), κ the smaller root: L − (…/k) 1 of the followers is positive definite."""
    scenario = claim.scenario
    require(claim.proof, scenario.fixed() and not scenario.varying(), "is not so: the Laplacian changes")
    small, large = sorted(positive(root, "roots_per_s") for root in pair(scenario.body.get("roots_per_s")))
    least = small + large + small**4 / (2 * ((small + large) ** 2 - small * large) * large)
    followers = [k for k in range(len(scenario.names)) if k != scenario.leader]
    shift = least / positive(scenario.body.get("coupling"), "coupling")
    rows = [[-shift if i == j else Fraction(0) for j in followers] for i in followers]
    at = {vertex: k for k, vertex in enumerate(followers)}
    for edge in scenario.graphs[0]:
        rows[at[edge.to]][at[edge.to]] += edge.weight
        if edge.source in at:
            rows[at[edge.to]][at[edge.source]] -= edge.weight
    definite(claim.proof, rows, pivots)
    return f"k λ exceeds {said(least)}"

def factors(scenario):
    """For every chain what encloses the factor of its input in every state, and the floor."""
    for agent in scenario.agents:
        if agent.law in CHAIN_LAWS:
            written = {"chain": agent.body.get("psi", "1"), "strict_feedback": "1"}.get(agent.robot, "x1")
            yield agent.name, enclose(formula(written, STATES), WHOLE), positive(agent.gains.get("floor", Fraction(1, 1000)), "floor")

@rule("input-factor", "constant")
def input_factor(claim):
    for name, within, floor in factors(claim.scenario):
        require(claim.proof, max(within[0], -within[1]) >= floor, f"is not so for {name}")
    return "every factor keeps away from zero"

@rule("input-factor", "factor")
def small_factor(claim, agent):
    found = {name: size(within) < floor for name, within, floor in factors(claim.scenario)}
    require(agent, found.get(agent.text(), False), "has no constant factor below its floor")
    return f"ψ of {agent.text()} is too small"

def quaternion(claim):
    paths = [tree for name in claim.agents for tree in claim.scenario.agents[claim.scenario.index[name]].target or []]
    if len(paths) != 4 or any(tree[0] == "points" for tree in paths):
        raise Undecided("a curve through points cannot be checked yet")
    return paths

@rule("nonzero-quaternion", "entry-away")
def entry_away(claim, entry, bound):
    """One entry keeps away from zero."""
    require(entry, 1 <= entry.count() <= 4, "is no entry")
    within = enclosed(bound, quaternion(claim)[entry.count() - 1], claim.scenario.end_s)
    require(bound.field("within"), max(within[0], -within[1]) > 0, "holds zero")
    return f"entry {entry.count()} keeps within [{said(within[0])}, {said(within[1])}]", lasts(bound)

@rule("nonzero-quaternion", "norm")
def norm(claim, bound):
    """The sum of squares keeps away from zero."""
    squares = [("^", tree, Fraction(2)) for tree in quaternion(claim)]
    within = enclosed(bound, functools.reduce(lambda a, b: ("+", a, b), squares), claim.scenario.end_s)
    require(bound.field("within"), within[0] > 0, "holds zero")
    return f"the norm squared keeps within [{said(within[0])}, {said(within[1])}]", lasts(bound)

# --- The whole certificate

def check(certificate_text, scenario_text, folder, digests=True):
    """All outcomes: a list of (id, agents, answer, outcome, words, place)."""
    found = []
    try:
        document = read_certificate(certificate_text)
        document.only("format", "producer", "scenario", "theorem", "hypotheses", "agreement")
        require(document.field("format"), document.field("format").count() == FORMAT, f"must be {FORMAT}")
        scenario = Scenario(scenario_text, folder)
        asked, spoken = requirements(scenario), set()
        require(document.field("theorem"), document.field("theorem").text() == theorem(scenario), f"must be {theorem(scenario)}")
        for entry in document.field("hypotheses").each():
            found.append(outcome(scenario, entry, asked, spoken))
        for each, agent in sorted(asked - spoken):
            result, words = (UNCHECKED, "no format of a proof yet") if each in LATER else (REJECTED, "is left out")
            found.append((each, [agent] if agent else [], "", result, words, ""))
        agreement = document.optional("agreement")
        if agreement is not None:
            unique = any(one[0] == "spanning-tree" and one[2] != VIOLATED and one[3] == ACCEPTED for one in found)
            require(agreement, unique, "is of a network whose spanning tree is not shown")
            agreed(scenario, agreement)
            found.append(("agreement", [], HOLDS, ACCEPTED, "uᵀL = 0 and Σu = 1", ""))
        if digests:
            same(document.field("scenario"), scenario_text, scenario.inputs)
    except Rejected as error:
        found.append(("certificate", [], "", REJECTED, error.words, error.place))
    except Meaningless as error:
        found.append(("certificate", [], "", REJECTED, f"the scenario: {error}", ""))
    except Undecided as error:
        found.append(("certificate", [], "", UNCHECKED, str(error), ""))
    except (RecursionError, MemoryError, ArithmeticError, ValueError, TypeError, LookupError, AttributeError) as error:
        words = f"cannot be checked in this form ({type(error).__name__}: {str(error)[:80]})"
        found.append(("certificate", [], "", REJECTED, words, ""))
    return found

def outcome(scenario, entry, asked, spoken):
    """The outcome of one entry. Each hypothesis is spoken about once."""
    claim = Claim(scenario, entry)
    later = claim.id in LATER
    for key in [(claim.id, name) for name in claim.agents or [""]]:
        require(entry, later or claim.id in SEVERAL or key not in spoken, "speaks twice about the same")
        require(entry, key in asked or (later and any(each == claim.id for each, _ in asked)), "is not asked for by this scenario")
        # What has no rule yet may be said of agents or of the whole.
        spoken.update({key} | {ask for ask in asked if later and ask[0] == claim.id})
    try:
        return claim.id, claim.agents, claim.answer, *claim.judge(), ""
    except Rejected as error:
        return claim.id, claim.agents, claim.answer, REJECTED, error.words, error.place

def agreed(scenario, node):
    """The shares u ≥ 0 with uᵀL = 0 and Σu = 1 of a fixed network: what each agent's start counts in the value agreed upon."""
    node.only("influence")
    influence = node.field("influence")
    stated = {pair_.each()[0].text(): pair_.each()[1].number() for pair_ in influence.each() if len(pair_.each()) == 2}
    require(influence, set(stated) == set(scenario.names) and len(influence.each()) == len(stated), "must be [agent, share] of everybody")
    require(node, len(scenario.graphs) == 1 and not scenario.varying(), "is of no fixed network")
    shares = [stated[name] for name in scenario.names]
    flow = [Fraction(0)] * len(shares)
    for edge in scenario.graphs[0]:
        flow[edge.to] += shares[edge.to] * edge.weight
        flow[edge.source] -= shares[edge.to] * edge.weight
    require(influence, min(shares) >= 0 and sum(shares) == 1, "must be shares of one")
    require(influence, not any(flow), "is no left null vector of the Laplacian")

def same(node, text, inputs):
    """Digests only say which files were meant."""
    node.only("name", "sha256", "inputs")
    require(node.field("sha256"), node.field("sha256").text() == hashlib.sha256(text.encode()).hexdigest(), "is not that of the scenario")
    for entry in node.field("inputs").each():
        entry.only("file", "sha256")
        data = inputs.get(entry.field("file").text())
        known = data is None or hashlib.sha256(data).hexdigest() == entry.field("sha256").text()
        require(entry, known, "is not that of the file")

def main(arguments=None):
    parser = argparse.ArgumentParser(description="Check a certificate of forwardstep against a scenario.")
    parser.add_argument("certificate", type=Path)
    parser.add_argument("scenario", type=Path)
    parser.add_argument("--ignore-digests", action="store_true", help="whether the files are those that were meant does not count")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    options = parser.parse_args(arguments)
    try:
        certificate, scenario = (decoded(read_bytes(path)) for path in (options.certificate, options.scenario))
        found = check(certificate, scenario, options.scenario.resolve().parent, not options.ignore_digests)
    except Meaningless as error:
        found = [("certificate", [], "", REJECTED, str(error), "")]
    results = {entry[3] for entry in found}
    whole = REJECTED if REJECTED in results else UNCHECKED if UNCHECKED in results or not found else ACCEPTED
    violated = [entry[0] for entry in found if entry[2:4] == (VIOLATED, ACCEPTED)]
    if options.json:
        entries = [dict(zip(("id", "agents", "answer", "outcome", "words", "place"), entry)) for entry in found]
        print(json.dumps({"outcome": whole, "violated": violated, "entries": entries}))
    else:
        for each, agents, answer, result, words, place in found:
            about = (f" of {', '.join(agents)}" if agents else "") + (f", {answer}" if answer else "")
            print(f"{result}: {each}{about}: {words}{f' ({place})' if place else ''}")
        print(f"all in all: {whole}{'; violated: ' + ', '.join(violated) if violated else ''}")
    return (ACCEPTED, REJECTED, UNCHECKED).index(whole)

if __name__ == "__main__":
    sys.exit(main())
