# What    A bound: a file with what is read from the kernels, hypotheses and a goal, made into a script for Gappa.
# Shape   Lines that begin with % say what is read; the rest is Gappa's, and %rounding in it stands for the hypotheses
#         about roundings.
#           %from FILE                 which of the kernels' files
#           %include FILE              lines of another file of the folder
#           %define NAME=VALUE         for the preprocessor
#           %read TEXT as TEXT         what an expression of the source stands for here (evaluate.py)
#           %set PLACE = EXPRESSION    what lies in a struct before
#           %call FUNCTION(ARGUMENTS)  evaluates a function
#           %let NAME = PLACE          names a value: what a call stored, or FUNCTION.VARIABLE at its end; behind an
#                                      operation, .0, .1 and .2 are what it is of
#           %unit UNIT: NAMES          what names are measured in. Sums must be of one unit: then all may be divided by
#                                      one value of each unit, and "in units of M" is no loss.
#           %power NAME                that a name is a power of two, a product with which isn't rounded
#           %pin FILE: TEXT            what stands in a file of the project that isn't read by this
#           %number NAME = EXPRESSION  names a constant
#         Each operation x is printed three times: op_x, what it computes of its rounded operands; x, the float nearest
#         to that, as op_x + (op_x*e + n) with |e| <= 2^-24 and, where it may underflow, |n| <= 2^-100; and exact_x, the
#         same without any rounding. (rounding.v. Sums don't underflow, nor does a product with a power of two
#         round.) Units are no less than 2^-50: n, which is 2^-150 at most, is no more than 2^-100 of them.
#         Hints say how the error of x comes from those of its operands; Gappa checks that they are equations.
import pathlib
import re
from fractions import Fraction

from evaluate import Evaluation, plain
from kernel_source import Broken, Op, Place, Source

FOLDER = pathlib.Path(__file__).parent / "bounds"
ROUNDED = ("+", "-", "*", "/", "fma", "sqrt")


def gappa_number(value):
    exponent = 0
    while value.denominator != 1:
        value, exponent = value * 2, exponent - 1
        if exponent < -400:
            raise Broken("a number that is no float")
    return f"{value.numerator}b{exponent}" if value >= 0 else f"(-{-value.numerator}b{exponent})"


def is_power_of_two(value):
    value = abs(value)
    return (
        value != 0
        and (value.numerator & (value.numerator - 1)) == 0
        and (value.denominator & (value.denominator - 1)) == 0
    )


