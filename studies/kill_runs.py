"""Kills `cutis estimate` of a UDIM set at random moments, and looks at what it leaves.

    python -m studies.kill_runs FACE --kills 50

FACE is cut into four tiles. After every kill -9 each file under its final name must be whole; at
the end one undisturbed run must complete the set, with the reports of a run that was never killed,
and leave no temporary files. Findings: docs/batch.md.
"""

import argparse
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import OpenImageIO as oiio

from cutis.textures import read_channels, read_texture, write_texture

SIDE = 512
COMMAND = (sys.executable, "-c", "from cutis.apps.main import main; main()", "estimate")


def whole(path: Path) -> bool:
    """Whether a result is complete."""
    if path.name.endswith(".report.json"):
        return "model" in json.loads(path.read_text("utf-8"))
    if path.suffix == ".exr":
        channels, _ = read_channels(path)
        return len(channels) >= 3
    if path.suffix == ".html":
        return path.read_text("utf-8").endswith("</html>\n")
    image = oiio.ImageBuf(str(path))
    return bool(image.read(force=True)) and not image.has_error


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("face")
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    dice = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "set").mkdir()
        face = read_texture(options.face)
        for i, number in enumerate((1001, 1002, 1003, 1011)):
            tile = face.rows(slice(i * SIDE, (i + 1) * SIDE))
            write_texture(tile, folder / "set" / f"face.{number}.exr")
        arguments = [*COMMAND, str(folder / "set" / "face.<UDIM>.exr"), "--exposure", "auto",
                     "--report", "--quiet", "-o"]  # fmt: skip
        begin = time.monotonic()
        subprocess.run([*arguments, str(folder / "good")], check=True)
        usual = time.monotonic() - begin
        expected = {p.name: p.read_bytes() for p in sorted((folder / "good").iterdir())}
        out, broken, found = folder / "out", 0, []
        for _ in range(options.kills):
            with subprocess.Popen([*arguments, str(out)]) as run:
                time.sleep(dice.uniform(0.2, 1.0) * usual)
                run.send_signal(signal.SIGKILL)
            final = [p for p in out.glob("*") if not p.name.startswith(".")]
            broken += sum(not whole(path) for path in final)
            found.append(len(final))
            if len(final) == len(expected):  # begin again: nothing is left to be killed at
                for path in out.iterdir():
                    path.unlink()
        subprocess.run([*arguments, str(out)], check=True)
        left = [p.name for p in out.iterdir() if p.name not in expected]
        compared = [name for name in expected if name.endswith((".json", ".png"))]
        same = [name for name in compared if (out / name).read_bytes() != expected[name]]
        missing = [name for name in expected if not (out / name).is_file()]
        print(f"{options.kills} kills; files under final names after them: {min(found)} to "
              f"{max(found)} of {len(expected)}, broken: {broken}; after one more run missing: "
              f"{len(missing)}, left over: {len(left)}, reports and previews that differ: "
              f"{len(same)}")  # fmt: skip
        raise SystemExit(1 if broken or left or same or missing else 0)


if __name__ == "__main__":
    main()
