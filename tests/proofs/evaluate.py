# What    Evaluates functions of the kernels with names in place of numbers (kernel_source.py has the values).
# Shape   Evaluation(source, reads).call(function, arguments) returns what the function returns; `memory` has what it
#         stored, by names like r.near.0, and `locals_of` its variables at its end. Equal operations on equal operands
#         are one Op: the kernels' arithmetic has one result for them.
#         Where lanes are chosen (select3), those that count; a loop over what isn't counted is gone through once.
# Errors  What isn't followed is an Op "undecided" with its text, which the printer refuses.
import re
from dataclasses import dataclass

from kernel_source import Broken, Op, Place, Vec, number, round32

LETTERS = "xyzw"
VECTORS = {"float2": 2, "float3": 3, "float4": 4, "real3": 3, "int4": 4, "uint2": 2, "uint4": 4}
APART = re.compile(r"(pack|packu|permute|permuteu|count_lanes|less|less_equal|greater_equal)\d*")  # of masks of lanes
SAME = {"convert_float16", "convert_float8", "splat3", "as_float", "as_realN", "loadN", "load_row"}


@dataclass(frozen=True, eq=False)
class Variable:
    """What & of a variable gives."""

    env: dict
    name: str


def plain(text):
    return re.sub(r"\s+", "", text)


