"""What damaged files can do to a reader: errors with the name of the file, and a child process with limits.

Readers in Python and NumPy run in this process: their worst is an exception, which `errors_of` turns into a DataError. MAT
files are checked byte by byte before SciPy reads them (`_util/mat_check.py`), and Matrix Market files are read here, since
SciPy's reader crashes on a zero byte. Readers in compiled code of others that do not check their input run in a child
process: `IN_CHILD` lists them.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from rattlebox._util.exceptions import DataError, RattleboxError

IN_CHILD = {"rst": "ansys_arrays.py", "full": "ansys_arrays.py", "mat": "hdf5_arrays.py", "h5": "hdf5_arrays.py"}
"""Scripts that read a format in a child process: python -P SCRIPT FORMAT FILE OUTPUT writes an NPZ file."""

LEAST_MEMORY, MEMORY_PER_BYTE = 4 << 30, 20
"""Limit of the memory of a child process [bytes]: the first, or the second times the size of the file if that is more."""

LEAST_TIME, BYTES_PER_SECOND = 120.0, 1e6
"""Limit of the time of a child process: the first [s], and a second for so many bytes."""

_SHOWN, _LONGEST = 200, 1000  # characters of a message of another library, and of one with names and cells of a file


@contextmanager
def errors_of(path: str | os.PathLike[str], what: str) -> Iterator[None]:
    """Raise a DataError with the name of the file for each error of a reader in the block that is none of Rattlebox."""
    try:
        yield
    except DataError as error:
        if len(error.complaint) <= _LONGEST:
            raise
        raise DataError(f"{error.complaint[:_LONGEST]}...", error.suggestion[:_LONGEST], error.place) from None
    except (RattleboxError, NotImplementedError):  # the caller knows more about a version that is not supported
        raise
    except MemoryError:
        raise DataError(f"{path}: there is not enough memory to read {what} of this size", "a smaller file") from None
    except OSError as error:
        reason = error.strerror or str(error)
        raise DataError(f"{path} cannot be read: {reason}", "a file that can be opened, and is complete") from None
    except Exception as error:
        text = " ".join(str(error).split())[:_SHOWN]
        reason = f"{type(error).__name__}: {text}" if isinstance(error, LookupError) or not text else text
        raise DataError(f"{path} cannot be read as {what}: {reason}", "the complete file, as it was written") from None


def arrays_from_child(path: Path, kind: str) -> dict[str, Any]:
    """Return the arrays that a script of `IN_CHILD` reads from a file, in a process with limits of memory and time."""
    size = path.stat().st_size
    # Damaged files can make a reader loop or allocate without end. What a sound file of this size may need is allowed.
    seconds = LEAST_TIME + size / BYTES_PER_SECOND
    memory = max(LEAST_MEMORY, MEMORY_PER_BYTE * size)
    whole = "the complete file"
    with TemporaryDirectory() as folder:
        output = Path(folder) / "arrays.npz"
        script = Path(__file__).with_name(IN_CHILD[kind])
        command = [sys.executable, "-P", str(script), kind, str(path), str(output), str(memory)]
        try:
            process = subprocess.run(
                command,
                capture_output=True,
                text=True,
                errors="replace",
                check=False,
                timeout=seconds,
                # Threads of OpenBLAS would reserve memory that counts towards the limit.
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            )
        except subprocess.TimeoutExpired:
            raise DataError(
                f"{path} cannot be read as .{kind} within {seconds:.0f} s; it may be damaged", whole
            ) from None
        # 1 is an error of the script itself, with its message in the last line; anything else is a crash of the
        # library.
        if process.returncode == 1:
            reason = (process.stderr.strip().splitlines() or ["cannot be read"])[-1]
            raise DataError(f"{path} {reason}", whole)
        if process.returncode:
            raise DataError(
                f"{path} cannot be read as .{kind}: the reader crashed (exit code {process.returncode}); the file may be"
                " cut short or damaged",
                whole,
            )
        with errors_of(path, f".{kind}"), np.load(output) as arrays:
            return dict(arrays)
