"""The one error that this package raises for a wrong input."""

import inspect
from collections.abc import Callable, Iterable, Mapping
from typing import Any


class IntervalError(ValueError):
    """A wrong input, as a message "key: found value, allowed is ...". key: name of the input, as
    the user wrote it (``"order"``, ``"interval a"``); value: what was found; allowed: what would
    have been accepted, as a short phrase."""

    def __init__(self, key: str, value: Any, allowed: str) -> None:
        self.key = key
        self.value = value
        self.allowed = allowed
        super().__init__(f"{key}: found {value!r}, allowed is {allowed}")

    def __reduce__(self):  # exceptions with several arguments need it to cross process borders
        return (type(self), (self.key, self.value, self.allowed))


def check_choice(key: str, value: Any, choices: Iterable[str]) -> Any:
    """Return `value` if it is among `choices`, else raise IntervalError; key: the input's name."""
    names = tuple(choices)
    if value not in names:
        raise IntervalError(key, value, "one of " + ", ".join(names))
    return value


def check_integer(key: str, value: Any, low: int, high: int) -> int:
    """Return `value` as int if it is a whole number from `low` to `high`, both included, else raise
    IntervalError. Integer types only (`__index__`): 3.0 and True are refused. key: its name."""
    whole = isinstance(value, (int,)) or (hasattr(value, "__index__"))
    if isinstance(value, bool) or not whole or not low <= int(value) <= high:
        raise IntervalError(key, value, f"a whole number from {low} to {high}")
    return int(value)


def check_options(key: str, function: Callable, options: Mapping[str, Any]) -> None:
    """Raise IntervalError for a name in `options` (values by name) that is not a keyword-only
    argument of `function`; key: name of the input for the message."""
    parameters = inspect.signature(function).parameters.values()
    names = [p.name for p in parameters if p.kind is p.KEYWORD_ONLY]
    for name in options:
        if name not in names:
            raise IntervalError(key, name, "one of " + ", ".join(names) if names else "none here")
