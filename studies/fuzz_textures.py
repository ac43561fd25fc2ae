"""Damages small image files of every kind and reads them: nothing may crash, hang or print.

    python -m studies.fuzz_textures --count 10000 --seed 1

Each file goes through `read_texture`, `read_mask` and, where it is OpenEXR, `load_maps`, in a
process of its own that may die of it; every fiftieth through `cutis estimate`. What goes wrong is
kept in the folder `--findings`, as a file and a line in findings.txt. Ends in 1 if anything did.
"""

import argparse
import json
import queue
import shutil
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
from hostile.seeds import seeds  # noqa: E402

ESTIMATED = 50


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
                shutil.copy(path, self.folder / path.name)
                with (self.folder / "findings.txt").open("a") as lines:
                    line = {"file": path.name, "damage": damage, "what": what}
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


def work(
    numbers: "queue.SimpleQueue[int]", whole: list[Path], scratch: Path, seed: int, run: Run
) -> None:
    """Damages and reads until no numbers are left."""
    readers = {how: Reader(how) for how in ("read", "estimate")}
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
        path = scratch / f"{seed}-{number}-{origin.name.replace('.skin', '-skin')}"
        path.write_bytes(content)
        outcome = readers["read"].read(path)
        if damage == "truncate":
            if origin not in originals:
                originals[origin] = readers["read"].read(origin)
            for way, good in outcome.good.items():
                if good and outcome.results[way] != originals[origin].results[way]:
                    outcome.findings.append(f"partial {way}")
        if number % ESTIMATED == 0:
            command = readers["estimate"].read(path)
            outcome.findings += command.findings
            outcome.good |= command.good
        run.count(path, damage, outcome)
        path.unlink()
    for reader in readers.values():
        reader.close()


def main() -> int:
    """Returns 0 where nothing was found."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--start", type=int, default=0, help="number of the first file")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="part of the names of the seed files")
    parser.add_argument("--findings", type=Path, default=Path("fuzz-findings"))
    args = parser.parse_args()
    run, start = Run(args.findings), time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        whole = [path for path in seeds(Path(name) / "seeds") if args.only in path.name]
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
