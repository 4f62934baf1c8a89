"""Requests that the server of the browser application refuses."""

import asyncio

import pytest

from rattlebox.app.guard import MOST_BYTES, Guard

TOKEN, HOST = "a-token", "127.0.0.1:8000"


async def reply(scope, receive, send):
    """An application that reads the body and answers with its size."""
    size = 0
    while True:
        message = await receive()
        if message["type"] == "http.disconnect":
            return
        size += len(message.get("body", b""))
        if not message.get("more_body"):
            break
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": str(size).encode()})


def ask(path="/", headers=(), kind="http", body=(b"",), host=HOST, query=f"token={TOKEN}"):
    """Return the messages with which a request is answered."""
    sent = []
    parts = [{"type": "http.request", "body": part, "more_body": k + 1 < len(body)} for k, part in enumerate(body)]

    async def receive():
        return parts.pop(0) if parts else {"type": "http.disconnect"}

    async def send(message):
        sent.append(message)

    scope = {
        "type": kind,
        "path": path,
        "raw_path": path.encode(),
        "query_string": query.encode(),
        "headers": [(b"host", host.encode()), *[(n.encode(), v.encode()) for n, v in headers]],
    }
    asyncio.run(Guard(reply, TOKEN, [HOST])(scope, receive, send))
    return sent


def status(*args, **options):
    """Return the status of the answer; None for none."""
    sent = ask(*args, **options)
    return sent[0].get("status") if sent else None


def test_token_in_the_url_sets_a_cookie_that_is_enough_later():
    """The first request has the token in its URL; later ones, also websockets, have it in a cookie."""
    sent = ask()
    cookie = dict(sent[0]["headers"])[b"set-cookie"].decode()
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    name = cookie.partition(";")[0]
    assert status(query="", headers=[("cookie", name)]) == 200
    assert ask(kind="websocket", query="", headers=[("cookie", name)])[0].get("code") != 1008


@pytest.mark.parametrize("query", ["", "token=", "token=wrong", "token=a-toke", "Token=a-token", "&" * 100])
def test_request_without_the_token_is_refused(query):
    """Without the right token nothing is served."""
    assert status(query=query) == 403


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1:8001", "", "127.0.0.1:8000.evil.example"])
def test_foreign_host_is_refused(host):
    """A name that another site gave this machine is refused, also with the token."""
    assert status(host=host) == 403


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:8000", "http://127.0.0.1:8001"])
def test_foreign_origin_is_refused(origin):
    """Requests and websockets of pages of other sites are refused, also with the token."""
    assert status(headers=[("origin", origin)]) == 403
    assert ask(kind="websocket", headers=[("origin", origin)])[0]["code"] == 1008


def test_own_origin_is_accepted():
    """Requests of the page itself pass."""
    assert status(headers=[("origin", f"http://{HOST}")]) == 200


@pytest.mark.parametrize(
    "path", ["/data/../../etc/passwd", "/data/%2e%2e/x", "/data/%252e%252e/x", "/a\\..\\b", "/data/%00"]
)
def test_tricks_with_paths_are_refused(path):
    """Paths that lead out of a folder are refused in all spellings."""
    assert status(path) == 400


def test_large_bodies_are_refused():
    """A request body whose stated length is too large is refused, and a chunked one is cut at the limit."""
    assert status(headers=[("content-length", str(MOST_BYTES + 1))]) == 413
    assert status(headers=[("content-length", "1e9")]) == 400
    assert status(body=[b"x" * 1_000_000] * 3) is None
    assert ask(body=[b"x" * 1000] * 3)[1]["body"] == b"3000"
