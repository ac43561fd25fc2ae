"""Who may talk to the studio: pages that it served itself, to whom was given its address.

A server on one's own machine is reached by every page in the browser that knows its port. So the
address holds a token, once; then a cookie does, which scripts cannot read and other sites' requests
do not carry. Host and Origin are checked on every request, against names that lead here from
elsewhere and against other sites' scripts.
"""

import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

LONGEST = 8192
"""Bytes of an address: nothing here needs more."""


class Guard:
    """An ASGI application in front of another that refuses everyone else."""

    def __init__(self, app: App, hosts: tuple[str, ...], port: int, token: str) -> None:
        """`hosts` are the names under which the page may be asked for, with `port`."""
        self._app, self._token = app, token
        self._hosts = {f"{host}:{port}" for host in hosts}
        if port == 80:
            self._hosts |= set(hosts)
        self._origins = {f"http://{host}" for host in self._hosts}
        self.cookie = f"cutis-{port}"
        sockets = " ".join(sorted(f"ws://{host}" for host in self._hosts))
        self._policy = (
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
            f"font-src 'self'; connect-src 'self' {sockets}; base-uri 'none'; form-action 'none'; "
            "frame-ancestors 'none'; require-trusted-types-for 'script'"
        )

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Lets through, or refuses."""
        if scope["type"] == "lifespan":
            return await self._app(scope, receive, send)
        headers: dict[str, list[str]] = {}
        for name, value in scope["headers"]:
            headers.setdefault(name.decode("latin1").lower(), []).append(value.decode("latin1"))
        refusal = self._refusal(scope, headers)
        if refusal is None and not self._known(headers):
            if scope["type"] == "http" and self._has_token(scope):
                return await self._welcome(send)
            refusal = 401
        if refusal is not None:
            return await self._refuse(scope, receive, send, refusal)
        await self._app(scope, receive, self._closing(send))

    def _refusal(self, scope: Scope, headers: dict[str, list[str]]) -> int | None:
        if headers.get("host", []) not in [[host] for host in self._hosts]:
            return 403
        origin = headers.get("origin")
        if scope["type"] == "websocket":
            if origin is None or len(origin) != 1 or origin[0] not in self._origins:
                return 403
            return 403 if scope["path"] != "/ws" else None
        if origin is not None and (len(origin) != 1 or origin[0] not in self._origins):
            return 403
        # a link on another site may lead here, and then has no cookie; its scripts may not ask
        site = headers.get("sec-fetch-site", ["none"])[0]
        asked = headers.get("sec-fetch-dest", ["document"])[0]
        if site in ("cross-site", "same-site") and asked != "document":
            return 403
        if scope["method"] not in ("GET", "HEAD"):
            return 405
        if len(scope["path"]) + len(scope["query_string"]) > LONGEST:
            return 414
        return None

    def _known(self, headers: dict[str, list[str]]) -> bool:
        for text in headers.get("cookie", ()):
            try:
                found = SimpleCookie(text).get(self.cookie)
            except CookieError:
                continue
            if found is not None and self._is_token(found.value):
                return True
        return False

    def _has_token(self, scope: Scope) -> bool:
        try:
            given = parse_qs(scope["query_string"].decode("ascii")).get("token", [""])
        except (UnicodeDecodeError, ValueError):
            return False
        return scope["path"] == "/" and len(given) == 1 and self._is_token(given[0])

    def _is_token(self, text: str) -> bool:
        return secrets.compare_digest(text.encode(), self._token.encode())

    async def _welcome(self, send: Send) -> None:
        """The cookie for the token, and the address without it."""
        cookie = f"{self.cookie}={self._token}; Path=/; HttpOnly; SameSite=Strict"
        await send({
            "type": "http.response.start", "status": 303,
            "headers": [
                (b"location", b"/"), (b"set-cookie", cookie.encode()), *self._headers(),
            ],
        })  # fmt: skip
        await send({"type": "http.response.body", "body": b""})

    async def _refuse(self, scope: Scope, receive: Receive, send: Send, status: int) -> None:
        if scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})  # before it is accepted: 403
            return
        said = {
            401: b"Open the address that `cutis studio` printed, with its token.\n",
            403: b"Refused: this page was asked for under another name, or by another site.\n",
            405: b"This address is for reading.\n",
            414: b"That address is too long.\n",
        }[status]
        head = [(b"content-type", b"text/plain; charset=utf-8"), *self._headers()]
        await send({"type": "http.response.start", "status": status, "headers": head})
        await send({"type": "http.response.body", "body": said})

    def _headers(self) -> list[tuple[bytes, bytes]]:
        return [
            (b"cache-control", b"no-store"),
            (b"content-security-policy", self._policy.encode()),
            (b"cross-origin-opener-policy", b"same-origin"),
            (b"cross-origin-resource-policy", b"same-origin"),
            (b"referrer-policy", b"no-referrer"),
            (b"x-content-type-options", b"nosniff"),
            (b"x-frame-options", b"DENY"),
        ]

    def _closing(self, send: Send) -> Send:
        """The same headers on every answer."""
        own = {name for name, _ in self._headers()}

        async def sending(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                kept = [(n, v) for n, v in message.get("headers", ()) if n.lower() not in own]
                message = {**message, "headers": [*kept, *self._headers()]}
            await send(message)

        return sending
