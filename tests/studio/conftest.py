"""A small face, and the studio as people start it: a process of its own, and its address."""

import contextlib
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest
from PIL import Image

from cutis.studio import Opening, Workshop

ROOT = Path(__file__).parents[2]
CAPTURE = ROOT / "examples" / "bioskin_capture1.jpg"
PROGRAM = "from cutis.apps.main import main; main()"
BOX = (780, 1180, 1020, 1380)
"""A part of the example capture, left, top, right, bottom: cheek and nose, 240 × 200."""


def small_face(folder: Path, name: str = "face.png", box: tuple[int, ...] = BOX) -> Path:
    """A crop of the example capture as a PNG."""
    path = folder / name
    with Image.open(CAPTURE) as picture:
        picture.crop(box).save(path)
    return path


@dataclass
class Running:
    """A studio that runs: its process, and the parts of its address."""

    process: subprocess.Popen[str]
    folder: Path
    port: int
    token: str
    said: str = ""

    @property
    def site(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def address(self) -> str:
        return f"{self.site}/?token={self.token}"

    @property
    def cookie(self) -> str:
        return f"cutis-{self.port}={self.token}"


def start(folder: Path, *arguments: str) -> Running:
    """Starts the studio in a folder and waits for its address."""
    environment = {**os.environ, "CUTIS_THREADS": os.environ.get("CUTIS_THREADS", "2")}
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, "studio", "--no-browser", *arguments],
        cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    line, said = process.stdout.readline(), ""
    while line.startswith("warning"):
        line, said = process.stdout.readline(), said + line
    if not line.startswith("http://127.0.0."):
        process.kill()
        raise AssertionError(line + process.stdout.read())
    host, token = line.strip().removeprefix("http://").split("/?token=")
    return Running(process, folder, int(host.rpartition(":")[2]), token, said)


def stop(running: Running) -> None:
    running.process.terminate()
    with contextlib.suppress(subprocess.TimeoutExpired):
        running.process.wait(20)
    if running.process.poll() is None:
        running.process.kill()
        running.process.wait()
    assert running.process.stdout is not None
    running.process.stdout.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a small face, and a secret beside it."""
    found = tmp_path_factory.mktemp("studio")
    inside = found / "faces"
    inside.mkdir()
    small_face(inside)
    (found / "secret.png").write_bytes((inside / "face.png").read_bytes())
    return inside


@pytest.fixture(scope="module")
def running(folder):
    """The studio on a small face."""
    found = start(folder, "face.png")
    yield found
    stop(found)


@pytest.fixture(scope="module")
def workshop(tmp_path_factory):
    """A small face at work, maps there."""
    face = small_face(tmp_path_factory.mktemp("workshop"))
    found = Workshop(Opening(face))
    found.estimate()
    yield found
    found.close()


def until(true, seconds: float = 30.0) -> None:
    """Waits until something is true."""
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "it did not become true"
        time.sleep(0.02)
