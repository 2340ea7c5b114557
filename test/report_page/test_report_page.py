# SPDX-License-Identifier: BSD-3-Clause
"""Opens the page of a run in a headless Chromium, and uses it as a reader does.

    test_report_page.py PROGRAM FOLDER

The screenshots stay in FOLDER. Ends with 77 where Chromium is not installed.
"""

import pathlib
import shutil
import subprocess
import sys

from browser import ARROW_RIGHT, Browser, missing_programs

SKIPPED = 77
SHEET = 20  # squares along each side
STEPS = 20  # more than there are from one whole frame to the next
TIP = (0.03, 0.02, 0.5)

# Whether the contact that is chosen is in the view, and how many pixels around it are red.
CHOSEN = """
  const canvas = document.querySelector('#view canvas'), label = document.getElementById('label');
  const x = Number(label.dataset.x), y = Number(label.dataset.y);
  const box = canvas.getBoundingClientRect();
  const copy = document.createElement('canvas');
  copy.width = canvas.width; copy.height = canvas.height;
  const context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);
  const scale = canvas.width / box.width;
  const rgb = context.getImageData(Math.round((x - 8) * scale), Math.round((y - 8) * scale), 16, 16).data;
  let red = 0;
  for (let i = 0; i < rgb.length; i += 4) red += rgb[i] > 200 && rgb[i + 1] < 100 && rgb[i + 2] < 120;
  return {x: box.left + x, y: box.top + y, red,
          inView: !label.hidden && x > 0 && y > 0 && x < box.width && y < box.height};
"""


def write_frames(folder):
    """A sheet that falls onto the tip of an octahedron, which it reaches at 0.8 of step 1."""
    corners = range(SHEET + 1)
    faces = []
    for i in range(SHEET):
        for j in range(SHEET):
            a = i * (SHEET + 1) + j + 1
            faces += [(a, a + 1, a + SHEET + 2), (a, a + SHEET + 2, a + SHEET + 1)]
    for frame in range(STEPS + 1):
        z = 0.95 - 0.25 * min(frame, 8)
        lines = [f"v {2 * i / SHEET - 1} {2 * j / SHEET - 1} {z}" for i in corners for j in corners]
        lines += [f"f {a} {b} {c}" for a, b, c in faces]
        (folder / f"sheet_{frame:02}.obj").write_text("\n".join(lines) + "\n")
    body = [f"v {x} {y} {z}" for x, y, z in
            (TIP, (0.5, 0, 0), (0, 0.5, 0), (-0.5, 0, 0), (0, -0.5, 0), (0, 0, -0.5))]
    for k in range(4):
        a, b = 2 + k, 2 + (k + 1) % 4
        body += [f"f 1 {a} {b}", f"f 6 {b} {a}"]
    (folder / "body.obj").write_text("\n".join(body) + "\n")


def make_page(program, folder):
    frames = folder / "frames"
    frames.mkdir()
    write_frames(frames)
    body = (frames / "body.obj").rename(folder / "body.obj")
    page = folder / "report.html"
    subprocess.run([program, "run", frames, "--against", body, "--no-self", "--toc-err", "1e-9", "--report", page],
                   check=True, stdout=subprocess.DEVNULL)
    return page


def make_page_of_cables(program, folder):
    """One step, in which a free edge of the body and a free point come near a cable."""
    write_cables(folder)
    page = folder / "cables.html"
    frames = [folder / f"cable_{frame}.obj" for frame in (0, 1)]
    subprocess.run([program, "run", *frames, "--against", folder / "thread.obj", "--no-self", "--thickness", "0.1",
                    "--report", page], check=True, stdout=subprocess.DEVNULL)
    return page


def write_cables(folder):
    for frame in (0, 1):
        z = 1 - frame
        lines = [f"v -1 0 {z}", f"v 1 0 {z}", f"v 0 0.5 {z}", "l 1 2", "p 3"]
        (folder / f"cable_{frame}.obj").write_text("\n".join(lines) + "\n")
    (folder / "thread.obj").write_text("v 0 -1 0\nv 0 1 0\nl 1 2\n")


def check_cables(browser):
    """Free edges and points have their names. A plot of one step shows its values."""
    names = browser.script("return Array.from(document.querySelectorAll('#contacts li'), (e) => e.textContent).join()")
    assert "edge 0 1 of free edge 0, edge b0 b1 of free edge b0" in names, names
    assert "vertex 2 of free point 0, edge b0 b1 of free edge b0" in names, names
    widths = browser.script("return Array.from(document.querySelectorAll('#plots svg'), (svg) => Math.max("
                            "...Array.from(svg.querySelectorAll('circle'), (c) => c.getBoundingClientRect().width)))")
    assert len(widths) == 4 and all(width > 4 for width in widths), widths


