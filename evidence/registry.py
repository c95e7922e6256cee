"""The studies: what each is about, which code it judges, and which files it leaves.

Read by the workflow as well, so that this module imports nothing heavy."""

from dataclasses import dataclass
from pathlib import Path

from evidence.tradeoff.measure.cases import CASES
from evidence.tradeoff.measure.tolerance_cases import ACCURACY_CASES
from fpm.kernels import sources

ROOT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Study:
    """One study.

    text: a line for those who wait; uses: folders and files, beside the solver, whose code decides
    what is measured; parts: measured by a process of their own each, side by side (without them,
    one process does all); exclusive: it times things, so that nothing should run beside it; quick:
    it has a quick form."""

    name: str
    text: str
    uses: tuple[str, ...]
    parts: tuple[str, ...] = ()
    exclusive: bool = False
    quick: bool = False

    def measuring_code(self) -> str:
        """Digest of the code that decides what is measured."""
        return digest("fpm", "evidence/linkage", *self.uses)

    def code(self) -> list[str]:
        """Digests of the code that decides what the study leaves, beside its measured parts."""
        files = (f"evidence/{name}.py" for name in ("rows", "results"))
        report_digest = digest(*files, f"evidence/{self.name}")
        return [report_digest] if self.parts else [report_digest, self.measuring_code()]


def digest(*places: str) -> str:
    """Digest of the source files in folders, and of single files, below the root."""
    return sources.digest(*(ROOT / place for place in places))


EXTREMES = (
    "stable-step", "materials", "sections", "lengths", "stiffnesses", "starts", "durations",
    "damping",
)  # fmt: skip

STUDIES = {
    study.name: study
    for study in (
        Study(
            "verification",
            "Comparing the solver with closed forms and published results",
            uses=("evidence/verification",),
            quick=True,
        ),
        Study(
            "extremes",
            "Running the linkage at the ends of its parameters' ranges",
            uses=("evidence/extremes",),
            parts=EXTREMES,
        ),
        Study(
            "accuracy",
            "Measuring what meshes, steps and lumpings cost and get wrong",
            uses=("evidence/accuracy",),
        ),
        Study(
            "tradeoff",
            "Putting error against cost",
            uses=(
                "deployable/intervals",
                "deployable/campaign/config",
                "deployable/campaign/plan",
                "deployable/campaign/answers/discretization.py",
                "evidence/tradeoff/measure",
            ),
            parts=(
                *(case.name for case in CASES),
                *(f"asked-{case.name}" for case in ACCURACY_CASES),
            ),
        ),
        Study(
            "search",
            "Searching bounds of quantities that are known",
            uses=("deployable",),
            parts=("carts", "slides", "chains", "fractions"),
            quick=True,
        ),
        Study(
            "measured",
            "Narrowing boxes by measured curves whose hidden values are known, and a real arm's",
            uses=(
                "deployable/intervals",
                "deployable/campaign/answers/measured.py",
                "deployable/campaign/config/measured.py",
                "evidence/measured",
            ),
            parts=("truths", "lacks", "arm-viscous", "arm-dry", "arm-air", "two-arms"),
            quick=True,
        ),
        Study(
            "scaling",
            "Timing scissor masts of 1 to 100 units",
            uses=("evidence/scaling", "evidence/benchmark"),
            exclusive=True,
            quick=True,
        ),
        Study(
            "calibration",
            "Fitting K_F to the paper's two numbers",
            uses=("deployable/intervals", "evidence/calibration"),
            parts=("default", "meshes", "starts", "supports"),
        ),
        Study(
            "benchmark",
            "Measuring the solver, the workflow and, where it is installed, Exudyn",
            uses=("evidence/benchmark",),
            exclusive=True,
            quick=True,
        ),
    )
}
