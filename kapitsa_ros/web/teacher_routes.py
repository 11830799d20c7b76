"""What the teacher of a class reaches by a link of their own: who is where, tables, and the report."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from functools import wraps
from http import HTTPStatus
from typing import TYPE_CHECKING, Any

from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from kapitsa_ros.analysis.class_coverage import coverage_of
from kapitsa_ros.errors import MissingPackageError
from kapitsa_ros.extras import import_of_extra
from kapitsa_ros.web.class_tables import books_csv, class_csv
from kapitsa_ros.web.guard import DOCUMENT_POLICY
from kapitsa_ros.web.pages import csv_answer, page_route

if TYPE_CHECKING:
    from starlette.requests import Request

    from kapitsa_ros.web.access import Access
    from kapitsa_ros.web.classroom import Classroom
    from kapitsa_ros.web.pages import Answer

_NO_TEACHER = "this link is not the teacher's: use the one that `kapitsa serve` printed\n"


def teacher_routes(room: Classroom, access: Access) -> list[Route]:
    """Return the routes; each answers to the teacher alone."""
    name = room.folder.path.name

    def guarded(answer: Answer) -> Answer:
        @wraps(answer)
        async def answer_teacher(request: Request) -> Response:
            if not room.is_teacher(request.query_params.get('token', '')):
                return PlainTextResponse(_NO_TEACHER, HTTPStatus.FORBIDDEN)
            return await answer(request)

        return answer_teacher

    async def values(request: Request) -> Response:  # noqa: ARG001
        rows = await room.rows()
        for row, bench in zip(rows, room.benches, strict=True):
            row['link'] = access.link('student', bench=bench.record.key) if bench.record.name else None
        told = {'benches': rows, 'join': access.link('', join=room.folder.join_code), 'code': room.folder.join_code}
        return JSONResponse(told | {'coverage': asdict(coverage_of(rows))})

    async def table(request: Request) -> Response:  # noqa: ARG001
        return csv_answer(class_csv(await room.rows()), name)

    async def books(request: Request) -> Response:  # noqa: ARG001
        return csv_answer(books_csv(room), f'{name}_books')

    async def report(request: Request) -> Response:  # noqa: ARG001
        rows = await room.rows()
        try:
            return HTMLResponse(await asyncio.to_thread(_report, rows), headers=DOCUMENT_POLICY)
        except MissingPackageError as error:
            return PlainTextResponse(f'{error}\n', HTTPStatus.SERVICE_UNAVAILABLE)

    answers = {'/teacher.json': values, '/class.csv': table, '/books.csv': books, '/report.html': report}
    return [
        page_route('/teacher', 'teacher', guarded),
        *(Route(path, guarded(answer)) for path, answer in answers.items()),
    ]


def _report(rows: list[dict[str, Any]]) -> str:
    reports = import_of_extra('kapitsa_ros.reporting.report', 'a report', 'report')
    page: str = reports.as_html(reports.class_document(rows))
    return page
