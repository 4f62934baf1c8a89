"""Bad cavities, bodies, rotations and cells: each is refused in three parts, by Python and by the command, with exit code 2.

Each row of the shapes was tried in one way only, so that a surface without volume ended as a traceback, ten million bodies
and a surface in the wrong unit took all memory, and a fold passed as a wall.
"""

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.command import rattlebox
from support.triangle_meshes import ball, box

import rattlebox as rb
from rattlebox.model.plausibility import plausibility_notes

Surface = tuple[Any, Any]


def merged(surface: Surface) -> Surface:
    """Return a surface with each corner once."""
    vertices, number = np.unique(np.round(surface[0], 9), axis=0, return_inverse=True)
    return vertices, number.reshape(-1)[surface[1]]


def both(*surfaces: Surface) -> Surface:
    """Return several surfaces as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in surfaces)])
    faces = [np.asarray(faces) + start for (_, faces), start in zip(surfaces, starts, strict=False)]
    return np.concatenate([vertices for vertices, _ in surfaces]), np.concatenate(faces)


def shifted(surface: Surface, *shift: float) -> Surface:
    """Return a displaced surface."""
    return surface[0] + np.array(shift), surface[1]


def moved(surface: Surface, corner: Any, place: Any) -> Surface:
    """Return a surface of which one corner is at another place."""
    vertices = surface[0].copy()
    vertices[np.linalg.norm(vertices - corner, axis=1).argmin()] = place
    return vertices, surface[1]


def mesh(surface: Surface, **fields: Any) -> dict[str, Any]:
    """Return the fields of a surface in mm."""
    return {
        "kind": "mesh",
        "vertices": np.asarray(surface[0]).tolist(),
        "faces": np.asarray(surface[1]).tolist(),
        "unit": "mm",
        **fields,
    }


BOX, INNER = merged(box((32, 22, 26), 2)), merged(box((9, 8, 7), 1))
TENT = (
    np.array([[0, 0, 0], [18, 0, -17], [-9, 15, -17], [-9, -15, -17]], float),
    np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]),
)
UPPER_TENT = (TENT[0] * [1, 1, -1], TENT[1][:, ::-1])
SHEET = (np.array([[0, 0, 0], [6, 0, 0], [0, 6, 0]], float), np.array([[0, 1, 2], [0, 2, 1]]))
THIRDS = merged(box((32, 22, 26), 3))
FINE = merged(box((32, 22, 26), 24))
ROD = {"kind": "rod", "diameter": "3 mm"}
ROW = {"kind": "row", "count": 4000, "step": [0, 0, 0], "body": ROD}
TURN = {"speed": "250 rpm", "arm": ["50 mm", 0, 0], "axis": "y"}
NAN = math.nan

SURFACES = {
    "hole as large as a side": ((BOX[0], BOX[1][8:]), "is open"),
    "hole smaller than a particle": ((FINE[0], FINE[1][1:]), "3 edges have a triangle on one side only"),
    "corner pulled through the other side": (moved(BOX, (16, 11, 13), (-40, 0, 0)), "crosses itself"),
    "one half inside out": ((BOX[0], np.concatenate([BOX[1][:20], BOX[1][20:, ::-1]])), "normals .* not consistent"),
    "two boxes with one edge": (merged(both(BOX, shifted(BOX, 32, 22, 0))), "more than two triangles"),
    "two boxes with one side": (merged(both(BOX, shifted(BOX, 32, 0, 0))), "more than two triangles"),
    "two boxes with one corner": (merged(both(BOX, shifted(BOX, 32, 22, 26))), "outside of the largest one"),
    "two tents at one tip": (merged(both(TENT, UPPER_TENT)), "outside of the largest one"),
    "two tents at one tip, that comes first": (
        both(TENT, (UPPER_TENT[0], UPPER_TENT[1][[1, 0, 2, 3]])),
        "outside of the largest one",
    ),
    "shell that crosses the wall": (both(BOX, shifted(INNER, 0, 0, -13)), "crosses itself"),
    "shell beside": (both(BOX, shifted(INNER, 45, 0, 0)), "2 shells"),
    "shell in a shell in a shell": (both(BOX, INNER, (0.3 * INNER[0], INNER[1])), "inside of another inner shell"),
    "the same surface twice": (both(BOX, BOX), "48 triangles are copies of others"),
    "two triangles back to back": (SHEET, "folded onto itself"),
    "sheet without thickness inside": (both(BOX, SHEET), "folded onto itself"),
    "fold in a side": (moved(THIRDS, (5.33, 3.67, 13), (-8, 3.67, 13)), "folded onto itself at 4 edges"),
    "fold beyond an edge": (moved(THIRDS, (5.33, 3.67, 13), (40, 3.67, 13)), "folded onto itself"),
    "all corners at one place": ((np.zeros((3, 3)), [[0, 1, 2]]), "all corners of the surface are at one place"),
    "corners 1e-3 apart that are one": (
        (box((32, 22, 26))[0] + 1e-3 * np.random.default_rng(2).standard_normal((24, 3)), box((32, 22, 26))[1]),
        "is open",
    ),
    "a triangle twice": (
        (BOX[0], np.concatenate([BOX[1], BOX[1][:1]])),
        "more than two triangles.*1 triangle is a copy of others",
    ),
    "corner without a number": (moved(BOX, (16, 11, 13), (NAN, 0, 0)), "rows of 3 finite numbers"),
    "corner at the end of the world": (moved(BOX, (16, 11, 13), (1e300, 0, 0)), "1e.297 m from the origin"),
    "ball with all corners of a shell on it": (
        merged(both(ball(14, 1), (14 * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, 0, 1]], float), TENT[1]))),
        "more than two triangles",
    ),
}
BODIES = {
    "touches the wall from outside": ([{"kind": "ball", "diameter": "5 mm", "position": ["18.5 mm", 0, 0]}], "outside"),
    "ring around the cavity": ([{"kind": "ring", "count": 4, "radius": "70 mm", "body": ROD}], "outside"),
    "as large as the cavity": ([{"kind": "plate", "size": ["32 mm", "22 mm", "26 mm"]}], "fill the whole cavity"),
    "leaves a slit": ([{"kind": "plate", "size": ["28 mm", "18 mm", "24 mm"]}], "larger than the cavity"),
    "axis without a direction": ([{**ROD, "axis": [0, 0, 0]}], "must not be zero"),
    "axis that is not a number": ([{**ROD, "axis": [NAN, 0, 1]}], "not finite"),
    "position that is not a number": ([{**ROD, "position": [0, NAN, 0]}], "a finite number is needed"),
    "millions": (
        [
            {
                "kind": "row",
                "count": 4000,
                "step": ["1 mm", 0, 0],
                "body": {"kind": "row", "count": 4000, "step": [0, 0, 0], "body": ROD},
            }
        ],
        "16000000 bodies are too many",
    ),
    "open surface": ([mesh((INNER[0], INNER[1][2:]))], "is open"),
    "surface without a unit": ([{**mesh(INNER), "unit": None}], "the unit of the coordinates is needed"),
    "surface in metres": ([mesh(INNER, unit="m")], "fill the whole cavity"),
    "two shells": ([mesh(both(INNER, shifted(INNER, 11, 0, 0)))], "2 shells"),
}
ROTATIONS = {
    "axis without a direction": ({"axis": [0, 0, 0]}, "must not be zero"),
    "axis that is not a number": ({"axis": [0, NAN, 0]}, "not finite"),
    "axis without end": ({"axis": [0, math.inf, 0]}, "not finite"),
    "axis of two numbers": ({"axis": [0, 1]}, "three numbers"),
    "arm that is not a number": ({"arm": [NAN, 0, 0]}, "a finite number is needed"),
    "no arm": ({"arm": None}, "arm"),
    "no motion": ({"speed": None}, "no angular velocity"),
    "speed of a point": ({"speed": "3 m/s"}, "m/s"),
    "rocking without a frequency": ({"amplitude": "4 deg"}, "frequency"),
}
CELLS = {
    "two at one place": [[0, 0, 0], [0, 0, 0]],
    "overlap of a micrometre": [[0, 0, 0], ["31.999 mm", 0, 0]],
    "not a number": [[0, 0, NAN], ["40 mm", 0, 0]],
}
FAULTS: dict[str, tuple[dict[str, Any], str]] = (
    {f"surface: {name}": ({"cavity": mesh(surface)}, text) for name, (surface, text) in SURFACES.items()}
    | {f"bodies: {name}": ({"bodies": bodies}, text) for name, (bodies, text) in BODIES.items()}
    | {
        f"rotation: {name}": ({"rotation": {k: v for k, v in (TURN | fields).items() if v is not None}}, text)
        for name, (fields, text) in ROTATIONS.items()
    }
    | {f"cells: {name}": ({"offsets": offsets}, "cells 1 and 2 overlap|finite") for name, offsets in CELLS.items()}
)


def damper(**changes: Any) -> dict[str, Any]:
    """Return the fields of ten balls of 3 mm in a box."""
    usual: dict[str, Any] = {
        "kind": "particle",
        "particles": {"material": "steel", "diameter": "3 mm", "count": 10},
        "cavity": {"kind": "box", "size": ["32 mm", "22 mm", "26 mm"]},
        "contact": {"kind": "tsuji", "restitution": 0.6},
        "friction": 0.2,
        "packing": {"kind": "settled", "seed": 1},
    }
    return usual | changes


def toml(value: Any) -> str:
    """Return a value in TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{name} = {toml(item)}" for name, item in value.items() if item is not None) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value).replace("NaN", "nan").replace("Infinity", "inf")


