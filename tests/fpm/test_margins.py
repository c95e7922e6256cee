"""Margins over a travel, as standards have them, against closed forms."""

from types import SimpleNamespace

import numpy as np
import pytest
from hinged import hinged

from fpm.elements import Friction, TableSpring
from fpm.errors import SceneError
from fpm.reading import margins, responses
from fpm.reading.quantities import KINDS
from fpm.reading.quantity_definitions import parse
from fpm.reading.standards import CLASSES, STANDARDS
from fpm.reading.variables import VARIABLES

HARNESS = {"classes": {"spring h1": "HA"}}


def panel(k=0.1, psi=np.pi, f=0.01, h=0.005):
    """A panel with a spring, friction and a harness, h times the opening."""
    scene = hinged(0.0)
    scene.add_torsion_spring(0, k, psi)
    scene.add(Friction(0, f))
    scene.add(TableSpring(0, (0.0, 3.0), (0.0, -3.0 * h)))
    return scene


def found(scene, definition):
    """The margin (t,), its least, and the opening there."""
    response = responses.parse("m", definition, scene)
    run = margins.sweep_travel(scene, [response])
    numbers, problems = parse(
        {"least": {"smallest": "m"}, "at": {"smallest_at": "m"}}, [response], []
    )
    assert not problems
    return response.evaluate(run), *(number.evaluate(run) for number in numbers)


@pytest.mark.parametrize(
    ("more", "least"),
    [
        ({"standard": "ecss-e-st-33-01c", **HARNESS}, 0.173069),
        ({"standard": "ecss-e-st-33-01c", "evidence": "measurement", **HARNESS}, 1.346137),
        # with factors of one's own: (0.1 pi/2)/(0.01 + 0.005 pi/2) - 1
        ({"standard": "nasa-std-5017b", **HARNESS, "uncertainty_factors": {"FR": 1, "HA": 1}},
         7.798016),
        ({"standard": "aiaa-s-114", **HARNESS}, 3.399008),
        ({"standard": "aiaa-s-114", **HARNESS, "without": ["torsion spring h1"]}, -1.0),
        # 0.157080 against what is there and 1.25 x 0.6 kg m² x 0.1 rad/s² and 0.02 N m
        ({"standard": "ecss-e-st-33-01c", **HARNESS, "specified_acceleration": 0.1,
          "output_torque": 0.02}, 0.125663706 / (0.107123889 + 0.075 + 0.02) - 1),
    ],
)  # fmt: skip
def test_the_least_margin_of_a_panel(more, least):
    """k (psi - th) against friction f and a harness h th, least at the end of the travel."""
    values, smallest, at = found(panel(), {"margin": "h1", "to": "90 deg", **more})
    assert smallest == pytest.approx(least, rel=1e-5)
    assert values[-1] == pytest.approx(least, rel=1e-5)
    if least > -1:
        assert at == pytest.approx(np.pi / 2)


def test_where_nothing_resists_the_margin_ends():
    scene = hinged(0.0)
    scene.add_torsion_spring(0, 0.2, np.pi)
    definition = {"margin": "h1", "to": 1.0, "standard": "nasa-std-5017b"}
    assert found(scene, definition)[0] == pytest.approx(margins.MOST)


@pytest.mark.parametrize(
    ("change", "key", "allowed"),
    [
        ({"margin": "h7"}, "margin", "one of h1"),
        ({"to": "ninety"}, "to", "with or without its unit"),
        ({"to": "3 kg"}, "to", "rad, deg"),
        ({"to": True}, "to", "stow"),
        ({"to": 0.0}, "to", "another opening than"),
        ({"standard": "ecss"}, "standard", "ecss-e-st-33-01c"),
        ({"evidence": "hope"}, "evidence", "theory, measurement"),
        ({"locked": "h1"}, "locked", "a list of names"),
        ({"locked": ["h1"]}, "locked", "openings that are not moved"),
        ({"with": ["h1"]}, "with", "each opening once"),
        ({"without": ["spring h9"]}, "without", "torsion spring h1"),
        ({"classes": {"friction h1": "XX"}}, "classes.friction h1", "FR"),
        ({"classes": ["FR"]}, "classes", "a mapping"),
        ({"uncertainty_factors": {"FR": -1}}, "uncertainty_factors.FR", "at least 0"),
        ({"output_torque": "much"}, "output_torque", "a number"),
    ],
)
def test_what_is_refused(change, key, allowed):
    definition = {"margin": "h1", "to": 1.0, "standard": "ecss-e-st-33-01c", **change}
    with pytest.raises(SceneError) as caught:
        responses.parse("m", definition, panel())
    assert caught.value.key == f"responses.m.{key}"
    assert allowed in caught.value.allowed


