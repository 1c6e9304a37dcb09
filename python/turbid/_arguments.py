"""Arguments as numbers, or what is allowed."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from ._turbid import Error


def count(name: str, value: Any, least: int = 1, most: int = 9_000_000_000_000_000) -> int:
    """A whole number, also written 1e6."""
    try:
        number = int(value)
        is_whole = number == value and not isinstance(value, bool)
    except (TypeError, ValueError, OverflowError):
        is_whole = False
    if not is_whole or not least <= number <= most:
        raise Error(f"{name} is {value!r}; allowed: whole numbers from {least} to {most}")
    return number


def optional_count(name: str, value: Any, least: int, most: int) -> Optional[int]:
    return None if value is None else count(name, value, least, most)


def real(name: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise Error(f"{name} is {value!r}; allowed: a number") from None


def optional_real(name: str, value: Any) -> Optional[float]:
    return None if value is None else real(name, value)


def flag(name: str, value: Any) -> bool:
    """A truth value; text such as "no" would be true."""
    if not isinstance(value, (bool, np.bool_)):
        raise Error(f"{name} is {value!r}; allowed: True or False")
    return bool(value)


def threads(value: Any) -> Optional[int]:
    return optional_count("threads", value, 1, 1024)


def seed(value: Any) -> int:
    return count("seed", value, 0, 2**64 - 1)
