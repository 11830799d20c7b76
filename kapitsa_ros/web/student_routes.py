"""What students of a class reach: the page to join, and each their own bench."""

from __future__ import annotations

import json
from functools import wraps
from http import HTTPStatus
from typing import TYPE_CHECKING, Any

from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute

from kapitsa_ros.web.catalogue import words_of
from kapitsa_ros.web.errors import PageRequestError
from kapitsa_ros.web.page_link import serve_page
from kapitsa_ros.web.pages import csv_answer, language_of, page_route

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.websockets import WebSocket

    from kapitsa_ros.web.classroom import Classroom
    from kapitsa_ros.web.pages import Answer
    from kapitsa_ros.web.student_bench import StudentBench

_LONGEST_BODY = 2048
"""Bytes of a request to join."""
_NO_BENCH = 'this link leads to no bench: join the class again, or ask the teacher for your link\n'


def student_routes(room: Classroom) -> list[BaseRoute]:
    """Return the routes."""

    def bench_asked(asked: Request | WebSocket) -> StudentBench | None:
        return room.bench_of(asked.query_params.get('bench', ''))

    def with_bench(answer: Answer) -> Answer:
        @wraps(answer)
        async def guarded(request: Request) -> Response:
            if bench_asked(request) is None:
                return PlainTextResponse(_NO_BENCH, HTTPStatus.FORBIDDEN)
            return await answer(request)

        return guarded

    async def join(request: Request) -> Response:
        try:
            values = await _body(request)
            bench = room.join(str(values.get('code', '')), str(values.get('name', '')))
        except PageRequestError as error:
            why = error.said.said_by(words_of(language_of(request)))
            return JSONResponse({'why': why}, HTTPStatus.FORBIDDEN)
        return JSONResponse({'bench': bench.number, 'link': f'student?bench={bench.record.key}'})

    async def book(request: Request) -> Response:
        bench = bench_asked(request)
        assert bench is not None  # noqa: S101  # whoever asks was let pass
        return csv_answer(bench.state.notebook.text(), f'bench_{bench.number:02d}')

    async def link(socket: WebSocket) -> None:
        bench = bench_asked(socket)
        if bench is None:
            await socket.send_denial_response(PlainTextResponse(_NO_BENCH, HTTPStatus.FORBIDDEN))
            return
        await bench.begin()
        await serve_page(bench, socket)

    return [
        page_route('/', 'join'),
        Route('/join', join, methods=['POST']),
        page_route('/student', 'index', with_bench),
        Route('/book.csv', with_bench(book)),
        WebSocketRoute('/bench', link),
    ]


async def _body(request: Request) -> dict[str, Any]:
    content = b''
    async for part in request.stream():
        content += part
        if len(content) > _LONGEST_BODY:
            raise PageRequestError('longer than a request to join')
    try:
        values = json.loads(content)
    except (ValueError, RecursionError):
        values = None
    if not isinstance(values, dict):
        raise PageRequestError('a request to join is a JSON object with "code" and "name"')
    return values
