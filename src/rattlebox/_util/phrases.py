"""Parts of English sentences: lists, counts and sizes."""

from __future__ import annotations

from collections.abc import Sequence

from rattlebox._util.quantities import amount, in_unit


def joined(items: Sequence[str]) -> str:
    """Return phrases in one list: "a, b and c"."""
    return " and ".join([", ".join(items[:-1]), items[-1]] if len(items) > 1 else items)


def counted(number: int, noun: str, plural: str = "") -> str:
    """Return a number with a noun: "1 mode", "5 modes", "12 000 particles"."""
    return f"{number:,} ".replace(",", "\N{NO-BREAK SPACE}") + (noun if number == 1 else plural or f"{noun}s")


def with_article(noun: str) -> str:
    """Return a noun with its indefinite article: "a steel ball", "an aluminium beam"."""
    return f"{'an' if noun[:1] in tuple('aeiou') else 'a'} {noun}".rstrip()


def sizes(lengths: Sequence[float]) -> str:
    """Return lengths [m] in the unit of the smallest one: "100 x 70 x 60 mm"."""
    divisor, unit = in_unit(min(lengths), "m")
    return f"{' x '.join(amount(length / divisor) for length in lengths)} {unit}"
