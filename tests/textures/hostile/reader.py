"""Reads files in a process of its own, and says what became of it.

`Reader` is the near end. Run as a program this module is the far end: it takes lines
"how<TAB>path", reads, and answers one line of JSON each. Whatever a decoder prints is caught.
"""

import contextlib
import ctypes
import hashlib
import json
import os
import resource
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

MOST_MEMORY = 1.5 * 2**30
ADDRESSES = 24 * 2**30  # so that no reader brings the machine down
SECONDS = 10.0
_LONGEST = 600  # characters of a message
_COMMAND_SECONDS = 120.0  # the whole command, its start among it, on a busy machine


@dataclass
class Outcome:
    """What became of one file.

    `findings` say what must not happen: "crash …", "hang", "memory …", "traceback …", "printed …",
    "partial output …". `results` are by kind of reading: a digest of what was read, or the error.
    """

    findings: list[str] = field(default_factory=list)
    results: dict[str, str] = field(default_factory=dict)
    good: dict[str, bool] = field(default_factory=dict)
    memory: int = 0
    seconds: float = 0.0


class Reader:
    """A process that reads; started again when it dies or hangs."""

    def __init__(self, how: str = "read") -> None:
        """`how` is "read" (by the library) or "command" (by the command line)."""
        self._how = how
        self._process: subprocess.Popen[str] | None = None

    @property
    def pid(self) -> int:
        """The far end's process."""
        return self._started().pid

    def _started(self) -> subprocess.Popen[str]:
        if self._process is None or self._process.poll() is not None:
            self._process = subprocess.Popen(
                [sys.executable, "-W", "ignore", __file__, self._how],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            )  # fmt: skip
            self._answer(120)
        return self._process

    def _answer(self, seconds: float) -> str | None:
        """A line of the far end; "" where it died, None where it takes too long."""
        process = self._process
        assert process is not None
        assert process.stdout is not None
        with selectors.DefaultSelector() as selector:
            selector.register(process.stdout, selectors.EVENT_READ)
            return process.stdout.readline() if selector.select(seconds) else None

    def read(self, path: Path) -> Outcome:
        """Reads a file in all ways."""
        process = self._started()
        assert process.stdin is not None
        start = time.monotonic()
        print(path, file=process.stdin, flush=True)
        line = self._answer(SECONDS if self._how == "read" else _COMMAND_SECONDS)
        seconds = time.monotonic() - start
        if line is None:
            self.close(kill=True)
            return Outcome([f"hang {seconds:.0f} s"], seconds=seconds)
        if not line:
            code = process.wait()
            self.close()
            name = signal.Signals(-code).name if code < 0 else f"exit {code}"
            return Outcome([f"crash {name}"], seconds=seconds)
        outcome = Outcome(**json.loads(line))
        outcome.seconds = seconds
        return outcome

    def close(self, kill: bool = False) -> None:
        """Ends the process."""
        process, self._process = self._process, None
        if process is None:
            return
        if kill:
            process.kill()
        for pipe in (process.stdin, process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()
        process.wait()


class _Terminal:
    """What this process and its libraries print, caught in a file."""

    def __init__(self) -> None:
        self._caught = tempfile.TemporaryFile()  # noqa: SIM115
        for stream in (1, 2):
            os.dup2(self._caught.fileno(), stream)
        self._flush: Callable[[Any], int] = ctypes.CDLL(None).fflush

    def said(self) -> str:
        """All since the last call."""
        sys.stdout.flush(), sys.stderr.flush()
        self._flush(None)
        self._caught.seek(0)
        text = self._caught.read()
        self._caught.truncate(0)
        self._caught.seek(0)
        return text.decode(errors="replace")


def _reset_peak() -> None:
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def _peak() -> int:
    with contextlib.suppress(OSError, StopIteration, ValueError):
        lines = Path("/proc/self/status").read_text().splitlines()
        return int(next(line for line in lines if line.startswith("VmHWM")).split()[1]) * 1024
    return 0


def _texture(path: Path) -> Any:
    from cutis.textures import read_texture

    texture = read_texture(path)
    assert texture.linear().shape == (*texture.shape, 3)
    return texture.pixels


def _mask(path: Path) -> Any:
    from cutis.textures import read_mask
    from cutis.textures.decoding import Decoder

    with Decoder(path) as source:
        frame = source.frame
    return read_mask(path, frame)


def _labels(path: Path) -> Any:
    from cutis.textures import LabelFile
    from cutis.textures.decoding import Decoder

    with Decoder(path) as source:
        frame = source.frame
    with LabelFile(path, frame) as file:
        return file.rows(slice(None))


def _skin(path: Path) -> Any:
    import numpy as np

    from cutis.maps import load_maps

    skin = load_maps(path)
    return np.stack([skin.map("melanin"), skin.map("oxygenation")])


def _table(path: Path) -> Any:
    import numpy as np

    from cutis.spectra import open_table

    table = open_table(path)
    factor, _ = table.scale(np.ones(len(table.wavelengths), bool))
    return table.values * factor


def _cube(path: Path) -> Any:
    from cutis.spectra import open_cube
    from cutis.spectra.reflectance import fraction_scale

    with open_cube(path) as cube:
        fraction_scale(cube.path, cube.sample(), cube.scale)
        return cube.rows(slice(0, 64))


def _list(path: Path) -> Any:
    from cutis.spectra.wavelengths import read_wavelengths

    return read_wavelengths(path)[0]


def _skins(path: Path) -> Any:
    from cutis.jobs.spectrum import read_skins
    from cutis.optics import RARE_NAMES

    return read_skins(path, RARE_NAMES)[2]


def _space(path: Path) -> Any:
    """Spaces of a configuration, or of the one beside a look-up table."""
    import numpy as np

    from cutis.errors import CutisError
    from cutis.textures import ocio

    config = path if path.suffix == ".ocio" else path.with_name("show.ocio")
    for cache in (ocio.ocio_space, ocio._config):
        cache.cache_clear()
    steps, found = np.linspace(0, 1, 12, dtype=np.float32).reshape(4, 3), []
    for name in ("power", "group", "cam"):
        try:
            space = ocio.ocio_space(name, str(config))
        except CutisError as error:
            if path.name in str(error) or name in str(error):  # one file or the other is named
                raise CutisError(f"{path.name}: {error}") from error
            raise
        found.append(steps if space is None else space.to_linear_srgb(steps))
    return np.stack(found)


def _report(path: Path) -> Any:
    """A report beside maps, by those that go on after a stop: damaged, it is no report."""
    import numpy as np

    from cutis.errors import CutisError
    from cutis.jobs.job import tell
    from cutis.jobs.results import look
    from cutis.maps.lost import given_calibration
    from cutis.optics import MEASURED2026

    found = look(path, {"white": tell("none")})
    with contextlib.suppress(CutisError):
        given_calibration(str(path), MEASURED2026)
    return np.array([found.complete])


def _look(path: Path) -> Any:
    import numpy as np

    from cutis.looks import Look

    return np.frombuffer(Look.load(path).model_dump_json().encode(), np.uint8)


def _journal(path: Path) -> Any:
    """The note of an interrupted simulation whose result is to be beside this file."""
    import shutil

    import numpy as np

    from cutis.albedo.simulation import SkinSimulation, Walks
    from cutis.errors import CutisError
    from cutis.jobs.journal import Journal
    from cutis.optics import MEASURED2026

    result = path.with_name(f"{path.stem}.csv")
    parts = result.with_name(result.name + ".parts")
    parts.mkdir()
    try:
        shutil.copy(path, parts / "run.json")
        skins = np.array([[0.02, 0.02, 80, 0.7, 0.7]])
        simulation = SkinSimulation(skins, Walks(MEASURED2026, photons=10))
        return np.array(Journal(simulation, result).missing())
    except CutisError as error:
        raise CutisError(f"{path.name}: {error}") from error
    finally:
        shutil.rmtree(parts)


_IMAGE = {"texture": _texture, "mask": _mask, "labels": _labels}
WAYS: dict[str, dict[str, Callable[[Path], Any]]] = {
    **dict.fromkeys((".png", ".jpg", ".tif", ".tx", ".dpx", ".psd"), _IMAGE),
    ".exr": {**_IMAGE, "maps": _skin, "cube": _cube},
    **{key: {"table": _table, "list": _list, "skins": _skins} for key in (".csv", ".tsv", ".txt")},
    **{key: {"cube": _cube, "table": _table} for key in (".hdr", ".img")},
    ".sli": {"table": _table},
    ".npy": {"cube": _cube, "list": _list},
    ".json": {"report": _report, "look": _look, "journal": _journal},
    **{key: {"space": _space} for key in (".ocio", ".cube", ".spi1d", ".spi3d", ".clf", ".csp")},
}
"""How files are read, by their extensions: each way gives an array, or raises CutisError in one
line. Other parsers of foreign bytes are to be added here, and their seeds to `seeds.py`.
"""


def command_for(path: Path, out: Path) -> list[str]:
    """The command that a user would give such a file; its results go to the folder `out`."""
    if path.name.endswith(".skin.exr"):
        return ["info", str(path)]
    if path.suffix in (".csv", ".tsv", ".txt"):
        return ["fit", str(path)]
    if path.suffix == ".json":
        return ["spectrum", str(path)]  # edits with looks need maps; nothing of it is a table
    if path.suffix in (".hdr", ".img", ".sli", ".npy"):
        return ["fit", str(path), "-o", str(out / "x.skin.exr")]
    if path.suffix in WAYS and WAYS[path.suffix] is not WAYS[".ocio"]:
        return ["estimate", str(path), "-o", str(out)]
    config = path if path.suffix == ".ocio" else path.with_name("show.ocio")
    return ["estimate", "face.png", "--ocio", str(config), "--colorspace", "cam", "-o", str(out)]


def _read(path: Path) -> Outcome:
    from cutis.errors import CutisError

    outcome = Outcome()
    for name, way in WAYS[path.suffix].items():
        try:
            values = way(path)
            outcome.results[name] = hashlib.sha256(values.tobytes()).hexdigest()
            outcome.good[name] = True
            del values
        except CutisError as error:
            outcome.results[name] = str(error)
            outcome.good[name] = False
            if len(str(error).splitlines()) != 1 or not str(error).isprintable():
                outcome.findings.append(f"lines {error}")
            elif len(str(error)) > _LONGEST:
                outcome.findings.append(f"long {error}")
            elif path.stem not in str(error):  # of a pair the other may be named
                outcome.findings.append(f"no name {error}")
        except BaseException as error:
            outcome.findings.append(f"traceback {name}: {type(error).__name__}: {error}")
    return outcome


def _command(path: Path) -> Outcome:
    """The whole command in a fork, with a folder of its own."""
    outcome = Outcome()
    with tempfile.TemporaryDirectory() as name:
        out, said, told = Path(name) / "out", Path(name) / "1", Path(name) / "2"
        child = os.fork()
        if child == 0:
            from cutis.apps.main import main

            for stream, file in ((1, said), (2, told)):
                os.dup2(os.open(file, os.O_CREAT | os.O_WRONLY | os.O_APPEND, 0o600), stream)
            sys.argv = ["cutis", *command_for(path, out)]
            if sys.argv[1] == "fit":
                out.mkdir()
            code = 99
            try:
                main()
            except SystemExit as stop:
                code = stop.code if isinstance(stop.code, int) else int(stop.code is not None)
            except BaseException:
                import traceback

                traceback.print_exc()
            finally:
                sys.stdout.flush(), sys.stderr.flush()
                ctypes.CDLL(None).fflush(None)
                os._exit(code)
        _, status = os.waitpid(child, 0)
        code, errors = os.waitstatus_to_exitcode(status), told.read_text(errors="replace")
        files = sorted(file.name for file in out.iterdir()) if out.is_dir() else []
        outcome.results["command"] = errors if code else ", ".join(files)
        outcome.good["command"] = code == 0
        if code not in (0, 1):
            outcome.findings.append(f"command exit {code}: {errors[:300]}")
        lines = errors.splitlines()
        if any(not line.isprintable() for line in lines) or (
            code and (len(lines) != 1 or not errors.startswith("cutis: "))
        ):
            outcome.findings.append(f"printed {errors[:300]!r}")
        if code and (files or said.read_text(errors="replace")):
            outcome.findings.append(f"partial output {files}")
        if any(".partial" in file for file in files):
            outcome.findings.append(f"left over {files}")
        reports = [file for file in files if file.endswith(".report.json")]
        for report in reports:
            listed = json.loads((out / report).read_text())["files"]
            if sorted([*listed, report]) != files:
                outcome.findings.append(f"partial output {files}")
    return outcome


def _serve(how: str) -> None:
    answers = os.fdopen(os.dup(1), "w")
    terminal = _Terminal()
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    import cutis.maps
    import cutis.textures

    if how == "command":
        import cutis.apps.main
        import cutis.jobs.estimate
        import cutis.jobs.fit

        cutis.maps.load_model()  # imported, nothing run: a fork cannot take threads on
    read = _read if how == "read" else _command
    print("ready", file=answers, flush=True)
    for line in sys.stdin:
        _reset_peak()
        outcome = read(Path(line.rstrip("\n")))
        outcome.memory = _peak()
        said = terminal.said()
        if said:
            outcome.findings.append(f"printed {said[:300]!r}")
        if outcome.memory > MOST_MEMORY:
            outcome.findings.append(f"memory {outcome.memory / 2**30:.1f} GiB")
        print(json.dumps(outcome.__dict__), file=answers, flush=True)


if __name__ == "__main__":
    _serve(sys.argv[1])