@pytest.fixture
def command(tmp_path: Path) -> Callable[[dict[str, Any]], Any]:
    """Return a function that runs a damper from a case file."""

    def run(fields: dict[str, Any]) -> Any:
        file = tmp_path / "case.toml"
        file.write_text(f'duration = "1 ms"\nstructure = {{ kind = "fixed" }}\ndamper = {toml(fields)}\n')
        return rattlebox("run", file, "-o", tmp_path / "out")

    return run


@pytest.mark.parametrize("fault", list(FAULTS))
def test_bad_shapes_are_refused(fault: str, command: Callable[[dict[str, Any]], Any]) -> None:
    """A fault is named with advice by Python and by the command, which ends with code 2 and without a traceback."""
    changes, text = FAULTS[fault]
    fields = damper(**changes)
    with pytest.raises(rb.CaseError, match=f"(?s)({text}).*try: "):
        rb.ParticleDamper(**{name: value for name, value in fields.items() if name != "kind"})
    answer = command(fields)
    words = " ".join(answer.stderr.split())
    assert answer.returncode == 2 and "try: " in words and "Traceback" not in words
    assert re.search(text, words)


def noted(**changes: Any) -> list[str]:
    """Return the notes on a damper."""
    fields = {name: value for name, value in damper(**changes).items() if name != "kind"}
    return list(plausibility_notes(rb.Case(structure=rb.Fixed(), damper=rb.ParticleDamper(**fields), duration="1 ms")))


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"cavity": mesh((BOX[0], BOX[1][:, ::-1]))}, "point inward"),
        ({"cavity": mesh(BOX, unit="m"), "packing": {"kind": "lattice", "seed": 1}}, "fill ratio of damper is"),
        ({"bodies": [mesh(INNER, unit="um")]}, "too small to matter"),
        ({"bodies": [mesh((INNER[0], INNER[1][:, ::-1]))]}, "point inward"),
    ],
)
def test_odd_shapes_are_computed_with_a_warning(changes: dict[str, Any], text: str) -> None:
    """Surfaces that are inside out, or in a unit that is wrong by a thousand, are computed with a warning."""
    assert any(note.startswith("warning") and text in note for note in noted(**changes))


