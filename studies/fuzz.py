"""Damages small files of every kind and reads them: nothing may crash, hang or print.

    python -m studies.fuzz --count 10000 --seed 1
    python -m studies.fuzz --count 3000 --only .npy --only .csv

Pictures go through `read_texture`, `read_mask`, `LabelFile` and, where they are OpenEXR, the
readers of maps and cubes; tables, lists, skins, ENVI, NPY and configurations of OpenColorIO through
theirs (`tests/textures/hostile/reader.py` lists the ways), in a process of its own that may die of
it; every fiftieth through the command that a user would give. What goes wrong is kept in the folder
`--findings`, as a file and a line in findings.txt. Ends in 1 if anything did.
"""

import argparse
import json
import queue
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path
from random import Random

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests" / "textures"), str(ROOT / "src")]

from hostile.mutations import mutate  # noqa: E402
from hostile.reader import Outcome, Reader  # noqa: E402
from hostile.seeds import all_seeds  # noqa: E402

COMMANDED = 50


PICTURES = (".png", ".jpg", ".tif", ".tx", ".exr", ".dpx", ".psd")
LOOKUPS = (".ocio", ".cube", ".spi1d", ".spi3d", ".clf", ".csp")
PAIRED = (".hdr", ".img", ".sli", ".npy", *LOOKUPS)


WARM = "import sys, tempfile; from cutis.apps.main import main; "
WARM += "sys.argv[1:] = ['estimate', sys.argv[1], '-q', '-o', tempfile.mkdtemp()]; main()"
"""Compiles what commands need before anything is timed."""


class Run:
    """Counts of one run, and where its findings go."""

    def __init__(self, findings: Path) -> None:
        self.folder = findings
        self.formats: Counter[str] = Counter()
        self.damages: Counter[str] = Counter()
        self.outcomes: Counter[tuple[str, str]] = Counter()
        self.found: Counter[str] = Counter()
        self.memory, self.seconds = 0, 0.0
        self._lock = threading.Lock()

    def count(self, path: Path, damage: str, outcome: Outcome) -> None:
        """Takes a file's outcome, and keeps the file if it is a finding."""
        with self._lock:
            self.formats[path.suffix[1:]] += 1
            self.damages[damage] += 1
            for way, good in outcome.good.items():
                self.outcomes[way, "read" if good else "refused"] += 1
            self.memory = max(self.memory, outcome.memory)
            self.seconds = max(self.seconds, outcome.seconds)
            for what in outcome.findings:
                self.found[f"{path.suffix[1:]}: {' '.join(what.split()[:2])}"] += 1
                self.folder.mkdir(parents=True, exist_ok=True)
                shutil.copy(path, self.folder / f"{path.parent.name}-{path.name}")
                with (self.folder / "findings.txt").open("a") as lines:
                    line = {
                        "file": f"{path.parent.name}-{path.name}",
                        "damage": damage,
                        "what": what,
                    }
                    print(json.dumps(line), file=lines)

    def report(self) -> str:
        """Counts, one line each."""
        total = sum(self.formats.values())
        lines = [f"{total} files, {self.memory / 2**20:.0f} MiB and {self.seconds:.1f} s at most"]
        for title, counter in (("format", self.formats), ("damage", self.damages)):
            lines += [f"{title} {name}: {n}" for name, n in counter.most_common()]
        lines += [f"{way} {what}: {n}" for (way, what), n in sorted(self.outcomes.items())]
        lines += [f"FOUND {what}: {n}" for what, n in self.found.most_common()]
        return "\n".join(lines)


def placed(origin: Path, folder: Path) -> Path:
    """Where to put a damaged copy: in a folder with whatever lies beside the original."""
    folder.mkdir()
    name = f"{folder.name}-{origin.name.replace('.skin', '-skin')}"
    beside = [path for path in origin.parent.iterdir() if path.is_file() and path != origin]
    if origin.suffix in PAIRED:
        name = origin.name
        partners = [path for path in beside if path.name.split(".")[0] == origin.name.split(".")[0]]
        for path in beside if origin.suffix in LOOKUPS else partners:
            shutil.copy(path, folder / path.name)
    return folder / name


def work(
    numbers: "queue.SimpleQueue[int]", whole: list[Path], scratch: Path, seed: int, run: Run
) -> None:
    """Damages and reads until no numbers are left."""
    readers = {how: Reader(how) for how in ("read", "command")}
    originals: dict[Path, Outcome] = {}
    kinds = [
        [path for path in whole if path.suffix == suffix]
        for suffix in sorted({path.suffix for path in whole})
    ]
    while True:
        try:
            number = numbers.get_nowait()
        except queue.Empty:
            break
        random = Random(f"{seed}:{number}")
        origin, other = random.choice(random.choice(kinds)), random.choice(random.choice(kinds))
        damage, content = mutate(origin.read_bytes(), other.read_bytes(), random)
        path = placed(origin, scratch / f"{seed}-{number}")
        path.write_bytes(content)
        outcome = readers["read"].read(path)
        if damage == "truncate" and path.suffix in PICTURES:
            if origin not in originals:
                originals[origin] = readers["read"].read(origin)
            for way, good in outcome.good.items():
                if good and outcome.results[way] != originals[origin].results[way]:
                    outcome.findings.append(f"partial {way}")
        if number % COMMANDED == 0:
            command = readers["command"].read(path)
            outcome.findings += command.findings
            outcome.good |= command.good
        run.count(path, damage, outcome)
        shutil.rmtree(path.parent)
    for reader in readers.values():
        reader.close()


def main() -> int:
    """Returns 0 where nothing was found."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--start", type=int, default=0, help="number of the first file")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", action="append", help="part of the names of the seed files")
    parser.add_argument("--findings", type=Path, default=Path("fuzz-findings"))
    args = parser.parse_args()
    run, start = Run(args.findings), time.monotonic()
    first = ROOT / "src" / "cutis" / "data" / "heads" / "leeperrysmith_color.jpg"
    subprocess.run([sys.executable, "-c", WARM, str(first)], check=True, capture_output=True)
    with tempfile.TemporaryDirectory() as name:
        whole = [
            path
            for path in all_seeds(Path(name) / "seeds")
            if not args.only or any(part in path.name for part in args.only)
        ]
        numbers: queue.SimpleQueue[int] = queue.SimpleQueue()
        for number in range(args.start, args.start + args.count):
            numbers.put(number)
        threads = [
            threading.Thread(target=work, args=(numbers, whole, Path(name), args.seed, run))
            for _ in range(args.jobs)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    print(f"{len(whole)} seed files, {time.monotonic() - start:.0f} s")
    print(run.report())
    return 1 if run.found else 0


if __name__ == "__main__":
    raise SystemExit(main())