def check_first_frame(browser):
    assert "first contact: step 1 at 0.8" in browser.script("return document.getElementById('answer').textContent")
    assert browser.script("return document.querySelectorAll('#table tbody tr').length") == STEPS
    assert browser.script("return document.querySelectorAll('#plots svg').length") == 4
    assert browser.script("return document.querySelectorAll('#contacts li').length") == 20
    assert browser.script("return document.getElementById('step').value") == "1"
    assert abs(float(browser.script("return document.getElementById('time').value")) - 0.8) < 1e-6
    assert "vertex b0" in browser.script("return document.getElementById('label').textContent")
    chosen = browser.script(CHOSEN)
    assert chosen["inView"] and chosen["red"] > 20, chosen
    return chosen


def check_click(browser, chosen):
    """A click beside all contacts chooses none, a click on one names it."""
    box = browser.script("const b = document.getElementById('view').getBoundingClientRect();"
                         "return [b.left, b.top, b.right, b.bottom]")
    browser.drag((box[0] + 5, box[1] + 5), (box[0] + 5, box[1] + 5))
    assert browser.script("return document.getElementById('label').hidden")
    browser.drag((chosen["x"], chosen["y"]), (chosen["x"], chosen["y"]))
    assert "vertex-face: " in browser.script("return document.getElementById('selected').textContent")
    assert "vertex b0" in browser.script("return document.getElementById('selected').textContent")
    return box


def check_camera(browser, box):
    """The view turns by mouse and by touch; the contact stays in the middle."""
    image = "document.querySelector('#view canvas').toDataURL()"
    middle = ((box[0] + box[2]) / 2, (box[1] + box[3]) / 2)
    for kind in ("mouse", "touch"):
        browser.script("window.before = " + image)
        browser.drag((middle[0] + 40, middle[1] + 60), (middle[0] + 130, middle[1] + 80), kind)
        browser.wait_for(image + " !== window.before")
    assert browser.script(CHOSEN)["inView"]


def check_sliders(browser):
    step = "document.getElementById('step-text').textContent"
    browser.type("#step", ARROW_RIGHT)
    browser.wait_for(f"{step}.startsWith('2 ')")
    image = "document.querySelector('#view canvas').toDataURL()"
    browser.script("window.before = " + image)
    browser.type("#time", ARROW_RIGHT * 3)
    browser.wait_for(image + " !== window.before")
    # The list leads back to the first contact, and on to another one.
    for i, label in ((1, "vertex b0"), (5, "of triangle")):
        browser.click(f"#contacts li:nth-child({i}) button")
        browser.wait_for("document.getElementById('label').textContent.includes(" + repr(label) + ")")
        assert browser.script(CHOSEN)["inView"], i
    browser.click("#table tbody tr:nth-child(1)")
    browser.wait_for(f"{step}.startsWith('0 ')")


def check_stands_alone(browser):
    errors = browser.errors()
    assert errors == [], errors
    loaded = browser.script("return performance.getEntriesByType('resource').map((e) => e.name)"
                            ".filter((name) => !name.startsWith('data:') && !name.startsWith('blob:'))")
    assert loaded == [], loaded


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    missing = missing_programs()
    if missing:
        print(f"Skipped: {' and '.join(missing)} not found (Debian: chromium chromium-driver)")
        return SKIPPED
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    page = make_page(program, folder)
    with Browser(folder / "profile") as browser:
        browser.open(page.resolve().as_uri())
        browser.wait_for("document.getElementById('page').dataset.ready === 'yes'")
        if browser.script("return window.FclCcdViewer === undefined"):
            print("Without 3D view: this program was built without its viewer")
            assert not browser.script("return document.getElementById('no-view').hidden")
            assert browser.script("return document.getElementById('picture').naturalWidth") > 0
        else:
            chosen = check_first_frame(browser)
            browser.screenshot(folder / "first_contact.png")
            check_camera(browser, check_click(browser, chosen))
            browser.screenshot(folder / "turned.png")
            check_sliders(browser)
            browser.click("#whole")
            browser.script("window.scrollTo(0, 0)")
            browser.screenshot(folder / "whole.png")
        check_stands_alone(browser)
        browser.open(make_page_of_cables(program, folder).resolve().as_uri())
        browser.wait_for("document.getElementById('page').dataset.ready === 'yes'")
        check_cables(browser)
        browser.screenshot(folder / "cables.png")
        check_stands_alone(browser)
    shutil.rmtree(folder / "profile", ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
