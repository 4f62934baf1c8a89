"""Figure 7b: instantaneous energies with constant restitution."""

from functools import partial

from . import figure_07a
from .figure import Reproduction
from .models import CONSTANT_E

FIGURE = Reproduction(
    number="7b",
    title="Instantaneous energies, constant restitution",
    data=partial(figure_07a.data, (CONSTANT_E,)),
    draw=figure_07a.draw,
    caption=figure_07a.caption,
    cases=partial(figure_07a.cases, (CONSTANT_E,)),
)
