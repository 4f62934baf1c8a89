"""Equations as they are read, interpretations of the printed text, and misprints: the tables of page and documentation."""

from __future__ import annotations

from typing import NamedTuple

PROVENANCE = (
    "We had the text of the paper, but none of its figures: no curve of ours is compared with one of theirs, and "
    "only what the text "
    "says about a figure is judged. Figures 1 and 8 are drawn anew from the text, 3 (the flow chart of the program) "
    "is left out, and "
    "4b and 4d, which show results of Li et al., cannot be compared. The amplitudes of figures 7d and 7e between 100 "
    "and 5000 N are ours."
)
"""What was available, for the top of the page."""


class Equation(NamedTuple):
    """Equation with its number in the paper and a remark."""

    number: str
    text: str
    remark: str


EQUATIONS = (
    Equation(
        "(1), (2)",
        "M z̈ + C ż + K z = F + F_d,  m ü = −F_d",
        "one structure, one ball on a line; no gravity, no friction",
    ),
    Equation("(17)", "F = F_0 sin(π t/t_f) for 0 < t < t_f", "an impulse of 2 F_0 t_f/π = 3.18 N s at 5000 N"),
    Equation("(4), (5), (8)", "N = A δ^1.5 + γ δ̇,  A = (4/3) E* √R*", "printed without the root"),
    Equation("(9)", "γ = α √(m* A) δ^0.25", "α from the restitution: α = −√5 ln e / √(π² + ln² e)"),
    Equation(
        "(6), (7), (10)",
        "1/E* = Σ (1 − ν²)/E,  1/R* = Σ 1/R,  1/m* = Σ 1/m",
        "wall: R infinite, mass M; rigid: E infinite",
    ),
    Equation(
        "(11)",
        "e = 1 for V* < 1;  1 − 0.1 ln V* ((V* − 1)/59)^0.156 to V* = 60",
        "the branch beyond V* = 60 is never reached",
    ),
    Equation(
        "(12) to (15)", "V* = V/V_c,  V_c = √(4 ω_c P_c/(5 m*)),  V_c ~ S_y^2.5 E*^-2", "a rigid wall divides V_c by 4"
    ),
    Equation("(16)", "C_y = 1.295 exp(0.736 ν)", "the body with the lower C_y S_y yields first"),
)


class Interpretation(NamedTuple):
    """Printed text that is not unique, how it is read, and why."""

    printed: str
    read: str
    reason: str


INTERPRETATIONS = (
    Interpretation(
        "wall in the elasto-plastic model",
        "three interpretations: steel; rigid in V_c; rigid in V_c and A",
        "section 3.2 says contact with a rigid body, section 3.1 a rigid surface; equations (6) and (13) to (15) "
        "take E* of both bodies",
    ),
    Interpretation(
        "cases 2 and 3",
        "two interpretations: 2 trailing and 3 leading wall (as read), or swapped",
        "the order is in figure 8, an image that we do not have; the text does not fix it",
    ),
    Interpretation("(5): A = (4/3) E* R*", "√R*", "A δ^1.5 must be a force"),
    Interpretation(
        "table 1: diameter 33.17 mm",
        "radius",
        "gives the 6 % of 20 kg of the text (1.200037 kg), and 67.14 − 2 × 33.17 = 0.80 mm = 2 d_0",
    ),
    Interpretation("γ = 0.006313, e ~ 0.99", "α = 0.006313, so that e = 0.991170", "(9) makes γ depend on the overlap"),
    Interpretation(
        "case 3 never touches at 100 N",
        "case 1",
        "the structure moves by 0.050 mm: less than the 0.4 mm of the centred ball, more than the zero gap of case 3",
    ),
    Interpretation("m* in V_c", "mM/(m + M)", "(10); with m* = m, V_c is 3 % lower"),
    Interpretation(
        "end of a contact",
        "at zero overlap",
        "the equation is solved to there; ending it at zero force changes e by 2e-5",
    ),
    Interpretation("duration of the runs", "10 s", "not printed; the text speaks of t > 2 s"),
)

MISPRINTS = (
    Interpretation("equation (5)", "√R* for R*", "dimensions"),
    Interpretation("table 1, particle size", "radius for diameter", "mass and clearance"),
    Interpretation("section 5.1, γ = 0.006313", "α for γ", "equation (9)"),
    Interpretation("conclusion 1, dissipation in the elastic phase", "plastic for the second elastic", "section 5"),
    Interpretation("section 5.1, case 3 at 100 N below the clearance", "case 1", "zero gap of case 3"),
    Interpretation("section 3.1, fit between log10 e and γ", "α for γ", "figure 2 says α"),
    Interpretation("equation (14), dot over C", "no dot", "a constant"),
    Interpretation("section 3.2, ω_c as the maximum deformation", "deformation at first yield", "equation (13)"),
    Interpretation("section 3, n_ij as a distance", "unit normal", "equations (3) and (4)"),
    Interpretation("section 4.1, Runge-Kutta as a multistep method", "one-step method; ODE45 is one", "definition"),
    Interpretation("figures 7c and 7d, t_0", "t_f", "equation (17)"),
    Interpretation("figure 7d, Case-1 only", "all three cases", "section 5.1"),
    Interpretation(
        "figure 9b, position of the structure within the cavity",
        "displacement of the structure",
        "the structure holds the cavity",
    ),
    Interpretation("conclusion 3, figure 6 for chaos", "figure 9", "figure 6 is a regular motion"),
    Interpretation("section 5.1, double negative about no dissipation", "one negation", "the reason that follows it"),
    Interpretation("section 6.1, “eternal” damping", "external", "sense"),
    Interpretation("section 3, “poisons” ratio", "Poisson's ratio", "spelling"),
    Interpretation("section 5.1, sqrt(k/M) = 63.24", "63.25 rad/s", "rounding of 63.2456"),
)
"""Printed text, what it should be, and what shows it; the first five change numbers or statements and are claims of "
"the matrix."""
