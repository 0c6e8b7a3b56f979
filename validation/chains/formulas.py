"""Formulas that can be differentiated and become Python functions: just enough for backstepping by the book."""

import math


class Formula:
    """A sum, product, function, variable or number; equal ones are one object."""

    known = {}

    def __new__(cls, kind, *parts):
        key = (kind, *(id(p) if isinstance(p, Formula) else p for p in parts))
        if key not in cls.known:
            new = super().__new__(cls)
            new.kind, new.parts, new.slopes = kind, parts, {}
            cls.known[key] = new
        return cls.known[key]

    def __add__(self, other):
        a, b = self, formula(other)
        if a is ZERO or b is ZERO:
            return b if a is ZERO else a
        return Formula("+", a, b)

    def __mul__(self, other):
        a, b = self, formula(other)
        if a is ZERO or b is ZERO:
            return ZERO
        if a is ONE or b is ONE:
            return b if a is ONE else a
        return Formula("*", a, b)

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self):
        return self * -1.0

    def __sub__(self, other):
        return self + -formula(other)

    def by(self, variable):
        """The derivative."""
        if variable not in self.slopes:
            self.slopes[variable] = self._by(variable)
        return self.slopes[variable]

    def _by(self, variable):
        p = self.parts
        if self.kind in ("number", "variable"):
            return ONE if self is variable else ZERO
        if self.kind == "+":
            return p[0].by(variable) + p[1].by(variable)
        if self.kind == "*":
            return p[0].by(variable) * p[1] + p[0] * p[1].by(variable)
        slope = {"sin": lambda: cos(p[0]), "cos": lambda: -sin(p[0]), "tanh": lambda: ONE - self * self}[self.kind]()
        return slope * p[0].by(variable)


def formula(value):
    return value if isinstance(value, Formula) else Formula("number", float(value))


def variables(count):
    start = len(Formula.known)
    return [Formula("variable", start + k) for k in range(count)]


def of_kind(kind):
    return lambda x: Formula(kind, formula(x))


sin, cos, tanh = of_kind("sin"), of_kind("cos"), of_kind("tanh")
ZERO, ONE = formula(0.0), formula(1.0)


def function(arguments, results):
    """A function of a list of numbers that gives a list."""
    names, lines = {id(v): f"v[{k}]" for k, v in enumerate(arguments)}, []

    def name(f):
        if id(f) not in names:
            if f.kind == "number":
                names[id(f)] = repr(f.parts[0])
            else:
                parts = [name(p) for p in f.parts]
                text = f" {f.kind} ".join(parts) if f.kind in "+*" else f"math.{f.kind}({parts[0]})"
                names[id(f)] = f"t{len(lines)}"
                lines.append(f"    {names[id(f)]} = {text}")
        return names[id(f)]

    final = ", ".join(name(f) for f in results)
    code = "def made(v):\n" + "\n".join(lines) + f"\n    return [{final}]\n"
    scope = {"math": math}
    exec(code, scope)
    return scope["made"]
