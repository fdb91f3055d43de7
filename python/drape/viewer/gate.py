# SPDX-License-Identifier: Apache-2.0
"""Who may see a page that is served.

A server on this machine's loopback address is reached by every page that a browser
of this machine shows, too: by a WebSocket, which asks nobody, or by a name of the
page's own that points to this machine (DNS rebinding). Such a page sends its own
name as Origin or as Host. Beyond this machine anybody may ask, and needs a token.
"""

from __future__ import annotations

import hmac
import http
import ipaddress
import re
import secrets
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs, urlsplit

from websockets import Headers
from websockets.asyncio import server
from websockets.http11 import Request, Response

from drape.errors import Error

COOKIE = "drape-token"
WITHOUT = "This page needs the address that drape view printed, with its token.\n"


def is_loopback(host: str) -> bool:
    """Whether a name or an address is reached from this machine alone; an Error if
    nobody has this name. localhost is this machine even where no list of names says
    so (RFC 6761)."""
    if host.lower() == "localhost":
        return True
    try:
        found = socket.getaddrinfo(host, None)
    except OSError as error:
        raise Error(f"{host}: no such host: {error.strerror}") from None
    return all(ipaddress.ip_address(each[4][0]).is_loopback for each in found)


# What browsers send: a name or an address, which may have a port behind it.
HOST = re.compile(r"(?:\[([0-9a-f:.]+)\]|([a-z0-9._-]+))(?::\d{1,5})?", re.IGNORECASE)


def _name(host: str) -> str:
    """Returns the name or address in a Host header, without its port; empty if the
    header is none."""
    found = HOST.fullmatch(host)
    return (found[1] or found[2]).lower() if found else ""


def _refused(status: http.HTTPStatus, text: str) -> Response:
    headers = Headers({"Content-Type": "text/plain; charset=utf-8"})
    return Response(status.value, status.phrase, headers, text.encode())


class Gate:
    """Answers the requests that a server must not.

    Attributes:
        token: what requests must show; None: those of this machine need none
        watched: whether a server asks this gate
    """

    def __init__(self, host: str) -> None:
        """For a server that listens on a host's name or address."""
        self.token = None if is_loopback(host) else secrets.token_urlsafe(16)
        self.names = {"localhost", "127.0.0.1", "::1", host.lower()}
        self.watched = False

    def answer(self, request: Request) -> Response | None:
        """Returns the answer to a request that is refused, or that has shown the
        token and is sent on with a cookie; None: the server may answer it."""
        forbidden = http.HTTPStatus.FORBIDDEN
        host, origins = (
            request.headers.get_all("Host"),
            request.headers.get_all("Origin"),
        )
        name = _name(host[0]) if len(host) == 1 else ""
        if not name or (self.token is None and name not in self.names):
            return _refused(forbidden, "This page has another host.\n")
        own = (f"http://{host[0]}", f"https://{host[0]}")  # https: by a proxy
        if any(each not in own for each in origins):
            return _refused(forbidden, "This page takes no other page's requests.\n")
        if self.token is None or self._is_token(self._cookie(request)):
            return None
        shown = parse_qs(urlsplit(request.path).query).get("token", [""])[0]
        if not self._is_token(shown):
            return _refused(forbidden, WITHOUT)
        # the token does not stay in the browser's address
        found = _refused(http.HTTPStatus.SEE_OTHER, "")
        found.headers["Location"] = "/"
        found.headers["Set-Cookie"] = (
            f"{COOKIE}={self.token}; HttpOnly; SameSite=Strict; Path=/"
        )
        return found

    def _is_token(self, shown: str) -> bool:
        expected = (self.token or "").encode()
        return hmac.compare_digest(shown.encode(errors="replace"), expected)

    @staticmethod
    def _cookie(request: Request) -> str:
        try:
            jar = SimpleCookie("; ".join(request.headers.get_all("Cookie")))
        except CookieError:
            return ""
        return jar[COOKIE].value if COOKIE in jar else ""

    @contextmanager
    def before(self) -> Iterator[None]:
        """Puts the gate before the server of websockets that is started meanwhile,
        in whatever thread; viser starts one and lends no way to its requests. Look
        at `watched` after it."""
        module: Any = server
        serve = module.serve

        def guarded(
            *arguments: Any, process_request: Callable[..., Any], **how: Any
        ) -> Any:
            def first(connection: server.ServerConnection, request: Request) -> Any:
                found = self.answer(request)
                return process_request(connection, request) if found is None else found

            self.watched = True
            return serve(*arguments, process_request=first, **how)

        module.serve = guarded
        try:
            yield
        finally:
            module.serve = serve