class Bound:
    def __init__(self, text):
        text = re.sub(r"^%include (\S+)$", lambda m: (FOLDER / m[1]).read_text(), text, flags=re.MULTILINE)
        self.lines = [line for line in text.split("\n") if line.startswith("%") and not line.startswith("%rounding")]
        self.script = "\n".join(line for line in text.split("\n") if line not in self.lines)

    def directives(self, word):
        return [line[len(word) + 2 :].strip() for line in self.lines if line.startswith(f"%{word} ")]

    def evaluate(self, compiler, kernels):
        """Returns the named values, and the named constants."""
        pairs = [d.split(" = ", 1) for d in self.directives("number")]
        reads = [d.split(" as ") for d in self.directives("read")]
        texts = pairs + [(f"read_{i}", text) for i, (text, _) in enumerate(reads)]
        source = Source(compiler, kernels, self.directives("from")[0], self.directives("define"), texts)
        evaluation = Evaluation(source, {source.numbers[f"read_{i}"]: value for i, (_, value) in enumerate(reads)})
        names = {}
        for line in self.lines:
            word, rest = line[1:].split(" ", 1)
            if word not in ("from", "define", "read", "set", "call", "let", "number", "unit", "power", "pin", "mutant"):
                raise Broken(f"no such line in a bound: {line}")
            if word == "set":
                place, value = rest.split(" = ")
                evaluation.memory[place.strip()] = evaluation.load(evaluation.value(source.expression(value), {}))
            elif word == "call":
                name, arguments = re.fullmatch(r"(\w+)\((.*)\)", rest.strip()).groups()
                values = [self.argument(evaluation, source, a) for a in arguments.split(",")]
                if not source.defines(name, len(values)):
                    raise Broken(f"no function {name} of {len(values)} parameters any more")
                evaluation.memory.pop(name, None)
                result = evaluation.call(name, values)
                if result is not None:
                    evaluation.store(Place(f"{name}.result"), result)
            elif word == "let":
                name, place = (part.strip() for part in rest.split(" = "))
                names[name] = self.resolve(evaluation, place)
        unused = set(evaluation.reads) - evaluation.used
        if unused:
            raise Broken(f"not in the source any more: {', '.join(sorted(unused))}")
        constants = {n: evaluation.load(evaluation.value(source.expression(source.numbers[n]), {})) for n, _ in pairs}
        return names, {n: c.value for n, c in constants.items()}

    def check_pins(self, kernels):
        for pin in self.directives("pin"):
            file, text = pin.split(": ", 1)
            folders = [pathlib.Path(folder) for folder in kernels] + [pathlib.Path(kernels[-1]).parent]
            lines = next(folder / file for folder in folders if (folder / file).exists()).read_text()
            if plain(text) not in plain(lines):
                raise Broken(f"not in {file} any more: {text}")

    def argument(self, evaluation, source, text):
        return evaluation.value(source.expression(text.strip()), {})

    def resolve(self, evaluation, place):
        first, *rest = place.split(".")
        if rest and rest[0] != "result" and first in evaluation.locals_of and rest[0] in evaluation.locals_of[first]:
            value = evaluation.locals_of[first][rest[0]]
            rest = rest[1:]
        else:
            value = Place(first)
        for part in rest:
            stored = evaluation.memory.get(value.name) if isinstance(value, Place) else value
            is_operand = part.isdigit() and isinstance(stored, Op) and stored.args
            if is_operand and int(part) >= len(stored.args):
                raise Broken(f"{place} isn't there any more")
            value = stored.args[int(part)] if is_operand else evaluation.component(value, part)
        if isinstance(value, Place) and value.name not in evaluation.memory:
            raise Broken(f"nothing lies at {place}")
        value = evaluation.load(value)
        if not isinstance(value, Op):
            raise Broken(f"{place} is no number")
        return value

    def gappa(self, compiler, kernels):
        names, constants = self.evaluate(compiler, kernels)
        units = {n: {d.split(":")[0]: Fraction(1)} for d in self.directives("unit") for n in d.split(":")[1].split()}
        for op in names.values():
            unit_of(op, units, {})
        self.check_pins(kernels)
        printer = Printer({id(op): name for name, op in names.items()}, self.directives("power"))
        for op in names.values():
            printer.define(op)
        printer.alias(names)
        numbers = ["u = 1b-24;"] + [f"{name} = {gappa_number(value)};" for name, value in constants.items()]
        rounding = " /\\ ".join(printer.roundings)
        script = self.script.replace("%rounding", rounding)
        return "\n".join(numbers + printer.lines) + "\n" + script + "\n" + "\n".join(printer.hints) + "\n"

    def coq(self, compiler, kernels):
        """Prints the named values as definitions of Coq, of what they are computed from."""
        names, _ = self.evaluate(compiler, kernels)
        text = ["Require Import Reals.", "Open Scope R_scope."]
        for name, op in names.items():
            lines, done = [], {}
            result = coq_value(op, lines, done)
            parameters = [coq_name(a.strip()) for a in re.search(r"\((.*)\)", self.directives("call")[0])[1].split(",")]
            text.append(f"Definition {name} (nearest : R -> R) ({' '.join(parameters)} : R) : R :=")
            text += [*lines, f"  {result}."]
        return "\n".join(text) + "\n"


def unit_of(op, units, done):
    """Returns the exponents of the units that a value is measured in."""
    if id(op) in done:
        return done[id(op)]
    args = [unit_of(a, units, done) for a in op.args]

    def scaled(a, b, times):
        both = {k: a.get(k, 0) + times * b.get(k, 0) for k in {*a, *b}}
        return {k: v for k, v in both.items() if v}

    def same(a, b):
        if a != b:
            raise Broken("a sum of different units")
        return a

    results = {"name": lambda: units.get(op.value, {}), "number": dict, "neg": lambda: args[0], "abs": lambda: args[0],
               "+": lambda: same(*args), "-": lambda: same(*args), "*": lambda: scaled(*args, 1),
               "/": lambda: scaled(*args, -1), "fma": lambda: same(scaled(args[0], args[1], 1), args[2]),
               "sqrt": lambda: {k: v / 2 for k, v in args[0].items()}}  # fmt: skip
    if op.kind not in results:
        raise Broken(f"what this stands for isn't told: {op.value}")
    done[id(op)] = results[op.kind]()
    return done[id(op)]


def coq_name(name):
    return name + "_" if name in ("by", "at", "as", "in", "end", "fun") else name


