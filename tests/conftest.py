"""Fixtures that every room's tests may use."""

import dataclasses
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import hypothesis
import pytest

# Property tests draw the same cases every time; `make fuzz` draws new ones, and says how to see a
# failure again.
hypothesis.settings.register_profile("same", derandomize=True, database=None, deadline=None)
hypothesis.settings.register_profile("new", deadline=None, print_blob=True)
hypothesis.settings.load_profile(os.environ.get("CUTIS_PROPERTIES", "same"))

# Workers of one run share the cores, so that their kernels do not wait for each other.
WORKERS = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
if WORKERS > 1:
    os.environ.setdefault("CUTIS_THREADS", str(max(1, (os.cpu_count() or 1) // WORKERS)))

# Before NumPy loads: on small matrices the threads of its BLAS wait for each other in a loop.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

ROOT = Path(__file__).parents[1]

SHARED_DATA = Path(os.environ.get("CUTIS_SHARED_DATA") or ROOT.parent / "shared" / "data")


def _skip_without_shared_data() -> None:
    if not SHARED_DATA.is_dir():
        pytest.skip(
            "the larger data is not here: put it in ../shared/data beside the repository, "
            "or name its folder in CUTIS_SHARED_DATA"
        )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks what can be seen: `shared` data that is used, and `property` tests."""
    for item in items:
        if "shared_data" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.shared)
        if hypothesis.is_hypothesis_test(getattr(item, "obj", None)):
            item.add_marker(pytest.mark.property)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Says last that nothing was rendered, where that is so."""
    skipped = terminalreporter.stats.get("skipped", [])
    count = sum("make setup-render" in str(report.longrepr) for report in skipped)
    if count:
        terminalreporter.write_line(
            f"{count} tests that render were skipped: `make setup-render` installs Blender"
        )


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("shared"):
        _skip_without_shared_data()


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of the larger data (spectra/, albedo/, mesh/); the test is skipped where absent."""
    _skip_without_shared_data()
    return SHARED_DATA


@pytest.fixture(scope="session")
def blender():
    """The Blender that users would get; tests that render are skipped without one."""
    from cutis.errors import CutisError
    from cutis.render.blender import find_blender

    try:
        return find_blender()
    except CutisError as error:
        if os.environ.get("BLENDER"):
            raise
        pytest.skip(f"{error} (or `make setup-render`)")


@pytest.fixture(scope="session")
def capture1() -> tuple[Path, Path]:
    """The example capture: (8-bit sRGB albedo, mask)."""
    folder = ROOT / "examples"
    return folder / "bioskin_capture1.jpg", folder / "bioskin_capture1_mask.jpg"


@pytest.fixture(scope="session")
def face_rgb():
    """(24, 32, 3) linear sRGB of skins whose melanin, blood and thickness vary over the image."""
    import numpy as np

    from cutis.albedo import albedo_space
    from cutis.optics import ALIAGA2022

    height, width = 24, 32
    y, x = np.mgrid[:height, :width]
    skins = np.stack(
        [
            0.01 + 0.04 * x / width,
            0.01 + 0.03 * y / height,
            60 + 40 * np.sin(x / 5) * np.cos(y / 7),
            np.full(x.shape, 0.7),
            np.full(x.shape, 0.7),
        ],
        axis=-1,
    )
    grain = 1 + 0.01 * np.random.default_rng(0).standard_normal((height, width, 1))
    rgb = (albedo_space(ALIAGA2022).rgb(skins) * grain).astype(np.float32)
    rgb.flags.writeable = False
    return rgb


@pytest.fixture(scope="session")
def face_mask():
    """(24, 32) mask: 0 in a frame of four texels, 0.5 in the next, 1 inside."""
    import numpy as np

    mask = np.zeros((24, 32), dtype=np.float32)
    mask[4:-4, 4:-4] = 0.5
    mask[5:-5, 5:-5] = 1.0
    mask.flags.writeable = False
    return mask


@pytest.fixture
def trusting(monkeypatch):
    """The default model with a σ that follows the colour; (model, function of what it knows)."""
    from dataclasses import replace

    import numpy as np

    from cutis.inverse import registry
    from cutis.maps import DEFAULT
    from cutis.optics import PARAMETERS

    width = np.array([p.high - p.low for p in PARAMETERS], dtype=np.float32)

    def to_trust(rgb):
        sigma = width * np.float32([0.004, 0.005, 0.1, 0.25, 0.3]) * (0.5 + rgb[:, 1:2])
        return np.concatenate([sigma, (rgb[:, :1] > 0.6).astype(np.float32)], axis=1)

    knowing = replace(registry.load_model(DEFAULT), to_trust=to_trust, prior_sigma=(0.2,) * 5)
    real = registry._ours
    monkeypatch.setattr(
        registry, "_ours", lambda name, how: knowing if name == knowing.name else real(name, how)
    )
    return knowing


STORED = {
    "png8": (".png", "uint8"),
    "png16": (".png", "uint16"),
    "tiff16": (".tif", "uint16"),
    "exr": (".exr", "float16"),
}
"""File formats in which an edit that changes nothing has to be bit for bit."""


@pytest.fixture(scope="session")
def write_face(face_rgb):
    """`write_face(folder, kind, alpha=False, name="face")` writes the face; returns its path."""
    import numpy as np

    from cutis.colour import LINEAR, SRGB
    from cutis.textures import Texture, write_texture

    def write(folder: Path, kind: str = "png8", alpha: bool = False, name: str = "face") -> Path:
        suffix, dtype = STORED[kind]
        space = LINEAR if suffix == ".exr" else SRGB
        count = 4 if alpha else 3
        blank = np.zeros((*face_rgb.shape[:2], count), dtype)
        if alpha:
            steps = np.linspace(0, 1, face_rgb.shape[1]) ** 2
            blank[..., 3] = steps if suffix == ".exr" else np.rint(steps * np.iinfo(dtype).max)
        texture = Texture(blank, tuple("RGBA"[:count]), space, associated=suffix == ".exr")
        path = folder / f"{name}{suffix}"
        everywhere = np.ones(face_rgb.shape[:2], bool)
        write_texture(texture.with_linear(face_rgb, everywhere), path)
        return path

    return write


@pytest.fixture(scope="session")
def write_envi():
    """`write_envi(path, values (H, W, n), interleave, dtype, …)` writes an ENVI cube.

    Wavelengths are 450, 500, … nm. `fields` replace those of the header; None leaves one out.
    """

    def write(path, values, interleave="bsq", dtype="<f4", ending=".img", offset=0, **fields):
        """NAME.hdr and its values; `fields` replace those of the header, None leaves one out."""
        import numpy as np

        wavelengths = 450 + 50.0 * np.arange(values.shape[2])
        kind = {"u1": 1, "i2": 2, "i4": 3, "f4": 4, "f8": 5, "u2": 12}[dtype[1:]]
        axes = {"bsq": (2, 0, 1), "bil": (0, 2, 1), "bip": (0, 1, 2)}.get(interleave, (0, 1, 2))
        data = np.ascontiguousarray(values.transpose(axes)).astype(dtype).tobytes()
        path.with_suffix(ending).write_bytes(bytes(offset) + data)
        header = {
            "description": "{made\n by a test}",
            "lines": values.shape[0], "samples": values.shape[1], "bands": values.shape[2],
            "header offset": offset, "data type": kind, "interleave": interleave,
            "byte order": int(dtype[0] == ">"), "wavelength units": "Nanometers",
            "wavelength": "{" + ",\n ".join(f"{lam:g}" for lam in wavelengths) + "}", **fields,
        }  # fmt: skip
        text = [f"{name} = {value}" for name, value in header.items() if value is not None]
        path.write_text("\n".join(["ENVI", *text, ""]), encoding="utf-8")
        return path

    return write


# the command line, in this process and in one of its own
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
    from cutis.jobs.estimate import EstimateJob
    from cutis.jobs.outcome import CaptureFiles

    folder = tmp_path_factory.mktemp("estimated")
    face = write_face(folder)
    out = folder / "out"
    EstimateJob((CaptureFiles(face),), out).run()
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
def scheduler_process(tmp_path):
    """A Dask scheduler of its own, as a process; its address is in scheduler.json."""
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
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def scheduler(scheduler_process, tmp_path) -> str:
    """Address of a Dask scheduler of its own."""
    return str(json.loads((tmp_path / "scheduler.json").read_text())["address"])


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
            env={**os.environ, "CUTIS_THREADS": "1"},
        ))  # fmt: skip
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.wait()