class Evaluation:
    def __init__(self, source, reads=None):
        self.source, self.memory, self.interned, self.frames = source, {}, {}, 0
        self.reads = {plain(text): value for text, value in (reads or {}).items()}
        self.used, self.reading = set(), set()
        self.locals_of = {}

    # Values

    def op(self, kind, *args, value=None):
        if kind == "neg" and args[0].kind == "number":
            return self.op("number", value=-args[0].value)
        if kind == "abs" and args[0].kind == "number":
            return self.op("number", value=abs(args[0].value))
        if kind in "+-*/" and all(a.kind == "number" for a in args):
            a, b = (x.value for x in args)
            if kind != "/" or b != 0:
                exact = a + b if kind == "+" else a - b if kind == "-" else a * b if kind == "*" else a / b
                return self.op("number", value=round32(exact))
        if kind == "+" and any(a.kind == "number" and a.value == 0 for a in args):
            return next((a for a in args if a.kind != "number" or a.value != 0), args[0])
        if any(a.kind == "undecided" for a in args):
            return self.undecided(next(a.value for a in args if a.kind == "undecided"))
        key = (kind, tuple(map(id, args)), value)
        if key not in self.interned:
            self.interned[key] = Op(kind, args, value)
        return self.interned[key]

    def undecided(self, text):
        return self.op("undecided", value=text)

    def load(self, value):
        """Returns what lies at a place: a number where nothing says otherwise."""
        if not isinstance(value, Place):
            return value
        if value.name in self.memory:
            return self.load(self.memory[value.name])
        inside = [key for key in self.memory if key.startswith(value.name + ".")]
        if inside and all(value.name + "." + c in self.memory for c in "xyz"):
            return Vec(self.load(Place(value.name + "." + c)) for c in "xyz")
        return self.op("name", value=re.sub(r"\W+", "_", value.name))

    def store(self, place, value):
        for key in [key for key in self.memory if key.startswith(place.name + ".")]:
            del self.memory[key]
        if isinstance(value, Place):
            inside = [key for key in self.memory if key.startswith(value.name + ".")]
            if inside and value.name not in self.memory:
                for key in inside:
                    self.memory[place.name + key[len(value.name) :]] = self.memory[key]
                return
        self.memory[place.name] = value

    def each(self, kind, *values):
        values = [self.load(v) for v in values]
        size = max((len(v) for v in values if isinstance(v, Vec)), default=0)
        if size == 0:
            return self.op(kind, *values)
        return Vec(self.op(kind, *(v[i] if isinstance(v, Vec) else v for v in values)) for i in range(size))

    def component(self, value, name):
        if isinstance(value, Place):
            at = Place(f"{value.name}.{name}")
            inside = any(key == at.name or key.startswith(at.name + ".") for key in self.memory)
            if not inside and value.name in self.memory:
                return self.component(self.memory[value.name], name)
            return at
        if not isinstance(value, Vec):
            return value  # the same in all lanes
        if re.fullmatch(r"s[0-9a-f]+", name):
            picked = [value[int(c, 16)] for c in name[1:]]
        elif all(c in LETTERS for c in name):
            picked = [value[LETTERS.index(c)] for c in name]
        else:
            raise Broken(f"no component {name}")
        return picked[0] if len(picked) == 1 else Vec(picked)

    # Expressions

    def value(self, node, env):
        text = plain(node[1])
        if text in self.reads and text not in self.reading:
            self.used.add(text)
            self.reading.add(text)
            try:
                return self.value(self.source.expression(self.reads[text]), env)
            finally:
                self.reading.discard(text)
        return getattr(self, "of_" + node[0])(node, env)

    def of_number(self, node, env):
        exact = number(node[2])
        return self.op("number", value=exact.value)

    def of_name(self, node, env):
        if node[2] in env:
            return env[node[2]]
        return Place(node[2])

    def of_inner(self, node, env):
        return self.value(node[2], env)

    def of_comma(self, node, env):
        self.value(node[2], env)
        return self.value(node[3], env)

    def of_cast(self, node, env):
        parts = [self.value(part, env) for part in node[3]]
        if len(parts) == 1 or (node[2] not in VECTORS and len(parts) != 16):
            return parts[0]
        flat = []
        for part in parts:
            part = self.load(part)
            flat += part if isinstance(part, Vec) else [part]
        return Vec(flat)

    def of_unary(self, node, env):
        operator, value = node[2], self.value(node[3], env)
        if operator == "&" and node[3][0] == "name" and not isinstance(value, Place):
            return Variable(env, node[3][2])
        if operator == "&" and isinstance(value, Place) and value.name in self.memory:
            return Variable(self.memory, value.name)
        if operator == "*" and isinstance(value, Variable):
            return value.env[value.name]
        if operator == "-":
            return self.each("neg", value)
        if operator == "*" and isinstance(value, Place):
            return self.memory.get(value.name, value)
        if operator in ("+", "&", "*"):
            return value
        known = self.load(value)
        if operator == "!" and isinstance(known, Op) and known.kind == "number":
            return self.op("number", value=1 if known.value == 0 else 0)
        return self.undecided(node[1])

    def of_binary(self, node, env):
        operator, left, right = node[2], self.value(node[3], env), self.value(node[4], env)
        if operator in "+-*/":
            return self.each(operator, left, right)
        left, right = self.load(left), self.load(right)
        if isinstance(left, Op) and isinstance(right, Op) and left.kind == right.kind == "number":
            a, b = left.value, right.value
            exact = {"<": lambda: a < b, ">": lambda: a > b, "<=": lambda: a <= b, ">=": lambda: a >= b,
                     "==": lambda: a == b, "!=": lambda: a != b, "&": lambda: int(a) & int(b),
                     "|": lambda: int(a) | int(b), ">>": lambda: int(a) >> int(b), "<<": lambda: int(a) << int(b),
                     "^": lambda: int(a) ^ int(b), "&&": lambda: a != 0 and b != 0,
                     "||": lambda: a != 0 or b != 0, "%": lambda: int(a) % int(b)}  # fmt: skip
            return self.op("number", value=int(exact[operator]()))
        return self.undecided(node[1])

    def of_choose(self, node, env):
        condition = self.load(self.value(node[2], env))
        if isinstance(condition, Op) and condition.kind == "number":
            return self.value(node[3] if condition.value != 0 else node[4], env)
        return self.undecided(node[1])

    def of_field(self, node, env):
        return self.component(self.value(node[2], env), node[3])

    def of_index(self, node, env):
        base, index = self.value(node[2], env), self.load(self.value(node[3], env))
        if isinstance(base, Vec):
            return base[int(index.value)]
        name = int(index.value) if index.kind == "number" else plain(node[3][1])
        return self.component(base, str(name))

    def of_call(self, node, env):
        name = node[2][2]
        args = [self.value(part, env) for part in node[3]]
        if name == "fma":
            return self.each("fma", *args)
        if name in ("fabs", "absolute16"):
            return self.each("abs", *args)
        if name == "sqrt":
            return self.each("sqrt", *args)
        if name in ("vload8", "vload16", "vload3"):
            return self.load(args[1])
        if name in ("vstore3", "vstore8", "vstore16"):
            parts = self.load(args[0])
            for i in range(3) if name == "vstore3" else ():
                self.store(self.component(args[2], str(i)), parts[i])
            return args[0]
        if name == "select3":
            return args[1]  # in the lanes that count
        if name in SAME:
            return args[0]
        if not APART.fullmatch(name) and self.source.defines(name, len(args)):
            return self.call(name, args)
        return self.undecided(node[1])

    def of_assign(self, node, env):
        operator, target, value = node[2], node[3], self.value(node[4], env)
        if operator != "=":
            if operator[:-1] not in "+-*/":
                value = self.undecided(node[1])
            else:
                value = self.each(operator[:-1], self.value(target, env), value)
        self.assign(target, value, env)
        return value

    def assign(self, target, value, env):
        if target[0] == "inner" or target[0] == "unary":
            return self.assign(target[-1], value, env)
        if target[0] == "name" and isinstance(env.get(target[2]), Variable):
            env[target[2]].env[env[target[2]].name] = self.load(value)
        elif target[0] == "name" and not isinstance(env.get(target[2]), Place):
            env[target[2]] = self.load(value)
        elif target[0] == "field" and target[2][0] == "name" and isinstance(env.get(target[2][2]), Vec):
            env[target[2][2]][LETTERS.index(target[3])] = self.load(value)
        else:
            place = self.value(target, env) if target[0] == "name" else self.place_of(target, env)
            self.store(place, value)

    def place_of(self, node, env):
        base = self.value(node[2], env) if node[2][0] == "name" else self.place_of(node[2], env)
        if not isinstance(base, Place):
            raise Broken(f"no place: {node[1]}")
        index = node[3] if node[0] == "field" else int(self.load(self.value(node[3], env)).value)
        return Place(f"{base.name}.{index}")

    def of_step(self, node, env):
        one = self.op("number", value=1)
        self.assign(node[3], self.each("+" if node[2] == "++" else "-", self.value(node[3], env), one), env)
        return self.undecided(node[1])

    # Statements; they return what a `return` gives, in a list.

    def run(self, node, env):
        return getattr(self, "run_" + node[0])(node, env)

    def run_block(self, node, env):
        for statement in node[2]:
            done = self.run(statement, env)
            if done:
                return done

    def run_return(self, node, env):
        return [None if node[2] is None else self.value(node[2], env)]

    def run_do(self, node, env):
        if node[2][0] == "unary" and node[2][2] in ("++", "--"):
            return self.of_step(("step", node[1], node[2][2], node[2][3]), env) and None
        self.value(node[2], env)

    def run_declare(self, node, env):
        for name, sizes, value in node[3]:
            if isinstance(value, list):
                fields = self.source.fields(node[2])
                if node[2] == "Real3xN":
                    env[name] = Vec(self.load(self.value(part, env)) for part in value)
                    continue
                env[name] = self.fresh(name)
                for i, part in enumerate(value):
                    key = str(i) if sizes else fields[i]
                    self.store(Place(f"{env[name].name}.{key}"), self.value(part, env))
            elif value is not None:
                found = self.value(value, env)
                if isinstance(found, Place) and self.source.fields(node[2]) and node[2] != "Real3xN":
                    env[name] = self.fresh(name)
                    self.store(env[name], found)
                else:
                    env[name] = self.load(found)
            elif sizes or self.source.fields(node[2]):
                env[name] = self.fresh(name)
            else:
                env[name] = self.undecided(f"{name}, of which nothing is said")

    def fresh(self, name):
        self.frames += 1
        return Place(f"{name}_{self.frames}")

    def run_if(self, node, env):
        condition = self.load(self.value(node[2], env))
        if not (isinstance(condition, Op) and condition.kind == "number"):
            raise Broken(f"whether this holds isn't told: {node[2][1]}")
        chosen = node[3] if condition.value != 0 else node[4]
        return self.run(chosen, env) if chosen else None

    def run_for(self, node, env):
        self.run(node[2], env)
        while True:
            condition = self.load(self.value(node[3], env))
            if condition.kind == "number" and condition.value == 0:
                return None
            done = self.run(node[5], env)
            if done or condition.kind != "number":  # a loop that isn't counted: once
                return done
            self.run_do(("do", node[4][1], node[4]), env)

    def call(self, name, args):
        names, body = self.source.function(name, len(args))
        env = {
            n: (a if isinstance(a, Place) and a.name not in self.memory else self.load(a))
            for n, a in zip(names, args, strict=True)
        }
        done = self.run(body, env)
        self.locals_of[name] = env
        return done[0] if done else None