def coq_value(op, lines, done):
    if id(op) in done:
        return done[id(op)]
    if op.kind == "name":
        return coq_name(op.value)
    args = [coq_value(a, lines, done) for a in op.args]
    if op.kind == "neg":
        return f"(- {args[0]})"
    if op.kind not in ROUNDED:
        raise Broken(f"not for Coq: {op.kind} {op.value or ''}")
    done[id(op)] = f"v{len(done) + 1}"
    lines.append(f"  let {done[id(op)]} := nearest ({formula(op.kind, args)}) in")
    return done[id(op)]


class Printer:
    def __init__(self, names, powers):
        self.powers = powers
        self.names, self.lines, self.hints, self.roundings, self.done = names, [], [], [], {}

    def alias(self, names):
        for name, op in names.items():
            text, exact = self.define(op)
            if text != name:
                self.lines += [f"{name} = {text};", f"exact_{name} = {exact};"]

    def define(self, op):
        """Returns the names of an operation's value, rounded and exact."""
        if id(op) not in self.done:
            self.done[id(op)] = self.print(op)
        return self.done[id(op)]

    def print(self, op):
        if op.kind == "name":
            return op.value, op.value
        if op.kind == "number":
            return gappa_number(op.value), gappa_number(op.value)
        if op.kind == "undecided":
            raise Broken(f"what this stands for isn't told: {op.value}")
        args = [self.define(a) for a in op.args]
        if op.kind == "neg":
            return f"(-{args[0][0]})", f"(-{args[0][1]})"
        if op.kind == "abs":
            return f"|{args[0][0]}|", f"|{args[0][1]}|"
        name = self.names.get(id(op), f"t{len(self.done) + 1}")
        rounded, exact = ([a[i] for a in args] for i in (0, 1))
        self.lines += [f"op_{name} = {formula(op.kind, rounded)};", f"exact_{name} = {formula(op.kind, exact)};"]
        self.round(op, name)
        self.hint(op, name, rounded, exact)
        return name, f"exact_{name}"

    def round(self, op, name):
        """Says how far a value may be from what is computed of its operands."""
        times_power = op.kind == "*" and any(self.is_power(a) for a in op.args)
        may_underflow = op.kind in ("*", "/", "fma")
        nearest = f"op_{name}" if times_power else f"r_{name}" if may_underflow else name
        if not times_power:
            self.roundings.append(f"{nearest} -/ op_{name} in [-1b-24,1b-24]")
        if may_underflow:
            self.lines.append(f"{name} = {nearest} + n_{name};")
            self.roundings.append(f"n_{name} in [-1b-100,1b-100]")
            error = f"({nearest} - op_{name}) + n_{name}" if nearest[0] == "r" else f"n_{name}"
            self.hints.append(f"{name} - op_{name} -> {error};")

    def is_power(self, op):
        return op.value in self.powers if op.kind == "name" else op.kind == "number" and is_power_of_two(op.value)

    def hint(self, op, name, a, exact):
        def off(i):
            return None if a[i] == exact[i] else f"({a[i]} - {exact[i]})"

        def sum_of(terms):
            return " + ".join(t for t in terms if t) or None

        def product(i, j):
            first = off(i) and f"{off(i)}*{a[j]}"
            second = off(j) and f"{exact[i]}*{off(j)}"
            return sum_of([first, second])

        whole = f"exact_{name}"
        if op.kind in "+-":
            second = off(1) and (off(1) if op.kind == "+" else f"-({off(1)})")
            way = sum_of([off(0), second])
        elif op.kind == "*":
            way = product(0, 1)
        elif op.kind == "fma":
            way = sum_of([product(0, 1), off(2)])
        elif op.kind == "/":
            top = sum_of([off(0), off(1) and f"-({whole}*{off(1)})"])
            way = top and f"({top})/{a[1]} {{ {a[1]} <> 0, {exact[1]} <> 0 }}"
        else:
            way = off(0)  # Gappa knows the rest itself
        if way:
            self.hints += [f"op_{name} - {whole} -> {way};"] if op.kind != "sqrt" else []
            self.hints += [f"{name} - {whole} -> (op_{name} - {whole}) + ({name} - op_{name});"]
        else:
            self.hints += [f"{name} - {whole} -> {name} - op_{name};"]


def formula(kind, a):
    if kind == "fma":
        return f"{a[0]}*{a[1]} + {a[2]}"
    if kind == "sqrt":
        return f"sqrt({a[0]})"
    return f"{a[0]} {kind} {a[1]}"
