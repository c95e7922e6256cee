"""Pages that are made when the site is built: the lists of keys, the verification problems, and the
gallery, where every structure of the library moves.

`-D gallery_moves=0` draws stills instead, which simulates nothing."""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
DURATION = 2.0  # s, of structures that no shipped campaign is about


def structures() -> dict[str, str]:
    """The library: what a structure's command takes, by the structure's name."""
    from deployable.campaign.config.sections import scene_type

    found = {}
    for path in sorted((ROOT / "config/structures").glob("*.yaml")):
        found[scene_type("", str(path)).name] = f"config/structures/{path.name}"
    return found


def campaigns() -> dict[str, str]:
    """The first shipped campaign of each structure, by the structure's file or name."""
    from deployable.campaign.config.check import load_config

    found: dict[str, str] = {}
    for path in sorted((ROOT / "config").glob("*.yaml"), key=lambda p: (p.stem != "paper", p.stem)):
        scene = load_config([path]).experiment.scene
        file = Path(scene.file).resolve().relative_to(ROOT).as_posix() if scene.file else scene.name
        found.setdefault(file, f"config/{path.name}")
    return found


def command(structure: str, campaign: str | None) -> list[str]:
    """The arguments of the export that makes a structure's picture."""
    if campaign:
        return ["export", campaign, "--to", "gif"]
    return ["export", structure, "--to", "gif", "--duration", f"{DURATION:g}"]


def picture(arguments: list[str], structure: str, name: str, folder: Path, moves: bool) -> str:
    """Make a picture unless it is there; its name."""
    from deployable.campaign.config.sections import scene_type
    from deployable.campaign.export import choose, export
    from deployable.campaign.pictures.drawing import write_structure

    found = scene_type(structure, str(ROOT / structure))
    path = folder / f"{name}-{found.digest[:8]}.{'gif' if moves else 'png'}"
    if not path.exists() and moves:
        duration = None if "--duration" not in arguments else float(arguments[-1])
        chosen = choose(str(ROOT / arguments[1]), duration=duration)
        (made,) = export(chosen, "gif", folder)
        made.rename(path)
    elif not path.exists():
        write_structure(found.build(), path)
    return path.name


def _default(parameter) -> str:
    """Write a parameter's default with its unit."""
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    return "" if parameter.default is None else f"{parameter.default:g}{unit}"


def page(folder: Path, moves: bool, follow=dict.items) -> str:
    """The gallery as Markdown: thumbnails, then each structure. follow: function that iterates over
    the structures, pairs of name and file, and may tell how far that is."""
    from deployable.campaign.config.sections import scene_type

    known, lines, thumbnails = campaigns(), [], []
    for name, structure in follow(structures()):
        found = scene_type("", str(ROOT / structure))
        campaign = known.get(structure) or known.get(name)
        still = picture([], structure, name, folder, moves=False)
        anchor = name.replace(" ", "-").lower()
        thumbnails.append(f"[![{found.description}](made/{still}) {name}](#{anchor})")
        arguments = command(structure, campaign)
        image = picture(arguments, structure, name, folder, moves)
        lines += [
            f"## {name}", "", f"{found.description}.", "",
            f"![{found.description}](made/{image})", "",
            f"File `{structure}`" + (f", campaign `{campaign}`." if campaign else "."), "",
            "```", f"python -m deployable {' '.join(arguments)}", "```", "",
            "| parameter | default | meaning |", "|---|---|---|",
            *(f"| `{key}` | {_default(p)} | {p.text} |" for key, p in found.parameters.items()), "",
        ]  # fmt: skip
        stem, library = Path(structure).stem, ROOT / "docs/library"
        told = next((p for p in library.glob("*.md") if p.stem.replace("-", "_") == stem), None)
        if told:
            lines += [
                f"[What is modelled, and against what it was checked](library/{told.name})",
                "",
            ]
    return "\n".join(["```{container} thumbnails", *thumbnails, "```", "", *lines])


def problems() -> str:
    """Make the table of verification problems, from the docstrings of their functions."""
    from evidence.verification.study import PROBLEMS

    lines = ["| problem | file | what is compared |", "|---|---|---|"]
    for name, problem in PROBLEMS.items():
        text = " ".join(problem.__doc__.partition("\n\n")[0].split())
        lines.append(f"| {name} | {problem.__module__.rpartition('.')[2]}.py | {text} |")
    return "\n".join([*lines, ""])


def draw_examples(folder: Path) -> list[str]:
    """Draw every whole structure among the examples of docs/structures.md, as it starts, into
    `example-<name>.png` in `folder`; returns the files' names."""
    from deployable.campaign.pictures.drawing import write_structure
    from fpm import structures

    text, names = (ROOT / "docs/structures.md").read_text(encoding="utf-8"), []
    for example in re.findall(r"^```yaml\n(name: .*?)^```$", text, re.M | re.S):
        scene_type = structures.loads(example)
        names.append(f"example-{scene_type.name}.png")
        write_structure(scene_type.build(), folder / names[-1])
    return names


def make(app):
    """Make pictures and pages before the sources are read, and tell which structure's are made."""
    from key_tables import keys_page, table
    from sphinx.util.display import status_iterator

    from deployable.campaign.config.read import whole

    folder, moves = Path(app.srcdir) / "made", bool(int(app.config.gallery_moves))
    folder.mkdir(exist_ok=True)
    draw_examples(folder)
    work = "simulating structures, which compiles each set of kinds once, for minutes in all"
    summary = f"gallery, {work if moves else 'drawing structures'}: "

    def follow(found: dict[str, str]):
        return status_iterator(
            found.items(), summary, length=len(found), stringify_func=lambda item: item[0]
        )

    made = {"config-keys.md": table(whole()), "structure-keys.md": keys_page()}
    made["problems.md"] = problems()
    for name, text in (made | {"gallery.md": page(folder, moves, follow)}).items():
        target = folder / name
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def setup(app):
    """Listen for the builder."""
    sys.path.insert(0, str(ROOT))
    app.add_config_value("gallery_moves", "1", "env")
    app.connect("builder-inited", make)
    return {"parallel_read_safe": True}
