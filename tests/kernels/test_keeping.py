"""Machine code between runs: never stale, never damaged, never in the way."""

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cutis.kernels import keeping
from cutis.kernels.keeping import DIGEST, GENERATIONS, sources

PACKAGE = Path(keeping.__file__).parents[1]
LAB = "import numpy as np\nfrom cutis.colour import lab\nprint(lab(np.full(3, 0.2))[0] > 51)\n"
RESULT = "True\n"


class Run:
    """Python in a process of its own, with its own caches; what it said."""

    def __init__(self, folder, code, source=PACKAGE.parent, **environment):
        base = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "CUTIS_"))}
        base |= {"HOME": str(folder / "home"), "TMPDIR": str(folder / "tmp"), "PYTHONPATH": ""}
        base |= {"XDG_CACHE_HOME": str(folder / "home" / "cache"), "PYTHONPATH": str(source)}
        done = subprocess.run(
            [sys.executable, "-P", "-c", code],
            env={k: v for k, v in {**base, **environment}.items() if v is not None},
            capture_output=True,
            text=True,
            timeout=120,
        )
        self.code, self.out, self.err = done.returncode, done.stdout, done.stderr


@pytest.fixture
def folder(tmp_path):
    """Without machine code."""
    for name in ("home", "tmp"):
        (tmp_path / name).mkdir()
    return tmp_path


@pytest.fixture(scope="module")
def once(tmp_path_factory) -> Path:
    """A folder in which LAB ran once."""
    whole = tmp_path_factory.mktemp("once")
    for name in ("home", "tmp"):
        (whole / name).mkdir()
    assert Run(whole, LAB).code == 0
    return whole


@pytest.fixture
def warm(once, tmp_path):
    """A copy of it."""
    shutil.copytree(once, tmp_path / "warm")
    return tmp_path / "warm"


def kept(folder: Path) -> list[Path]:
    return sorted(folder.rglob("*.code"))


def test_what_one_run_compiles_the_next_finds(warm):
    files = kept(warm / "home" / "cache" / "cutis")
    assert any("lab_kernel" in file.name for file in files)
    before = {file: file.stat().st_mtime_ns for file in files}
    misses = (
        "from cutis.kernels.difference_kernel import relative_lab\n"
        "print(sum(relative_lab.stats.cache_misses.values()))\n"
    )
    found = Run(warm, LAB + misses)
    assert (found.code, found.err) == (0, "")
    assert found.out == RESULT + "0\n"
    assert {file: file.stat().st_mtime_ns for file in kept(warm)} == before


def test_an_edit_of_what_a_kernel_calls_is_seen(folder):
    """In a copy of the package: the kernel's own module stays as it is."""
    copy = folder / "site" / "cutis"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__", "data"))
    (copy / "data").symlink_to(PACKAGE / "data")
    code = (
        "import numpy as np\n"
        "from cutis.transport import Layer, walk\n"
        "print(walk([Layer(1.0, 10.0)], photons=99).reflected)\n"
    )
    first, again = (Run(folder, code, copy.parent) for _ in range(2))
    assert first.out == again.out != ""
    callee = copy / "transport" / "philox.py"
    edited = callee.read_text("utf-8").replace("0xD2511F53", "0xD2511F55")
    assert edited != callee.read_text("utf-8")
    callee.write_text(edited, "utf-8")
    assert Run(folder, code, copy.parent).out != first.out
    assert Run(folder, code).out == first.out  # the package itself has not changed


@pytest.mark.parametrize("harm", ["truncated", "flipped", "emptied", "other"])
def test_damaged_files_are_made_anew(warm, harm):
    files = kept(warm)
    whole = {file: file.read_bytes() for file in files}
    for number, file in enumerate(files):
        content = bytearray(whole[file])
        if harm == "truncated":
            del content[len(content) // 2 :]
        elif harm == "flipped":
            for place in range(DIGEST, len(content), 97):
                content[place] ^= 0xFF
        elif harm == "emptied":
            content.clear()
        else:
            content = bytearray(whole[files[number - 1]][:DIGEST] + whole[file][DIGEST:])
        file.write_bytes(content)
    again = Run(warm, LAB)
    assert (again.code, again.out, again.err) == (0, RESULT, "")
    for file in files:
        assert (
            keeping.hashlib.sha256(file.read_bytes()[DIGEST:]).digest()
            == (file.read_bytes()[:DIGEST])
        )


NOWHERE = {"HOME": "/nonexistent", "XDG_CACHE_HOME": "/proc/no", "TMPDIR": "/proc/none"}


def test_without_a_place_it_works_and_says_so_once(folder):
    nowhere = "import tempfile\ntempfile.tempdir = '/proc/none'\n"
    found = Run(folder, nowhere + LAB, **NOWHERE)
    assert found.code == 0
    assert found.out == RESULT
    assert len(found.err.splitlines()) == 1
    assert found.err.startswith("cutis: compiled code cannot be kept in /proc/no")
    assert "NUMBA_CACHE_DIR" in found.err


@pytest.mark.parametrize("home", ["/nonexistent", None])
def test_without_a_home_it_is_kept_beside_temporary_files(folder, home):
    found = Run(folder, LAB, HOME=home, XDG_CACHE_HOME="/proc/no")
    assert (found.code, found.err) == (0, "")
    assert kept(folder / "tmp")


def test_the_folder_that_was_named_comes_first(folder):
    found = Run(folder, LAB, NUMBA_CACHE_DIR=str(folder / "named"))
    assert (found.code, found.err) == (0, "")
    assert kept(folder / "named") == kept(folder)


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="no owners here")
@pytest.mark.parametrize("mode", [0o775, 0o757])
def test_folders_that_others_may_write_to_are_not_believed(warm, mode):
    for file in kept(warm):
        payload = b"not machine code"
        file.write_bytes(keeping.hashlib.sha256(payload).digest() + payload)
        file.parent.chmod(mode)
    found = Run(warm, LAB)
    assert (found.code, found.out, found.err) == (0, RESULT, "")
    assert kept(warm / "tmp")


