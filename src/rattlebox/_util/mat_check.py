"""Check of MAT files before SciPy reads them: its reader does not check sizes and indices, and crashes on wrong ones.

The layout is that of "MAT-File Format" by MathWorks: level 5 (versions 5 to 7) and level 4.
"""

from __future__ import annotations

import math
import struct
import zlib

import numpy as np

LARGEST = 1 << 32
"""Largest size of a variable [bytes]; the format allows no more."""

_COMPRESSED, _MATRIX = 15, 14
_INT8, _INT32, _UINT32, _UTF8 = 1, 5, 6, 16
_SIZES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}
"""Bytes of a number, by the type of an element."""

_TEXT_SIZES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 16: 1, 17: 2, 18: 4}
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE, _FUNCTION, _OPAQUE = 1, 2, 3, 4, 5, 16, 17
_DEPTH = 64


def check_mat(content: bytes) -> None:
    """Raise if a MAT file is damaged."""
    if len(content) < 20:
        raise ValueError("the file is cut off")
    if 0 in content[:4]:
        _check_level_4(content)
        return
    # The header ends with the order of bytes; version 7.3 is HDF5, which its own library checks.
    order = {b"IM": "<", b"MI": ">"}.get(content[126:128])
    if order is None:
        raise ValueError("it has no header of a MAT file")
    major = content[125] if order == "<" else content[124]
    if major == 2:
        raise NotImplementedError
    if major != 1:
        raise ValueError(f"it is of version {major}, which is not known")
    offset = 128
    while offset < len(content):
        if len(content) - offset < 8:
            raise ValueError("the file is cut off")
        kind, size = struct.unpack_from(f"{order}II", content, offset)
        offset += 8
        if size > len(content) - offset:
            raise ValueError("the file is cut off")
        # Variables follow each other, compressed or not, and must fill the size that they state.
        element = content[offset : offset + size]
        if kind == _COMPRESSED:
            unpacker = zlib.decompressobj()
            try:
                unpacked = unpacker.decompress(element, LARGEST)
            except zlib.error as error:
                raise ValueError(str(error)) from None
            if not unpacker.eof or len(unpacked) < 8:
                raise ValueError("a compressed variable is cut off")
            kind, inside = struct.unpack_from(f"{order}II", unpacked)
            if inside != len(unpacked) - 8:
                raise ValueError("a compressed variable has another size than it states")
            element = unpacked[8:]
        if kind != _MATRIX:
            raise ValueError(f"it contains an element of the unknown type {kind}")
        _Variable(element, order).check(0)
        offset += size


