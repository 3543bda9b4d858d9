"""What is said of arguments that kdray's C++ has no function for."""

from __future__ import annotations

import functools
from collections.abc import Callable, Container
from types import FunctionType
from typing import Any

MOST = 60  # characters of an argument


def short(value: Any) -> str:
    try:
        text = repr(value).replace("\n", " ")
    except Exception:
        text = type(value).__name__
    return text if len(text) <= MOST else text[: MOST - 3] + "..."


def in_one_line(function: Callable[..., Any], name: str) -> Callable[..., Any]:
    @functools.wraps(function)
    def call(*args: Any, **named: Any) -> Any:
        try:
            return function(*args, **named)
        except TypeError as error:
            if "incompatible function arguments" not in str(error) or "kdray._core." not in str(error):
                raise  # of the caller's own functions, perhaps
            given = [short(a) for a in args[1:]] + [f"{key}={short(a)}" for key, a in named.items()]
        raise TypeError(
            f"{name}({', '.join(given)}): an argument is of a type, or a number, that it can't be; see help({name})"
        )

    return call


def tell_in_one_line(owner: type, but: Container[str] = ()) -> None:
    """Makes a class's methods say what was wrong in a line, where the bindings list all their types."""
    for name, method in list(vars(owner).items()):
        if isinstance(method, FunctionType) and not name.startswith("_") and name not in but:
            setattr(owner, name, in_one_line(method, f"kdray.{owner.__name__}.{name}"))
