"""What stands before every page: who asks is looked at, and browsers are told to load nothing from elsewhere."""

from __future__ import annotations

from http import HTTPStatus
from typing import TYPE_CHECKING

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse
from starlette.websockets import WebSocket

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from kapitsa_ros.web.access import Access

PUBLIC = ('/static/', '/words.json')
"""Paths of what is the same for all."""
_HEADERS = {
    'Content-Security-Policy': "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    'X-Content-Type-Options': 'nosniff',
    'Referrer-Policy': 'no-referrer',
    'Cache-Control': 'no-store',
}
DOCUMENT_POLICY = {
    'Content-Security-Policy': "default-src 'none'; style-src 'unsafe-inline'; img-src data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
}
"""Header of a report, which holds its style and its figures, and no script."""


class Guard:
    """Refuses what does not come from the server's own pages, and tells browsers to load nothing from elsewhere."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self._app = app
        self._access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope['type'] not in {'http', 'websocket'}:
            await self._app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        public = connection.url.path.startswith(PUBLIC)
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
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        await self._app(scope, receive, send_guarded)
