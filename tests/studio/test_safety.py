"""Attacks on the studio, by clients that are no browser: each point of the issue's list."""

import json
import os
import re
import socket
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from tests.studio.conftest import PROGRAM, small_face, start, stop

PAGES = ["/", "/page/main.js", "/page/studio.css", "/nothing"]


def get(running, path="/", **headers):
    return httpx.get(running.site + path, headers=headers)


def known(running, **headers):
    return {"Cookie": running.cookie, **headers}


def socket_of(running, origin="same", cookie="own", host=None, path="/ws"):
    headers = {} if cookie is None else {
        "Cookie": running.cookie if cookie == "own" else cookie
    }  # fmt: skip
    if host is not None:
        headers["Host"] = host
    return connect(
        f"ws://127.0.0.1:{running.port}{path}", additional_headers=headers, max_size=1 << 26,
        origin=running.site if origin == "same" else origin,
    )  # fmt: skip


def ask(link, **message):
    """Sends a message and gives the first text with its number."""
    link.send(json.dumps({"n": 7, **message}))
    while True:
        data = link.recv(60)
        if isinstance(data, str) and json.loads(data).get("n") == 7:
            return json.loads(data)


def opened(link, file=0):
    found = ask(link, t="open", file=file)
    while found["t"] == "face" and not found["ready"]:
        data = link.recv(120)
        if isinstance(data, str) and json.loads(data)["t"] == "ready":
            break
    return found


# who gets in ------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", PAGES)
@pytest.mark.parametrize("cookie", [None, "", "cutis=x", "cutis-{port}=", "cutis-{port}=wrong"])
def test_without_the_token_there_is_nothing(running, path, cookie):
    headers = {} if cookie is None else {"Cookie": cookie.format(port=running.port)}
    answer = get(running, path, **headers)
    assert answer.status_code == 401
    assert "token" in answer.text


@pytest.mark.parametrize("query", ["token=wrong", "token=", "token=%ff", "token={t}&token={t}"])
def test_wrong_tokens_give_no_cookie(running, query):
    answer = get(running, "/?" + query.format(t=running.token))
    assert answer.status_code == 401
    assert "set-cookie" not in answer.headers


def test_the_token_is_in_the_address_once(running):
    answer = httpx.get(running.address)
    assert (answer.status_code, answer.headers["location"]) == (303, "/")
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    page = get(running, "/", **known(running))
    assert page.status_code == 200
    assert running.token not in page.text
    # only the first page takes it
    assert get(running, f"/page/main.js?token={running.token}").status_code == 401


@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", "127.0.0.1.evil:{port}",
     "localhost.:{port}", "[::1]:{port}", "", "127.0.0.1:{port}@evil"],
)  # fmt: skip
def test_names_that_lead_here_from_elsewhere_are_refused(running, host):
    """DNS rebinding: the browser believes it talks to evil.example."""
    host = host.format(port=running.port)
    with socket.create_connection(("127.0.0.1", running.port)) as raw:
        head = f"GET / HTTP/1.1\r\nHost: {host}\r\nCookie: {running.cookie}\r\n"
        raw.sendall(f"{head}Connection: close\r\n\r\n".encode())
        answer = raw.recv(100)
    assert answer.split()[1] in (b"403", b"400")


def test_two_hosts_are_refused(running):
    with socket.create_connection(("127.0.0.1", running.port)) as raw:
        raw.sendall(
            f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{running.port}\r\nHost: evil\r\n"
            f"Cookie: {running.cookie}\r\nConnection: close\r\n\r\n".encode()
        )
        assert raw.recv(100).split()[1] in (b"403", b"400")


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:{port}",
                                    "http://127.0.0.1:1", "http://127.0.0.1"])  # fmt: skip
@pytest.mark.parametrize("path", PAGES)
def test_other_origins_are_refused(running, path, origin):
    origin = origin.format(port=running.port)
    assert get(running, path, **known(running, Origin=origin)).status_code == 403


def test_scripts_of_other_sites_are_refused_links_are_not(running):
    asked = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Dest": "script"}
    assert get(running, "/page/main.js", **known(running), **asked).status_code == 403
    link = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Dest": "document"}
    assert httpx.get(running.address, headers=link).status_code == 303


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE"])
def test_nothing_is_taken_but_questions(running, method):
    answer = httpx.request(method, running.site + "/", headers=known(running), content=b"x" * 100)
    assert answer.status_code == 405


