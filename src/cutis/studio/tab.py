"""One page in a browser: what it asks is done, and the newest of its views is drawn.

Two pieces of work go on for a page beside its messages: views and readings. Of each kind only the
newest request counts; one that is being worked on is finished, what waits behind it is replaced. A
page that goes away takes its work with it.
"""

import asyncio
import contextlib
import json
import time
from typing import TYPE_CHECKING, Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from cutis.errors import CutisError
from cutis.looks import Look
from cutis.studio import protocol, tracks
from cutis.studio.drawing import Drawn, Region, codes, jpeg
from cutis.studio.overlays import map_picture, mask_over
from cutis.studio.pointing import axes, reading
from cutis.studio.presets import preset_list
from cutis.studio.rates import Rate
from cutis.studio.workshop import Workshop

if TYPE_CHECKING:
    from cutis.studio.server import Studio

MESSAGES = (240.0, 480.0)
"""Messages a second, and at once: a pointer that moves sends 60 to 120."""
ROOM = 16 << 20
"""Bytes of messages a second."""
QUICK, FINE = 80, 92
"""Quality of JPEGs while a slider moves, and after."""


class Newest:
    """A place for one request: a new one takes the place of one that waits."""

    def __init__(self) -> None:
        self._waiting: Any = None
        self._event = asyncio.Event()

    def put(self, request: Any) -> None:
        """Leaves a request."""
        self._waiting = request
        self._event.set()

    async def take(self) -> Any:
        """Waits for one and takes it."""
        await self._event.wait()
        self._event.clear()
        return self._waiting


