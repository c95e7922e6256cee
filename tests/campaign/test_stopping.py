"""Ctrl-C ends a shell's run at once."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys

import pytest

from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import Folder
from deployable.campaign.runs.progress import end_on_ctrl_c
from deployable.campaign.stages import STAGES
from fpm.files.seals import _host


@pytest.fixture
def interrupts():
    """SIGINT as Python starts with it, and after the test as it was."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_the_command_is_there_before_what_reads_the_number_of_threads():
    code = """if True:
        import os, sys
        os.environ.pop("OMP_NUM_THREADS", None)
        class Watch:
            def find_spec(self, name, path=None, target=None):
                if name == "numpy":
                    sys.exit(os.environ.get("OMP_NUM_THREADS", "any"))
        sys.meta_path.insert(0, Watch())
        import deployable.__main__, deployable.campaign.cli
    """
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert (ended.returncode, ended.stderr) == (1, "1\n")


def test_ctrl_c_stays_ignored_where_it_is(interrupts):
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_on_ctrl_c()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_whoever_reads_the_words_may_stop_reading(unbuffered):
    command = [sys.executable, "-m", "deployable", "new", "--starts"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    environment = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    with subprocess.Popen(command, **pipes, env=environment) as process:
        process.stdout.close()  # as `head` does
        assert process.stderr.read() == b""
    assert process.returncode == 1


@pytest.mark.parametrize(
    ("output", "status", "told"), [(">/dev/full", 1, "error: [Errno 28]"), (">&-", 0, "")]
)
def test_an_output_that_takes_no_words_is_told_in_one_line(output, status, told):
    command = f"{shlex.quote(sys.executable)} -m deployable new --starts {output}"
    ended = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert ended.returncode == status and ended.stderr.startswith(told)
    assert ended.stderr.count("\n") == bool(told)


def test_every_stage_sweeps_what_dead_processes_left_in_any_folder(tmp_path):
    """A run that was killed while it wrote the motions of the page, say, and goes on without it."""
    with subprocess.Popen([sys.executable, "-c", ""]) as dead:
        pass
    folder = Folder(tmp_path / "mine")
    left = []
    for place in folder.stage_folders:
        place.mkdir(parents=True, exist_ok=True)
        left.append(place / f".one.{_host()}-{dead.pid}.part.nc")
        left[-1].touch()
    with pytest.raises((CampaignError, OSError)):  # there is no plan
        STAGES["simulate"].run(folder, print, jobs=None)
    assert not [path for path in left if path.exists()]
