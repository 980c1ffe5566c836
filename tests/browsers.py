"""Browsers without a window, of which tests look at pages; and what these tests have in common."""
import base64
import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

WIDTHS = {"phone": 390, "desk": 1280}


class Chromium:
    """Debian's Chromium, by its DevTools protocol over two pipes: no driver and no port. What the browser complains of is collected in `messages`.

    Not Selenium: it has no call of its own for a page's printed form, its accessibility tree, a colour scheme or what it asks the
    network for, so that most of this class would stay, as commands that it passes on, beside two more packages."""

    @staticmethod
    def program():
        return shutil.which("chromium") or shutil.which("chromium-browser")

    def __init__(self):
        self.messages, self.events, self.next = [], [], 0
        self.profile = tempfile.TemporaryDirectory(prefix="chromium")
        here_in, there_out = os.pipe()
        there_in, here_out = os.pipe()

        def connect():  # the browser reads descriptor 3 and writes descriptor 4
            pipes = os.dup(there_in), os.dup(there_out)
            os.dup2(pipes[0], 3)
            os.dup2(pipes[1], 4)

        self.process = subprocess.Popen(
            [self.program(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
             "--no-first-run", "--disable-background-networking", "--disable-component-update", "--lang=en-GB",
             f"--user-data-dir={self.profile.name}", "--remote-debugging-pipe", "about:blank"],
            preexec_fn=connect, close_fds=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(there_in)
        os.close(there_out)
        self.reader, self.writer, self.session, self.pending = here_in, here_out, None, b""
        targets = self.call("Target.getTargets")["targetInfos"]
        target = next(each["targetId"] for each in targets if each["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network", "DOM", "Accessibility"):
            self.call(f"{domain}.enable")

    def close(self):
        self.process.terminate()
        self.process.wait(30)
        os.close(self.reader)
        os.close(self.writer)
        time.sleep(0.2)  # its children write to the profile for a moment more
        shutil.rmtree(self.profile.name, ignore_errors=True)

    def call(self, method: str, **parameters):
        self.next += 1
        command = {"id": self.next, "method": method, "params": parameters}
        if self.session:
            command["sessionId"] = self.session
        os.write(self.writer, json.dumps(command).encode() + b"\0")
        while True:
            answer = self.answer()
            if answer.get("id") == self.next:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def answer(self) -> dict:
        """The next answer or event; of events, what is wrong with a page is kept."""
        while b"\0" not in self.pending:
            part = os.read(self.reader, 1 << 20)
            if not part:
                raise RuntimeError("the browser has ended")
            self.pending += part
        text, _, self.pending = self.pending.partition(b"\0")
        event = json.loads(text)
        method, parameters = event.get("method"), event.get("params", {})
        if method == "Runtime.consoleAPICalled":
            self.messages.append(" ".join(str(each.get("value", each.get("description"))) for each in parameters["args"]))
        elif method == "Runtime.exceptionThrown":
            self.messages.append(json.dumps(parameters["exceptionDetails"])[:500])
        elif method == "Log.entryAdded":
            self.messages.append(parameters["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            url = parameters["request"]["url"]
            if not url.startswith(("file:", "data:", "about:", "blob:")):
                self.messages.append(f"asks for {url}")
        self.events.append(method)
        return event

    def open(self, file: Path, width: int, scheme: str = "light", media: str = "screen"):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=width < 600)
        self.call("Emulation.setEmulatedMedia", media=media, features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.load(lambda: self.call("Page.navigate", url=file.resolve().as_uri()))

    def load(self, begin):
        """Until the page is loaded, which begin() begins."""
        self.events.clear()
        begin()
        while "Page.loadEventFired" not in self.events:
            self.answer()

    def load_again(self, link: str = ""):
        """The page anew, with a link's end as its address has it."""
        self.load(lambda: self.does((f"location.replace('#{link}'); " if link else "") + "location.reload(); 0"))

    def does(self, script: str):
        """What a script gives, as JSON."""
        result = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{script}\n{result['exceptionDetails'].get('exception', {}).get('description')}")
        return result["result"].get("value")

    def moves(self, x: float, y: float):
        self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

    def presses(self, key: str):
        for what in ("rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=what, key=key, code=key)

    def screenshot(self, file: Path, of: str = "body"):
        """A picture of what a selector names, as much of it as the browser can draw at once."""
        box = self.does(f"""(() => {{
          const {{left, top, width, height}} = document.querySelector("{of}").getBoundingClientRect();
          return {{x: left + scrollX, y: top + scrollY, width, height: Math.min(height, 16000)}};
        }})()""")
        picture = self.call("Page.captureScreenshot", captureBeyondViewport=True, clip={**box, "scale": 1})
        file.write_bytes(base64.b64decode(picture["data"]))


class Firefox:
    """Debian's Firefox, by its Marionette protocol, for which Debian has no driver; with as much of Chromium as is needed here. What Firefox complains of is not told."""

    @staticmethod
    def program():
        return shutil.which("firefox-esr") or shutil.which("firefox")

    def __init__(self):
        self.messages, self.next, self.pending = [], 0, b""
        self.profile = tempfile.TemporaryDirectory(prefix="firefox")
        port = free_port()
        Path(self.profile.name, "user.js").write_text(f'user_pref("marionette.port", {port});\n')
        self.process = subprocess.Popen([self.program(), "--headless", "--marionette", "--no-remote", "--profile", self.profile.name],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.socket = connected(port, self.process)
        self.answer()  # what Firefox says of itself
        self.call("WebDriver:NewSession")
        self.call("WebDriver:SetTimeouts", script=1_800_000)

    def close(self):
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


class InABrowser(unittest.TestCase):
    """Tests of pages in one browser; nothing may go wrong in it, and nothing be asked for outside."""

    kind = Chromium

    @classmethod
    def setUpClass(cls):
        cls.page = cls.kind()

    @classmethod
    def tearDownClass(cls):
        cls.page.close()

    def setUp(self):
        self.page.messages.clear()

    def tearDown(self):
        self.assertEqual(self.page.messages, [], "nothing is asked for outside, and the browser's console is empty")

    def each_width(self, file: Path):
        for name, width in WIDTHS.items():
            with self.subTest(f"{file.stem}, {name}"):
                self.page.open(file, width)
                yield name


def demand_chromium():
    if not Chromium.program():
        print("skipped: Chromium is not here (Debian: chromium)")
        sys.exit(77)
