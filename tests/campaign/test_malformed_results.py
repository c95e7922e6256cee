"""Results that hold what none does end every command that opens them in one sentence: which file,
what is wrong with it, and what to do. Damages are drawn; MALFORMED in the environment says for how
many seconds, and SEED from where."""

from __future__ import annotations

import copy
import json
import os
import random
import shutil
import time
from pathlib import Path

import netCDF4
import numpy as np
from matplotlib.figure import Figure

from deployable.campaign.cli import main
from deployable.campaign.folder import Folder
from fpm.files.seals import check, seal, unseal

READ = {
    "plan.json": ("simulate", "bounds", "answers", "figures"),
    "samples.nc": ("answers", "figures", "page", "vtk", "csv"),
    "bounds.nc": ("answers", "figures", "page", "figure", "csv"),
    "sensitivities.nc": ("figures", "page", "figure"),
    "surrogate.nc": ("page",),
    "quantities.nc": ("figures", "page", "csv"),
    "refinement.nc": ("figures", "page"),
    "summary.json": ("page",),
    "batches/0.json": ("page",),
    "motions": ("page",),
    "trajectories": ("simulate", "bounds", "answers"),
}
"""Commands that open each result; `vtk` and the like are exports."""
EXPORTS = {"vtk": "vtk", "csv": "csv", "figure": "figures"}


def reseal(path: Path, facts: dict[str, str]) -> None:
    seal(path, {key: value for key, value in facts.items() if key != "digest"})


# -- damages: of any file, of JSON, of netCDF ------------------------------------------------------


def empty(path, rng):
    path.write_bytes(b"")


def cut(path, rng):
    content = path.read_bytes()
    path.write_bytes(content[: rng.randrange(len(content))])


def folder(path, rng):
    path.unlink()
    path.mkdir()


def foreign(path, rng):
    facts = check(path)
    if path.suffix == ".json":
        path.write_text('{\n "other": [1, 2]\n}\n', encoding="utf-8")
    else:
        with netCDF4.Dataset(path, "w") as file:
            file.createDimension("x", 3)
            file.createVariable("temperature", "f8", ("x",))[:] = 1.0
    reseal(path, facts)


