"""What all commands have in common."""

import os
import signal
import subprocess
import sys
import time

import pytest

import cutis as package
from cutis.apps.main import app

COMMANDS = sorted(command.name for command in app.registered_commands)


def test_the_commands():
    assert COMMANDS == [
        "bench", "check", "demo", "edit", "estimate", "export", "fit", "info", "render",
        "simulate", "spectrum", "studio", "train",
    ]  # fmt: skip


def test_version(cutis):
    ended = cutis("--version")
    assert (ended.code, ended.out, ended.err) == (0, f"cutis {package.__version__}\n", "")


@pytest.mark.parametrize("arguments", [[], ["--help"], ["-h"], *([c, "--help"] for c in COMMANDS)])
def test_help_has_an_example(arguments, cutis):
    ended = cutis(*arguments)
    assert ended.code == 0
    assert ended.err == ""
    command = arguments[0] if len(arguments) > 1 else ""
    assert f"Example: cutis {command}" in ended.out


def test_help_is_light(process):
    """No package that takes long to import."""
    before = (
        "import atexit, sys\n"
        "slow = 'torch numba scipy matplotlib colour OpenImageIO.OpenImageIO_'.split()\n"
        "atexit.register(lambda: print('LOADED', *[n for n in slow if n in sys.modules]))"
    )
    ended = process("--help", before=before)
    assert ended.code == 0
    assert ended.out.splitlines()[-1] == "LOADED"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["estimate"], "Missing argument"),
        (["paint"], "No such command 'paint'"),
        (["edit", "a.exr", "-o", "b.png", "--freckles", "x2"], "No such option: --freckles"),
        (["edit", "a.exr"], "Missing option"),
        (["spectrum", "--melanin", "dark"], "Invalid value for '--melanin'"),
        (["train", "smoke", "--epochs", "0"], "Invalid value for '--epochs'"),
        (["--sing"], "No such option: --sing"),
    ],
)
def test_usage_errors_are_one_line_that_says_where_help_is(arguments, message, cutis, one_line):
    ended = cutis(*arguments)
    line = one_line(ended)
    assert ended.code == 2
    assert message in line
    command = f"cutis {arguments[0]}" if arguments[0] in COMMANDS else "cutis"
    assert line.endswith(f"; see {command} --help")


def test_errors_of_a_process_are_one_line_too(process, one_line, tmp_path):
    """Nothing is added by the libraries when the process ends."""
    (tmp_path / "face.png").write_bytes(b"\x89PNG\r\n\x1a\nnot really")
    assert "face.png" in one_line(process("estimate", tmp_path / "face.png", "-o", tmp_path))
    one_line(process("estimate", tmp_path / "none.exr", "-o", tmp_path))
    assert [path.name for path in tmp_path.iterdir()] == ["face.png"]


def test_terminals_without_the_letters(process, maps):
    ended = process("info", maps, PYTHONIOENCODING="ascii")
    assert ended.code == 0
    assert ended.err == ""
    assert "?m" in ended.out  # µm


def test_names_of_files_are_printed_as_they_are(cutis, maps, tmp_path):
    """Not as markup, not wrapped."""
    folder = (
        tmp_path / "a [bold] :smile: folder whose name is longer than a terminal is wide, really"
    )
    folder.mkdir()
    ended = cutis("edit", maps, "--melanin", "x1.1", "-o", folder / "tanned.png")
    assert ended.code == 0, ended.err
    assert f"wrote {folder / 'tanned.png'}\n" in ended.out


def test_a_reader_that_leaves_is_no_error():
    code = "from cutis.apps.main import main; main()"
    with subprocess.Popen(
        [sys.executable, "-c", code, "spectrum"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        process.stdout.close()
        err = process.stderr.read().decode()
    assert "Traceback" not in err
    assert "internal error" not in err


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_with_one_line_and_no_partial_file(capture1, tmp_path):
    face, mask = capture1
    out = tmp_path / "out"
    code = "from cutis.apps.main import main; main()"
    arguments = ["estimate", face, "--mask", mask, "--white", "auto", "-o", out]
    with subprocess.Popen(
        [sys.executable, "-c", code, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        deadline = time.monotonic() + 60
        while not out.exists() and time.monotonic() < deadline:
            time.sleep(0.02)
        time.sleep(0.3)  # now it is in the middle of writing
        process.send_signal(signal.SIGINT)
        said, err = process.communicate(timeout=60)
    assert err.splitlines()[-1] == "cutis: interrupted; files already written are whole"
    assert (process.returncode, said) == (130, "")
    assert not out.exists()
