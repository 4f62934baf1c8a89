"""Damaged files: bytes and fields that are changed at random, the same for the same number."""

from __future__ import annotations

import re

import numpy as np

_FIELDS = (
    b"1e999", b"-1", b"0", b"nan", b"inf", b"99999999999999999999", b"-2147483648", b"9" * 5000, b"A" * 140_000, b" " * 4000,
    b"1.2.3", b"(" * 3000, b"\x00", b"\xff\xfe", b"1,5", b"1D+05", b"\n" * 2000, b"\xc3\xa4", b'"', b"#",
)  # fmt: skip
"""Replacements and insertions of a field."""


def mutant(content: bytes, number: int) -> bytes:
    """Return a damaged file.

    Parameters
    ----------
    content
        The valid file.
    number
        Number of the mutant; it decides kind and place of the damage.
    """
    random = np.random.default_rng([len(content), number])
    size = len(content)
    at = int(random.integers(size))
    kind = number % 7
    if kind == 0:  # bits and bytes
        changed = bytearray(content)
        for place in random.integers(size, size=int(random.integers(1, 9))):
            changed[place] = (
                int(random.integers(256)) if random.random() < 0.5 else changed[place] ^ 1 << random.integers(8)
            )
        return bytes(changed)
    if kind == 1:
        return content[:at]
    if kind == 2:  # a lost block of a disk
        length = int(2 ** random.uniform(0, 13))
        return content[:at] + bytes(len(content[at : at + length])) + content[at + length :]
    field = _FIELDS[int(random.integers(len(_FIELDS)))]
    if kind == 3:
        return content[:at] + field + content[at:]
    fields = list(re.finditer(rb"[^\s,;]+", content))
    chosen = fields[int(random.integers(len(fields)))]
    if kind == 4:
        return content[: chosen.start()] + field + content[chosen.end() :]
    if kind == 5:  # lines or blocks that are missing or come twice
        length = int(2 ** random.uniform(0, 10))
        block = content[at : at + length]
        return content[:at] + (block * 2 if random.random() < 0.5 else b"") + content[at + length :]
    other = fields[int(random.integers(len(fields)))]
    return content[: chosen.start()] + other[0] + content[chosen.end() :]