def test_where_nothing_acts_is_refused():
    definition = {"margin": "h1", "to": 1.0, "standard": "aiaa-s-114"}
    with pytest.raises(SceneError, match="nothing does"):
        responses.parse("m", definition, hinged(0.0))


def test_a_reeled_cable_is_left_out_or_refused():
    """A curve of time winds it in, and a travel has no time."""
    scene = panel()
    scene.add_curve([0.0, 1.0], [0.0, 1.0])
    ends = [(0, (1.0, 2.0, 0.0)), (1, (1.0, 0.0, 0.0))]
    scene.add_cable("hoist", ends, EA=50.0, rest=2.0, reel=0.5, curve=0)
    definition = {"margin": "h1", "to": 1.0, "standard": "aiaa-s-114"}
    with pytest.raises(SceneError, match="cable hoist among them: a curve of time reels it"):
        responses.parse("m", definition, scene)
    responses.parse("m", definition | {"without": ["cable hoist"]}, scene)


def test_every_run_is_led_from_its_own_start():
    """By one definition, of a start at 0: the harness is worst at the end, the spring's at 1.5."""
    definition = {"margin": "h1", "to": -0.2, "standard": "aiaa-s-114"}
    response = responses.parse("m", definition, hung(0.0))
    for start in (0.0, 0.3):
        run = margins.sweep_travel(hung(start), [response])
        opening = run.columns[margins.OPENING, response.columns[0][1]]
        assert (opening[0], opening[-1]) == (start, -0.2)
        # the spring gives 0.1 (start + 0.5) against 2 x 0.01, least where the way ends
        assert margins.least(response, run) == pytest.approx((0.1 * 0.3 / 0.02 - 1, -0.2))


@pytest.mark.parametrize(("names", "unit"), [("h", "N m"), ("s", "N"), ("hs", "")])
def test_travels_are_recorded_in_units_of_their_openings(names, unit):
    scene = SimpleNamespace(hinges=[SimpleNamespace(name=n, slides=n == "s") for n in "hs"])
    labels = [margins.OpeningPath((name,), 0.0, 1.0).label("friction") for name in names]
    assert VARIABLES[margins.WORK].unit_of(scene, labels) == unit


def test_a_scene_that_starts_where_it_is_led_to_names_the_opening():
    led = margins.OpeningPath(("h1",), None, 0.25)
    assert margins.travel_of(hung(0.2), led).opening[-1] == pytest.approx(0.25)
    with pytest.raises(SceneError, match=r"opening h1 = '0.25 at the start'.*another one"):
        margins.travel_of(hung(0.25), led)


def hung(start):
    scene = hinged(start)
    scene.add_torsion_spring(0, 0.1, -0.5)
    scene.add(Friction(0, 0.01))
    return scene


def test_times_of_a_margin_are_refused():
    response = responses.parse("m", {"margin": "h1", "to": 1.0, "standard": "aiaa-s-114"}, panel())
    for kind in ("crossing", "value", "settling"):
        keys = dict.fromkeys(KINDS[kind].mandatory, 0.5)
        _, problems = parse({"q": {kind: "m", **keys}}, [response], [])
        assert "over time" in problems[0].allowed


def test_labels_are_read_as_they_are_written():
    led = margins.OpeningPath(("a", "b", "c"), 0.1, -2 / 3, ("d", "e"))
    assert margins.read_label(led.label("loop x y")) == (led, "loop x y")
    assert margins.read_label(margins.OpeningPath(("a",), 0.0, 1.0).label())[1] == ""


def ecss(I, S, HM, FR, HY, HA, HD, TD, TL):
    """Tmin of ECSS-E-ST-33-01C 4.7.5.3, by theory."""
    return 2 * (1.1 * I + 1.2 * S + 1.5 * HM + 3 * FR + 3 * HY + 3 * HA + 3 * HD) + 1.25 * TD + TL


