"""`rattlebox new-law`: a package with a contact law in C++, ready to be changed and installed."""

from __future__ import annotations

import keyword
import re
from importlib import resources
from pathlib import Path

from rattlebox._util.exceptions import CaseError, DataError
from rattlebox.cli.terminal import terminal
from rattlebox.model.contacts import Contact

_FILES = {
    "pyproject.toml": "pyproject.toml",
    "CMakeLists.txt": "CMakeLists.txt",
    "law.cpp": "{name}/law.cpp",
    "law.py": "{name}/__init__.py",
}
"""Templates, and their places in the folder."""


def new_law(name: str, out: Path | None) -> None:
    """Write the package of a law, and print how to install and use it."""
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name) or keyword.iskeyword(name):
        raise CaseError(
            f"{name!r} cannot be the name of a law: small letters, digits and _ are allowed, beginning with a letter",
            "rattlebox new-law my_law",
        )
    if name in Contact.kinds:
        raise CaseError(f"there is a contact law {name!r} already", f"rattlebox new-law my_{name}")
    folder = out or Path(name)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise DataError(f"{folder} exists", "a new folder, with -o")
    words = {"@name@": name, "@class@": "".join(part.capitalize() for part in name.split("_"))}
    templates = resources.files("rattlebox.cli").joinpath("law")
    (folder / name).mkdir(parents=True)
    for template, place in _FILES.items():
        text = templates.joinpath(f"{template}.in").read_text(encoding="utf-8")
        for word, value in words.items():
            text = text.replace(word, value)
        (folder / place.format(name=name)).write_text(text, encoding="utf-8")
    terminal().print(
        f"{folder}: the formula is in {name}/law.cpp, the class in {name}/__init__.py\n"
        f"  install it: pip install --no-build-isolation ./{folder}   (needs scikit-build-core, cmake and a C++ compiler)\n"
        f'  use it: contact = {{ kind = "{name}", loss = 0.1 }} in a case',
        soft_wrap=True,
    )
