"""The server of the studio: one process on this machine, for the faces that are open."""

import asyncio
import contextlib
import secrets
import socket
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from importlib import resources
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.responses import FileResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from cutis.errors import CutisError
from cutis.jobs import Cancel, Cancelled
from cutis.maps.estimating import Progress
from cutis.studio.files import Files
from cutis.studio.guard import Guard
from cutis.studio.protocol import LARGEST
from cutis.studio.tab import Tab
from cutis.studio.workshop import Workshop

LOOPBACK = "127.0.0.1"
KINDS = {
    ".html": "text/html; charset=utf-8", ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8", ".svg": "image/svg+xml",
}  # fmt: skip
"""Files of the page, by their endings."""
TABS = 32
"""Sockets at a time."""


class Studio:
    """Files, open faces, and the thread that draws."""

    def __init__(self, files: Files) -> None:
        self.files = files
        self._open: dict[int, Workshop] = {}
        self._tabs: dict[int, int] = {}
        self._estimates: dict[int, asyncio.Task[None]] = {}
        self._listeners: dict[int, list[Progress]] = {}
        self._cancels: dict[int, Cancel] = {}
        self._entering = asyncio.Lock()
        self._draws = ThreadPoolExecutor(1, "cutis-draws")
        self._sockets = 0

    async def enter(self, number: int) -> Workshop:
        """The face of a number, opened where it is not; CutisError where that cannot be."""
        async with self._entering:
            if number not in self._open:
                opening = self.files.opening(number)
                self._open[number] = await asyncio.to_thread(Workshop, opening)
                self._tabs[number] = 0
            self._tabs[number] += 1
            return self._open[number]

    async def leave(self, workshop: Workshop) -> None:
        """A page goes; the face stays open, for it may come back, unless another one is in use."""
        number = self._number(workshop)
        if number is None:
            return
        self._tabs[number] -= 1
        async with self._entering:
            used = any(tabs > 0 for tabs in self._tabs.values())
            for one in [n for n, tabs in self._tabs.items() if tabs < 1]:
                if used or one != number:
                    await self._close(one)

    async def _close(self, number: int) -> None:
        workshop = self._open.pop(number)
        self._tabs.pop(number, None)
        if number in self._cancels:
            self._cancels[number].cancel()
            task = self._estimates.get(number)
            if task is not None:
                await asyncio.wait([task])
        loop = asyncio.get_running_loop()
        await loop.run_in_executor(self._draws, workshop.close)

    async def estimated(self, workshop: Workshop, progress: Progress) -> None:
        """Waits until the maps of a face are there; all who wait are told how far that is."""
        number = self._number(workshop)
        if number is None or workshop.face.ready:
            return
        if number not in self._estimates:
            listeners = self._listeners[number] = []
            cancel = self._cancels[number] = Cancel()

            def tell(done: int, total: int, doing: str) -> None:
                for listener in list(listeners):
                    listener(done, total, doing)

            work = asyncio.to_thread(workshop.estimate, cancel(tell))
            self._estimates[number] = asyncio.create_task(work)
        self._listeners[number].append(progress)
        try:
            await asyncio.shield(self._estimates[number])
        except Cancelled:
            raise CutisError("the estimate was stopped") from None
        finally:
            task = self._estimates.get(number)
            if task is not None and task.done():
                for held in (self._estimates, self._listeners, self._cancels):
                    held.pop(number, None)

    def _number(self, workshop: Workshop) -> int | None:
        return next((n for n, one in self._open.items() if one is workshop), None)

    async def drawing(self, work: Callable[..., Any], *arguments: Any) -> Any:
        """Does something in the thread that draws, one after the other."""
        return await asyncio.get_running_loop().run_in_executor(self._draws, work, *arguments)

    async def socket(self, socket: WebSocket) -> None:
        """A page connects."""
        if self._sockets >= TABS:
            await socket.close(1013)
            return
        self._sockets += 1
        try:
            await Tab(self, socket).run()
        finally:
            self._sockets -= 1

    @contextlib.asynccontextmanager
    async def lifespan(self, _: Starlette) -> AsyncIterator[None]:
        """Closes all faces at the end."""
        yield
        for number in list(self._open):
            await self._close(number)
        self._draws.shutdown()


def page_files() -> dict[str, Path]:
    """The files of the page by the name under which they are asked for."""
    folder = Path(str(resources.files("cutis.studio").joinpath("page")))
    found = sorted(path for path in folder.rglob("*") if path.suffix in KINDS)
    return {path.relative_to(folder).as_posix(): path for path in found}


def application(studio: Studio, hosts: tuple[str, ...], port: int, token: str) -> Guard:
    """The ASGI application, guarded."""
    files = page_files()

    def served(path: Path) -> Callable[..., Any]:
        async def serve(_: Any) -> Response:
            return FileResponse(path, media_type=KINDS[path.suffix])

        return serve

    async def nothing(_: Any) -> Response:
        return Response("There is nothing here.\n", 404, media_type="text/plain")

    routes: list[Any] = [Route("/", served(files["index.html"]))]
    routes += [Route(f"/page/{name}", served(path)) for name, path in files.items()]
    routes += [WebSocketRoute("/ws", studio.socket), Route("/{rest:path}", nothing)]
    return Guard(Starlette(routes=routes, lifespan=studio.lifespan), hosts, port, token)


def listening(host: str, port: int) -> socket.socket:
    """A bound socket; CutisError where the port is taken or the host is none of this machine."""
    found = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((host, port))
    except (OSError, OverflowError) as error:
        found.close()
        reason = getattr(error, "strerror", None) or str(error)
        raise CutisError(
            f"cannot listen on {host} port {port} ({reason.lower()}); give another with --port, or "
            "--port 0 for any that is free"
        ) from error
    return found


def serve(
    files: Files, host: str = LOOPBACK, port: int = 0, started: Callable[[str], None] = print
) -> None:
    """Serves until it is interrupted; `started` is told the address, token included.

    Raises CutisError where the port is taken.
    """
    import uvicorn

    bound = listening(host, port)
    port = bound.getsockname()[1]
    token = secrets.token_urlsafe(24)
    hosts = (host, "localhost") if host == LOOPBACK else (host,)
    if ":" in host:
        hosts = (f"[{host}]",)
    app = application(Studio(files), hosts, port, token)
    config = uvicorn.Config(
        app, log_level="error", access_log=False, server_header=False, date_header=False,
        ws="websockets-sansio", ws_max_size=LARGEST, ws_per_message_deflate=False,
        h11_max_incomplete_event_size=16 << 10, limit_concurrency=256,
        timeout_graceful_shutdown=3, lifespan="on",
    )  # fmt: skip

    class Server(uvicorn.Server):
        async def startup(self, sockets: Any = None) -> None:
            await super().startup(sockets)
            started(f"http://{hosts[0]}:{port}/?token={token}")

    with bound:
        Server(config).run(sockets=[bound])