class _Variable:
    """The bytes of a variable, read from first to last."""

    def __init__(self, content: bytes, order: str) -> None:
        self._content, self._order, self._place = content, order, 0

    def _element(self) -> tuple[int, bytes]:
        """Return type and content of the next element."""
        if len(self._content) - self._place < 8:
            raise ValueError("an element is missing")
        kind, size = struct.unpack_from(f"{self._order}II", self._content, self._place)
        if kind >> 16:  # a small element: size and type in one word, then at most four bytes
            size, kind = kind >> 16, kind & 0xFFFF
            if size > 4:
                raise ValueError("a small element is too large")
            start, self._place = self._place + 4, self._place + 8
        else:
            start = self._place + 8
            self._place = start + size + -size % 8 * (kind != _MATRIX)
        if start + size > len(self._content):
            raise ValueError("an element is cut off")
        return kind, self._content[start : start + size]

    def _text(self) -> bytes:
        kind, text = self._element()
        if kind not in (_INT8, _UTF8):
            raise ValueError("a name is not text")
        return text

    def _integers(self) -> np.ndarray[tuple[int], np.dtype[np.int32]]:
        kind, content = self._element()
        if kind not in (_INT32, _UINT32) or len(content) % 4:
            raise ValueError("an index is not an integer")
        return np.frombuffer(content, f"{self._order}i4")

    def _numbers(self, count: int, sizes: dict[int, int]) -> None:
        kind, content = self._element()
        if kind not in sizes or len(content) != count * sizes[kind]:
            raise ValueError("an array has another size than it states")

    def _nested(self, count: int, depth: int) -> None:
        for _ in range(count):
            kind, content = self._element()
            if kind != _MATRIX:
                raise ValueError("a part of a variable is not a variable")
            if content:
                _Variable(content, self._order).check(depth + 1)

    def check(self, depth: int) -> None:
        """Raise if the parts of the variable contradict each other."""
        if depth > _DEPTH:
            raise ValueError("variables are nested too deeply")
        kind, flags = self._element()
        if kind != _UINT32 or len(flags) != 8:
            raise ValueError("a variable has no flags")
        (word,) = struct.unpack_from(f"{self._order}I", flags)
        sort, is_complex = word & 0xFF, bool(word & 0x800)
        if sort == _OPAQUE:
            for _ in range(3):
                self._text()
            self._nested(1, depth)
        else:
            shape = self._integers()
            if len(shape) < 2 or len(shape) > 32 or (shape < 0).any():
                raise ValueError("a variable has no shape")
            self._text()
            self._values(sort, shape.tolist(), is_complex, depth)
        if self._place < len(self._content):
            raise ValueError("a variable is longer than it states")

    def _values(self, sort: int, shape: list[int], is_complex: bool, depth: int) -> None:
        count = math.prod(shape)
        if sort == _SPARSE:
            self._sparse(shape, is_complex)
        elif sort == _CHAR:
            if is_complex:
                raise ValueError("a text is complex")
            kind, content = self._element()
            # In UTF-8 a character takes one to four bytes.
            most = 4 if kind == _UTF8 else 1
            size = _TEXT_SIZES.get(kind, 0)
            if not size or not count * size <= len(content) <= most * count * size:
                raise ValueError("a text has another length than it states")
        elif sort == _CELL:
            self._nested(count, depth)
        elif sort in (_STRUCT, _OBJECT):
            if sort == _OBJECT:
                self._text()
            length = self._integers()
            names = self._text()
            if len(length) != 1 or length[0] < 1 or len(names) % length[0]:
                raise ValueError("a struct has no names of fields")
            if not names and count > len(self._content):
                raise ValueError("a struct without fields is too large")
            self._nested(count * (len(names) // int(length[0])), depth)
        elif sort == _FUNCTION:
            self._nested(1, depth)
        elif 6 <= sort <= 15:
            for _ in range(1 + is_complex):
                self._numbers(count, _SIZES)
        else:
            raise ValueError(f"a variable is of the unknown class {sort}")

    def _sparse(self, shape: list[int], is_complex: bool) -> None:
        if len(shape) != 2:
            raise ValueError("a sparse matrix does not have two dimensions")
        if 8 * math.prod(shape) > LARGEST:
            raise ValueError(f"a sparse matrix of {shape[0]} x {shape[1]} is too large")
        rows, columns = self._integers(), self._integers()
        if len(columns) != shape[1] + 1 or columns[0] != 0 or (np.diff(columns) < 0).any():
            raise ValueError("a sparse matrix has wrong columns")
        count = int(columns[-1])
        if count > len(rows) or (rows[:count] < 0).any() or (rows[:count] >= shape[0]).any():
            raise ValueError("a sparse matrix has wrong rows")
        for _ in range(1 + is_complex):
            kind, content = self._element()
            if kind not in _SIZES or len(content) % _SIZES[kind] or len(content) // _SIZES[kind] < count:
                raise ValueError("a sparse matrix has too few numbers")


def _check_level_4(content: bytes) -> None:
    first = content[:4]
    order = "<" if struct.unpack("<i", first)[0] in range(5000) else ">"
    offset = 0
    while offset < len(content):
        if len(content) - offset < 20:
            raise ValueError("the file is cut off")
        code, rows, columns, imaginary, length = struct.unpack_from(f"{order}5i", content, offset)
        machine, rest = divmod(code, 1000)
        zero, rest = divmod(rest, 100)
        precision, sort = divmod(rest, 10)
        size = {0: 8, 1: 4, 2: 4, 3: 2, 4: 2, 5: 1}.get(precision)
        expected = 0 if order == "<" else 1
        if machine != expected or zero or size is None or sort > 2 or imaginary not in (0, 1) or min(rows, columns) < 0:
            raise ValueError("it has no header of a MAT file")
        if length < 1:
            raise ValueError("a variable has no name")
        start = offset + 20 + length
        offset = start + rows * columns * size * (1 + imaginary)
        if offset > len(content):
            raise ValueError("the file is cut off")
        if sort == 2:
            _check_sparse_4(
                content[start:offset], rows, columns, f"{order}{['f8', 'f4', 'i4', 'i2', 'u2', 'u1'][precision]}"
            )


def _check_sparse_4(content: bytes, rows: int, columns: int, kind: str) -> None:
    """Raise if a sparse matrix, rows of row, column and value, is damaged; its last row contains the shape."""
    if columns not in (3, 4) or rows < 1:
        raise ValueError("a sparse matrix does not have three columns")
    table = np.frombuffer(content, kind).astype(float)[: rows * columns].reshape(columns, rows)
    shape, places = table[:2, -1], table[:2, :-1]
    if not (np.isfinite(table[:2]).all() and (shape >= 0).all() and (shape < 2**31).all()):
        raise ValueError("a sparse matrix has no shape")
    if (places < 1).any() or (places > shape[:, None]).any():
        raise ValueError("a sparse matrix has wrong rows or columns")