@pytest.mark.parametrize(
    ("origin", "cookie", "host"),
    [
        ("http://evil.example", "own", None),
        (None, "own", None),
        ("null", "own", None),
        ("same", None, None),
        ("same", "cutis=wrong", None),
        ("same", "own", "evil.example"),
    ],
)
def test_sockets_of_others_are_refused(running, origin, cookie, host):
    with pytest.raises(InvalidStatus) as refused, socket_of(running, origin, cookie, host):
        pass
    assert refused.value.response.status_code in (400, 401, 403)


def test_there_is_one_socket(running):
    with pytest.raises(InvalidStatus), socket_of(running, path="/page/ws"):
        pass


# what answers say -------------------------------------------------------------------------------


@pytest.mark.parametrize("path", PAGES)
def test_nothing_is_kept_framed_or_loaded_from_elsewhere(running, path):
    head = get(running, path, **known(running)).headers
    assert head["cache-control"] == "no-store"
    policy = dict(one.strip().split(" ", 1) for one in head["content-security-policy"].split(";"))
    assert policy["default-src"] == "'none'"
    assert policy["frame-ancestors"] == "'none'"
    assert not re.search("unsafe|data:|\\*|https?:", head["content-security-policy"])
    assert set(policy["connect-src"].split()) == {
        "'self'", f"ws://127.0.0.1:{running.port}", f"ws://localhost:{running.port}"
    }  # fmt: skip
    assert head["x-content-type-options"] == "nosniff"
    assert head["referrer-policy"] == "no-referrer"
    assert "access-control-allow-origin" not in head


ELSEWHERE = (
    r"https?://|\bimport\(|innerHTML|localStorage|indexedDB|sessionStorage|caches\.|eval\(|"
    "serviceWorker"
)
"""What a page loads or keeps by."""


def test_the_page_asks_nobody_else():
    """No address of another site is in the page's files."""
    from cutis.studio.server import page_files

    files = page_files()
    assert {"index.html", "main.js", "studio.css"} <= set(files)
    for name, path in files.items():
        if not name.startswith("vendor/"):
            text = path.read_text("utf-8").replace("http://www.w3.org/2000/svg", "")
            text = re.sub(r"/\*.*?\*/|^//.*?$", "", text, flags=re.S | re.M)
            assert not re.search(ELSEWHERE, text), name
            assert not re.search(r"<style|style=|onclick=|<script>", text) or path.suffix == ".js"


@pytest.mark.parametrize(
    "path",
    ["/page/../server.py", "/page/%2e%2e/server.py", "/page/..%2fserver.py", "/page//etc/passwd",
     "/../../etc/passwd", "/page/main.js/../../server.py", "/page/", "/face.png", "/faces/face.png",
     "/page/index.html%00.js"],
)  # fmt: skip
def test_no_path_reaches_the_disk(running, path):
    with socket.create_connection(("127.0.0.1", running.port)) as raw:
        raw.sendall(
            f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{running.port}\r\n"
            f"Cookie: {running.cookie}\r\nConnection: close\r\n\r\n".encode()
        )
        data = b""
        while piece := raw.recv(65536):
            data += piece
    assert data.split()[1] in (b"404", b"400")
    assert b"Starlette" not in data
    assert b"root:" not in data


# messages ---------------------------------------------------------------------------------------

BAD = [
    "", "null", "[]", "{}", "x", '{"t": "open"}', '{"t": "open", "file": "../secret.png"}',
    '{"t": "open", "file": -1}', '{"t": "open", "file": 1e99}', '{"t": "open", "file": 99999}',
    '{"t": "open", "file": 0, "path": "/etc/passwd"}',
    '{"t": "view", "left": NaN, "top": 0, "right": 1, "bottom": 1, "scale": 1}',
    '{"t": "view", "left": 0, "top": 0, "right": 1e300, "bottom": 1, "scale": 1}',
    '{"t": "view", "left": 0, "top": 0, "right": 1, "bottom": 1, "scale": 0}',
    '{"t": "view", "left": 0, "top": 0, "right": 1, "bottom": 1, "scale": 1, "show": ["../x"]}',
    '{"t": "read", "x": -1, "y": 0}', '{"t": "read", "x": 100000, "y": 5}',
    '{"t": "save", "kind": "albedo", "label": "../../evil"}',
    '{"t": "save", "kind": "albedo", "label": ""}',
    '{"t": "save", "kind": "albedo", "label": "a/b"}',
    '{"t": "save", "kind": "albedo", "label": "a\\u0000b"}',
    '{"t": "save", "kind": "shell", "label": "x"}',
    '{"t": "do", "op": {"op": "add", "layers": []}}', '{"t": "do", "op": {"op": "eval"}}',
    '{"t": "do", "op": {"op": "look", "look": {"cutis_look": 99}}}',
    '{"t": "do", "op": {"op": "look", "look": ' + '{"a":' * 300 + "1" + "}" * 300 + "}}",
    "[" * 100_000, '{"t": "go", "number": 12345678}', '{"t": "step", "by": 5}',
]  # fmt: skip


