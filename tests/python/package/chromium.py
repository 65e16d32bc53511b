"""A page in headless Chromium, driven over the DevTools protocol on two pipes: nothing but Python's own library is needed.

    with Chromium.open(Path("page.html"), profile) as page:
        page.wait("window.page")
        page.click("#play")

Exceptions and errors in the console are kept in `page.errors`. WebGL is SwiftShader's, in software, so that any machine draws.
"""

import base64
import fcntl
import json
import os
import shutil
import subprocess
import time

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--no-first-run", "--disable-extensions", "--disable-background-networking", "--remote-debugging-pipe",
    "--disable-dev-shm-usage", "--force-device-scale-factor=1", "--window-size=1280,800",
)  # fmt: skip


def found():
    """The browser's path, or None: $TIDES_CHROMIUM, else one that is on the path."""
    return os.environ.get("TIDES_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)


class Chromium:
    def __init__(self, url, profile, limit=60):
        self.limit, self.errors, self._events, self._number, self._rest = limit, [], [], 0, b""
        self._read, answers = os.pipe()
        commands, self._write = os.pipe()
        high = [fcntl.fcntl(one, fcntl.F_DUPFD_CLOEXEC, 10) for one in (commands, answers)]  # neither is 3 or 4
        command = [found(), *FLAGS, f"--user-data-dir={profile}", "about:blank"]
        with open(profile / "chromium.log", "wb") as log:
            self._process = subprocess.Popen(
                ["bash", "-c", 'exec "$@" 3<&{} 4>&{}'.format(*high), "bash", *command],
                pass_fds=high, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
            )  # fmt: skip
        for one in (commands, answers, *high):
            os.close(one)
        self._session = None
        target = next(t for t in self.send("Target.getTargets")["targetInfos"] if t["type"] == "page")["targetId"]
        self._session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.send(f"{domain}.enable")
        self.send("Page.navigate", url=url)

    @classmethod
    def open(cls, file, profile, fragment=""):
        return cls(file.resolve().as_uri() + fragment, profile)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self._write)
        os.close(self._read)
        self._process.terminate()
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    # -- the protocol: JSON texts that end in a 0

    def _receive(self):
        while b"\0" not in self._rest:
            more = os.read(self._read, 1 << 20)
            if not more:
                raise RuntimeError("the browser has ended")
            self._rest += more
        text, self._rest = self._rest.split(b"\0", 1)
        return json.loads(text)

    def _note(self, message):
        kind, what = message["method"], message["params"]
        if kind == "Runtime.exceptionThrown":
            details = what["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description") or details["text"])
        elif kind == "Runtime.consoleAPICalled" and what["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(one.get("value", one.get("description"))) for one in what["args"]))
        elif kind == "Log.entryAdded" and what["entry"]["level"] in ("error", "warning"):
            self.errors.append(what["entry"]["text"])

    def send(self, method, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._receive()
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            if "method" in answer:
                self._note(answer)

    # -- what a user does and sees

    def do(self, script):
        """The value of an expression; promises are waited for."""
        got = self.send("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in got:
            raise RuntimeError(got["exceptionDetails"].get("exception", {}).get("description", "exception"))
        return got["result"].get("value")

    def _holds(self, condition):
        try:
            return self.do(f"Boolean({condition})")
        except RuntimeError as error:  # asked as the page before it gives way: not yet
            if "navigated or closed" not in str(error):
                raise
            return False

    def wait(self, condition):
        until = time.monotonic() + self.limit
        while not self._holds(condition):
            if time.monotonic() > until:
                raise TimeoutError(f"{condition}: not within {self.limit} s; errors: {self.errors}")
            time.sleep(0.05)

    def place(self, selector, x=0.5, y=0.5):
        """Where a part of an element is on the screen."""
        element = f"document.querySelector({json.dumps(selector)})"
        self.do(f"{element}.scrollIntoView({{block: 'nearest'}})")
        box = self.do(f"(b => [b.x, b.y, b.width, b.height])({element}.getBoundingClientRect())")
        return box[0] + x * box[2], box[1] + y * box[3]

    def mouse(self, kind, at, **more):
        self.send("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], **more)

    def drag(self, begin, end, steps=5):
        self.mouse("mousePressed", begin, button="left", buttons=1, clickCount=1)
        for i in range(1, steps + 1):
            at = [a + (b - a) * i / steps for a, b in zip(begin, end)]
            self.mouse("mouseMoved", at, button="left", buttons=1)
        self.mouse("mouseReleased", end, button="left", clickCount=1)

    def click(self, selector):
        at = self.place(selector)
        self.mouse("mousePressed", at, button="left", buttons=1, clickCount=1)
        self.mouse("mouseReleased", at, button="left", clickCount=1)

    def key(self, key, **more):
        text = {"text": key} if len(key) == 1 else {}
        self.send("Input.dispatchKeyEvent", type="keyDown", key=key, **text, **more)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=key, **more)

    def picture(self, file):
        file.write_bytes(base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"]))
