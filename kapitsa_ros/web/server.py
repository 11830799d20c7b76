"""The web server of a bench: page, book and link; nothing that a client sends leads to a file."""

from __future__ import annotations

from http import HTTPStatus
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.responses import JSONResponse, Response
from starlette.routing import Route, WebSocketRoute

from kapitsa_ros.web.guard import Guard
from kapitsa_ros.web.page_link import serve_page
from kapitsa_ros.web.pages import csv_answer, page_route, shared_routes

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.types import ASGIApp
    from starlette.websockets import WebSocket

    from kapitsa_ros.web.access import Access
    from kapitsa_ros.web.web_bench import WebBench


def application(bench: WebBench, access: Access) -> ASGIApp:
    """Return the server's application."""

    async def health(request: Request) -> Response:  # noqa: ARG001
        status = HTTPStatus.OK if bench.runs else HTTPStatus.SERVICE_UNAVAILABLE
        values = {'runs': bench.runs, 'run': bench.state.run, 'failure': bench.failure, 'pages': len(list(bench.pages))}
        return JSONResponse(values, status)

    async def book(request: Request) -> Response:  # noqa: ARG001
        return csv_answer(bench.state.notebook.text(), bench.state.notebook.path.stem)

    async def link(socket: WebSocket) -> None:
        await serve_page(bench, socket)

    routes = [
        page_route('/', 'index'),
        Route('/health', health),
        Route('/book.csv', book),
        WebSocketRoute('/bench', link),
    ]
    return Guard(Starlette(routes=[*routes, *shared_routes()]), access)