def test_broken_messages_are_answered_in_one_line_and_change_nothing(running):
    with socket_of(running) as link:
        opened(link)
        before = sorted(os.listdir(running.folder))
        for text in BAD:
            link.send(text)
            while True:
                data = link.recv(60)
                if isinstance(data, str) and json.loads(data)["t"] in ("error", "done"):
                    break
            said = json.loads(data)
            assert said["t"] == "error", text
            assert "\n" not in said["text"]
            assert "Traceback" not in said["text"]
            assert len(said["text"]) < 600
        assert ask(link, t="ask", what="history")["t"] == "history"
        assert sorted(os.listdir(running.folder)) == before
    assert not list(running.folder.parent.glob("evil*"))


def test_masks_in_files_cannot_be_named_by_the_page(running):
    """A picture part of a look names a file; what a page sends may not."""
    layer = {"mask": [{"part": "picture", "path": "../secret.png"}]}
    with socket_of(running) as link:
        opened(link)
        answer = ask(link, t="do", op={"op": "add", "layers": [layer]})
        assert answer["t"] == "error"
        assert "cannot name" in answer["text"]


def test_only_what_is_listed_opens(running):
    with socket_of(running) as link:
        hello = json.loads(link.recv(10))
        names = [one["name"] for one in hello["files"]]
        assert names[0] == "face.png"
        assert "secret.png" not in names
        assert all(set(one) == {"file", "name"} for one in hello["files"])
        said = json.dumps([hello, opened(link)])
        assert str(running.folder) not in said


def ended(running, messages):
    """The server ends a socket that sends these."""
    with socket_of(running) as link:
        try:
            for message in messages:
                link.send(message)
            for _ in range(10_000):
                link.recv(5)
        except ConnectionClosed:
            return
    raise AssertionError("the socket is still open")


def test_binary_messages_end_the_socket_only(running):
    ended(running, [b"\0" * 100])
    with socket_of(running) as link:
        assert opened(link)["t"] == "face"


def test_large_messages_end_the_socket(running):
    ended(running, ["x" * (5 << 20)])


def test_floods_end_the_socket_and_nobody_else_s(running):
    with socket_of(running) as quiet:
        opened(quiet)
        ended(running, ['{"t": "step", "by": 5}'] * 5000)
        assert ask(quiet, t="ask", what="files")["t"] == "files"


def test_a_page_that_goes_away_frees_its_work(running):
    view = {"t": "view", "left": 0, "top": 0, "right": 240, "bottom": 200, "scale": 1}
    for _ in range(12):
        with socket_of(running) as link:
            opened(link)
            for _ in range(50):
                link.send(json.dumps(view))
    threads = Path(f"/proc/{running.process.pid}/task")
    time.sleep(0.5)
    if threads.is_dir():
        assert len(list(threads.iterdir())) < 40
    with socket_of(running) as link:
        start = time.monotonic()
        opened(link)
        assert ask(link, t="read", x=5, y=5)["t"] == "reading"
        assert time.monotonic() - start < 10


def test_two_pages_do_not_lose_each_other_s_edits(running):
    with socket_of(running) as one, socket_of(running) as two:
        id = opened(one)["state"]["ids"][0]
        opened(two)

        def tune(link, name, by):
            edit = {"do": "multiply", "map": name, "by": by}
            return ask(link, t="do", op={"op": "tune", "id": id, "map": name, "edit": edit})

        assert tune(one, "melanin", 1.5)["t"] == "done"
        assert tune(two, "blood", 1.5)["t"] == "done"
        assert tune(one, "thickness", 1.2)["t"] == "done"
        state = ask(two, t="open", file=0)["state"]
        edits = {edit["map"]: edit["by"] for edit in state["look"]["layers"][0]["edits"]}
        assert edits == {"melanin": 1.5, "blood": 1.5, "thickness": 1.2}


# starting ---------------------------------------------------------------------------------------


def run(folder, *arguments):
    return subprocess.run(
        [sys.executable, "-c", PROGRAM, "studio", "--no-browser", *arguments],
        cwd=folder, capture_output=True, text=True, timeout=120,
    )  # fmt: skip


def test_a_taken_port_is_one_line(running, folder):
    done = run(folder, "face.png", "--port", str(running.port))
    assert done.returncode == 1
    assert re.fullmatch(r"cutis: cannot listen on .* --port 0 .*\n", done.stderr)
    assert done.stdout == ""


