"""A small client of chromedriver, with the standard library alone."""

import base64
import json
import pathlib
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request


def found():
    """The browser and its driver; nothing where one is not there."""
    browser = next(filter(None, map(shutil.which, ["chromium", "chromium-browser", "google-chrome"])), None)
    driver = shutil.which("chromedriver")
    return (browser, driver) if browser and driver else None


class Browser:
    """A headless browser with a profile of its own."""

    def __init__(self, browser, driver, width=1400, height=900):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.process = subprocess.Popen([driver, f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.address = f"http://127.0.0.1:{port}"
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
                 "--disable-component-update", "--disable-sync", "--enable-unsafe-swiftshader", f"--user-data-dir={self.profile.name}",
                 f"--window-size={width},{height}", "--hide-scrollbars"]
        options = {"binary": browser, "args": flags}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        for attempt in range(100):
            try:
                self.session = self.call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]
                break
            except (urllib.error.URLError, ConnectionError) as error:
                if attempt == 99 or isinstance(error, urllib.error.HTTPError):
                    self.process.kill()
                    raise
                time.sleep(0.1)
        self.call("POST", f"/session/{self.session}/timeouts", {"script": 60_000, "pageLoad": 30_000})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("DELETE", f"/session/{self.session}")
        finally:
            self.process.terminate()
            self.process.wait()
            self.profile.cleanup()

    def call(self, method, path, body=None):
        data = None if method == "DELETE" else json.dumps(body or {}).encode()
        request = urllib.request.Request(self.address + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]

    def post(self, path, body=None):
        return self.call("POST", f"/session/{self.session}{path}", body)

    def tool(self, command, **parameters):
        """A command of the browser's own protocol for tools."""
        return self.post("/goog/cdp/execute", {"cmd": command, "params": parameters})

    def open(self, page, query=""):
        address = pathlib.Path(page).resolve().as_uri() + query
        self.post("/url", {"url": address})
        # On a busy machine the driver answers before the scripts of the page have run.
        for _ in range(600):
            if self.run("return [location.href, document.readyState]") == [address, "complete"]:
                return
            time.sleep(0.05)
        raise TimeoutError(f"{address} was not loaded within half a minute")

    def screen(self, width, height, dark=False, calm=False, touch=False):
        self.tool("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=touch)
        features = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
                    {"name": "prefers-reduced-motion", "value": "reduce" if calm else "no-preference"}]
        self.tool("Emulation.setEmulatedMedia", features=features)

    def run(self, script, *arguments):
        """The value of a script that returns one, or a promise of one."""
        return self.post("/execute/sync", {"script": script, "args": list(arguments)})

    def press(self, key):
        keys = {"Space": (" ", 32), "ArrowRight": ("ArrowRight", 39), "ArrowLeft": ("ArrowLeft", 37), "End": ("End", 35), "Home": ("Home", 36)}
        name, code = keys[key]
        for kind in ["keyDown", "keyUp"]:
            text = {"text": " "} if name == " " and kind == "keyDown" else {}
            self.tool("Input.dispatchKeyEvent", type=kind, key=name, code=key, windowsVirtualKeyCode=code, **text)

    def point(self, x, y):
        self.tool("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

    def complaints(self):
        """What the console said that is no remark of the graphics driver."""
        said = self.post("/se/log", {"type": "browser"})
        return [line["message"] for line in said if "GL Driver Message" not in line["message"] and "GroupMarkerNotSet" not in line["message"]]

    def picture(self, path):
        pathlib.Path(path).write_bytes(base64.b64decode(self.tool("Page.captureScreenshot", format="png")["data"]))
