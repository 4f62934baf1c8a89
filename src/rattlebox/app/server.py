"""The server of the application, on this machine only."""

from __future__ import annotations

import asyncio
import secrets
import socket
import webbrowser
from pathlib import Path
from typing import Any

from fastapi import HTTPException, Response
from nicegui import app, core, ui

import rattlebox as rb

from .draft import Draft
from .form import schema
from .guard import MOST_BYTES, Guard
from .jobs import Worker
from .page import Bodies, Page

HOST = "127.0.0.1"


def build(folder: Path, port: int, token: str) -> None:
    """Add the page, its data and the guard to the application of NiceGUI."""
    bodies: Bodies = {}

    @ui.page("/", title="Rattlebox")
    def index() -> None:
        page = Page(folder, bodies)
        ui.context.client.on_delete(page.close)

    @app.get("/data/{key}/{_version}")
    def data(key: str, _version: str, first: int = 0) -> Response:
        body = bodies.get(key)
        if body is None or not 0 <= first < 10**9:
            raise HTTPException(404)
        try:
            content = body(first)
        except rb.RattleboxError as error:
            raise HTTPException(409, str(error)) from None
        return Response(content, media_type="application/octet-stream", headers={"Cache-Control": "no-store"})

    app.add_middleware(Guard, token=token, hosts=(f"{HOST}:{port}", f"localhost:{port}"))
    core.sio.eio.max_http_buffer_size = MOST_BYTES
    app.on_startup(lambda: (schema(), Draft(folder), rb.materials(), rb.MEASURES))  # else the first page loads them
    app.on_shutdown(Worker.stop_spare)


def serve(folder: str | Path, *, port: int = 0, show: bool = True) -> None:
    """Start the application and serve it until Ctrl-C."""
    root = _folder(Path(folder))
    port = _free_port(port)
    token = secrets.token_urlsafe(24)
    build(root, port, token)

    async def announce() -> None:
        while True:  # handlers of the startup are called before the port is open
            try:
                _, writer = await asyncio.open_connection(HOST, port)
            except OSError:
                await asyncio.sleep(0.02)
            else:
                writer.close()
                break
        await Worker.load_spare()  # while it loads, a page would wait for the processor
        url = f"http://{HOST}:{port}/?token={token}"
        print(f"Rattlebox runs at {url}\nFiles are in {root}. Ctrl-C ends it.", flush=True)
        if show:
            await asyncio.to_thread(webbrowser.open, url)

    app.on_startup(announce)
    options: dict[str, Any] = {
        "host": HOST,
        "port": port,
        "title": "Rattlebox",
        "reload": False,
        "favicon": "\N{HAMMER}",
        "gzip_middleware_factory": None,  # compression takes longer than the loopback
    }
    ui.run(show=False, show_welcome_message=False, reconnect_timeout=3.0, **options)


def _folder(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / f".rattlebox-{secrets.token_hex(4)}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise rb.DataError(f"{folder} cannot be written: {error.strerror}", "a folder of your own") from None
    return folder.resolve()


def _free_port(port: int) -> int:
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((HOST, port))
        except OverflowError:
            raise rb.ResourceError(f"port {port} does not exist; ports are from 1 to 65535", "--port 0") from None
        except OSError as error:
            raise rb.ResourceError(f"port {port} cannot be used: {error.strerror}", "--port 0, a free one") from None
        return int(trial.getsockname()[1])
