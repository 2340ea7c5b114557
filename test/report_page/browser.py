# SPDX-License-Identifier: BSD-3-Clause
"""A headless Chromium that chromedriver steers, by the W3C WebDriver protocol."""

import base64
import json
import re
import shutil
import subprocess
import time
import urllib.error
import urllib.request

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # the key of references to elements
ARROW_RIGHT = "\ue014"


def missing_programs():
    """Names those of the programs that are not installed."""
    return [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]


class Browser:
    def __init__(self, profile):
        self._driver = subprocess.Popen(
            ["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        port = None
        while port is None:
            line = self._driver.stdout.readline()
            if not line:
                raise RuntimeError("chromedriver ended before it listened")
            found = re.search(r"started successfully on port (\d+)", line)
            port = found and found.group(1)
        self._address = f"http://127.0.0.1:{port}/session"
        # SwiftShader is WebGL without a graphics card.
        arguments = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
                     "--enable-unsafe-swiftshader", "--window-size=1280,1000", f"--user-data-dir={profile}"]
        options = {"args": arguments, "binary": shutil.which("chromium")}
        session = self._call("POST", "", {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
        self._address += "/" + session["sessionId"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self._call("DELETE", "")
        finally:
            self._driver.terminate()
            self._driver.wait()

    def _call(self, method, path, body=None):
        data = None if method != "POST" else json.dumps(body or {}).encode()
        request = urllib.request.Request(self._address + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(f"{path}: {error.read().decode()}") from error

    def open(self, address):
        self._call("POST", "/url", {"url": address})

    def script(self, text):
        """The value that the body of a function returns in the page."""
        return self._call("POST", "/execute/sync", {"script": text, "args": []})

    def wait_for(self, condition, seconds=60):
        """Waits until an expression is true in the page."""
        end = time.monotonic() + seconds
        while not self.script(f"return Boolean({condition})"):
            if time.monotonic() > end:
                raise AssertionError(f"not true after {seconds} s: {condition}; console: {self.errors()}")
            time.sleep(0.02)

    def type(self, selector, text):
        element = self._call("POST", "/element", {"using": "css selector", "value": selector})[ELEMENT]
        self._call("POST", f"/element/{element}/value", {"text": text})

    def click(self, selector):
        element = self._call("POST", "/element", {"using": "css selector", "value": selector})[ELEMENT]
        self._call("POST", f"/element/{element}/click")

    def drag(self, begin, end, kind="mouse"):
        """Presses at a place of the window, moves to another one, and lets go; kind: mouse or touch."""
        moves = [{"type": "pointerMove", "duration": 0, "x": round(x), "y": round(y)} for x, y in (begin, end)]
        self._call("POST", "/actions", {"actions": [{
            "type": "pointer", "id": kind, "parameters": {"pointerType": kind},
            "actions": [moves[0], {"type": "pointerDown", "button": 0}, moves[1], {"type": "pointerUp", "button": 0}]}]})

    def errors(self):
        """The errors and warnings of the console since the last call."""
        log = self._call("POST", "/se/log", {"type": "browser"})
        return [entry["message"] for entry in log if entry["level"] in ("SEVERE", "WARNING")
                # What Chromium says of drawing without a graphics card.
                and "GL Driver Message" not in entry["message"] and "software WebGL" not in entry["message"]]

    def screenshot(self, path):
        path.write_bytes(base64.b64decode(self._call("GET", "/screenshot")))
