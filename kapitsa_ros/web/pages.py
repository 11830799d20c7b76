"""Pages and what they are made of: all of it is read by the server's own names, and none comes from a client."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from kapitsa_ros.web.catalogue import choose_language, translated, words_of

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from starlette.requests import Request

    Answer = Callable[[Request], Awaitable[Response]]

STATIC = Path(__file__).parent / 'static'
_TYPES = {'.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml'}


@cache
def static_files() -> dict[str, tuple[bytes, str]]:
    """Return what is sent as it is, and its type, by the name it is asked for."""
    return {path.name: (path.read_bytes(), _TYPES[path.suffix]) for path in STATIC.iterdir() if path.suffix in _TYPES}


def page_route(path: str, name: str, guarded: Callable[[Answer], Answer] = lambda answer: answer) -> Route:
    """Return the route to a page, by the name of its file, in the language of whoever asks; `guarded` may refuse."""
    page = (STATIC / f'{name}.html').read_text(encoding='utf-8')

    async def answer(request: Request) -> Response:
        language = language_of(request)
        text = translated(page, language).replace('<html lang="en">', f'<html lang="{language}">')
        return Response(text, media_type='text/html', headers={'Vary': 'Accept-Language'})

    return Route(path, guarded(answer))


def shared_routes() -> list[Route]:
    """Return the routes to what all pages are made of."""

    async def words(request: Request) -> Response:
        return JSONResponse(words_of(language_of(request)))

    async def static(request: Request) -> Response:
        content, kind = static_files().get(request.path_params['name'], (None, ''))
        return PlainTextResponse('no such file', 404) if content is None else Response(content, media_type=kind)

    return [Route('/words.json', words), Route('/static/{name}', static)]


def csv_answer(text: str, name: str) -> Response:
    """Return a table that is to be saved, under a name of which letters and digits are kept."""
    plain = name.encode('ascii', 'ignore').decode()
    attachment = ''.join(sign for sign in plain if sign.isalnum() or sign in '_-') or 'table'
    headers = {'Content-Disposition': f'attachment; filename="{attachment}.csv"'}
    return Response(text, media_type='text/csv', headers=headers)


def language_of(request: Request) -> str:
    """Return the language of whoever asks."""
    return choose_language(request.query_params.get('lang'), request.headers.get('accept-language', ''))
