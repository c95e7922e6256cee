"""The config of a campaign: read, checked, filled with defaults and resolved before any job starts.

    campaign = load_config(["config/paper.yaml"])
    campaign.experiment.solver.duration

Everything wrong with it is collected into one `ConfigError`: what the models of its sections refuse
(`models`, by `read`), then what needs the scene (`scene_checks`)."""

import copy
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from deployable.campaign.config.cases import (
    case_config,
    case_problem,
    fixed_interval_problems,
    naming_problems,
    without_cases,
)
from deployable.campaign.config.loader import read_file
from deployable.campaign.config.models import Config
from deployable.campaign.config.read import correct_sections, read
from deployable.campaign.config.resolve import with_margins
from deployable.campaign.config.scene_checks import accuracy_problems, resolve
from deployable.campaign.config.sections import Campaign
from deployable.campaign.config.units import StatedUnits
from deployable.campaign.errors import ConfigError
from fpm.structures.model import KEYS


def load_config(
    paths: str | Path | Sequence[str | Path],
    overrides: Mapping | None = None,
    source: str | None = None,
) -> Campaign:
    """Read the config of a campaign from YAML files, check it and fill in all defaults.

    Files are merged key by key, later ones over earlier ones and `overrides` over all. `published`
    of an earlier file is dropped where a later one changes `scene` or `intervals`. The path of a
    structure's file is relative to the YAML file that names it, in `overrides` to the working
    folder. Numbers of the campaign returned are in SI units, those of parameters in theirs. Raises
    `ConfigError` with everything that is wrong, each with its file and line.

    Parameters
    ----------
    paths: a YAML file, or several.
    overrides: further keys of a config, nested as in YAML.
    source: what messages call the config; None: the paths."""
    config: dict = {}
    lines: dict[str, str] = {}
    paths = [paths] if isinstance(paths, str | Path) else paths
    for path in paths:
        data, line_numbers = read_file(path)
        _add(config, anchor_paths(data, Path(path).parent))
        prefix = f"{path}, " if len(paths) > 1 else ""
        lines |= {key: f"{prefix}line {line}: " for key, line in line_numbers.items()}
    _add(config, anchor_paths(overrides or {}, "."))
    lines |= dict.fromkeys(_keys(overrides or {}), "--config: ")
    try:
        campaign = check_config(config, source or ", ".join(str(path) for path in paths))
        return replace(campaign, sources=tuple(map(str, paths)), lines=lines)
    except ConfigError as error:
        raise ConfigError(error.source, [locate(x, lines) for x in error.problems]) from None


def locate(text: str, lines: Mapping[str, str]) -> str:
    """Put the line of the key with which a text on a config begins, or of the nearest key above,
    before it. lines: such as `line 3: `, by key."""
    key = text.partition(":")[0]
    while key and key not in lines:
        key = key.rpartition(".")[0]
    return lines.get(key, "") + text


def _add(config: dict, update: Mapping) -> None:
    """Merge a further config; of another box, what was published of the first is left out."""
    published = config.get("published")
    original = [copy.deepcopy(config.get(key)) for key in ("scene", "intervals")]
    merge(config, update)
    if published and original != [config.get(key) for key in ("scene", "intervals")]:
        config.pop("published")
        merge(config, {key: update[key] for key in update if key == "published"})


def _keys(data: Any, path: str = "") -> Iterator[str]:
    """List all keys of nested mappings, with their names joined by dots."""
    for name, child in data.items() if isinstance(data, Mapping) else ():
        yield (key := f"{path}{name}")
        yield from _keys(child, f"{key}.")


