# What    Reads functions from the kernels' source and evaluates them with names in place of numbers: a value is then
#         the expression, operation by operation in the source's order, that a kernel computes.
# Shape   Source(kernels, file) runs the C preprocessor; evaluate(function, arguments) goes through a function's
#         statements. Values: Op for a number, Vec for a vector whose components differ (float4, real3), Place for what
#         lies at a name that nothing has been stored at, Struct for structs and arrays. A vector whose lanes all do the
#         same (float8, float16) is one number.
# Errors  A Broken tells what of the source isn't understood. What decides (comparisons, larger of two) isn't followed:
#         `reads` says what such a piece of text stands for, and a piece that is not there any more is an error.
import re
import subprocess
from dataclasses import dataclass
from fractions import Fraction


class Broken(Exception):
    pass


@dataclass(frozen=True, eq=False)
class Op:
    kind: str  # "+", "-", "*", "/", "fma", "sqrt": rounded; "neg", "abs"; "name"; "number"
    args: tuple = ()
    value: object = None  # of names and numbers


class Vec(list):
    pass


class Struct(dict):
    pass


@dataclass(frozen=True)
class Place:
    name: str


def round32(value):
    """The float nearest to a fraction, to even."""
    if value == 0:
        return Fraction(0)
    sign, value, exponent = (-1 if value < 0 else 1), abs(value), 0
    while value >= 2**24:
        value, exponent = value / 2, exponent + 1
    while value < 2**23 and exponent > -149:
        value, exponent = value * 2, exponent - 1
    return sign * round(value) * Fraction(2) ** exponent


def number(text):
    text = text.rstrip("uUlL") if text.lower().startswith("0x") and "p" not in text.lower() else text
    if re.fullmatch(r"(0[xX][0-9a-fA-F]+|\d+)[uUlL]*", text):
        return Op("number", value=Fraction(int(text.rstrip("uUlL"), 0)))
    text = text.rstrip("fF")
    if text.lower().startswith("0x"):
        return Op("number", value=round32(Fraction(float.fromhex(text))))
    return Op("number", value=round32(Fraction(text)))


TOKEN = re.compile(
    r"0[xX][0-9a-fA-F]+(?:\.[0-9a-fA-F]*)?(?:[pP][-+]?\d+)?[fFuUlL]*|\d+\.?\d*(?:[eE][-+]?\d+)?[fFuUlL]*"
    r"|[A-Za-z_]\w*|->|<<=|>>=|<<|>>|<=|>=|==|!=|&&|\|\||\+\+|--|[-+*/|&^]=|[-+*/%<>=!~&|^?:;,.(){}\[\]]"
)
TYPE = re.compile(r"(?:float|real|double|int|uint|u32|word|lanes|mask|bool|long|uchar|u8)(?:\d+|N)?|Real3xN|void")
BINARY = [["||"], ["&&"], ["|"], ["^"], ["&"], ["==", "!="], ["<", ">", "<=", ">="], ["<<", ">>"], ["+", "-"],
          ["*", "/", "%"]]  # fmt: skip