class Tab:
    """A socket, and the face that its page shows."""

    def __init__(self, studio: "Studio", socket: WebSocket) -> None:
        self._studio, self._socket = studio, socket
        self._workshop: Workshop | None = None
        self._views, self._points = Newest(), Newest()
        self._sending = asyncio.Lock()
        self._loop = asyncio.get_running_loop()
        self._rate, self._bytes = Rate(*MESSAGES), Rate(ROOM, 2 * ROOM)
        self._others: set[asyncio.Task[None]] = set()

    async def run(self) -> None:
        """Until the page goes away."""
        await self._socket.accept()
        going = [
            asyncio.create_task(self._work(self._views, self._view)),
            asyncio.create_task(self._work(self._points, self._read)),
        ]
        try:
            await self._tell({"t": "hello", "files": self._studio.files.list(), **axes()})
            while True:
                text = await self._socket.receive_text()
                if not (self._rate.take() and self._bytes.take(len(text))):
                    await self._socket.close(1008, "too many messages")
                    return
                try:
                    message = protocol.understood(text)
                except CutisError as error:
                    await self._say(error, 0)
                    continue
                await self._hear(message)
        except (WebSocketDisconnect, RuntimeError, KeyError):
            pass  # gone; a binary message, which no page sends, is a KeyError
        finally:
            for task in (*going, *self._others):
                task.cancel()
            await self._leave()

    async def _hear(self, message: Any) -> None:
        if isinstance(message, protocol.View):
            self._views.put(message)
        elif isinstance(message, protocol.Read):
            self._points.put(message)
        elif isinstance(message, protocol.Do | protocol.Step | protocol.Go):
            await self._guarded(message, self._change)  # in the order in which they come
        else:
            if len(self._others) >= 8:
                return await self._say(CutisError("wait for what you asked for first"), message.n)
            task = asyncio.create_task(self._guarded(message, self._other))
            self._others.add(task)
            task.add_done_callback(self._others.discard)

    async def _guarded(self, message: Any, work: Any) -> None:
        """Errors are said to the page."""
        try:
            await work(message)
        except (CutisError, OSError, MemoryError) as error:
            await self._say(error, message.n)

    async def _work(self, newest: Newest, work: Any) -> None:
        while True:
            await self._guarded(await newest.take(), work)

    # what is asked ----------------------------------------------------------------------------

    async def _other(self, message: Any) -> None:
        if isinstance(message, protocol.Open):
            return await self._open(message)
        workshop = self._here()
        if isinstance(message, protocol.Tracks):
            layer = workshop.state.look.layers[workshop.state.place(message.id)]
            found = await asyncio.to_thread(tracks.tracks, workshop.face, layer, message.does)
            await self._tell({"t": "tracks", "n": message.n, "id": message.id, "tracks": found})
        elif isinstance(message, protocol.Save):
            save = workshop.save if message.kind == "albedo" else workshop.save_look
            done = await asyncio.to_thread(save, message.label)
            await self._tell({
                "t": "saved", "n": message.n, "name": done.path.name, "command": done.command,
                "changed": done.changed, "notes": list(done.notes),
            })  # fmt: skip
        elif message.what == "history":
            states = await asyncio.to_thread(workshop.history.list)
            await self._tell({"t": "history", "n": message.n, "states": states})
        elif message.what == "files":
            await self._tell({"t": "files", "n": message.n, "files": self._studio.files.list()})
        else:
            for head, picture in await asyncio.to_thread(preset_list, workshop.face):
                await self._send(protocol.packed({"t": "preset", "n": message.n, **head}, picture))

    async def _open(self, message: protocol.Open) -> None:
        workshop = await self._studio.enter(message.file)
        await self._leave()
        self._workshop = workshop
        workshop.watchers.append(self._changed)
        face = workshop.face
        await self._tell({
            "t": "face", "n": message.n, "file": message.file, "name": face.capture.name,
            "height": face.shape[0], "width": face.shape[1], "space": face.space.name,
            "origin": face.origin, "depth": face.stored.name, "notes": face.notes,
            "ready": face.ready, "state": workshop.told(), "spans": tracks.SPANS,
        })  # fmt: skip
        if not face.ready:
            await self._studio.estimated(workshop, self._progress)
        if self._workshop is workshop:
            await self._tell({"t": "ready", "model": face.file.made_by.name,
                              "gains": list(face.file.header.calibration.gains)})  # fmt: skip

    def _progress(self, done: int, total: int, doing: str) -> None:
        """Called in another thread."""
        said = {"t": "progress", "share": done / max(total, 1), "doing": doing}
        self._loop.call_soon_threadsafe(self._tell_soon, said)

    def _changed(self) -> None:
        """Called, in any thread, after the state has changed."""
        if self._workshop is not None:
            said = {"t": "state", "state": self._workshop.told()}
            self._loop.call_soon_threadsafe(self._tell_soon, said)

    def _tell_soon(self, said: dict[str, Any]) -> None:
        task = self._loop.create_task(self._tell(said))
        self._others.add(task)
        task.add_done_callback(self._others.discard)

    async def _change(self, message: Any) -> None:
        workshop = self._here()
        if isinstance(message, protocol.Do):
            await asyncio.to_thread(workshop.do, message.op, message.what)
        elif isinstance(message, protocol.Step):
            await asyncio.to_thread(workshop.step, message.by)
        else:
            await asyncio.to_thread(workshop.go, message.number)
        await self._tell({"t": "done", "n": message.n, "revision": workshop.revision})

    async def _view(self, message: protocol.View) -> None:
        workshop = self._here()
        start = time.perf_counter()
        state, revision = workshop.state, workshop.revision
        if message.preview is not None:
            state = state.after(message.preview)
        region = Region(message.left, message.top, message.right, message.bottom, message.scale)
        for show in message.show:
            drawn, head, data = await self._studio.drawing(
                _picture, workshop, region, show, state.look, message
            )
            took = 1000 * (time.perf_counter() - start)
            await self._send(protocol.packed({
                "t": "picture", "n": message.n, "show": show, "place": drawn.place,
                "level": drawn.level, "coarser": message.coarser, "revision": revision,
                "took": round(took, 1), **head,
            }, data))  # fmt: skip

    async def _read(self, message: protocol.Read) -> None:
        workshop = self._here()
        found = await asyncio.to_thread(
            reading, workshop.face, workshop.state.look, message.y, message.x, message.light
        )
        await self._tell({"t": "reading", "n": message.n, **found})

    # talking ----------------------------------------------------------------------------------

    def _here(self) -> Workshop:
        if self._workshop is None:
            raise CutisError("open a face first")
        return self._workshop

    async def _leave(self) -> None:
        if self._workshop is not None:
            with contextlib.suppress(ValueError):
                self._workshop.watchers.remove(self._changed)
            workshop, self._workshop = self._workshop, None
            await self._studio.leave(workshop)

    async def _say(self, error: Exception, n: int) -> None:
        text = str(error) if isinstance(error, CutisError) else _reason(error)
        await self._tell({"t": "error", "n": n, "text": text})

    async def _tell(self, said: dict[str, Any]) -> None:
        await self._send(json.dumps(said))

    async def _send(self, data: str | bytes) -> None:
        async with self._sending:
            with contextlib.suppress(WebSocketDisconnect, RuntimeError):
                if isinstance(data, str):
                    await self._socket.send_text(data)
                else:
                    await self._socket.send_bytes(data)


def _picture(
    workshop: Workshop, region: Region, show: str, look: Look, message: protocol.View
) -> tuple[Drawn, dict[str, Any], bytes]:
    """A picture as JPEG, and what is to be said of it; in the thread that draws."""
    head: dict[str, Any] = {}
    if show == "original" or not workshop.face.ready:
        drawn = workshop.drawer.original(region, message.coarser)
    elif show == "edited":
        drawn = workshop.drawer.edited(region, look, message.coarser, message.light)
    elif show.startswith("mask:"):
        number = workshop.state.place(show.removeprefix("mask:"))
        drawn, picture = mask_over(workshop.drawer, region, look, number, message.coarser)
        return drawn, head, jpeg(picture, QUICK if message.coarser else FINE)
    else:
        drawn, picture, head = map_picture(
            workshop.face, workshop.drawer, region, look, show, message.coarser
        )
        return drawn, head, jpeg(picture, FINE)
    picture = codes(drawn.colours)
    return drawn, head, jpeg(picture, QUICK if message.coarser else FINE)


def _reason(error: Exception) -> str:
    if isinstance(error, MemoryError):
        return "not enough memory; zoom out, or close other faces"
    return str(getattr(error, "strerror", None) or error)
