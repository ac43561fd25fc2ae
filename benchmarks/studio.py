"""Times of the studio's server on a large face: `python -m benchmarks.studio [SIDE]`.

A face of SIDE² texels (4096) in a 16-bit EXR is opened as a page opens it, over the socket; sliders
move, and the time from the request to the JPEG's last byte is taken. What a browser adds (decoding
a JPEG, drawing it) is not in it. Also resident memory, after the first face and after opening and
closing others in turn. Says the load of the machine beside the times.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

PROGRAM = "from cutis.apps.main import main; main()"
VIEW = (1920, 1080)
MOVES = 40
TURNS = 20
CAPTURE = Path(__file__).parents[1] / "examples" / "bioskin_capture1.jpg"


def face(path: Path, side: int) -> None:
    """The middle of the example capture, enlarged by interpolation."""
    import OpenImageIO as oiio
    from PIL import Image

    from cutis.colour import decode_srgb

    with Image.open(CAPTURE) as picture:
        part = picture.crop((500, 900, 1600, 2000)).resize((side, side), Image.Resampling.BICUBIC)
    linear = decode_srgb(np.asarray(part, np.float32) / 255).astype(np.float16)
    spec = oiio.ImageSpec(side, side, 3, "half")
    out = oiio.ImageOutput.create(str(path))
    out.open(str(path), spec)
    out.write_image(linear)
    out.close()


class Page:
    """A page without a browser."""

    def __init__(self, address: str) -> None:
        from websockets.sync.client import connect

        site, token = address.strip().split("/?token=")
        host = site.removeprefix("http://")
        cookie = f"cutis-{host.rpartition(':')[2]}={token}"
        self.link = connect(
            f"ws://{host}/ws", origin=site, additional_headers={"Cookie": cookie}, max_size=1 << 28
        )

    def ask(self, kind: str, **message: Any) -> Any:
        """Sends a message and waits for an answer of a kind."""
        self.link.send(json.dumps(message))
        while True:
            data = self.link.recv(900)
            if isinstance(data, bytes):
                length = int.from_bytes(data[:4], "little")
                head = json.loads(data[4 : 4 + length])
            else:
                head = json.loads(data)
            if head["t"] == "error":
                raise RuntimeError(head["text"])
            if head["t"] == kind:
                return head


def memory(process: int) -> tuple[float, float]:
    """Resident megabytes: in all, and without pages of files, which the system takes back."""
    status = Path(f"/proc/{process}/status").read_text()
    found = {line.split(":")[0]: line.split()[1] for line in status.splitlines() if "kB" in line}
    return int(found["VmRSS"]) / 1024, int(found["RssAnon"]) / 1024


def view(side: int, **more: Any) -> dict[str, Any]:
    """A view of 1920 × 1080 that the face fills from left to right."""
    scale = VIEW[0] / side
    return {"t": "view", "left": 0, "top": 0, "right": side, "bottom": VIEW[1] / scale,
            "scale": scale, **more}  # fmt: skip


def main() -> None:
    side = int(sys.argv[1]) if len(sys.argv) > 1 else 4096
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        face(folder / "large.exr", side)
        face(folder / "other.exr", 512)
        process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM, "studio", "large.exr", "--no-browser"],
            cwd=folder, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        assert process.stdout is not None
        try:
            measure(Page(process.stdout.readline()), side, process.pid)
        finally:
            process.terminate()
            process.wait()
            process.stdout.close()


def measure(page: Page, side: int, process: int) -> None:
    print(f"{side} × {side}, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    start = time.perf_counter()
    state = page.ask("face", t="open", file=0)["state"]
    page.ask("picture", **view(side))
    print(f"open to first picture {time.perf_counter() - start:.2f} s")
    page.ask("ready", t="ask", what="files")
    print(f"open to all maps {time.perf_counter() - start:.2f} s")

    def preview(by: float) -> dict[str, Any]:
        edit = {"do": "multiply", "map": "melanin", "by": by}
        return {"op": "tune", "id": state["ids"][0], "map": "melanin", "edit": edit}

    for coarser, what in ((1, "dragging, half the resolution"), (0, "released, all of it")):
        page.ask("picture", **view(side, coarser=coarser, preview=preview(1.9)))
        times = []
        for by in np.linspace(0.6, 1.8, MOVES):
            start = time.perf_counter()
            page.ask("picture", **view(side, coarser=coarser, preview=preview(float(by))))
            times.append(1000 * (time.perf_counter() - start))
        ranked = sorted(times)
        print(f"{what}: median {statistics.median(times):.0f} ms, "
              f"95 % {ranked[int(0.95 * len(ranked))]:.0f} ms")  # fmt: skip
    print("memory {:.0f} MB, {:.0f} MB of it not of files".format(*memory(process)))
    for turn in range(TURNS):
        files = page.ask("files", t="ask", what="files")["files"]
        other = next(one["file"] for one in files if one["name"] == "other.exr")
        for number in (other, 0):
            found = page.ask("face", t="open", file=number)
            if not found["ready"]:
                page.ask("ready", t="ask", what="files")
        if turn in (0, TURNS - 1):
            said = "after {} more: {:.0f} MB, {:.0f} MB of it not of files"
            print(said.format(turn + 1, *memory(process)))


if __name__ == "__main__":
    main()