class Parser:
    """Expressions and statements as tuples: (what, its text, parts)."""

    def __init__(self, tokens, is_type):
        self.tokens, self.at, self.is_type = tokens, 0, is_type

    def peek(self, ahead=0):
        return self.tokens[self.at + ahead] if self.at + ahead < len(self.tokens) else ""

    def take(self, expected=None):
        token = self.peek()
        if expected is not None and token != expected:
            raise Broken(
                f"'{expected}' was to come, not '{token}': {' '.join(self.tokens[max(0, self.at - 8) : self.at + 4])}"
            )
        self.at += 1
        return token

    def node(self, what, start, *parts):
        return (what, " ".join(self.tokens[start : self.at]), *parts)

    def expression(self):
        start = self.at
        first = self.assignment()
        while self.peek() == ",":
            self.take()
            first = self.node("comma", start, first, self.assignment())
        return first

    def assignment(self):
        start = self.at
        left = self.ternary()
        if self.peek() in ("=", "+=", "-=", "*=", "/=", "|=", "&=", "^=", "<<=", ">>="):
            operator = self.take()
            return self.node("assign", start, operator, left, self.assignment())
        return left

    def ternary(self):
        start = self.at
        condition = self.binary(0)
        if self.peek() != "?":
            return condition
        self.take()
        yes = self.assignment()
        self.take(":")
        return self.node("choose", start, condition, yes, self.assignment())

    def binary(self, level):
        if level == len(BINARY):
            return self.unary()
        start = self.at
        left = self.binary(level + 1)
        while self.peek() in BINARY[level]:
            operator = self.take()
            right = self.binary(level + 1)
            left = self.node("binary", start, operator, left, right)
        return left

    def unary(self):
        start = self.at
        if self.peek() in ("-", "+", "!", "~", "&", "*", "++", "--"):
            operator = self.take()
            return self.node("unary", start, operator, self.unary())
        if self.peek() == "(" and self.cast_ahead():
            self.take("(")
            name = ""
            while self.peek() != ")":
                name = (
                    self.take()
                    if self.peek() not in ("const", "__global", "*", "__attribute__")
                    else self.take() and name
                )
            self.take(")")
            if self.peek() == "(":
                self.take()
                parts = [self.assignment()]
                while self.peek() == ",":
                    self.take()
                    parts.append(self.assignment())
                self.take(")")
                return self.postfix(start, self.node("cast", start, name, parts))
            return self.node("cast", start, name, [self.unary()])
        return self.postfix(start, self.primary())

    def cast_ahead(self):
        return self.is_type(self.peek(1)) or self.peek(1) in ("__global", "const")

    def primary(self):
        start = self.at
        if self.peek() == "(":
            self.take()
            inner = self.expression()
            self.take(")")
            return self.node("inner", start, inner)
        token = self.take()
        if re.match(r"\d", token):
            return self.node("number", start, token)
        if not re.match(r"[A-Za-z_]", token):
            raise Broken(f"not understood: '{token}' after {' '.join(self.tokens[max(0, start - 8) : start])}")
        return self.node("name", start, token)

    def postfix(self, start, left):
        while self.peek() in ("(", "[", ".", "->", "++", "--"):
            token = self.take()
            if token == "(":
                parts = []
                while self.peek() != ")":
                    parts.append(self.assignment())
                    if self.peek() == ",":
                        self.take()
                self.take(")")
                left = self.node("call", start, left, parts)
            elif token == "[":
                index = self.expression()
                self.take("]")
                left = self.node("index", start, left, index)
            elif token in (".", "->"):
                left = self.node("field", start, left, self.take())
            else:
                left = self.node("step", start, token, left)
        return left

    def declaration_ahead(self):
        return self.peek() in ("const", "__global", "__constant", "volatile") or (
            self.is_type(self.peek()) and re.match(r"[A-Za-z_]|\*", self.peek(1) or "")
        )

    def statement(self):
        start = self.at
        if self.peek() == "{":
            self.take()
            body = []
            while self.peek() != "}":
                body.append(self.statement())
            self.take("}")
            return self.node("block", start, body)
        if self.peek() == "return":
            self.take()
            value = None if self.peek() == ";" else self.expression()
            self.take(";")
            return self.node("return", start, value)
        if self.peek() == "if":
            self.take()
            self.take("(")
            condition = self.expression()
            self.take(")")
            yes = self.statement()
            no = None
            if self.peek() == "else":
                self.take()
                no = self.statement()
            return self.node("if", start, condition, yes, no)
        if self.peek() == "for":
            self.take()
            self.take("(")
            first = self.statement()
            condition = self.expression()
            self.take(";")
            step = None if self.peek() == ")" else self.expression()
            self.take(")")
            return self.node("for", start, first, condition, step, self.statement())
        if self.declaration_ahead():
            return self.declaration(start)
        value = self.expression()
        self.take(";")
        return self.node("do", start, value)

    def declaration(self, start):
        kind = ""
        while self.peek() in ("const", "__global", "__constant", "volatile") or self.is_type(self.peek()):
            token = self.take()
            kind = token if self.is_type(token) else kind
        names = []
        while True:
            while self.peek() in ("*", "const"):
                self.take()
            name, sizes, value = self.take(), [], None
            while self.peek() == "[":
                self.take()
                sizes.append(self.expression())
                self.take("]")
            if self.peek() == "=":
                self.take()
                if self.peek() == "{":
                    self.take()
                    value = []
                    while self.peek() != "}":
                        value.append(self.assignment())
                        if self.peek() == ",":
                            self.take()
                    self.take("}")
                else:
                    value = self.assignment()
            names.append((name, sizes, value))
            if self.take() == ";":
                return self.node("declare", start, kind, names)


class Source:
    """The functions that a file of the kernels sees. `kernels`: folders, the first with a file wins."""

    def __init__(self, compiler, kernels, file, defines=(), numbers=()):
        command = [compiler, "-E", "-P", "-x", "c", "-D__OPENCL_C_VERSION__=120"]
        command += [f"-D{d}" for d in defines] + [f"-I{folder}" for folder in kernels] + ["-"]
        text = f'#include "{file}"\n' + "".join(f"KDRAY_NUMBER {name} = {value};\n" for name, value in numbers)
        done = subprocess.run(command, input=text, capture_output=True, text=True)
        if done.returncode != 0:
            raise Broken(f"the preprocessor fails on {file}: {done.stderr.strip()}")
        self.text = "\n".join(line for line in done.stdout.split("\n") if not line.startswith("#"))
        self.numbers = dict(re.findall(r"KDRAY_NUMBER (\w+) = (.*);", self.text))
        self.structs = {}
        for match in re.finditer(r"typedef struct[^{};]*\{([^{}]*)\}\s*(\w+);", self.text):
            fields = re.findall(r"(\w+)\s*(?:\[[^\]]*\])*\s*(?=[,;])", match[1])
            self.structs[match[2]] = fields
        self.parsed = {}

    def fields(self, kind):
        return self.structs.get(kind)

    def is_type(self, token):
        return bool(TYPE.fullmatch(token)) or token in self.structs

    def expression(self, text):
        return Parser(TOKEN.findall(text), self.is_type).expression()

    def function(self, name, arity):
        """Returns the names of the parameters and the body of the first function of that name and arity."""
        if (name, arity) in self.parsed:
            return self.parsed[name, arity]
        for match in re.finditer(rf"\b{name}\s*\(", self.text):
            depth, at = 1, match.end()
            while depth:
                depth += {"(": 1, ")": -1}.get(self.text[at], 0)
                at += 1
            if not re.match(r"\s*\{", self.text[at:]):
                continue
            parameters = self.text[match.end() : at - 1].split(",")
            if len(parameters) != arity:
                continue
            parser = Parser(TOKEN.findall(self.body(at)), self.is_type)
            names = [re.findall(r"\w+", p)[-1] for p in parameters]
            self.parsed[name, arity] = names, parser.statement()
            return self.parsed[name, arity]
        return None

    def body(self, at):
        start = self.text.index("{", at)
        depth, at = 1, start + 1
        while depth:
            depth += {"{": 1, "}": -1}.get(self.text[at], 0)
            at += 1
        return self.text[start:at]

    def defines(self, name, arity):
        return self.function(name, arity) is not None