@pytest.mark.parametrize(
    "changes",
    [
        {"bodies": [{"kind": "ball", "diameter": "5 mm", "position": ["13.5 mm", 0, 0]}]},
        {"bodies": [{"kind": "ball", "diameter": "5 mm", "position": ["16 mm", 0, 0]}]},
        {"cavity": mesh(both(BOX, INNER))},
        {"cavity": mesh(box((32, 22, 26), 2))},
        {"cavity": mesh((np.concatenate([BOX[0], [[900.0, 0, 0]]]), BOX[1]))},
        {"cavity": mesh((BOX[0], np.concatenate([BOX[1], [[2, 2, 5]]])))},
        {"cavity": mesh(both(BOX, shifted((0.2 * UPPER_TENT[0], UPPER_TENT[1]), 0, 0, -13)))},
        {"offsets": [[0, 0, 0], ["32 mm", 0, 0]]},
    ],
)
def test_limits_of_shapes_are_allowed(changes: dict[str, Any]) -> None:
    """Bodies in a wall, repeated and unused corners, a shell with its tip on the wall, and cells that touch are allowed."""
    assert not any("warning" in note for note in noted(**changes))


@pytest.mark.parametrize(
    ("changes", "field"),
    [({"rotation": TURN}, "rotation"), ({"cavity": mesh(BOX)}, "cavity"), ({"bodies": [ROD]}, "bodies")],
)
def test_packed_cases_refuse_shapes_with_advice_that_works(changes: dict[str, Any], field: str, tmp_path: Path) -> None:
    """Steppers, packed cases and FMUs name the field that they cannot contain; both pieces of advice work."""
    file = tmp_path / "case.toml"
    file.write_text(f'duration = "1 ms"\nstructure = {{ kind = "fixed" }}\ndamper = {toml(damper(**changes))}\n')
    case = rb.Case.from_file(file)
    with pytest.raises(rb.CaseError, match=rf"(?s)damper\.{field}.*try: .*rb\.simulate"):
        rb.Stepper(case)
    for name in ("pack", "fmu"):
        answer = rattlebox(name, file, "-o", tmp_path / f"case.{'bin' if name == 'pack' else 'fmu'}")
        assert answer.returncode == 2 and f"damper.{field}" in answer.stderr and "Traceback" not in answer.stderr
    assert rb.simulate(case).ok
    plain = damper(**(changes | {field: damper().get(field)}))
    file.write_text(f'duration = "1 ms"\nstructure = {{ kind = "fixed" }}\ndamper = {toml(plain)}\n')
    assert rb.Stepper(rb.Case.from_file(file))
