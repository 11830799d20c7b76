"""The link to one page: requests come in, checked and counted; reports and motion go out."""

from __future__ import annotations

import asyncio
import json
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from starlette.websockets import WebSocketDisconnect

from kapitsa_ros.message import Message
from kapitsa_ros.web.catalogue import choose_language, words_of
from kapitsa_ros.web.errors import PageRequestError
from kapitsa_ros.web.page_actions import carry_out
from kapitsa_ros.web.page_client import PageClient
from kapitsa_ros.web.protocol import parse_request
from kapitsa_ros.web.request_limit import REQUESTS_PER_SECOND, RequestLimit

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

    from kapitsa_ros.web.web_bench import WebBench

_LONGEST_KEY = 64
_TOO_MANY = Message('more than {most:.0f} requests a second: some were left out')
_NOT_UNDERSTOOD, _ABUSED, _FULL = 1003, 1008, 1013
"""Codes by which a link is closed (RFC 6455)."""


async def serve_page(bench: WebBench, socket: WebSocket) -> None:
    """Serve a page until its link is closed."""
    query = socket.query_params
    language = choose_language(query.get('lang'), socket.headers.get('accept-language', ''))
    key, load = (query.get(name, '')[:_LONGEST_KEY] or f'{id(socket)}' for name in ('key', 'load'))
    page = PageClient(key, load, language)
    await socket.accept()
    try:
        bench.pages.join(page, time.monotonic())
    except PageRequestError as error:
        await socket.close(_FULL, str(error))
        return
    bench.welcome(page)
    sending = asyncio.create_task(_send(socket, page))
    try:
        await _receive(bench, socket, page)
    except WebSocketDisconnect:
        pass
    finally:
        bench.pages.leave(page, time.monotonic())
        sending.cancel()
        with suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError):
            await sending
        bench.changed()


async def _receive(bench: WebBench, socket: WebSocket, page: PageClient) -> None:
    limit = RequestLimit(time.monotonic())
    while True:
        frame = await socket.receive()
        if frame['type'] == 'websocket.disconnect':
            return
        now = time.monotonic()
        if not limit.allows(now):
            if limit.is_to_be_told(now):
                _refuse(page, Message(_TOO_MANY, most=REQUESTS_PER_SECOND))
            if limit.exhausted:
                await socket.close(_ABUSED, f'more than {REQUESTS_PER_SECOND:.0f} requests a second')
                return
            continue
        text = frame.get('text')
        if text is None:
            await socket.close(_NOT_UNDERSTOOD, 'requests are text: one JSON object a frame')
            return
        try:
            request = parse_request(text)
            if not bench.pages.works(page):
                raise PageRequestError('another page works this bench: this one watches')  # noqa: TRY301
            await carry_out(bench, request)
        except PageRequestError as error:
            _refuse(page, error.said)


def _refuse(page: PageClient, why: Message) -> None:
    said = why.said_by(words_of(page.language))
    page.tell('refusal', json.dumps({'kind': 'refusal', 'why': said, 'at': time.monotonic()}))


async def _send(socket: WebSocket, page: PageClient) -> None:
    while True:
        for frame in await page.next():
            if isinstance(frame, str):
                await socket.send_text(frame)
            else:
                await socket.send_bytes(frame)
            await asyncio.sleep(0)  # a link that was lost is noticed, or each frame of many would be a line on stderr
