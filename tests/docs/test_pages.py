"""Every command and snippet of README and docs is right, and run as far as it takes seconds."""

import re
import shlex
from pathlib import Path

import pytest
import yaml

import campaign
from campaign.cli import _parser, main
from campaign.config.check import load_config
from campaign.stages import STAGES
from evidence.registry import STUDIES
from fpm import structures
from fpm.structures import report

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [page for page in PAGES if "made" not in page.parts]
_BLOCK = re.compile(r"^( *)```(\w*)\n(.*?)^\1```$", re.M | re.S)

# Of other programs, and of ours what is no command to be typed as it stands.
OTHERS = (
    "git clone", "python3 -m venv", ". .venv/bin/activate", "pip install", "pre-commit", "pytest",
    ".ci/run", "sphinx-build", "python3.11 -m venv", "EXUDYN_PYTHON=", "cd deployable-intervals",
    "exudyn/bin/pip install", "elastica/bin/pip install", "python -m fpm.structures.table",
)  # fmt: skip


def blocks(page, *languages):
    """The listings of a page in one of these languages."""
    found = _BLOCK.findall(page.read_text(encoding="utf-8"))
    return [text for _, language, text in found if language in languages]


def commands(page):
    """The lines of listings that begin with a known program, and those in running text."""
    text = page.read_text(encoding="utf-8")
    listed = "\n".join(blocks(page, "", "sh")).replace("\\\n", " ")
    lines = [line.split(" #")[0].strip() for line in listed.splitlines()]
    lines += re.findall(r"`((?:python -m|snakemake) [^`\n]+)`", text)
    found = [part.strip() for line in lines for part in line.split("&&")]
    return sorted(
        {line for line in found if re.match(r"(python|snakemake|pip|git|pytest)\b", line)}
    )


CASES = [(page, line) for page in PAGES for line in commands(page)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder like the program's, with the results of a small campaign, which those of others
    stand for."""
    folder = tmp_path_factory.mktemp("checkout")
    for name in ("config", "docs", "Snakefile", "workflow"):
        (folder / name).symlink_to(ROOT / name)
    for name in ("first", "mine"):
        for text in blocks(ROOT / "docs" / f"{PAGE_OF[name]}.md", "yaml"):
            kind = "campaign" if text.startswith("campaign:") else "structure"
            (folder / FILES[name, kind]).write_text(text, encoding="utf-8")
    campaign.run(ROOT / "config/small.yaml", folder / "results", tell=lambda text: None)
    for other in ("paper", "first"):
        (folder / "results" / other).symlink_to(folder / "results/small")
    return folder


PAGE_OF = {"first": "first-campaign", "mine": "own-structure"}
FILES = {
    ("first", "campaign"): "first.yaml", ("mine", "structure"): "mine.yaml",
    ("mine", "campaign"): "my-campaign.yaml",
}  # fmt: skip


@pytest.mark.parametrize(("page", "line"), CASES, ids=[f"{p.stem}: {c}" for p, c in CASES])
def test_a_command_can_be_given(page, line, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    if line.startswith(OTHERS):
        return
    words = shlex.split(line)
    if words[0] == "snakemake":
        _check_snakemake(words[1:])
    elif words[:3] == ["python", "-m", "evidence"]:
        assert words[3] in {*STUDIES, "attack"} or words[3].isupper()
    else:
        assert words[:3] == ["python", "-m", "campaign"], line
        _check_campaign(words[3:])


def _check_snakemake(words):
    options = {"--configfile", "--report", "--force", "--unlock", "--config", "--cores"}
    for word, value in zip(words, [*words[1:], ""], strict=True):
        assert not word.startswith("--") or word in {*options, "--forcerun", "--dry-run"}, word
        if word == "--configfile" and value != "my.yaml":
            load_config([value])
    before = dict(zip(words[1:], words, strict=False))
    for target in words:
        if not target.startswith("-") and not before.get(target, "").startswith("--"):
            assert target in STUDIES or Path(target).is_file() or target == "benchmark", target


def _check_campaign(words):
    """Run what is quick; what has the name of a file to come, or takes long, is only parsed."""
    if any(word.isupper() or "|" in word or "<" in word for word in words):
        return  # a form, not a command
    if len(words) == 1 and words[0] != "keys":
        assert words[0] in {"new", "check", "run", "structure", "export", *STAGES}
        return  # a name, not a command
    words = [w for w in words if w != ">" and not w.startswith("docs/")]
    if words[0] == "attack":  # has its own parser
        with pytest.raises(SystemExit) as ended:
            main([*words, "--help"])
        assert ended.value.code == 0
    elif any(word in ("my.yaml", "mast.yaml") for word in words):
        _parser().parse_args(words)
    elif words[0] in ("check", "structure", "keys", "report") or (
        words[0] == "export" and words[1].startswith("results/")
    ):
        assert main([*words, *(["--frames", "3"] if words[0] == "export" else [])]) == 0
    else:
        options = _parser().parse_args(words)
        name = getattr(options, "what", None) or getattr(options, "file", None)
        assert name is None or Path(name).is_file(), name


# A snippet that defines a class or a function of a kernel is a form; `named` is run.
SNIPPETS = [
    (page, text)
    for page in PAGES
    for text in blocks(page, "python")
    if "def " not in text or "open_mfdataset" in text
]


@pytest.mark.parametrize(
    ("page", "text"), SNIPPETS, ids=[f"{p.stem}: {t.splitlines()[0]}" for p, t in SNIPPETS]
)
def test_a_snippet_runs(page, text, folder, monkeypatch):
    monkeypatch.chdir(folder)
    if "open_mfdataset" in text:
        pytest.importorskip("dask", reason="not installed")
    text = text.replace('sel(response="angle")', "isel(response=0)")  # of the campaign stood for
    exec(compile(text, page.name, "exec"), {})


def test_the_structure_and_campaigns_of_the_pages_are_right(folder, monkeypatch):
    monkeypatch.chdir(folder)
    mine = structures.load("mine.yaml")
    assert report.mobility(mine.build()).degrees == 2
    for name in ("first.yaml", "my-campaign.yaml"):
        assert load_config([name]).name == yaml.safe_load(Path(name).read_text())["campaign"]


@pytest.mark.parametrize("page", PAGES, ids=[page.stem for page in PAGES])
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
        if not target.startswith(("http", "made/")):
            assert (page.parent / target).exists(), target


@pytest.mark.slow
def test_the_answer_of_the_first_campaign_is_what_the_page_says(folder, monkeypatch):
    """Numbers in the text, and the closed form of a rigid panel, to 0.1 % (it bends a little)."""
    import numpy as np

    monkeypatch.chdir(folder)
    bounds = campaign.run("first.yaml", folder / "other", figures=False, tell=lambda text: None)
    last = bounds.sel(response="angle").isel(time=-1)

    def angle(k, mass):
        return np.pi * (1 - np.cos(3 * np.sqrt(3 * k / (mass * (1 + 0.1**2 / 4)))))

    found = last["lower"].item(), last["upper"].item()
    np.testing.assert_allclose(found, [angle(0.095, 1.02), angle(0.105, 0.98)], rtol=1e-3)
    page = (ROOT / "docs/first-campaign.md").read_text(encoding="utf-8")
    assert f"{found[0]:.3f} and {found[1]:.3f} rad" in page
    assert (
        f"{angle(0.095, 1.02):.3f} rad with" in page
        and f"{angle(0.105, 0.98):.3f} rad with" in page
    )
