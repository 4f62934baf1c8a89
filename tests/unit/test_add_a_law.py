"""The example of docs/add_a_law.md, taken from the page, added to the core's headers and compiled."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rattlebox as rb

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "add_a_law.md").read_text(encoding="utf-8")
COMPILER = shutil.which(os.environ.get("CXX", "c++")) or shutil.which("g++") or shutil.which("clang++")
SPEEDS = [1e-6, 0.1, 1.0, 32.0]

PROGRAM = """
#include <cstdio>
#include <cstring>
#include "contact/laws.hpp"

using namespace rattlebox;

// Finds the law by its name, fills its coefficients by theirs, and prints what it says.
int main() {
    RestitutionLaw choice;
    RestitutionLaw::each_type([&](auto* null) {
        using Law = std::remove_const_t<std::remove_pointer_t<decltype(null)>>;
        if (std::strcmp(Law::name, "NAME") != 0) return;
        Law law;
        std::printf("[[");
        for (const auto& field : Law::fields) {
            std::printf("%s\\"%s\\"", &field == Law::fields ? "" : ", ", field.name);
VALUES
        }
        choice.set(law);
    });
    std::printf("], [");
    for (const real speed : {SPEEDS}) std::printf("%.17g, ", rebound(choice, speed).e);
    std::printf("%d]]", rebound(choice, 1e9).outside);
}
"""


def block(language: str) -> str:
    """Return the only block of a language on the page."""
    (found,) = re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)
    return str(found)


def compiled(folder: Path, values: dict[str, float], name: str) -> tuple[list[str], list[float]]:
    """Follow the page in a copy of the core: add file and row; return the law's fields and what it says of SPEEDS."""
    core = folder / "core"
    shutil.copytree(ROOT / "core", core)
    (path,) = re.findall(r"\*\*1\. The formula\*\*, `core/(\S+\.hpp)`", PAGE)
    (law,) = re.findall(r"add `(\w+)` to `RestitutionLaw`", PAGE)
    (core / path).write_text(block("cpp"), encoding="utf-8")
    table = core / "contact" / "laws.hpp"
    rows = table.read_text(encoding="utf-8")
    assert rows.count("JohnsonRestitution>;") == 1
    rows = rows.replace("JohnsonRestitution>;", f"JohnsonRestitution, {law}>;")
    table.write_text(rows.replace("#pragma once\n", f'#pragma once\n#include "{path}"\n', 1), encoding="utf-8")
    given = "".join(
        f'            if (std::strcmp(field.name, "{key}") == 0) law.*field.member = {value!r};\n'
        for key, value in values.items()
    )
    program = PROGRAM.replace("NAME", name).replace("VALUES\n", given).replace("SPEEDS", ", ".join(map(repr, SPEEDS)))
    (folder / "main.cpp").write_text(program, encoding="utf-8")
    command = [str(COMPILER), "-std=c++20", "-Wall", "-Wextra", "-Werror", "-I", str(core), "main.cpp", "-o", "main"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    fields, numbers = json.loads(subprocess.run([folder / "main"], capture_output=True, text=True, check=True).stdout)
    return fields, numbers


@pytest.mark.skipif(COMPILER is None, reason="no C++ compiler")
def test_the_example_on_the_page(tmp_path: Path) -> None:
    """The page's C++ law compiles in place, takes the coefficients of the page's class by name, and gives the formula."""
    space: dict[str, Any] = {}
    exec(compile(block("python"), "page", "exec", dont_inherit=True), space)
    law = space["Viscoelastic"](loss=0.25, maximum=0.95)
    ball = rb.ImpactDamper(
        ball=rb.Sphere(radius="5 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.9)
    )
    pair = rb.contact_pairs(rb.Case(structure=rb.Fixed(), damper=ball, duration=1.0), 0)[0]
    name, values = law.coefficients(pair)
    assert name == law.kind
    fields, numbers = compiled(tmp_path, values, name)
    assert set(values) == set(fields)
    np.testing.assert_allclose(numbers[:-1], np.minimum(1 - 0.25 * np.power(SPEEDS, 0.2), 0.95), rtol=1e-14)
    assert numbers[-1] == 0  # no speed is outside
    with pytest.raises(rb.CaseError, match="must be at least 0"):
        space["Viscoelastic"](loss=-1.0)
