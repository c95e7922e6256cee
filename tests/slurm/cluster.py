"""A Slurm cluster of three nodes on this machine, for tests: munge, slurmctld, a slurmd each,
loopback only.

    python tests/slurm/cluster.py up      needs root, and Debian's slurm-wlm and munge
    python tests/slurm/cluster.py down

It has no accounting, no cgroups, and one partition, `test`. /etc/slurm/slurm.conf links to its
configuration meanwhile, since programs that it starts do not get SLURM_CONF; another one that is
there already is left alone, and refused.
"""

from __future__ import annotations

import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

HOME = Path("/tmp/slurm-of-tests")
CONFIG, KEY = Path("/etc/slurm/slurm.conf"), Path("/etc/munge/munge.key")
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scancel", "scontrol", "squeue", "srun")
NODES = ("one", "two", "three")
PORT = 17300

TEXT = """\
ClusterName=tests
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
AuthType=auth/munge
SlurmUser=root
StateSaveLocation={home}/state
SlurmdSpoolDir={home}/spool-%n
SlurmctldPidFile={home}/slurmctld.pid
SlurmdPidFile={home}/slurmd-%n.pid
SlurmctldLogFile={home}/slurmctld.log
SlurmdLogFile={home}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
KillWait=3
MinJobAge=600
SchedulerParameters=sched_interval=2,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SlurmdParameters=config_overrides
{nodes}
PartitionName=test Nodes={names} Default=YES MaxTime=60 State=UP OverSubscribe=NO
"""


def missing() -> str:
    """Why a cluster cannot be had here; nothing where it can."""
    absent = [name for name in PROGRAMS if not find(name)]
    if absent:
        return f"{', '.join(absent)} not installed (apt-get install slurm-wlm munge)"
    if os.geteuid() != 0:
        return "only root can bring up a cluster"
    if CONFIG.exists() and not CONFIG.is_symlink():
        return f"{CONFIG} is of another cluster"
    return ""


def find(name: str) -> str | None:
    """The path of a program, some of which are for root."""
    return shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")


def up(cores: int = 1) -> None:
    """Start the cluster, and wait until its nodes are idle. Each has so many cores."""
    down()
    for folder in ("state", *(f"spool-{name}" for name in NODES)):
        (HOME / folder).mkdir(parents=True)
    nodes = [
        f"NodeName={name} NodeHostname={socket.gethostname()} NodeAddr=127.0.0.1 "
        f"Port={PORT + 1 + number} CPUs={cores} RealMemory=8000 State=UNKNOWN"
        for number, name in enumerate(NODES)
    ]
    text = TEXT.format(
        host=socket.gethostname(), port=PORT, home=HOME, nodes="\n".join(nodes),
        names=",".join(NODES),
    )  # fmt: skip
    (HOME / "slurm.conf").write_text(text, encoding="utf-8")
    CONFIG.parent.mkdir(exist_ok=True)
    CONFIG.symlink_to(HOME / "slurm.conf")
    _start_munge()
    _start("slurmctld")
    for name in NODES:
        start_node(name)
    _wait_for(lambda: told("sinfo", "-h", "-o", "%t %D") == f"idle {len(NODES)}", "idle nodes")


def down() -> None:
    """Stop everything that `up` started, and remove what it left."""
    for path in sorted(HOME.glob("*.pid")):
        _stop(path)
    if CONFIG.is_symlink():
        CONFIG.unlink()
    shutil.rmtree(HOME, ignore_errors=True)


def start_node(name: str) -> None:
    """Start a node's daemon."""
    _start("slurmd", "-N", name)


def stop_node(name: str) -> None:
    """End a node's daemon and all that it runs, as where its power fails."""
    _stop(HOME / f"slurmd-{name}.pid", signal.SIGKILL)
    for number in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = Path("/proc", number, "cmdline").read_bytes()
            environment = Path("/proc", number, "environ").read_bytes()
        except OSError:
            continue
        mine = f"SLURMD_NODENAME={name}".encode() in environment.split(b"\0")
        if mine or f"spool-{name}".encode() in command:
            os.kill(int(number), signal.SIGKILL)


def told(program: str, *arguments: str) -> str:
    """What a program of the cluster prints."""
    done = subprocess.run(
        [find(program), *arguments], capture_output=True, text=True, check=True, timeout=60
    )
    return done.stdout.strip()


def _start_munge() -> None:
    if not KEY.exists():
        KEY.parent.mkdir(exist_ok=True)
        KEY.write_bytes(secrets.token_bytes(128))
        KEY.chmod(0o400)
    folder = Path("/run/munge")
    folder.mkdir(exist_ok=True)
    if subprocess.run([find("munge"), "-n"], capture_output=True, check=False).returncode == 0:
        return  # one is there already
    # As root, who owns none of munge's folders: `--force` has it say so and go on.
    files = {"pid": HOME / "munged.pid", "log": HOME / "munged.log", "seed": HOME / "munged.seed"}
    _start(
        "munged", "--force", f"--pid-file={files['pid']}", f"--log-file={files['log']}",
        f"--seed-file={files['seed']}",
    )  # fmt: skip
    ready = [find("munge"), "-n"]
    _wait_for(lambda: subprocess.run(ready, capture_output=True).returncode == 0, "munge")


def _start(program: str, *arguments: str) -> None:
    """Start a daemon, which goes to the background by itself."""
    done = subprocess.run(
        [find(program), *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, check=False, timeout=60,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"{program} did not start: {done.stdout}")


def _stop(pid_file: Path, how: int = signal.SIGTERM) -> None:
    """End the process whose number is in a file, and wait for it."""
    try:
        number = int(pid_file.read_text())
        os.kill(number, how)
    except (OSError, ValueError):
        return
    deadline = time.monotonic() + 20
    while Path("/proc", str(number)).exists() and time.monotonic() < deadline:
        time.sleep(0.1)
    pid_file.unlink(missing_ok=True)


def _wait_for(state, what: str) -> None:
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        try:
            if state():
                return
        except (subprocess.SubprocessError, OSError):
            pass
        time.sleep(0.5)
    raise RuntimeError(f"no {what} within a minute; see the logs in {HOME}")


if __name__ == "__main__":
    if reason := missing():
        sys.exit(reason)
    {"up": up, "down": down}[sys.argv[1]]()
