"""Debian's Chromium without a window, by its DevTools protocol over two pipes: no driver and no port.

Not Selenium: it has no call of its own for a page's printed form, its accessibility tree, a colour scheme or what it asks
the network for, so that most of this file would stay, as commands that it passes on, beside two more packages.
"""
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path


class Page:
    """One page. What the browser complains of is collected in `messages`."""

    def __init__(self, patience: float = 120):
        self.patience = patience
        self.messages, self.events, self.next = [], [], 0
        self.profile = tempfile.TemporaryDirectory(prefix="chromium")
        here_in, there_out = os.pipe()
        there_in, here_out = os.pipe()

        def connect():  # the browser reads descriptor 3 and writes descriptor 4
            pipes = os.dup(there_in), os.dup(there_out)
            os.dup2(pipes[0], 3)
            os.dup2(pipes[1], 4)

        self.process = subprocess.Popen(
            [program(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
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

    def __enter__(self):
        return self

    def __exit__(self, *_):
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
        self.events.clear()
        self.call("Page.navigate", url=file.resolve().as_uri())
        while "Page.loadEventFired" not in self.events:
            self.answer()

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


def program():
    return shutil.which("chromium") or shutil.which("chromium-browser")
