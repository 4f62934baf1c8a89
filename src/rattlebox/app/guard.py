"""Refusal of requests from other hosts and origins, without the token, with relative paths, or with large bodies."""

from __future__ import annotations

import secrets
from collections.abc import Iterable
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, unquote

from starlette.types import ASGIApp, Message, Receive, Scope, Send

MOST_BYTES = 2_000_000
"""Largest body of a request [B]."""


class Guard:
    """ASGI middleware that accepts requests of the user's browser only."""

    def __init__(self, app: ASGIApp, token: str, hosts: Iterable[str]) -> None:
        self._app, self._token, self._hosts = app, token, frozenset(hosts)
        self._cookie = "rattlebox_" + "".join(c for c in min(self._hosts) if c.isalnum())

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Forward a request or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        status = self._refusal(scope, headers)
        if status:
            await _refuse(scope, send, *status)
            return
        # The token in the address becomes a cookie, so that later requests do not carry it in their addresses.
        cookie = f"{self._cookie}={self._token}; HttpOnly; SameSite=Strict; Path=/".encode()

        async def with_cookie(message: Message) -> None:
            if message["type"] == "http.response.start" and self._has_token_in_url(scope):
                extra = [(b"set-cookie", cookie), (b"referrer-policy", b"no-referrer")]
                message = {**message, "headers": [*message.get("headers", []), *extra]}
            await send(message)

        await self._app(scope, _limited(receive), with_cookie)

    def _refusal(self, scope: Scope, headers: dict[str, str]) -> tuple[int, str] | None:
        if headers.get("host") not in self._hosts:
            return 403, "another host"
        # Pages of other origins can send requests to this port; browsers state their origin.
        origin = headers.get("origin")
        if origin is not None and origin not in {f"http://{host}" for host in self._hosts}:
            return 403, "another origin"
        if not (self._has_token_in_url(scope) or self._has_cookie(headers)):
            return 403, "the token is missing; open the address that the command printed"
        # Decoded twice, since a proxy or a framework may decode once more than the check did.
        path = unquote(unquote(scope.get("raw_path", scope["path"].encode()).decode("latin-1")))
        if "\\" in path or "\0" in path or any(part in (".", "..") for part in path.split("/")):
            return 400, "no such path"
        try:
            if int(headers.get("content-length", "0")) > MOST_BYTES:
                return 413, f"a request has at most {MOST_BYTES} bytes"
        except ValueError:
            return 400, "the length of the body is not a number"
        return None

    def _has_token_in_url(self, scope: Scope) -> bool:
        try:
            tokens = parse_qs(scope.get("query_string", b"").decode("latin-1"), max_num_fields=50).get("token", [""])
        except ValueError:  # too many fields
            return False
        return secrets.compare_digest(tokens[0].encode(), self._token.encode())

    def _has_cookie(self, headers: dict[str, str]) -> bool:
        try:
            morsel = SimpleCookie(headers.get("cookie", "")).get(self._cookie)
        except CookieError:
            return False
        return morsel is not None and secrets.compare_digest(morsel.value.encode(), self._token.encode())


def _limited(receive: Receive) -> Receive:
    """Return `receive` that ends a body, also one in parts, which is too large."""
    size = 0

    async def receive_part() -> Message:
        nonlocal size
        message = await receive()
        if message["type"] == "http.request":
            size += len(message.get("body", b""))
            if size > MOST_BYTES:
                return {"type": "http.disconnect"}
        return message

    return receive_part


async def _refuse(scope: Scope, send: Send, status: int, reason: str) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": reason})
        return
    content = [(b"content-type", b"text/plain; charset=utf-8"), (b"connection", b"close")]
    await send({"type": "http.response.start", "status": status, "headers": content})
    await send({"type": "http.response.body", "body": f"Refused: {reason}.\n".encode()})
