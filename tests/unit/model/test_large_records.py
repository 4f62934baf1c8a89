"""Records of many rows: the quick way to read them equals the slow one, takes little time and memory, and keeps arrays."""

from __future__ import annotations

import copy
import pickle
import time
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb
from rattlebox.model import records, text_rows, text_table

ROWS = 60


def as_text(rng: np.random.Generator) -> tuple[str, dict[str, Any], bytes]:
    """Return a table with a random layout and at times a fault, the options to read it, and the fault."""
    width = int(rng.choice([1, 2, 3, 6]))
    mark = str(rng.choice([" ", ",", ";", "\t", ", "]))
    numbers = np.cumsum(rng.random((ROWS, width)), axis=0)
    lines = [mark.join(f"{x:.7g}" for x in row) for row in numbers]
    heads = ["", "# made by a logger\n", "t (ms)" + f"{mark}a (g)" * (width - 1) + "\n", f"{ROWS}\n", f"{ROWS} 0.01\n"]
    end = str(rng.choice(["\n", "\r\n"], p=[0.7, 0.3]))
    k = int(rng.integers(30, ROWS))
    fault = int(rng.integers(0, 26))
    changes = {
        1: lines[k] + mark + "1", 2: "n/a" + mark + lines[k], 3: lines[k].replace("1", "inf"), 4: "# " + lines[k],
        5: "\n" + lines[k], 6: lines[k] + mark.strip(), 7: '"' + lines[k], 8: lines[k].replace(".", ","), 9: "  ",
        10: lines[k] + "\r" + lines[k], 11: lines[k] + "µ", 12: "1_0" + lines[k], 13: lines[k] + " # late",
        14: lines[k].rpartition(mark)[0], 15: "-" + lines[k], 16: "",
    }  # fmt: skip
    lines[k] = changes.get(fault, lines[k])
    if fault == 17:
        lines[-1] = lines[-1].rpartition(mark)[0]
    if fault == 18:
        lines = [mark.strip() + line for line in lines]
    if fault == 19:
        lines = [mark.join(f'"{cell}"' for cell in line.split(mark)) for line in lines]
    if fault == 20:
        lines += ["", "# the end", ""]
    options = [
        {},
        {"dt": "0.01 s"},
        {"dt": 0.01, "columns": [width]},
        {"columns": [1, 2]},
        {"dt": 0.01, "columns": "rows"},
    ]
    content = (str(rng.choice(heads)) + "\n".join(lines)).replace("\n", end).encode() + end.encode() * (fault != 21)
    return content, {"unit": "m/s^2", **options[int(rng.integers(0, 5))]}, fault


def result(path: Path, options: dict[str, Any]) -> Any:
    """Return a record with its notes, or the message of its error."""
    try:
        record = rb.Record(file=path, **options)
    except (rb.CaseError, rb.DataError) as error:
        return str(error)
    return record, list(record.notes())


def test_the_quick_way_equals_the_slow_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Records, notes and messages are the same whether a file is read line by line or only at both ends.

    Files in tests are too short for the quick way, so that nothing would compare the two: here its limits are small.
    """
    rng = np.random.default_rng(7)
    path, quick, read = tmp_path / "a.txt", 0, 0
    for number in range(200):
        content, options, fault = as_text(rng)
        path.write_bytes(content)
        for module in (records, text_table):
            monkeypatch.setattr(module, "PROBED", 10)
        slow = result(path, options)
        monkeypatch.setattr(text_rows, "_HEAD", 16 * (len(content) // ROWS))
        monkeypatch.setattr(text_rows, "_TAIL", 6 * (len(content) // ROWS))
        is_quick = text_rows.read_quickly(path) is not None
        assert result(path, options) == slow, (number, fault, options, content.decode())
        monkeypatch.undo()
        quick += is_quick
        read += not isinstance(slow, str)
    assert quick > 75
    assert read > 50


@pytest.fixture
def large(tmp_path: Path) -> Path:
    """Write a million rows of two numbers."""
    block = "".join(f"{k / 1e3:.4f},{np.sin(0.37 * k):.7f}\n" for k in range(1000))
    path = tmp_path / "large.csv"
    path.write_text("time (s),a (m/s^2)\n" + 1000 * block)
    return path


def test_time_and_memory_of_a_million_rows(large: Path) -> None:
    """A million rows take at most three times the processor time of `numpy.loadtxt`, and four times their memory.

    They took a hundred times as long and forty times the memory, since each number was an object: no test measured it.
    """
    options: dict[str, Any] = {"file": large, "dt": "1 ms", "columns": [2], "unit": "m/s^2"}
    times: dict[str, list[float]] = {"loadtxt": [], "record": []}
    for _ in range(3):
        begin = time.process_time()
        table = np.loadtxt(large, delimiter=",", skiprows=1)
        middle = time.process_time()
        record = rb.Record(**options)
        times["loadtxt"].append(middle - begin)
        times["record"].append(time.process_time() - middle)
    np.testing.assert_array_equal(record.values, table[:, 1])
    assert min(times["record"]) < 3 * min(times["loadtxt"])
    tracemalloc.start()
    try:
        rb.Record(**options)
        assert tracemalloc.get_traced_memory()[1] < 4 * table.nbytes
    finally:
        tracemalloc.stop()


def test_a_record_is_an_array() -> None:
    """A record keeps its own array up to the core, compares by value, and is the same in files and other processes."""
    times, values = np.linspace(0.0, 1.0, 50), np.sin(np.arange(50.0))
    record = rb.Record(times=times, values=values, unit="m/s^2")
    times[:] = 0.0  # the user's array
    assert record.times[-1] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        record.values[0] = 1.0
    structure = rb.SDOF(mass="3 kg", frequency="4 Hz", damping_ratio=0.04)
    case = rb.Case(structure=structure, base=record, duration="0.9 s")
    (base,) = case.base
    assert base.values is record.values
    assert base.coefficients()["values"] is record.values
    assert case.replaced({"duration": "0.8 s"}).base[0].values is record.values
    other = rb.Record(times=record.times, values=-record.values, unit="m/s^2")
    assert record != other
    for same in (rb.Case.from_toml(case.to_toml()), pickle.loads(pickle.dumps(case)), copy.deepcopy(case)):
        assert same == case
        assert hash(same.base[0]) == hash(base)
        assert same.base[0].model_dump_json() == base.model_dump_json()
    assert case != case.replaced({"base": other})
    assert case.replaced({"base.values[1]": 2.0}).base[0].evaluate(record.times[1]) == pytest.approx(2.0)
    assert rb.simulate(case) == rb.simulate(rb.Case.from_toml(case.to_toml()))


def test_masked_numbers_are_refused() -> None:
    """Masked numbers are invalid and refused like NaN; no test had an array with a mask, whose numbers were taken."""
    values = np.ma.masked_array([0.0, 900.0, 0.2, 0.1], mask=[False, True, False, False])
    for unit in ("m/s^2", "g"):
        with pytest.raises(rb.CaseError, match="number 2 of 4 is not finite"):
            rb.Record(dt="5 ms", values=values, unit=unit)
    whole = rb.Record(dt="5 ms", values=np.ma.masked_array([0, 1, 2]), unit="m/s^2")
    assert whole.values.tolist() == [0, 1, 2]
    with pytest.raises(rb.CaseError, match="number 4 of 4 is not finite"):
        rb.Matrices(
            M=np.eye(2), K=np.ma.masked_array([[3e4, -1e4], [-1e4, 1e4]], mask=[[0, 0], [0, 1]]), points={"a": 0}
        )
