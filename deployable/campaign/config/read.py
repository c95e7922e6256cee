"""A config as its models take it, and what they refuse: key, value and what is allowed."""

import json
import math
import re
from collections.abc import Mapping
from functools import cache
from typing import Any

from deployable.campaign.config.keys import RefusedError, Rule, rule_of
from deployable.campaign.config.models import Config
from fpm.arithmetic.units import number_hint
from fpm.declare import NO_VALUE
from fpm.errors import did_you_mean, likely
from fpm.reading import quantities, responses
from fpm.structures.model import KEYS
from fpm.structures.reading import OTHER_KEYS, PREFIXES, commas


def read(raw: Any) -> tuple[Config | None, dict, list[str]]:
    """Check a raw config by the models of its sections: returns the `Config`, a copy of the valid
    part of `raw`, and a sentence for each problem. Invalid keys are left out, so that the rest can
    be checked too; the config is None if that rest is invalid too, or a number is not finite."""
    endless: dict[str, Any] = {}
    right = _plain(raw, "", endless)
    problems = [f"{key}: {value} is not allowed; allowed: a finite number"
                for key, value in endless.items()]  # fmt: skip
    faults: list[tuple[tuple[str, ...], str]] = []
    try:
        config = _load(whole(), right, (), faults, False)
    except RefusedError:
        config = None
    texts = (text for path, text in sorted(faults) if ".".join(path) not in endless)
    return None if endless else config, right, [*dict.fromkeys([*problems, *texts])]


@cache
def whole() -> Rule:
    """Describe all keys that a config may have: the tree of the whole config, made once."""
    return rule_of(Config)


def schema() -> dict[str, Any]:
    """Return the JSON Schema of configs, by which editors complete and check them. What depends on
    a structure's names and units is left to the program."""
    result = whole().schema | OTHER_KEYS
    result["required"].remove("responses")  # there may be margins
    requirement = result["properties"]["requirements"]["additionalProperties"]
    requirement["properties"]["cases"] = {"type": "array", "items": {"type": "string"}}
    margins = {"along": responses.KINDS["margin"]}
    groups: dict[str, Any] = {
        "responses": responses.KINDS,
        "quantities": quantities.KINDS,
        "margins": margins,
    }
    for group, kinds in groups.items():
        definitions: list[dict[str, Any]] = [
            {
                "properties": {key: {} for key in (name, *kind.mandatory, *kind.optional)},
                "required": [name, *kind.mandatory],
                "additionalProperties": False,
            }
            for name, kind in kinds.items()
        ]
        expression = [{"type": "string"}] * (group == "quantities")
        result["properties"][group]["additionalProperties"] = {"anyOf": definitions + expression}
    return result


def _load(key: Rule, value: Any, path: tuple, faults: list, is_entry: bool) -> Any:
    """The value of a key as its section has it. What is wrong goes to `faults`, as path and
    sentence, and is taken out of `value`, of an entry of any name (is_entry: within one) the whole
    entry; RefusedError where the rest cannot be used."""
    if not isinstance(value, dict) or not (key.section or key.entry):
        result = key.take(value)
        if result is NO_VALUE:
            faults.append((path, _refusal(key, path, value)))
            raise RefusedError
        return result
    result, names = {}, [*value]
    for name in names:
        place, child = (*path, name), key.child(name)
        try:
            if child is None:
                faults.append((place, _no_key([*path], name, key)))
                raise RefusedError
            inner = is_entry or name not in key.children
            if name not in key.children and not key.names.fits(name):
                allowed = f"not a name that can be used; allowed: {key.names.allowed}"
                example = re.sub("[^A-Za-z0-9_]+", "_", name)[:60].lstrip("_")
                example = example if example[:1].isalpha() else f"x{example}"
                faults.append((place, f"{'.'.join(place)}: {allowed}, such as {example}"))
                raise RefusedError
            result[name] = _load(child, value[name], place, faults, inner)
        except RefusedError:
            if not is_entry:
                del value[name]
    mandatory = [name for name, child in key.children.items() if child.default is NO_VALUE]
    for name in {*mandatory} - {*names}:
        place = (*path, name)
        text = f"{'.'.join(place)}: missing; allowed: {key.children[name].allowed}"
        faults.append((place, text))
    is_sound = len(result) == len(names)
    if (is_entry and not is_sound) or not result.keys() >= {*mandatory}:
        raise RefusedError
    return _section_of(key, result, value, path, faults if is_sound else [])


def _section_of(key: Rule, result: dict, value: Any, path: tuple, faults: list) -> Any:
    """The section that a key's values make together; where they must not be, `faults` gets the path
    and a sentence, and RefusedError is raised."""
    try:
        if not key.fits(result):
            raise RefusedError
        return key.section(**result) if key.section else result
    except RefusedError as error:
        place = (*path, error.key) if error.key else path
        text = f"{'.'.join(place)}: {error.text}" if error.text else _refusal(key, path, value)
        faults.append((place, text))
        raise