def flip(path, rng):
    """Bytes of the file itself, sealed again: what the library makes of them."""
    facts, content = check(path), bytearray(unseal(path))
    for _ in range(rng.choice([1, 8])):
        content[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
    if path.suffix == ".json" and not content.startswith(b"{\n"):
        content[:2] = b"{\n"
    path.write_bytes(bytes(content))
    reseal(path, facts)


def nodes(data, found=None):
    """All (holder, key) of a tree."""
    found = [] if found is None else found
    for key, one in data.items() if isinstance(data, dict) else enumerate(data):
        found.append((data, key))
        if isinstance(one, dict | list):
            nodes(one, found)
    return found


OTHERS = (None, True, -1, 0, 1e308, 10**30, "", "x", "a\nb|<b>\x1b[31m", [], {}, [[1]], {"a": 1},
          float("nan"), float("inf"))  # fmt: skip


def edit(path, rng):
    facts, data = check(path), json.loads(unseal(path))
    holder, key = rng.choice(nodes(data))
    if rng.random() < 0.3:
        del holder[key]
    else:
        holder[key] = copy.deepcopy(rng.choice(OTHERS))
    path.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    reseal(path, facts)


def edit_config(path, rng):
    facts = check(path)
    path.write_bytes(unseal(path))
    with netCDF4.Dataset(path, "a") as file:
        data = json.loads(file.config)
        holder, key = rng.choice(nodes(data))
        holder[key] = copy.deepcopy(rng.choice(OTHERS))
        file.config = json.dumps(data)
    reseal(path, facts)


def attribute(path, rng):
    facts = check(path)
    path.write_bytes(unseal(path))
    with netCDF4.Dataset(path, "a") as file:
        holder = rng.choice([file, file, *file.variables.values()])
        name = rng.choice(["scale_factor", "units", *holder.ncattrs()])
        if name == "_FillValue":
            name = "add_offset"
        value = rng.choice([None, "x", 7, np.nan, np.arange(3), "days since 1900-01-01", ""])
        if value is not None:
            holder.setncattr(name, value)
        elif name in holder.ncattrs():
            holder.delncattr(name)
    reseal(path, facts)


def values(path, rng):
    facts = check(path)
    path.write_bytes(unseal(path))
    with netCDF4.Dataset(path, "a") as file:
        file.set_auto_mask(False)
        variable = file[rng.choice([n for n, v in file.variables.items() if v.size])]
        found = variable[:]
        at = rng.randrange(found.size)
        if variable.dtype is str:
            odd = ["", "../x", "a\nb", "\u202e", "x" * 5000, "<b>|`", "\0", "BD"]
            found.ravel()[at] = rng.choice(odd)
        elif variable.dtype.kind == "f":
            every = slice(None) if rng.random() < 0.3 else at
            found.ravel()[every] = rng.choice([np.nan, np.inf, -1e308, 1e308, -1.0, 0.0, 1e-320])
        else:
            found.ravel()[at] = rng.choice([-1, 99, -(2**31) + 1])
        variable[:] = found
    reseal(path, facts)


def variable(path, rng):
    """A variable that is absent, of another type, or over other or absurd dimensions."""
    facts = check(path)
    path.write_bytes(unseal(path))
    with netCDF4.Dataset(path, "a") as file:
        name = rng.choice(list(file.variables))
        old = file.variables[name]
        dims, kind = old.dimensions, old.dtype
        file.renameVariable(name, "before")
        how = rng.choice(["absent", "text", "number", "turned", "flat", "huge", "deep"])
        if how == "huge":
            file.createDimension("huge", 10 ** rng.choice([10, 12, 18]))
            dims = ("huge",) * max(1, len(dims))
        dims = {"turned": dims[::-1], "flat": (), "deep": (*dims, "more")}.get(how, dims)
        kind = {"text": str, "number": "i2"}.get(how, kind)
        if how == "deep":
            file.createDimension("more", 2)
        if how != "absent":
            chunks = {"chunksizes": (1,) * len(dims)} if dims and kind is not str else {}
            file.createVariable(name, kind, dims, **chunks)
    reseal(path, facts)


ANY = (empty, cut, folder, foreign, flip)
NETCDF = (*ANY, edit_config, attribute, attribute, values, values, values, variable, variable)
JSON = (*ANY, edit, edit, edit, edit, edit, edit)


def wrong_with(command: str, place: Folder, sections: dict, capsys) -> tuple[str, int]:
    """What is wrong with how a command ends, and its status."""
    arguments = ["--to", EXPORTS[command]] if command in EXPORTS else []
    if command in EXPORTS:
        arguments += ["--frames", "2"] * (command != "csv")
    else:
        arguments = ["--config", sections[command]] + ["--frames", "2"] * (command == "page")
    name = "export" if command in EXPORTS else command
    try:
        status = main([name, str(place.path), *arguments])
    except BaseException as error:
        return f"raises {error!r}", 2
    told = capsys.readouterr().err
    lines = [line for line in told.splitlines() if line.startswith("error: ")]
    if status == 0:
        return ("" if not lines else told), 0
    if len(lines) != 1 or not told.endswith(lines[0] + "\n"):
        return told, status
    is_kind = str(place.path) in lines[0] and "led to" not in lines[0]
    remedy = "run" in lines[0] or "allowed: " in lines[0] or "remove" in lines[0]
    return ("" if is_kind and remedy and "Traceback" not in told else told), status


def test_malformed_results_end_in_one_sentence(rich, tmp_path, capsys, monkeypatch):
    whole, sections = rich
    # To draw takes seconds, and is done at the end.
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **how: Path(path).touch())
    place = Folder(tmp_path / "rich")
    shutil.copytree(whole.path, place.path)
    seed, seconds = int(os.environ.get("SEED", 1)), float(os.environ.get("MALFORMED", 8))
    rng, start, counts, bad = random.Random(seed), time.monotonic(), {}, []
    while time.monotonic() - start < seconds:
        kind = rng.choice(list(READ))
        name = kind
        if (place / kind).is_dir() and not kind.endswith("json"):
            name = f"{kind}/{rng.choice(sorted(p.name for p in (whole / kind).glob('*.nc')))}"
        path = place / name
        classic = kind == "trajectories"
        damages = ANY if classic else JSON if path.suffix == ".json" else NETCDF
        if kind == "motions":
            damages = (*ANY, values, variable)
        damage, command = rng.choice(damages), rng.choice(READ[kind])
        draw = rng.getrandbits(32)
        damage(path, random.Random(draw))
        text, status = wrong_with(command, place, sections, capsys)
        counts[status] = counts.get(status, 0) + 1
        if text:
            bad.append(f"{damage.__name__}({name}, {draw}) {command}: {text}")
        shutil.rmtree(place.path)
        shutil.copytree(whole.path, place.path)
    with capsys.disabled():
        print(f"\n{counts} of status: cases; {len(bad)} bad")
    assert not bad, "\n\n".join(bad)
    assert len(counts) == 2