def ecss_measured(I, S, HM, FR, HY, HA, HD, TD, TL):
    """The same with factors by measurement; that of adhesion has none."""
    rubs = 1.5 * FR + 1.5 * HY + 1.5 * HA + 3 * HD
    return 2 * (1.1 * I + 1.2 * S + 1.2 * HM + rubs) + 1.25 * TD + TL


def sums(fixed, variable, acceleration):
    """What is required by NASA-STD-5017B eq. 4-1, of three factors."""
    return lambda I, S, HM, FR, HY, HA, HD, TD, TL: (
        fixed * (I + S + HM + TL) + variable * (FR + HY + HA + HD) + acceleration * TD
    )


REQUIRED = {
    ("ecss-e-st-33-01c", "theory"): ecss,
    ("ecss-e-st-33-01c", "measurement"): ecss_measured,
    ("nasa-std-5017b", "analysis"): sums(1.5, 3.0, 1.25),
    ("nasa-std-5017b", "development test"): sums(1.35, 2.5, 1.15),
    ("nasa-std-5017b", "acceptance test"): sums(1.25, 2.0, 1.1),
    ("nasa-std-5017b", "spring out"): sums(1.0, 1.0, 1.0),
    # a static margin of 100 %, a dynamic one of 25 %
    ("aiaa-s-114", "analysis"): sums(2.0, 2.0, 1.25),
}


def test_factors_are_those_of_the_formulas_of_the_standards():
    """Class by class: of one N m of it alone, all other classes being zero."""
    assert list(REQUIRED) == [(name, how) for name, one in STANDARDS.items() for how in one.resists]
    for (name, how), required in REQUIRED.items():
        for class_ in CLASSES:
            alone = dict.fromkeys(CLASSES, 0.0) | {class_: 1.0}
            factor = STANDARDS[name].resists[how][class_]
            assert factor == pytest.approx(required(**alone), rel=1e-12), (name, how, class_)


def test_what_drives_counts_by_the_standard():
    """A spring 0.8 and inertia 0.9 times by ECSS, a motor and a load whole, friction, hysteresis,
    harness and adhesion never."""
    whole = dict.fromkeys(CLASSES, 0.0) | {"S": 1.0, "I": 1.0, "HM": 1.0, "TL": 1.0}
    weighed = {"ecss-e-st-33-01c": whole | {"S": 0.8, "I": 0.9}}
    for name, standard in STANDARDS.items():
        assert standard.drives == weighed.get(name, whole), name


def given(way, *parts):
    """A response of parts and a run that has them: each part's class of factors, drive and resist,
    and its moment as a function of the opening."""
    led = margins.OpeningPath(("h",), float(way[0]), float(way[-1]))
    labels = [(margins.WORK, led.label(f"part {i}")) for i in range(len(parts))]
    columns = ((margins.OPENING, led.label()), *labels)
    numbers = (way, *(moment(way) + 0 * way for *_, moment in parts))
    factors = ((0.0, 1.0), *((drive, resist, "S") for drive, resist, _ in parts))
    response = SimpleNamespace(columns=columns, factors=factors)
    return response, SimpleNamespace(columns=dict(zip(columns, numbers, strict=True)))


@pytest.mark.parametrize("count", [5, 31, 46])
def test_the_least_margin_between_positions_is_as_exact_as_it_is_sought(count):
    """Where a part stops to drive and another begins, no position lies: |x - at| + 0.5 to 1."""
    way = np.linspace(0.0, 2.0, count)
    exact = np.diff(way).max() / margins.FINER**margins.ZOOMS
    for at in np.random.default_rng(count).uniform(0.0, 2.0, 100):
        bend = ((1.0, 0.0, lambda x, at=at: x - at), (1.0, 0.0, lambda x, at=at: at - x))
        response, run = given(way, *bend, (1.0, 0.0, lambda x: 0.5), (0.0, 1.0, lambda x: -1.0))
        least, place = margins.least(response, run)
        assert abs(place - at) <= exact, at
        assert least == pytest.approx(-0.5, abs=2 * exact), at
        # a parabola, so flat that the place is known to a millionth only
        bowl = (1.0, 0.0, lambda x, at=at: 1.0 + (x - at) ** 2)
        least, place = margins.least(*given(way, bowl, (0.0, 1.0, lambda x: -1.0)))
        assert (least, place) == pytest.approx((0.0, at), abs=2e-6), at
