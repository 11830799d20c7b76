"""The web server of a class."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from kapitsa_ros.web.guard import Guard
from kapitsa_ros.web.pages import shared_routes
from kapitsa_ros.web.student_routes import student_routes
from kapitsa_ros.web.teacher_routes import teacher_routes

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.types import ASGIApp

    from kapitsa_ros.web.access import Access
    from kapitsa_ros.web.classroom import Classroom


def class_application(room: Classroom, access: Access) -> ASGIApp:
    """Return the server's application."""

    async def health(request: Request) -> Response:  # noqa: ARG001
        running = sum(bench.runs for bench in room.benches)
        pages = sum(len(list(bench.pages)) for bench in room.benches)
        return JSONResponse({'benches': len(room.benches), 'running': running, 'pages': pages})

    routes = [*student_routes(room), *teacher_routes(room, access), Route('/health', health), *shared_routes()]
    return Guard(Starlette(routes=routes), access)
