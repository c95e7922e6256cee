"""Cases of a campaign: variants of its config, each of which is a campaign of its own."""

import copy
import re
from collections.abc import Iterator, Mapping
from typing import Any

from deployable.campaign.config.read import show
from deployable.campaign.config.resolve import unknown
from deployable.campaign.config.sections import Campaign


def folder_name(case: str) -> str:
    """Return the folder of a case below the campaign's; case: its name (spaces become `-`)."""
    return re.sub(" +", "-", case)


def without_cases(raw: Mapping) -> tuple[dict, dict[str, Any]]:
    """Separate the lists `cases` of requirements (the cases to which each applies) from a raw
    config. Returns the config without them, and the lists by requirement. A mapping called `cases`
    stays, because it states the limits of a quantity of that name."""
    requirements, case_lists = {}, {}
    sections = raw.get("requirements")
    for name, limits in sections.items() if isinstance(sections, Mapping) else ():
        if isinstance(limits, Mapping) and not isinstance(limits.get("cases", {}), Mapping):
            limits = dict(limits)
            case_lists[name] = limits.pop("cases")
        requirements[name] = limits
    return ({**raw, "requirements": requirements} if case_lists else dict(raw)), case_lists


def naming_problems(cases: Mapping[str, Any], case_lists: Mapping[str, Any]) -> Iterator[str]:
    """Check the names of cases, and that requirements list existing ones: yields a sentence for
    each problem. cases: that section of the config; case_lists: names of cases by requirement."""
    folders: dict = {}
    for name in sorted(cases):
        twin = folders.setdefault(folder_name(name).lower().replace("-", "_"), name)
        if twin != name:
            yield (
                f"cases.{name}: as a folder's name it is that of {twin}; allowed: names that "
                "differ in more than spaces, `-`, `_` and capitals"
            )
    allowed = f"a list of {', '.join(cases)}" if cases else "none, without `cases`"
    for requirement, names in case_lists.items():
        key = f"requirements.{requirement}.cases"
        if not isinstance(names, list | tuple) or not names or not cases:
            yield f"{key}: {show(names)} is not allowed; allowed: {allowed}"
            continue
        for name in (name for name in names if name not in [*cases]):
            yield f"{key}: {show(name)}: {unknown(str(name), 'case', cases)}"


def case_config(raw: Mapping, name: str, case_lists: Mapping[str, Any]) -> tuple[dict, dict]:
    """Return the raw config of one case, without what the case changes, and the changes, to be
    merged into it. case_lists: names of cases by requirement; one without is of all."""
    case = raw["cases"][name]
    rest = {key: copy.deepcopy(value) for key, value in raw.items() if key != "cases"}
    rest["campaign"] = folder_name(name)
    limits = rest.get("requirements", {})
    keys = [key for key in limits if name in case_lists.get(key, [name])]
    rest["requirements"] = {key: limits[key] for key in keys}
    changes = {key: case[key] for key in ("solver", "intervals") if key in case}
    if case.get("scene"):
        changes["scene"] = {"parameters": case["scene"]}
    if "file" in case:
        rest["scene"].pop("name", None)
        changes["scene"] = {**changes.get("scene", {}), "file": case["file"]}
    for parameter in case.get("intervals", {}):
        rest["intervals"].pop(parameter, None)
    return rest, changes


def fixed_interval_problems(case: Mapping, name: str, intervals: Mapping) -> Iterator[str]:
    """Check that a case gives no value to a parameter that is an interval."""
    for parameter, value in case.get("scene", {}).items():
        if parameter in {**intervals, **case.get("intervals", {})}:
            spec = intervals.get(parameter, {})
            width = {key: spec[key] for key in ("relative", "absolute") if key in spec}
            if "lower" in spec:
                width = {"absolute": float(f"{0.5 * (spec['upper'] - spec['lower']):.6g}")}
            keys = {"nominal": value, **(width or {"relative": 0.1})}
            text = ", ".join(f"{key}: {x}" for key, x in keys.items())
            yield (
                f"cases.{name}.scene.{parameter}: {show(value)}, and {parameter} is an interval; "
                f"allowed: instead `intervals: {{{parameter}: {{{text}}}}}` in this case, or "
                "another parameter"
            )


def case_problem(name: str, problem: str) -> str:
    """Turn a problem of the config made for one case into one of the user's config:
    `scene.parameters.g: ...` into `cases.<name>.scene.g: ...`, and so on; before a problem of a key
    that a case cannot state stands `cases.<name>: `."""
    key, _, text = problem.partition(":")
    if key.startswith(("scene.parameters.", "scene.file", "solver.duration", "intervals.")):
        user_key = key.replace("scene.parameters.", "scene.", 1).replace("scene.file", "file", 1)
        return f"cases.{name}.{user_key}:{text}"
    return f"cases.{name}: {problem}"


def variants(campaign: Campaign) -> Iterator[tuple[str, Campaign]]:
    """Yield the campaigns that are to be run, each as a prefix for messages on it and the campaign:
    those of the cases, or with "" the campaign itself if there are none."""
    if not campaign.cases:
        yield "", campaign
    for name, variant in campaign.case_campaigns.items():
        yield f"case {name}: ", variant
