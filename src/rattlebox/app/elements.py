"""The elements of the page that draw in the browser."""

from __future__ import annotations

from pathlib import Path

import nicegui
from nicegui.element import Element

_BINARY = {"rattlebox-binary": "browser/binary"}
_ELEMENTS = Path(nicegui.__file__).parent / "elements"


class _Drawing(Element):
    """An element that draws the body at its URL."""

    def show(self, url: str, **properties: object) -> None:
        """Draw the body at a URL of this server; "" for none."""
        self._props["url"] = url
        for name, value in properties.items():
            self._props[name] = value
        self.update()


class Charts(
    _Drawing, component="browser/charts.js", esm={**_BINARY, "nicegui-echart": str(_ELEMENTS / "echart" / "dist")}
):
    """Motion, energy, phase portrait and impacts of a run."""


class Balls(_Drawing, component="browser/balls.js", esm=_BINARY):
    """Animation of a structure with balls on a line."""


class Particles(
    _Drawing, component="browser/particles.js", esm={**_BINARY, "nicegui-scene": str(_ELEMENTS / "scene" / "dist")}
):
    """3-D view of particles in their cavities."""
