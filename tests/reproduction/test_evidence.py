"""Figure R2: the ensembles and the claims that they test."""

import numpy as np
import pytest

import rattlebox as rb
from reproduction import evidence
from reproduction.judge import verdict
from reproduction.models import ALL_MODELS, CONSTANT_E, RIGID, STEEL, STIFF, model_case
from reproduction.system import START, near

VERDICTS = [
    "reproduced",  # fast impacts with low restitution
    "qualitatively",  # vastly different restitution
    "qualitatively",  # predominantly plastic
    "qualitatively",  # too short for the steady state
    "reproduced",  # a few contacts take most
    "not reproducible",  # a hundred times faster
    "reproduced",  # constant restitution underestimates
    "not reproducible",  # smoother
    "under one interpretation only",  # more sensitive to the start
    "qualitatively",  # nearly 50 %
    "not reproducible",  # that drop is chaos
    "reproduced",  # particularly at low loads
    "reproduced",  # case 3 dissipates nothing
    "misprint",  # because of the clearance
    "not reproducible",  # collisions lower the relative velocity
    "qualitatively",  # earlier attenuation
    "reproduced",  # nonlinear spring
    "not reproducible",  # chattering
    "cannot be checked",  # accurately
]


@pytest.fixture(scope="module")
def data():
    """Return the data for fewer starts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evidence, "MEMBERS", 12)
        patch.setattr(evidence, "FEWER", 2)
        yield evidence.data()


def test_few_starts_give_nearly_the_same_verdicts(data):
    """With twelve starts at most two verdicts differ, because of their wider intervals."""
    found = [verdict(claim) for claim in evidence.FIGURE.claims(data)]
    assert sum(one != other for one, other in zip(found, VERDICTS, strict=True)) <= 2


@pytest.mark.slow
def test_verdicts(computed):
    """The verdicts are those of the documentation."""
    assert [verdict(claim) for claim in evidence.FIGURE.claims(computed("evidence").data)] == VERDICTS


@pytest.mark.slow
def test_verdicts_do_not_depend_on_the_ensemble(monkeypatch):
    """Other starts, and more of them, give the same verdicts."""
    monkeypatch.setattr(evidence, "MEMBERS", 90)
    monkeypatch.setattr(evidence, "near", lambda start, offset: near(start, 0.73 * offset))
    assert [verdict(claim) for claim in evidence.FIGURE.claims(evidence.data())] == VERDICTS


def test_plastic_impacts(data):
    """With a rigid wall most impacts of the first second are plastic and a third of those of 10 s; with steel few are."""
    share = data.plastic_share.sel(quantile=0.5)
    assert 0.7 < float(share.sel(shown=RIGID, until=1.0)) < 0.95
    assert 0.3 < float(share.sel(shown=RIGID, until=10.0)) < 0.45
    assert float(share.sel(shown=STEEL, until=1.0)) == pytest.approx(0.13, abs=0.01)
    strong = data.sel(pulse=5000.0, case=1).median("member")
    assert float(strong.last_plastic.sel(model=STEEL)) == pytest.approx(0.488, abs=0.005)
    assert 2.7 < float(strong.last_plastic.sel(model=RIGID)) < 4.0


def test_losses_of_all_models(data):
    """The medians are the known losses; at 100 N only constant restitution loses anything."""
    loss = 100 * data.loss.median("member")
    known = {
        CONSTANT_E: (5.35, 1.55, 5.27),
        STEEL: (0.324, 0, 0.220),
        RIGID: (6.95, 2.94, 7.11),
        STIFF: (7.33, 3.02, 6.76),
    }
    for model in ALL_MODELS:
        assert loss.sel(model=model, pulse=5000.0).values == pytest.approx(known[model], rel=0.08, abs=1e-3)
    assert float(loss.sel(pulse=100.0, model=[STEEL, RIGID, STIFF]).max()) < 1e-10
    assert float(loss.sel(pulse=100.0, model=CONSTANT_E, case=[2, 3]).min()) > 2


def test_thornton_has_the_same_limit(data):
    """Thornton's contact, without a fit, loses about as much as Jackson and Green's on steel and more on a rigid wall."""
    thornton = 100 * data.thornton.mean("fewer")
    assert float(thornton.sel(wall=STEEL)) == pytest.approx(0.307, abs=0.003)
    assert 8.5 < float(thornton.sel(wall=RIGID)) < 10


@pytest.mark.parametrize(("model", "elastic"), [(STEEL, True), (RIGID, False), (STIFF, True)])
def test_first_contact_of_case_2_is_not_the_hardest(model, elastic):
    """The contact that the pulse closes is weaker than later ones and, if the wall is the same in V_c and A, elastic."""
    run = rb.simulate(model_case(model, start=START[2], times=[0.0]))
    overlap = run.arrays.impacts.peak_overlap
    assert float(np.mean(overlap > overlap[0])) > 0.05
    pair = rb.contact_pairs(run.case, 0)[0]
    limit = evidence.critical_speed(model)
    first_yield = (1.25 * pair.mass * limit**2 / pair.hertz_stiffness) ** 0.4
    assert (overlap[0] < first_yield) == elastic


def test_measures_of_a_run():
    """The measures of one run are those that its impacts and its motion give directly."""
    run = rb.simulate(evidence._case(RIGID, 0.0, 5000.0))
    pair, limit = rb.contact_pairs(run.case, 0)[0], evidence.critical_speed(RIGID)
    bare = evidence.envelope(rb.simulate(evidence._bare(5000.0)).arrays.displacement[:, 0])
    found = evidence._measured(run, pair, limit, bare)
    log = run.arrays.impacts
    assert found["contacts"] == len(log)
    assert found["last_plastic"] == log.time[log.approach_speed > 0.0423652].max()
    before = log.time <= found["plastic_until"]
    assert np.mean(log.approach_speed[before] > limit) > 0.5
    assert np.mean(log.approach_speed[: before.sum() + 1] > limit) <= 0.5
    assert log.energy_lost[: int(found["to_half"])].sum() >= log.energy_lost.sum() / 2
    assert found["lasting"] == 0
