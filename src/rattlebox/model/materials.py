"""Materials: a small library with sources, and user-defined materials."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo, field_validator

from rattlebox._util.html import Catalogue
from rattlebox._util.plugins import Registry, load_plugins

from .also_accepts import AlsoAccepts
from .base import Part
from .errors import Hint, nearest
from .units import Density, Modulus, Number


class Material(Part):
    """An isotropic material.

    Parameters
    ----------
    density
        Mass density [kg/m^3].
    young
        Modulus of elasticity [Pa].
    poisson
        Poisson's ratio, above -1 and at most 0.5.
    yield_stress
        Yield stress [Pa]; None for brittle materials.
    name, title, source
        Name, description, and source of the values.

    Raises
    ------
    CaseError
        If a value is not physical.
    """

    field_names: ClassVar[tuple[str, ...]] = ("material", "wall", "materials")
    name: str = ""
    title: str = ""
    density: Density
    young: Modulus
    poisson: Number = Field(examples=[0.3])
    yield_stress: Modulus | None = None
    source: str = ""

    @property
    def words(self) -> str:
        """Name in a sentence."""
        return self.name.replace("_", " ")

    @field_validator("poisson")
    @classmethod
    def _physical(cls, value: float) -> float:
        if not -1 < value <= 0.5:
            raise Hint("Poisson's ratio of an isotropic solid is above -1 and at most 0.5", "poisson = 0.3")
        return value


class Materials(Catalogue[Material]):
    """Materials by name."""

    plural = "materials"
    columns = ("name", "description", "density", "Young's modulus", "Poisson's ratio", "yield stress")

    def row(self, name: str, entry: Material) -> tuple[str, ...]:
        """Return name, description and values of a material."""
        stress = "" if entry.yield_stress is None else f"{entry.yield_stress / 1e6:g} MPa"
        values = f"{entry.density:g} kg/m^3", f"{entry.young / 1e9:g} GPa", f"{entry.poisson:g}", stress
        return name, entry.title, *values


def materials() -> Materials:
    """Return the library, by name.

    Returns
    -------
    dict of str to Material
        In the order of the file; each material names its source. Notebooks display a table. Materials of other packages
        (`add_material`) follow.
    """
    load_plugins()
    return Materials(_library())


@cache
def _library() -> Registry[Material]:
    text = resources.files("rattlebox.model").joinpath("materials.toml").read_text(encoding="utf-8")
    library: Registry[Material] = Registry("material")
    for name, values in tomllib.loads(text).items():
        library.add(name, Material(name=name, **values), "rattlebox")
    return library


def add_material(material: Material, owner: str) -> Material:
    """Add a material to the library, for a package outside; `owner` is its module, `__name__`."""
    for field in ("name", "source"):
        if not getattr(material, field):
            raise Hint(f"a material of the library needs a {field}", f'{field} = "..."', [field])
    _library().add(material.name, material, owner)
    return material


def find_material(value: object, info: ValidationInfo) -> Any:
    """Return the material of a name in the library or in the case file; return any other value unchanged."""
    if isinstance(value, str):
        load_plugins()
        library = {**_library(), **(info.context or {})}
        if value not in library:
            raise Hint("there is no material of this name", nearest(value, library))
        return library[value]
    return value


AnyMaterial = Annotated[
    Material, BeforeValidator(find_material), AlsoAccepts({"type": "string", "not": {"const": "rigid"}})
]
AnyWall = Annotated[
    Annotated[AnyMaterial, Tag("of a material")] | Annotated[Literal["rigid"], Tag("rigid")],
    Discriminator(lambda value: "rigid" if value == "rigid" else "of a material"),
]
