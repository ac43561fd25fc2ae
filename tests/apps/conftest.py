"""The command line, in this process and in one of its own."""

import dataclasses
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

MAIN = "from cutis.apps.main import main; main()"


@dataclasses.dataclass(frozen=True)
class Ended:
    """How a command ended: exit code, and what it said."""

    code: int
    out: str
    err: str


@pytest.fixture
def cutis(monkeypatch, capfd):
    """`cutis("info", path)` runs the command line in this process."""
    from cutis.apps.main import main

    def run(*arguments: object) -> Ended:
        monkeypatch.setattr(sys, "argv", ["cutis", *map(str, arguments)])
        capfd.readouterr()
        with pytest.raises(SystemExit) as end:
            main()
        said = capfd.readouterr()
        return Ended(int(end.value.code or 0), said.out, said.err)

    return run


@pytest.fixture
def process():
    """`process("info", path)` runs it in a process of its own; `before` is code to run first."""

    def run(*arguments: object, before: str = "", **environment: str) -> Ended:
        done = subprocess.run(
            [sys.executable, "-c", f"{before}\n{MAIN}", *map(str, arguments)],
            capture_output=True,
            text=True,
            encoding="utf-8",
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1", **environment},
            timeout=120,
        )
        return Ended(done.returncode, done.stdout, done.stderr)

    return run


@pytest.fixture(scope="session")
def estimated(write_face, face_mask, tmp_path_factory) -> Path:
    """out/ of `cutis estimate face.png`, the capture beside it; not to be written to."""
    from cutis.apps.estimate_file import Settings, Task, calibrated, estimate_file

    folder = tmp_path_factory.mktemp("estimated")
    face = write_face(folder)
    out = folder / "out"
    task = Task(face, None, out, Settings())
    estimate_file(task, calibrated([task], lambda *_: None), lambda *_: None)
    assert json.loads((out / "face.report.json").read_text("utf-8"))
    return out


@pytest.fixture
def maps(estimated, tmp_path) -> Path:
    """A copy of out/face.skin.exr with its capture where it belongs."""
    import shutil

    shutil.copytree(estimated.parent, tmp_path / "work")
    return tmp_path / "work" / "out" / "face.skin.exr"


def one_line(ended: Ended) -> str:
    """The one line of an error, after everything that an error must be was checked."""
    assert ended.code != 0
    assert ended.out == ""
    lines = ended.err.splitlines()
    assert len(lines) == 1, ended.err
    assert lines[0].startswith("cutis: ")
    assert "Traceback" not in ended.err
    assert "internal error" not in ended.err
    return lines[0]


@pytest.fixture(name="one_line")
def _one_line():
    return one_line


@pytest.fixture
def scheduler(tmp_path):
    """Address of a Dask scheduler of its own."""
    where = tmp_path / "scheduler.json"
    process = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port",
         "0", "--no-dashboard", "--no-show", "--scheduler-file", str(where)],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=tmp_path,
    )  # fmt: skip
    try:
        end = time.monotonic() + 60
        while not (where.is_file() and where.stat().st_size > 0):
            assert time.monotonic() < end, "no scheduler"
            time.sleep(0.01)
        yield json.loads(where.read_text())["address"]
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def worker(scheduler, tmp_path):
    """`worker()` starts a worker of one thread, a process; `before` is code to run first."""
    started: list[subprocess.Popen] = []

    def start(before: str = "") -> subprocess.Popen:
        code = f"{before}\nfrom distributed.cli.dask_worker import main; main()"
        started.append(subprocess.Popen(
            [sys.executable, "-c", code, scheduler, "--no-nanny", "--nthreads", "1",
             "--no-dashboard", "--local-directory", str(tmp_path)],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=tmp_path,
            env={**os.environ, "NUMBA_NUM_THREADS": "1"},
        ))  # fmt: skip
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.wait()
