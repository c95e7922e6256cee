"""Chromium without a window, driven by chromedriver's own HTTP protocol (WebDriver)."""

import base64
import json
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
MISSING = [
    name
    for name, path in {"chromium": BROWSER, "chromedriver": shutil.which("chromedriver")}.items()
    if path is None
]

_FLAGS = (
    "--headless", "--no-sandbox", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars", "--disable-dev-shm-usage",
)  # fmt: skip
_ELEMENT = "element-6066-11e4-a52e-4f735466cecf"


class Browser:
    """A window of `width` x `height` pixels; use it in a `with` block."""

    def __init__(
        self, width: int = 1360, height: int = 900, dark: bool = False, scale: float = 1,
        webgl: bool = True,
    ):  # fmt: skip
        with socket.socket() as found:
            found.bind(("127.0.0.1", 0))
            port = found.getsockname()[1]
        self.address = f"http://127.0.0.1:{port}"
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.process = subprocess.Popen(
            [shutil.which("chromedriver"), f"--port={port}"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        arguments = [*_FLAGS, f"--user-data-dir={self.folder.name}"]
        arguments += [f"--window-size={width},{height}"]
        arguments += ["--force-dark-mode"] * dark
        software = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
        arguments += software if webgl else ("--disable-gpu", "--disable-software-rasterizer")
        options = {"binary": BROWSER, "args": arguments}
        wanted = {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        self.path = ""
        self._wait_until_ready()
        answer = self.call("POST", "/session", capabilities={"alwaysMatch": wanted})
        self.path = f"/session/{answer['sessionId']}"
        # A window is at least 500 wide, a telephone is not.
        metrics = {"width": width, "height": height, "deviceScaleFactor": scale}
        self.developer("Emulation.setDeviceMetricsOverride", mobile=width < 500, **metrics)
        if width < 500:
            self.developer("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("DELETE", "")
        finally:
            self.process.terminate()
            self.process.wait(10)
            self.folder.cleanup()

    def call(self, method: str, path: str, **body):
        """One command of the protocol; RuntimeError with the browser's words if it refuses."""
        data = None if method == "GET" else json.dumps(body).encode()
        request = urllib.request.Request(self.address + self.path + path, data, method=method)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def developer(self, command: str, **parameters):
        """One command of Chromium's developer tools."""
        return self.call("POST", "/goog/cdp/execute", cmd=command, params=parameters)

    def open(self, page: Path) -> None:
        self.call("POST", "/url", url=page.resolve().as_uri())

    def ask(self, expression: str):
        """The value of a JavaScript expression."""
        return self.call("POST", "/execute/sync", script=f"return {expression};", args=[])

    def settle(self, seconds: float = 0.0) -> None:
        """Let the page draw what was asked of it, after `seconds`."""
        time.sleep(seconds)
        frames = "requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 20)))"
        self.call("POST", "/execute/async", script=f"const [done] = arguments; {frames};", args=[])

    def press(self, *keys: str) -> None:
        """Press keys one after another, where the focus is."""
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.call("POST", "/actions", actions=[{"type": "key", "id": "keys", "actions": actions}])

    def drag(self, selector: str, right: int, down: int) -> None:
        """Drag from the middle of an element."""
        found = self.call("POST", "/element", using="css selector", value=selector)
        origin = {_ELEMENT: found[_ELEMENT]}
        self.call("POST", "/actions", actions=[{
            "type": "pointer", "id": "mouse", "actions": [
                {"type": "pointerMove", "origin": origin, "x": 0, "y": 0, "duration": 0},
                {"type": "pointerDown", "button": 0},
                {"type": "pointerMove", "origin": origin, "x": right, "y": down, "duration": 100},
                {"type": "pointerUp", "button": 0},
            ],
        }])  # fmt: skip

    def middle(self, selector: str) -> tuple[float, float]:
        """The middle (pixels) of an element, after that was brought to the middle of the window."""
        found = f"document.querySelector('{selector}')"
        self.ask(f"{found}.scrollIntoView({{behavior: 'instant', block: 'center'}})")
        self.settle()
        box = f"{found}.getBoundingClientRect()"
        return tuple(self.ask(f"[{box}.x + {box}.width / 2, {box}.y + {box}.height / 2]"))

    def touch(self, selector: str, *ways: tuple[tuple[float, float], tuple[float, float]]) -> None:
        """Move a finger each along a way, from one place to another (pixels from the element's
        `middle`)."""
        x, y = self.middle(selector)
        for step in range(6):
            places = [
                {"id": i, "x": x + a + (c - a) * step / 5, "y": y + b + (d - b) * step / 5}
                for i, ((a, b), (c, d)) in enumerate(ways)
            ]
            kind = "touchMove" if step else "touchStart"
            self.developer("Input.dispatchTouchEvent", type=kind, touchPoints=places)
        self.developer("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.settle()

    def tap(self, selector: str) -> None:
        """Tap an element until it has the focus: a slow tap is taken for a long press."""
        x, y = self.middle(selector)
        for _ in range(10):
            for kind, places in (("touchStart", [{"id": 0, "x": x, "y": y}]), ("touchEnd", [])):
                self.developer("Input.dispatchTouchEvent", type=kind, touchPoints=places)
            self.settle(0.1)
            if self.ask(f"document.activeElement === document.querySelector('{selector}')"):
                return
        raise AssertionError(f"tapping {selector} gives it no focus")

    def errors(self) -> list[str]:
        """What the console complained about since the last call."""
        entries = self.call("POST", "/se/log", type="browser")
        return [e["message"] for e in entries if e["level"] in ("SEVERE", "WARNING")]

    def screenshot(self, path: Path, whole: bool = False) -> None:
        if whole:
            extra = {"captureBeyondViewport": True}
            size = self.developer("Page.getLayoutMetrics")["cssContentSize"]
            extra["clip"] = {**size, "scale": 1}
            data = self.developer("Page.captureScreenshot", **extra)["data"]
        else:
            data = self.call("GET", "/screenshot")
        path.write_bytes(base64.b64decode(data))

    def print(self, path: Path) -> None:
        data = self.call("POST", "/print", page={"width": 21.0, "height": 29.7}, background=True)
        path.write_bytes(base64.b64decode(data))

    def _wait_until_ready(self) -> None:
        for _ in range(100):
            try:
                self.call("GET", "/status")
                return
            except (urllib.error.URLError, ConnectionError):
                time.sleep(0.1)
        raise RuntimeError("chromedriver does not answer")