def test_what_numba_cannot_read_is_made_anew(warm):
    for file in kept(warm):
        payload = b"whole, but not machine code"
        file.write_bytes(keeping.hashlib.sha256(payload).digest() + payload)
    again = Run(warm, LAB)
    assert (again.code, again.out, again.err) == (0, RESULT, "")
    assert min(file.stat().st_size for file in kept(warm)) > 1000


def _closed_to_others() -> bool:
    """Whether another user cannot run this Python, or there is no way to become one."""
    if not hasattr(os, "getuid") or os.getuid() != 0:
        return True
    places = [Path(sys.base_prefix), *Path(sys.base_prefix).parents, *PACKAGE.parents]
    return any(place.stat().st_mode & 0o005 != 0o005 for place in places)


@pytest.mark.skipif(_closed_to_others(), reason="needs two users of this Python")
def test_another_users_read_only_package_and_cache(folder):
    """As a service does: no home, nothing writable but what root has prepared to be read."""
    for place in (folder, *folder.parents[:2]):
        place.chmod(0o755)
    named = {"NUMBA_CACHE_DIR": str(folder / "named")}
    first = Run(folder, LAB, **named)
    nobody = (
        "import os, tempfile\nos.setgroups([])\nos.setgid(65534)\nos.setuid(65534)\n"
        "tempfile.tempdir = '/proc/none'\n"
    )
    found = Run(folder, nobody + LAB, **NOWHERE, **named)
    assert (found.code, found.out, found.err) == (0, first.out, "")


def test_old_folders_go_and_nothing_else(folder):
    cache = folder / "home" / "cache" / "cutis"
    for age in range(GENERATIONS + 4):
        old = cache / f"code-{age:020x}"
        old.mkdir(parents=True)
        (old / "a.code").write_bytes(b"x")
    (cache / "code-00000000000000000001" / "thesis.txt").write_text("precious")
    for age in range(GENERATIONS + 4):
        os.utime(cache / f"code-{age:020x}", (10_000 + age, 10_000 + age))
    other = cache / "something else"
    other.mkdir()
    (other / "b.code").write_bytes(b"x")
    assert Run(folder, LAB).code == 0
    left = {place.name for place in cache.iterdir()}
    assert "something else" in left
    assert "code-00000000000000000000" not in left
    assert (cache / "code-00000000000000000001" / "thesis.txt").read_text() == "precious"
    assert f"code-{GENERATIONS + 3:020x}" in left
    assert len(left) == GENERATIONS + 2  # the one with the thesis, and what is not ours


@pytest.mark.parametrize(
    "setting",
    ["NUMBA_DISABLE_JIT=1", "NUMBA_NUM_THREADS=0", "NUMBA_THREADING_LAYER=nope", "CUTIS_THREADS=0",
     "NUMBA_OPT=fast"],
)  # fmt: skip
def test_wrong_settings_work_or_are_named_in_one_line(setting, process, one_line, tmp_path):
    name, _, value = setting.partition("=")
    ended = process(
        "spectrum", "--melanin", "0.02", "-o", tmp_path / "skin.csv", "-q", **{name: value}
    )
    if ended.code:
        assert name in one_line(ended)
    else:
        assert (tmp_path / "skin.csv").is_file()


def imported(module: str) -> dict[str, str]:
    """Names that a module takes from others of the package, and from which."""
    return {
        alias.asname or alias.name: node.module
        for node in ast.parse(sources()[module]).body
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("cutis")
        for alias in node.names
    }


def test_sources_are_all_that_kernels_are_made_of():
    """What a module of kernels imports from the package is a source too, so nothing is missed."""
    found = sources()
    makers = [
        name for name, text in found.items() if re.search(rb"@(compiled|on_all_cores)\(", text)
    ]
    assert len(makers) > 5
    for name in makers:
        for alias, module in imported(name).items():
            assert module in found or f"{module}.{alias}" in found
    for path in PACKAGE.rglob("*.py"):
        name = ".".join(("cutis", *path.relative_to(PACKAGE).with_suffix("").parts))
        if b"numba" in path.read_bytes() and "njit" in path.read_text("utf-8"):
            assert name in found