def check_config(raw: Mapping | str | Path, source: str = "the config") -> Campaign:
    """Check a config, fill in all defaults, return the campaign. raw: sections by name, or the path
    of a YAML file; source: what messages call it. Raises `ConfigError` with all that is wrong."""
    if not isinstance(raw, Mapping):
        return load_config([raw])
    sections = Config.__dataclass_fields__.keys()
    if "campaign" not in raw and len(raw.keys() & {*KEYS}) > len(raw.keys() & sections):
        raise ConfigError(source, [
            f"this is a structure's file, not a campaign's: use `structure {source}`, or in Python "
            "`structures.load`"
        ])  # fmt: skip
    if raw.get("margins"):  # which are responses, too
        raw = {"responses": {}, **raw}
    sections_by_name, name_problems = correct_sections(raw)
    raw, case_lists = without_cases(sections_by_name)
    original, units = raw, StatedUnits(raw)
    raw = units.raw
    config, user_config, problems = read(raw)
    problems = name_problems + problems
    campaign: Any = None
    if config is not None:
        cases = raw.get("cases")  # sections with a mistake count as present
        names = dict.fromkeys(cases) if isinstance(cases, Mapping) else {}
        problems += naming_problems({**names, **config.cases}, case_lists)
        if config.responses or config.margins:
            config, margin_problems = with_margins(config, raw.get("solver") or {})
            problems += [*margin_problems, *accuracy_problems(config, user_config)]
            campaign, scene_problems = resolve(config, user_config)
            problems += scene_problems
        else:
            allowed = "a mapping from at least one name (letters, digits, `_`)"
            problems.append(f"responses: {{}} is not allowed; allowed: {allowed} to definitions")
    problems = [units.misfits.get(problem.partition(":")[0], problem) for problem in problems]
    problems = _find_causes([*dict.fromkeys([*problems, *units.misfits.values()])])
    if problems := problems or [*units.unknowns.values()]:
        raise ConfigError(source, problems)
    assert config is not None  # else there are problems
    return _resolve_cases(campaign, raw, original, case_lists, source) if config.cases else campaign


def _find_causes(problems: list[str]) -> list[str]:
    """Return the problems that follow neither from a key of their section, nor a missing one."""
    pairs, causes = [problem.partition(":")[::2] for problem in problems], []
    keys = {f"{key}." for key, _ in pairs}
    for i, (key, text) in enumerate(pairs):
        has_cause = any(peer != f"{key}." and peer.startswith(f"{key}.") for peer in keys)
        is_told = text in [cause for _, cause in pairs[:i]] or {"quantities.", "responses."} & keys
        if not has_cause and not (text.endswith("allowed: none") and is_told):
            causes.append(problems[i])
    return causes


def _resolve_cases(
    campaign: Campaign, raw: Mapping, original: Mapping, case_lists: Mapping, source: str
) -> Campaign:
    """Return the campaign with its cases, each checked as a campaign of its own; original: the raw
    config with its units, which in a case are of the case's structure."""
    cases, campaigns, problems = raw["cases"], {}, []
    for name in cases:
        fixed = [*fixed_interval_problems(cases[name], name, raw["intervals"])]
        config, changes = case_config(original, name, case_lists)
        _add(config, changes)
        try:
            campaigns[name] = check_config(config)
        except ConfigError as error:
            fixed = fixed or [case_problem(name, problem) for problem in error.problems]
        problems += fixed
    campaign = replace(campaign, cases=copy.deepcopy(dict(cases)), case_campaigns=campaigns)
    if problems:
        raise ConfigError(source, problems)
    return campaign


def merge(target: dict, update: Mapping) -> dict:
    """Merge the mapping `update` into `target`, and return the changed `target`. Mappings are
    merged key by key; any other value replaces that of `target`."""
    for key, value in update.items():
        if isinstance(value, Mapping) and isinstance(target.get(key), Mapping):
            target[key] = merge(dict(target[key]), value)
        else:
            target[key] = copy.deepcopy(value)
    return target


def anchor_paths(raw: Mapping, folder: str | Path) -> Mapping:
    """Return the raw config with paths of structures' files, measured curves and runs,
    relative to `folder`, made relative to the working folder if they lie in it, else absolute."""
    anchored_raw = dict(raw)
    for key in raw.keys() & {"scene", "design"}:
        anchored_raw[key] = _anchored_file(raw[key], folder)
    for key in ("cases", "measured"):
        if isinstance(entries := raw.get(key), Mapping):
            sections = {name: _anchored_file(section, folder) for name, section in entries.items()}
            anchored_raw[key] = sections
    return anchored_raw


def _anchored_file(section: Any, folder: str | Path) -> Any:
    """Return a section of a config with its key `file` relative to the working folder."""
    if not isinstance(section, Mapping) or not isinstance(section.get("file"), str):
        return section
    if "\0" in section["file"]:  # no path, which the models refuse
        return section
    path = Path(os.path.realpath(Path(folder, section["file"])))  # a loop of links is left as it is
    working_folder = Path.cwd().resolve()
    path = path.relative_to(working_folder) if path.is_relative_to(working_folder) else path
    return {**section, "file": str(path)}
