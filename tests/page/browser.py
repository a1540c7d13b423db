"""A Chromium without a screen, driven through pipes by its own protocol (DevTools), of which this knows what the tests need."""

import base64
import fcntl
import json
import os
import pathlib
import select
import shutil
import subprocess
import tempfile
import time

FLAGS = [
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--no-first-run",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--hide-scrollbars",
    "--remote-debugging-pipe",
]
NO_WEBGL = ["--disable-gpu", "--disable-3d-apis"]


def program():
    return shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    """One page at a time. `messages`: what it wrote to its console, and errors; `requests`: addresses that it asked for."""

    def __init__(self, flags=(), width=1200, height=800):
        self.profile = tempfile.mkdtemp(prefix="selvage-browser-")
        to_it, from_us = os.pipe()
        from_it, to_us = os.pipe()
        # Above 3 and 4, where Chromium looks for its ends.
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_it, to_us)]
        for end in (to_it, to_us):
            os.close(end)

        def place():
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen(
            [
                program(),
                *FLAGS,
                *flags,
                f"--user-data-dir={self.profile}",
                f"--window-size={width},{height}",
                "about:blank",
            ],
            preexec_fn=place,
            pass_fds=(3, 4),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            stdin=subprocess.DEVNULL,
        )
        for end in ends:
            os.close(end)
        self.to, self.source = from_us, from_it
        self.waiting, self.number, self.session = b"", 0, None
        self.messages, self.requests, self.events = [], [], []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def close(self):
        if self.process.poll() is None:
            self.session = None
            try:
                self.call("Browser.close")
                self.process.wait(10)
            except (OSError, subprocess.TimeoutExpired, TimeoutError, EOFError):
                self.process.kill()
                self.process.wait()
        for end in (self.to, self.source):
            os.close(end)
        shutil.rmtree(self.profile, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _receive(self, seconds):
        """The next message; nothing when none has come."""
        end = time.monotonic() + seconds
        while b"\0" not in self.waiting:
            if not select.select([self.source], [], [], max(0, end - time.monotonic()))[0]:
                return None
            more = os.read(self.source, 1 << 20)
            if not more:
                raise EOFError("the browser has ended")
            self.waiting += more
        message, _, self.waiting = self.waiting.partition(b"\0")
        return json.loads(message)

    def _take(self, event):
        method, facts = event.get("method"), event.get("params", {})
        self.events.append(method)
        if method == "Runtime.consoleAPICalled":
            self.messages.append(
                (facts["type"], " ".join(str(a.get("value", a.get("description"))) for a in facts["args"]))
            )
        elif method == "Runtime.exceptionThrown":
            details = facts["exceptionDetails"]
            self.messages.append(("exception", details.get("exception", {}).get("description", details["text"])))
        elif method == "Log.entryAdded":
            self.messages.append((facts["entry"]["level"], facts["entry"]["text"]))
        elif method == "Network.requestWillBeSent":
            self.requests.append(facts["request"]["url"])

    def call(self, method, seconds=240, **facts):
        self.number += 1
        message = {"id": self.number, "method": method, "params": facts}
        if self.session:
            message["sessionId"] = self.session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.to, data) :]
        while True:
            answer = self._receive(seconds)
            if answer is None:
                raise TimeoutError(f"{method} took more than {seconds} s")
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self._take(answer)

    def open(
        self,
        path,
        wait="document.readyState === 'complete' && Boolean(window.selvage || document.querySelector('[role=alert]'))",
    ):
        self.messages, self.requests = [], []
        self.call("Page.navigate", url=pathlib.Path(path).resolve().as_uri())
        self.until(wait)
        self.settle()

    def until(self, condition, seconds=240):
        end = time.monotonic() + seconds
        while not self.run(condition):
            if time.monotonic() > end:
                raise TimeoutError(f"never came true: {condition}; the console has {self.messages}")
            time.sleep(0.05)

    def run(self, expression):
        """What JavaScript makes of it; promises are waited for."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"].get("exception", {}).get("description", str(result)))
        return result["result"].get("value")

    def settle(self):
        """Two frames on, all that was asked to be drawn is drawn."""
        self.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")

    def click(self, selector):
        self.run(f"document.querySelector({json.dumps(selector)}).click()")
        self.settle()

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def key(self, key, code=None, shift=False):
        text = {"text": key} if len(key) == 1 else {"text": "\r"} if key == "Enter" else {}
        facts = {"key": key, "code": code or key, "modifiers": 8 if shift else 0}
        virtual = {
            "Tab": 9,
            "Enter": 13,
            "ArrowLeft": 37,
            "ArrowUp": 38,
            "ArrowRight": 39,
            "ArrowDown": 40,
            "Escape": 27,
        }.get(key)
        if virtual:
            facts["windowsVirtualKeyCode"] = virtual
        self.call("Input.dispatchKeyEvent", type="keyDown", **facts, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", **facts)

    def screenshot(self):
        """PNG bytes."""
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
