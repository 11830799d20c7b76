"""Who may reach the bench: requests by the name the server was given, from its own pages, with its token."""

from __future__ import annotations

import ipaddress
import secrets
import socket
from dataclasses import dataclass, field
from typing import TYPE_CHECKING
from urllib.parse import urlencode, urlsplit

if TYPE_CHECKING:
    from collections.abc import Mapping

LOOPBACK = '127.0.0.1'


@dataclass(frozen=True)
class Access:
    """What is asked of each request.

    Beyond loopback a link has a token, for there the names by which the machine may be reached are many.
    """

    host: str
    """That the server listens on."""
    port: int
    token: str | None = field(default=None, repr=False)

    @classmethod
    def of(cls, host: str, port: int) -> Access:
        """Return what is asked where the server listens on an address."""
        return cls(host, port, None if is_loopback(host) else secrets.token_urlsafe(18))

    @property
    def url(self) -> str:
        """The link to the page."""
        return self.link('', **({'token': self.token} if self.token else {}))

    def link(self, page: str, **query: str) -> str:
        """Return the link to a page by its name, with a query."""
        wildcard = host_is_wildcard(self.host)
        name = socket.gethostname() if wildcard else self.host
        shown = f'[{name}]' if ':' in name else name
        return f'http://{shown}:{self.port}/{page}' + (f'?{urlencode(query)}' if query else '')

    def refusal(self, headers: Mapping[str, str], query: Mapping[str, str], *, public: bool) -> str | None:
        """Return why a request is refused; None where it is not.

        Parameters
        ----------
        headers, query
            Of the request.
        public
            Whether what is asked for is the same for all, and needs no token.

        """
        host = headers.get('host', '')
        if not self._is_ours(host):
            return f'this is {self.host}:{self.port}, which answers to no other name'
        origin = headers.get('origin')
        if origin is not None and origin != f'http://{host}':  # whatever is no browser sends none
            return 'the request comes from another page'
        if (
            self.token
            and not public
            and not secrets.compare_digest(query.get('token', '').encode(), self.token.encode())
        ):
            return 'the link lacks its token: use the link that `kapitsa` printed'
        return None

    def _is_ours(self, host: str) -> bool:
        try:
            parts = urlsplit(f'//{host}')
            name, port = parts.hostname or '', parts.port
        except ValueError:
            return False
        if port != self.port and not (port is None and self.port == 80):
            return False
        if is_loopback(self.host):
            return is_loopback(name)
        if host_is_wildcard(self.host):
            return is_address(name) or name in {'localhost', socket.gethostname().lower()}
        return name == self.host.lower()


def is_address(name: str) -> bool:
    """Whether a name is an IP address, which no page elsewhere can have made point here."""
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def is_loopback(name: str) -> bool:
    """Whether a name is this machine's own, seen from itself."""
    return name == 'localhost' or (is_address(name) and ipaddress.ip_address(name).is_loopback)


def host_is_wildcard(name: str) -> bool:
    """Whether an address stands for all of this machine."""
    return is_address(name) and ipaddress.ip_address(name).is_unspecified
