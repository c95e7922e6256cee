"""The campaigns of README and docs are run, and what they answer is what the pages tell of it."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import pytest
import xarray

from deployable.campaign.cli import main
from deployable.campaign.text.numbers import share, with_error

ROOT = Path(__file__).parents[2]
_NONE = {"share": 0.0, "share_uncertainty": 0.0}


def answers(folder: Path) -> SimpleNamespace:
    """What a campaign answers, by the names of its quantities and responses; which shares `meet`
    each requirement and `all`, `choice` and `runs` beside them."""
    told = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    found = {one["name"]: SimpleNamespace(**one) for one in told.get("quantities", [])}
    with xarray.open_dataset(folder / "bounds.nc") as bounds:
        for one in told["responses"]:
            last = bounds.sel(response=one["name"]).isel(time=-1)
            ends = {"last_lower": last["lower"].item(), "last_upper": last["upper"].item()}
            found[one["name"]] = SimpleNamespace(**one, **ends)
    found["meet"] = {
        one["name"]: share(one["share"], one["share_uncertainty"])
        for one in [*told.get("requirements", []), {"name": "all", **told.get("together", _NONE)}]
    }
    found |= {key: told.get(key) for key in ("choice", "parameters", "requirements", "together")}
    found["runs"] = told["runs"]["all"]
    return SimpleNamespace(**found)


def interval(of: SimpleNamespace, digits: int, unit: str, scale: float = 1.0) -> str:
    """The interval of a quantity as pages write it."""
    return f"{of.lower * scale:.{digits}f} to {of.upper * scale:.{digits}f} {unit}"


def about(found: float, told: float, error: float, unit: str) -> str:
    """What a page rounds, if that is what was found but for a relative error."""
    return f"some {told if abs(found / told - 1) < error else found} {unit}"


TOLD = {
    "array": {"docs/library/solar-array.md": lambda a: [
        interval(a.t_open, 3, "s"), interval(a.v_open, 3, "m/s"), interval(a.turned, 4, "m"),
        f"{a.runs} runs",
    ]},
    "review": {"docs/review-sheet.md": lambda a: [
        f"| {a.ecss_least.lower:.2f} |", f"| {a.nasa_least.lower:.1f} |",
        f"| {a.one_out_least.lower:.1f} |",
    ]},
    "boom": {"docs/library/boom.md": lambda a: [
        interval(a.t_root, 2, "s"), interval(a.t_tube, 2, "s"), f"{a.runs} runs",
    ]},
    "telescope": {"docs/library/telescope.md": lambda a: [
        interval(a.t_out, 2, "s"), f"{a.blow.lower:.1f} to {a.blow.upper:.1f} N s",
        f"{a.runs} runs",
    ]},
    "umbrella": {"docs/library/umbrella.md": lambda a: [
        interval(a.t_out, 3, "s"), f"{a.runs} runs", f"{a.tightest.upper:.0f} N",
    ]},
    "tensegrity": {"docs/library/tensegrity.md": lambda a: [
        f"{1e3 * a.height.last_lower:.1f} to {1e3 * a.height.last_upper:.1f} mm",
        f"{a.side.last_lower:.1f} to {a.side.last_upper:.1f} N",
        f"{a.base.last_lower:.1f} to {a.base.last_upper:.1f} N",
    ]},
    "ring_truss": {"docs/library/ring_truss.md": lambda a: [
        f"{a.near.largest_difference:.2f} and {a.far.largest_difference:.2f} rad",
        f"{a.near.largest_error:.3f} and {a.far.largest_error:.3f} rad",
    ]},
    "strength": {"docs/responses.md": lambda a: [
        f"Its {a.runs} runs", interval(a.t_shut, 5, "s"), interval(a.moment_peak, 2, "N m"),
        interval(a.contact_peak, 2, "N m"), interval(a.stress_peak, 3, "MPa", 1e-6),
    ]},
    "mast": {"docs/library/scissor.md": lambda a: [
        f"{a.reach.largest_difference:.3f} m", f"{a.vend.largest_difference:.2f} m/s",
    ]},
    "closing": {"docs/quantities.md": lambda a: [
        interval(a.t_shut, 3, "s"), a.meet["all"],
        # Rounding decides at which choices it simulates last: 5.53 or 5.66.
        about(a.choice["parameters"][0]["value"], 5.6, 0.03, "N/rad"),
    ]},
    "deploys": {"docs/will-it-latch.md": lambda a: [
        f"{a.meet['opens']} of the box", f"{a.meet['all']} of the box",
        f"{a.t_open.lower:.1f} s to more than the {a.t_open.censored_at:g} s",
        f"at most {a.v_open.upper:.2f} m/s",
        f"**k = {a.choice['parameters'][0]['value']:.3f} N m/rad**",
        f"some {round(a.runs, -1)} runs",
        "{lower:.1f} to {upper:.1f} N m".format(**a.parameters[2]),
        "k = {k:.2f} N m/rad, c = {c:.2f} N m s/rad, friction {dry:.1f} N m".format(
            **a.requirements[0]["limits"][0]["at"]
        ),
        f"every tolerance is cut to {int(100 * a.together['max_interval_scale'])} %",
        "k = {k:.3f}, c = {c:.2f}, friction {dry:.2f}".format(**a.together["fails"]["at"]),
        f"latches after {a.together['fails']['simulated']:.1f} s",
        f"{100 * a.t_open.influence['dry']['share']:.0f} % of the interval of the time",
        f"more than {a.t_open.upper - a.t_open.lower:.1f} s to "
        f"{a.t_open.influence['dry']['fixed']:.1f} s",
        f"in {100 * a.together['halved']['dry']['share']:.1f} % of the box",
        f"latches within {a.choice['goals'][1]['simulated']:.1f} s",
        f"at most {a.choice['goals'][0]['simulated']:.2f} m/s",
        " and ".join(with_error(one["margin"], one["error"], one["units"])
                     for one in a.choice["limits"][1:]),
    ], "README.md": lambda a: [
        f"in {a.meet['opens']} of the box",
        f"after {a.t_open.lower:.1f} s to more than {a.t_open.censored_at:g} s",
    ]},
    "paper": {"README.md": lambda a: [
        f"| {a.BD.largest_difference:.4f} m at {a.BD.time_of_largest_difference:.3f} s |",
        f"| {a.vBz.largest_difference:.2f} m/s at {a.vBz.time_of_largest_difference:.3f} s (",
    ]},
}  # fmt: skip
"""For each campaign the pages that tell of it, and the texts that are there if they tell right."""


def written(page: str) -> str:
    """The text of a page, its lines joined."""
    return " ".join((ROOT / page).read_text(encoding="utf-8").split())


def decimals(text: str) -> set[str]:
    return set(re.findall(r"\d+\.\d+", text))


@pytest.mark.slow
@pytest.mark.parametrize("name", TOLD)
def test_a_page_tells_what_its_campaign_answers(name, shipped):
    found = answers(shipped(name)[0])
    for page, texts in TOLD[name].items():
        missing = [text for text in texts(found) if text not in written(page)]
        assert not missing, f"{page} does not say {missing}"
        _, _, section = written(page).partition("## The campaign")
        section = section or (written(page) if page == "docs/will-it-latch.md" else "")
        config = (ROOT / f"config/{name}.yaml").read_text(encoding="utf-8")
        unchecked = decimals(section) - decimals(" ".join(texts(found)) + config)
        assert not unchecked, f"nothing tells {unchecked} of {page}"


@pytest.fixture
def changed(tmp_path):
    """Runs a shipped campaign in which a text is replaced."""

    def run_changed(name, old, new):
        text = (ROOT / f"config/{name}.yaml").read_text(encoding="utf-8")
        assert text.count(old) == 1
        config = tmp_path / f"{name}.yaml"
        config.write_text(text.replace(old, new), encoding="utf-8")
        assert main(["run", str(config), "--results", str(tmp_path), "--no-figures"]) == 0
        return answers(tmp_path / name)

    return run_changed


@pytest.fixture
def fewer(changed):
    """Runs a scan with 64 of its 10,000 runs, which are the first of them."""

    def run_fewer(name):
        found = changed(name, "samples: 10000", "samples: 64")
        assert 64 <= found.runs <= 65  # the nominal one beside them
        return found

    return run_fewer


@pytest.mark.slow
def test_a_spline_through_the_papers_runs_gives_what_the_readme_says(changed):
    found = changed("paper", "model: polynomial", "model: spline")
    differences = found.BD.largest_difference, found.vBz.largest_difference
    assert "gives {:.4f} m and {:.2f} m/s".format(*differences) in written("README.md")


@pytest.mark.slow
def test_few_runs_of_the_scan_reach_nearly_as_far_as_all(fewer):
    """The README's differences of 10,000 runs, of which no part can reach further."""
    assert "A scan of 10,000 runs gives 0.0617 m and 4.20 m/s" in written("README.md")
    found = fewer("scan")
    for response, told, digit in ((found.BD, 0.0617, 1e-4), (found.vBz, 4.20, 1e-2)):
        assert 0.99 * told < response.largest_difference < told + digit


@pytest.mark.slow
def test_few_runs_of_the_scan_for_strength_lie_within_all(fewer):
    """The table's intervals of 10,000 runs; the closing's ends lie in corners, which come first."""
    found = fewer("strength_scan")
    for name, least, largest, digits, unit in (
        ("t_shut", 0.30021, 0.31896, 5, "s"), ("moment_peak", 11.51, 22.41, 2, "N m"),
        ("contact_peak", 24.22, 27.78, 2, "N m"), ("stress_peak", 5.411, 6.257, 3, "MPa"),
    ):  # fmt: skip
        assert f"| {least:.{digits}f} to {largest:.{digits}f} {unit} |" in written(
            "docs/responses.md"
        )
        one, scale = getattr(found, name), 1e-6 if unit == "MPa" else 1.0
        slack, width = 10.0**-digits, largest - least
        lower, upper = one.simulated_lower * scale, one.simulated_upper * scale
        assert least - slack < lower < upper < largest + slack
        assert upper - lower > (0.999 if name == "t_shut" else 0.8) * width
