"""The web server of a replay: page, runs, motion, fit and report; nothing that a client sends leads to a file."""

from __future__ import annotations

import asyncio
from http import HTTPStatus
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from starlette.applications import Starlette
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from kapitsa_ros._api.report import report
from kapitsa_ros.errors import KapitsaError, said_of
from kapitsa_ros.message import said_by
from kapitsa_ros.web.catalogue import words_of
from kapitsa_ros.web.fit_values import fit_values
from kapitsa_ros.web.guard import DOCUMENT_POLICY, Guard
from kapitsa_ros.web.pages import language_of, page_route, shared_routes

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from starlette.requests import Request
    from starlette.types import ASGIApp

    from kapitsa_ros.web.access import Access
    from kapitsa_ros.web.recorded_runs import RecordedRuns


def replay_application(
    runs: RecordedRuns, paths: Sequence[Path], warnings: Sequence[str], beginning: Mapping[str, Any], access: Access
) -> ASGIApp:
    """Return the server's application.

    Parameters
    ----------
    runs
        That are shown.
    paths
        Of their bags, for the report.
    warnings
        To be told on the page: what is wrong with the bags together.
    beginning
        How the page is to begin: `start`, `rate`, `paused`, `loop`.
    access
        What is asked of each request.

    """
    worked_out = _Once(lambda: fit_values(runs.reduction()))
    written = _Once(lambda: _report(paths))

    async def listed(request: Request) -> Response:
        found = await asyncio.to_thread(runs.listed, words_of(language_of(request)))
        return JSONResponse({'runs': found, 'warnings': list(warnings), **beginning})

    async def motion(request: Request) -> Response:
        asked = request.query_params
        try:
            run, begin, count = (int(asked.get(name, '')) for name in ('run', 'from', 'count'))
            found = await asyncio.to_thread(runs.motion, run, begin, count, float(asked.get('dial', '0')))
        except (ValueError, KapitsaError) as error:
            said = said_of(error).said_by(words_of(language_of(request)))
            return PlainTextResponse(said, HTTPStatus.BAD_REQUEST)
        return Response(found, media_type='application/octet-stream')

    async def fit(request: Request) -> Response:
        words = words_of(language_of(request))
        try:
            values = await worked_out.result()
        except KapitsaError as error:
            return JSONResponse({'why': error.said.said_by(words)})
        return JSONResponse(
            {'why': None} | values | {'warnings': [said_by(text, words) for text in values['warnings']]}
        )

    async def laboratory_report(request: Request) -> Response:  # noqa: ARG001
        try:
            return HTMLResponse(await written.result(), headers=DOCUMENT_POLICY)
        except KapitsaError as error:
            return PlainTextResponse(f'{error}\n', HTTPStatus.SERVICE_UNAVAILABLE)

    routes = [
        page_route('/', 'replay'),
        Route('/runs.json', listed),
        Route('/motion', motion),
        Route('/fit.json', fit),
        Route('/report.html', laboratory_report),
    ]
    return Guard(Starlette(routes=[*routes, *shared_routes()]), access)


class _Once:
    """Long work, done in a thread when somebody first asks for it."""

    def __init__(self, work: Callable[[], Any]) -> None:
        self._work = work
        self._task: asyncio.Task[Any] | None = None

    async def result(self) -> Any:
        """Return what it came to, or raise what it raised."""
        if self._task is None:
            self._task = asyncio.get_running_loop().create_task(asyncio.to_thread(self._work))
        return await asyncio.shield(self._task)


def _report(paths: Sequence[Path]) -> str:
    with TemporaryDirectory(prefix='kapitsa-') as folder:
        page = Path(folder, 'report.html')
        report(paths, page)
        return page.read_text(encoding='utf-8')
