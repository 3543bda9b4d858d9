"""What is said of arguments that kdray's C++ has no function for."""

from __future__ import annotations

import functools
from collections.abc import Callable, Container
from types import FunctionType
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])

MOST = 60  # characters of an argument


def short(value: Any) -> str:
    try:
        text = repr(value).replace("\n", " ")
    except Exception:
        text = type(value).__name__
    return text if len(text) <= MOST else text[: MOST - 3] + "..."


def _is_ours(error: TypeError) -> bool:
    """Whether kdray's bindings raised it, and not what a function of the caller's has called."""
    last = error.__traceback__
    while last is not None and last.tb_next is not None:
        last = last.tb_next
    return last is not None and str(last.tb_frame.f_globals.get("__name__", "")).startswith("kdray.")


def in_one_line(name: str, is_method: bool = False) -> Callable[[F], F]:
    """Has a function say what was wrong in a line, where the bindings list all their types."""

    def told(function: F) -> F:
        @functools.wraps(function)
        def call(*args: Any, **named: Any) -> Any:
            try:
                return function(*args, **named)
            except TypeError as error:
                if "incompatible function arguments" not in str(error) or not _is_ours(error):
                    raise
                given = [short(a) for a in args[is_method:]] + [f"{key}={short(a)}" for key, a in named.items()]
            raise TypeError(
                f"{name}({', '.join(given)}): an argument is of a type, or a number, that it can't be; see help({name})"
            )

        return cast(F, call)

    return told


def tell_in_one_line(owner: type, but: Container[str] = ()) -> None:
    """The same for a class's methods."""
    for name, method in list(vars(owner).items()):
        if isinstance(method, FunctionType) and not name.startswith("_") and name not in but:
            setattr(owner, name, in_one_line(f"kdray.{owner.__name__}.{name}", True)(method))
