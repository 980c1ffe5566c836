"""Debian's Firefox without a window, by its Marionette protocol: Debian has no driver for it."""
import contextlib
import json
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path


class Page:
    """One page, with as much of chromium.Page as is needed here. What Firefox complains of is not told."""

    def __init__(self):
        self.messages, self.next, self.pending = [], 0, b""
        self.profile = tempfile.TemporaryDirectory(prefix="firefox")
        port = free_port()
        Path(self.profile.name, "user.js").write_text(f'user_pref("marionette.port", {port});\n')
        self.process = subprocess.Popen([program(), "--headless", "--marionette", "--no-remote", "--profile", self.profile.name],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.socket = connected(port, self.process)
        self.answer()  # what Firefox says of itself
        self.call("WebDriver:NewSession")
        self.call("WebDriver:SetTimeouts", script=1_800_000)

    def __exit__(self, *_):
        with contextlib.suppress(RuntimeError, ConnectionError):  # it may end before it has answered
            self.call("Marionette:Quit")
        self.process.wait(60)
        self.socket.close()
        shutil.rmtree(self.profile.name, ignore_errors=True)

    def answer(self):
        while b":" not in self.pending:
            self.receive()
        length, _, self.pending = self.pending.partition(b":")
        while len(self.pending) < int(length):
            self.receive()
        text, self.pending = self.pending[:int(length)], self.pending[int(length):]
        return json.loads(text)

    def receive(self):
        part = self.socket.recv(1 << 20)
        if not part:
            raise RuntimeError("the browser has ended")
        self.pending += part

    def call(self, name: str, **parameters):
        self.next += 1
        text = json.dumps([0, self.next, name, parameters]).encode()
        self.socket.sendall(b"%d:%s" % (len(text), text))
        _, _, error, result = self.answer()
        if error:
            raise RuntimeError(f"{name}: {error}")
        return result

    def open(self, file: Path, *_):
        self.call("WebDriver:Navigate", url=file.resolve().as_uri())

    def does(self, script: str):
        """What a script gives, as JSON."""
        told = self.call("WebDriver:ExecuteAsyncScript", args=[], script=f"""
          const done = arguments[0];
          Promise.resolve({script}).then((value) => done({{ value }}), (error) => done({{ error: String(error) }}));""")["value"]
        if "error" in told:
            raise RuntimeError(f"{script}\n{told['error']}")
        return told.get("value")


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def connected(port: int, process, seconds: float = 60):
    end = time.monotonic() + seconds
    while process.poll() is None and time.monotonic() < end:
        try:
            return socket.create_connection(("127.0.0.1", port))
        except OSError:
            time.sleep(0.1)
    raise RuntimeError("Firefox does not answer")


def program():
    return shutil.which("firefox-esr") or shutil.which("firefox")
