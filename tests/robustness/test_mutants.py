"""Damaged files at random: each reader refuses them with the name of the file, or reads finite numbers, within seconds.

No test changed bytes at random, so that crashes of other libraries, their messages, and patterns that take cubic time were
seen in no sample of `test_damaged_inputs.py`. `docs/validation/robustness.md` has the counts of longer campaigns.
"""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from support.mutants import mutant

import rattlebox as rb

from .test_damaged_inputs import GOOD, read_file

MUTANTS = 35
LIMIT = 2.0  # s of processor time
IN_CHILD = ("Ansys result", "Ansys matrices", "MAT 7.3 record")
"""Samples that a child process reads."""


@pytest.mark.parametrize("name", [name for name in GOOD if name not in IN_CHILD])
def test_mutants(tmp_path: Path, name: str) -> None:
    """A mutant is read, or refused with the name of the file and advice, in two seconds at most."""
    good = GOOD[name]
    for number in range(MUTANTS):
        start = time.process_time()
        try:
            read_file(tmp_path, good, mutant(good.content, number))
        except rb.RattleboxError as error:
            message = str(error)
        else:
            message = ""
        assert time.process_time() - start < LIMIT, f"mutant {number}"
        assert not message or (good.name in message and "try: " in message), f"mutant {number}: {message[:300]}"
        assert len(message) < 5000, f"mutant {number}"


@pytest.mark.slow
@pytest.mark.parametrize("name", IN_CHILD)
def test_mutants_of_binary_files(tmp_path: Path, name: str) -> None:
    """A mutant of an Ansys or HDF5 file never ends this process, also if it crashes the child process that reads it."""
    for number in range(14):
        message = GOOD[name].name
        try:
            read_file(tmp_path, GOOD[name], mutant(GOOD[name].content, number))
        except rb.RattleboxError as error:
            message = str(error)
        assert GOOD[name].name in message, f"mutant {number}"