_NUMBER = r"([-+]?[\d.]+(?:e[-+]?\d+)?)"
_SHORT_FORMS = {
    rf"intervals\.\w+: {_NUMBER} ?%": "{{relative: {0} %}}",
    rf"intervals\.\w+: {_NUMBER} ?(?:±|\+/?-) ?{_NUMBER} ?%": "{{nominal: {0}, relative: {1} %}}",
    rf"intervals\.\w+: {_NUMBER} ?(?:±|\+/?-) ?{_NUMBER}": "{{nominal: {0}, absolute: {1}}}",
    rf"intervals\.\w+: \[?{_NUMBER}(?:, ?| ?\.\.+ ?| to | ?[-–] ?){_NUMBER}\]?":
        "{{lower: {0}, upper: {1}}}",
    rf"intervals\.(\w+): {_NUMBER}": "`{0}: {1}` under scene.parameters, for a fixed value",
    rf'choose\.parameters\.\w+: .*"lower": {_NUMBER}, "upper": {_NUMBER}.*': "[{0}, {1}]",
    rf"requirements\.\w+\.\w+: {_NUMBER}": "{{at_most: {0}}}",
    r"requirements\.(\w+)\.(at_most|at_least|happens): (.+)": "{0}: {{{0}: {{{1}: {2}}}}}",
    r"requirements\.\w+: (\w+) ?[<≤]=? ?(.+)": "{{{0}: {{at_most: {1}}}}}",
    r"requirements\.\w+: (\w+) ?[>≥]=? ?(.+)": "{{{0}: {{at_least: {1}}}}}",
    rf"accuracy: {_NUMBER}": "{0} %",
    r"design: ([a-z]\w+)": "{{method: {0}}}",
}  # fmt: skip
"""What is written for a mapping, key and value, and the mapping that is meant; the last counts."""


def _refusal(key: Rule, path: tuple, value: Any) -> str:
    """That a key may not have a value, with what is likely meant."""
    allowed, unit = key.allowed, key.unit
    hint = number_hint(value, with_unit=False) if isinstance(value, str) else ""
    if "number" not in allowed:
        is_word = isinstance(value, str) and value[:1].isalpha()
        hint = did_you_mean(value, re.findall(r"`(\w+)`", allowed)) if is_word else ""
    entry = f"{'.'.join(path)}: {value if isinstance(value, str) else json.dumps(value)}"
    matches = ((re.fullmatch(form, entry), text) for form, text in _SHORT_FORMS.items())
    for match, text in matches:
        hint = f" (did you mean {text.format(*match.groups())}?)" if match else hint
    if isinstance(value, list) and value and all(isinstance(item, Mapping) for item in value):
        hint = hint or " (leave out the dashes)" * ("a mapping" in allowed)
    allowed += f" ({unit})" if unit in ("s", "min") else ""
    return f"{'.'.join(path) or 'the file'}: {show(value)} is not allowed{hint}; allowed: {allowed}"


def correct_sections(raw: Any) -> tuple[Any, list[str]]:
    """Return the config with sections under the names likely meant, and a sentence for each that is
    renamed, in which nothing else is then wrong for its name. Those ignored are left out."""
    names: Any = Config.__dataclass_fields__
    fixes: dict[str, str] = {}
    raw = {name: section for name, section in raw.items() if not str(name).startswith(PREFIXES)}
    for name in [name for name in raw if isinstance(name, str) and name not in names]:
        likely_name = likely(name, names)
        if likely_name not in ("", *raw, *fixes.values()):
            fixes[name] = likely_name
    problems = [_no_key([], name, whole()) for name in fixes]
    return {fixes.get(name, name): section for name, section in raw.items()}, problems


_OF_DISTRIBUTIONS = (
    "mean", "sigma", "std", "stdev", "stddev", "variance", "distribution", "dist", "normal", "mu",
)  # fmt: skip


def _no_key(path: list[str], name: str, section: Rule) -> str:
    """That a key is not known, with the likely one."""
    hint = did_you_mean(name, section.children)
    owners = [owner for owner, rule in section.children.items() if name in rule.children]
    if not hint and path and name in Config.__dataclass_fields__:
        hint = " (it stands at the top of the file)"
    elif not hint and path[:1] == ["intervals"] and name in _OF_DISTRIBUTIONS:
        hint = " (an interval has no distribution: give lower and upper)"
    elif not hint and path == ["scene"]:
        hint = f" (is `{name}` a parameter? These stand under scene.parameters)"
    elif not hint and not path and owners:
        hint = f" (did you mean {' or '.join(f'{owner}.{name}' for owner in owners)}?)"
    elif not hint and not path and name in KEYS:
        hint = " (it stands in the file of the structure)"
    key = ".".join([*path, name])
    return (
        f"{key}: there is no such key{hint}; allowed: {commas(section.children, 6 if hint else 99)}"
    )


def show(value: Any) -> str:
    """Write a value as text for a message, at most 60 characters of it."""
    text = json.dumps(value, default=str) if not isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def sentence(key: str, error: Any) -> str:
    """Write an error of `fpm` or `intervals`, with value and allowed, as a message on a key."""
    return f"{key}: {show(error.value)} is not allowed; allowed: {error.allowed}"


def _plain(value: Any, key: str, endless: dict[str, Any]) -> Any:
    """A copy fit for arrays and JSON; `endless` gets keys and values of numbers not finite."""
    if isinstance(value, Mapping):
        return {
            _plain(name, "", {}): _plain(item, f"{key}.{name}".lstrip("."), endless)
            for name, item in value.items()
        }
    if isinstance(value, list | tuple):
        return [_plain(item, f"{key}[{i}]", endless) for i, item in enumerate(value)]
    if isinstance(value, str):
        return value.encode(errors="replace").decode()
    if isinstance(value, float) and not math.isfinite(value):
        endless[key] = value
    elif isinstance(value, int) and abs(value) > 1 << 1000:  # no float holds it
        endless[key] = f"a number of some {value.bit_length() // 3.33:.0f} digits"
        return math.inf
    elif isinstance(value, int) and abs(value) >= 1 << 63:
        return float(value)
    return value