def test_a_missing_face_is_one_line(folder):
    done = run(folder, "nothing.png")
    assert done.returncode == 1
    assert done.stderr == "cutis: nothing.png: no such file; check the name\n"


def test_without_the_extra_it_says_what_to_install(folder):
    blocked = (
        "import sys, importlib.util as u; found = u.find_spec; "
        "u.find_spec = lambda name, *a: None if name == 'uvicorn' else found(name, *a); "
    )
    done = subprocess.run(
        [sys.executable, "-c", blocked + PROGRAM, "studio"],
        cwd=folder, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr == "cutis: the studio needs more packages: pip install 'cutis[studio]'\n"


def test_it_listens_on_this_machine_only(running):
    """No address of a network that this machine has answers."""
    for found in {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None)}:
        if not found.startswith("127.") and found != "::1":
            with pytest.raises(OSError), socket.create_connection((found, running.port), 2):  # noqa: PT011
                pass


def test_another_host_is_warned_of_and_needs_the_token(tmp_path):
    small_face(tmp_path)
    running = start(tmp_path, "face.png", "--host", "127.0.0.2")
    try:
        assert "can be reached by other machines" in running.said
        site = f"http://127.0.0.2:{running.port}"
        assert httpx.get(site).status_code == 401
        assert httpx.get(f"{site}/?token={running.token}").status_code == 303
        assert httpx.get(site, headers={"Host": "127.0.0.1"}).status_code == 403
    finally:
        stop(running)


def test_pictures_come_without_what_cameras_write(tmp_path):
    """GPS and serial numbers of a capture are neither shown nor in what is drawn."""
    from PIL import Image

    face = small_face(tmp_path, "face.jpg")
    with Image.open(face) as picture:
        exif = picture.getexif()
        exif[0x0110] = "CameraModelSecret"
        exif[0xA431] = "SERIAL-12345"
        exif.get_ifd(0x8825)[1] = "N"
        exif.get_ifd(0x8825)[2] = (48.0, 11.0, 12.0)
        picture.save(face, exif=exif, quality=95)
    assert b"SERIAL-12345" in face.read_bytes()
    running = start(tmp_path, "face.jpg")
    try:
        with socket_of(running) as link:
            said = json.dumps(opened(link))
            assert "SERIAL" not in said
            assert "Secret" not in said
            link.send(json.dumps({
                "t": "view", "left": 0, "top": 0, "right": 240, "bottom": 200, "scale": 1,
            }))  # fmt: skip
            while isinstance(data := link.recv(60), str):
                pass
            for word in (b"SERIAL", b"Secret", b"Exif", b"GPS"):
                assert word not in data
    finally:
        stop(running)


# the disk ---------------------------------------------------------------------------------------


def test_a_source_that_changes_or_goes_is_one_line_and_nothing_is_lost(tmp_path):
    face = small_face(tmp_path)
    content = face.read_bytes()
    running = start(tmp_path, "face.png")
    try:
        with socket_of(running) as link:
            state = opened(link)["state"]
            edit = {"do": "multiply", "map": "melanin", "by": 2}
            op = {"op": "tune", "id": state["ids"][0], "map": "melanin", "edit": edit}
            assert ask(link, t="do", op=op)["t"] == "done"
            small_face(tmp_path, box=(0, 0, 240, 200))
            said = ask(link, t="save", kind="albedo", label="a")
            assert said["t"] == "error"
            assert "changed since" in said["text"]
            face.unlink()
            said = ask(link, t="save", kind="albedo", label="a")
            assert said["t"] == "error"
            assert "missing" in said["text"]
            assert sorted(p.name for p in tmp_path.iterdir()) == ["face.png.studio"]
            face.write_bytes(content)
            assert ask(link, t="save", kind="albedo", label="a")["name"] == "face.a.png"
            assert ask(link, t="save", kind="albedo", label="a")["name"] == "face.a-2.png"
            assert face.read_bytes() == content
    finally:
        stop(running)


@pytest.mark.skipif(os.geteuid() == 0 and not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_folder_that_cannot_be_written_while_saving(tmp_path, workshop, monkeypatch):
    """A full disk while saving: one line, no half-written file."""
    import errno

    from cutis.errors import CutisError

    real = os.fsync

    def full(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    before = sorted(p.name for p in workshop.folder.iterdir())
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(CutisError, match=r"No space|space"):
        workshop.save("full")
    monkeypatch.setattr(os, "fsync", real)
    assert sorted(p.name for p in workshop.folder.iterdir()) == before
