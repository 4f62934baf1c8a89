"""Simulator and design tool for particle and impact dampers.

Use `import rattlebox as rb`. All public names are in this module and its subpackages `analysis` and `plots`; modules load on
first use. `__init__.pyi` lists the names.
"""

import re
from importlib import import_module
from pathlib import Path
from typing import Any

__version__ = "0.3.0"

_NAMES = re.findall(r"^from (\S+) import \w+ as (\w+)$", Path(__file__).with_suffix(".pyi").read_text("utf-8"), re.M)
_MODULES = {name: module for module, name in _NAMES}

__all__ = sorted(_MODULES)


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'rattlebox' has no attribute {name!r}")
    if _MODULES[name] == "rattlebox":
        return import_module(f"rattlebox.{name}")
    import_module("rattlebox.model.case")  # a message about one part names the fields of others
    value = getattr(import_module(_MODULES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
