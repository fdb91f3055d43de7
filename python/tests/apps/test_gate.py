# SPDX-License-Identifier: Apache-2.0
"""Who may see the page of `drape view`: requests as other pages send them."""

from __future__ import annotations

import re
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import pytest

WHY = "is not installed: no test of the page"
pytest.importorskip("viser", reason=f"viser {WHY}")
pytest.importorskip("pygltflib", reason=f"pygltflib {WHY}")
from drape.errors import Error  # noqa: E402
from drape.viewer.gate import Gate, is_loopback  # noqa: E402
from drape.viewer.page import Page  # noqa: E402
from drape.viewer.source import Recorded  # noqa: E402

SOCKET = (
    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
)


@contextmanager
def served(run: Path, host: str) -> Iterator[Page]:
    page = Page(Recorded(run), host, 0)
    thread = threading.Thread(target=page.serve)
    thread.start()
    try:
        yield page
    finally:
        page.close()
        thread.join()


def ask(port: int, path: str, headers: str) -> str:
    """What the server answers to a request: its head."""
    with socket.create_connection(("127.0.0.1", port), timeout=30) as s:
        s.sendall(f"GET {path} HTTP/1.1\r\n{headers}\r\n".encode())
        got = b""
        while b"\r\n\r\n" not in got and (more := s.recv(4096)):
            got += more
    return got.split(b"\r\n\r\n")[0].decode()


def code(answer: str) -> int:
    return int(answer.split()[1])


def test_another_page_is_refused(still: Path) -> None:
    with served(still, "127.0.0.1") as page:
        port, here = page.port, f"Host: 127.0.0.1:{page.port}\r\n"
        assert page.url == f"http://127.0.0.1:{port}"
        evil = "Origin: http://evil.example\r\n"
        for headers, expected in (
            (here, 200),
            (f"Host: localhost:{port}\r\n", 200),
            ("Host: localhost:9000\r\n", 200),  # a port that ssh forwards
            (f"Host: evil.example:{port}\r\n", 403),
            ("", 403),
            ("Host: [::1\r\n", 403),
            (f"Host: evil.example@127.0.0.1:{port}\r\n", 403),
            (f"Host: evil.example\\@127.0.0.1:{port}\r\n", 403),
            (f"Host: 127.0.0.1:{port}:evil.example\r\n", 403),
            (f"Host: [::1]:{port}\r\n", 200),
            (f"{here}{here}", 403),
            (here + evil, 403),
            (f"{here}Origin: null\r\n", 403),
            (f"{here}Origin: http://[::1\r\n", 403),
            (f"{here}Origin: ftp://127.0.0.1:{port}\r\n", 403),
            (f"{here}Origin: http://127.0.0.1:{port + 1}\r\n", 403),
            (f"{here}{SOCKET}Origin: http://127.0.0.1:{port}\r\n", 101),
            (here + SOCKET + evil, 403),
            (f"Host: evil.example\r\n{SOCKET}Origin: http://evil.example\r\n", 403),
        ):
            assert code(ask(port, "/", headers)) == expected, headers


def test_beyond_this_machine_a_token_is_asked_for(still: Path) -> None:
    with served(still, "0.0.0.0") as page:
        port, host = page.port, "Host: any.example\r\n"
        found = re.fullmatch(r"http://(.+):(\d+)/\?token=([\w-]{20,})", page.url)
        assert found and found[1] == socket.gethostname() and int(found[2]) == port
        token = found[3]
        socket_ = f"{host}{SOCKET}Origin: http://any.example\r\n"
        for path in ("/", "/?token=", "/?token=é", f"/?token={token[1:]}"):
            assert code(ask(port, path, host)) == 403
            assert code(ask(port, path, socket_)) == 403
        shown = ask(port, f"/?token={token}", host)
        assert code(shown) == 303 and "\r\nLocation: /\r\n" in shown
        cookie = re.search(r"Set-Cookie: ([^;]+); HttpOnly; SameSite=Strict", shown)
        assert cookie
        with_cookie = f"Cookie: other=1; {cookie[1]}\r\n"
        assert code(ask(port, "/", host + with_cookie)) == 200
        assert code(ask(port, "/", socket_ + with_cookie)) == 101
        wrong = f"Cookie: {cookie[1]}x\r\n"
        assert code(ask(port, "/", host + wrong)) == 403
        evil = f"{host}{SOCKET}Origin: http://evil.example\r\n"
        assert code(ask(port, "/", evil + with_cookie)) == 403


def test_what_this_machine_is() -> None:
    assert is_loopback("127.0.0.1") and is_loopback("localhost") and is_loopback("::1")
    assert not is_loopback("0.0.0.0") and not is_loopback("192.0.2.1")
    with pytest.raises(Error, match=r"nowhere\.invalid: no such host"):
        Gate("nowhere.invalid")


def test_no_server_without_the_gate(
    still: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As with a version of viser that starts its server in another way."""
    monkeypatch.setattr(Gate, "before", lambda _: nullcontext())
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        port = s.getsockname()[1]
    with pytest.raises(Error, match="cannot be guarded"):
        Page(Recorded(still), "127.0.0.1", port)
    with pytest.raises(ConnectionRefusedError):
        ask(port, "/", f"Host: 127.0.0.1:{port}\r\n")
