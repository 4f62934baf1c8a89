"""Faces of a cavity that differ from its other walls."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, ValidationInfo

from rattlebox._util.exceptions import CaseError

from .also_accepts import AlsoAccepts
from .base import Part
from .contacts import AnyContact
from .errors import Hint, nearest
from .friction import AnyFriction, AnyRolling
from .materials import AnyWall, materials
from .restitutions import AnyRestitution

FRICTIONLESS = "frictionless"


class Wall(Part):
    """Properties of a face of a cavity; those that are left out are the ones of the other walls of the damper.

    Parameters
    ----------
    material
        Material of the face, or "rigid".
    contact
        Contact law, of the same kind as that of the other walls.
    restitution
        Restitution law or number, in place of the one in the contact law of the other walls.
    friction
        Friction law or coefficient. Without friction there is no rolling resistance.
    rolling
        Rolling resistance or its coefficient.

    Examples
    --------
    >>> import rattlebox as rb
    >>> damper = rb.ParticleDamper(
    ...     particles=rb.Particles(material="steel", diameter="5 mm", count=100),
    ...     cavity=rb.Box(size=("30 mm", "30 mm", "25 mm")),
    ...     contact=rb.Tsuji(restitution=0.8),
    ...     friction=0.2,
    ...     walls={"-z": rb.Wall(material="aluminium", friction=0.4), "+x": "frictionless", "-x": "frictionless"},
    ... )
    >>> damper.walls["+x"].friction.coefficient
    0.0
    """

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("contact", "restitution"),)
    field_names: ClassVar[tuple[str, ...]] = ("walls",)
    material: AnyWall | None = Field(default=None, examples=["steel"])
    contact: AnyContact | None = None
    restitution: AnyRestitution | None = None
    friction: AnyFriction | None = None
    rolling: AnyRolling | None = None

    def contact_from(self, usual: Any) -> Any:
        """Return the contact law of the face; `usual` is that of the other walls.

        Raises
        ------
        Hint
            If the usual law has no restitution that another one can replace, or cannot have this one.
        """
        if self.contact is not None:
            return self.contact
        if self.restitution is None:
            return usual
        given = {name: getattr(usual, name) for name in type(usual).model_fields if name != "restitution"}
        if "restitution" not in type(usual).model_fields:
            raise Hint(
                f"the contact law {usual.kind!r} has no restitution that a face could replace",
                'contact = { kind = "' + usual.kind + '", ... }',
                ["restitution"],
            )
        excluded = {other for pair in usual.alternatives if "restitution" in pair for other in pair}
        kept = {name: value for name, value in given.items() if name not in excluded}
        try:
            return type(usual)(restitution=self.restitution, **kept)
        except CaseError as error:  # names the contact law, of which the user has written nothing at this place
            raise error.restated(Hint, head="", place=["restitution"]) from None


def _wall(value: object, info: ValidationInfo) -> Any:
    """Return the fields of a face for one word: "frictionless", "rigid" or a material."""
    if value == FRICTIONLESS:
        return {"friction": 0.0, "rolling": 0.0}
    if isinstance(value, (Mapping, Wall)):
        return value
    words = (FRICTIONLESS, "rigid", *materials(), *(info.context or {}))
    if value not in words:
        what = f"a face is a table, a material, or one of the words {FRICTIONLESS} and rigid"
        raise Hint(what, nearest(value, words) if isinstance(value, str) else "{ friction = 0.3 }")
    return {"material": value}


AnyFace = Annotated[Wall, BeforeValidator(_wall), AlsoAccepts({"type": "string"})]
