"""The web server of a bench: page, book and link; nothing that a client sends leads to a file."""

from __future__ import annotations

from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from kapitsa_ros.web.catalogue import choose_language, translated, words_of
from kapitsa_ros.web.page_link import serve_page

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from kapitsa_ros.web.access import Access
    from kapitsa_ros.web.web_bench import WebBench

STATIC = Path(__file__).parent / 'static'
_TYPES = {'.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml'}
_PUBLIC = ('/static/', '/words.json')
"""The same for all."""
_HEADERS = {
    'Content-Security-Policy': "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    'X-Content-Type-Options': 'nosniff',
    'Referrer-Policy': 'no-referrer',
    'Cache-Control': 'no-store',
}


@cache
def static_files() -> dict[str, tuple[bytes, str]]:
    """Return what is sent as it is, and its type, by the name it is asked for."""
    return {path.name: (path.read_bytes(), _TYPES[path.suffix]) for path in STATIC.iterdir() if path.suffix in _TYPES}


def application(bench: WebBench, access: Access) -> ASGIApp:
    """Return the server's application."""
    page = (STATIC / 'index.html').read_text(encoding='utf-8')

    async def index(request: Request) -> Response:
        language = _language(request)
        text = translated(page, language).replace('<html lang="en">', f'<html lang="{language}">')
        return Response(text, media_type='text/html', headers={'Vary': 'Accept-Language'})

    async def words(request: Request) -> Response:
        return JSONResponse(words_of(_language(request)))

    async def static(request: Request) -> Response:
        content, kind = static_files().get(request.path_params['name'], (None, ''))
        return PlainTextResponse('no such file', 404) if content is None else Response(content, media_type=kind)

    async def health(request: Request) -> Response:  # noqa: ARG001
        status = HTTPStatus.OK if bench.runs else HTTPStatus.SERVICE_UNAVAILABLE
        values = {'runs': bench.runs, 'run': bench.state.run, 'failure': bench.failure, 'pages': len(list(bench.pages))}
        return JSONResponse(values, status)

    async def book(request: Request) -> Response:  # noqa: ARG001
        name = bench.state.notebook.path.stem.encode('ascii', 'ignore').decode()
        attachment = ''.join(sign for sign in name if sign.isalnum() or sign in '_-') or 'book'
        headers = {'Content-Disposition': f'attachment; filename="{attachment}.csv"'}
        return Response(bench.state.notebook.text(), media_type='text/csv', headers=headers)

    async def link(socket: WebSocket) -> None:
        await serve_page(bench, socket)

    routes = [
        Route('/', index),
        Route('/health', health),
        Route('/words.json', words),
        Route('/book.csv', book),
        Route('/static/{name}', static),
        WebSocketRoute('/bench', link),
    ]
    return _Guard(Starlette(routes=routes), access)


class _Guard:
    """Refuses what does not come from the bench's own page, and tells browsers to load nothing from elsewhere."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self._app = app
        self._access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope['type'] not in {'http', 'websocket'}:
            await self._app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        public = connection.url.path.startswith(_PUBLIC)
        why = self._access.refusal(connection.headers, connection.query_params, public=public)
        if why is not None:
            refusal = PlainTextResponse(f'{why}\n', HTTPStatus.FORBIDDEN)
            if scope['type'] == 'websocket':
                await WebSocket(scope, receive, send).send_denial_response(refusal)
            else:
                await refusal(scope, receive, send)
            return

        async def send_guarded(message: Message) -> None:
            if message['type'] == 'http.response.start':
                MutableHeaders(scope=message).update(_HEADERS)
            await send(message)

        await self._app(scope, receive, send_guarded)


def _language(request: Request) -> str:
    return choose_language(request.query_params.get('lang'), request.headers.get('accept-language', ''))
