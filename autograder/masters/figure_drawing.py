"""Draws a PNG next to each SVG of the masters' figures: ``python -m autograder.masters.figure_drawing``.

An author runs this and commits the PNGs. A build does not draw, because on a machine with other fonts the PNGs would
look different.
"""

from __future__ import annotations

import base64
import sys
import zlib
from pathlib import Path
from typing import TYPE_CHECKING

import numpy

from autograder import course
from autograder.masters.master_cells import DIGEST_KEYWORD, figure_digest
from course_runtime.system_packages import CHROMIUM_NAMES, find_program

if TYPE_CHECKING:
    from collections.abc import Sequence

    from playwright.sync_api import Page

SCALE = 1.5
"""The number of pixels per unit of an SVG: sharp on most screens, and no wider than a wide notebook."""
SIGNATURE = b"\x89PNG\r\n\x1a\n"
"""The bytes with which a PNG file begins."""
_HEADER_LENGTH = len(SIGNATURE) + 8 + 13 + 4
COLORS = 256
_PIXELS = """async png => {
    const picture = await createImageBitmap(await (await fetch("data:image/png;base64," + png)).blob());
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const drawn = canvas.getContext("2d");
    drawn.drawImage(picture, 0, 0);
    const pixels = drawn.getImageData(0, 0, picture.width, picture.height).data;
    let text = "";
    for (let at = 0; at < pixels.length; at += 32768) {
        text += String.fromCharCode(...pixels.subarray(at, at + 32768));
    }
    return [picture.width, picture.height, btoa(text)];
}"""


def stale_figures(root: Path) -> list[Path]:
    """Return those figures of the course in ``root`` whose PNG is missing or out of date."""
    found = []
    for svg in sorted((root / course.SOLUTIONS).rglob("figures/*.svg")):
        png = svg.with_suffix(".png")
        if not png.exists() or figure_digest(svg.read_bytes()) not in png.read_bytes():
            found.append(svg)
    return found


def _draw(figures: Sequence[Path], chromium: str) -> None:
    """Draw a PNG next to each SVG.

    Args:
        figures: The SVG files.
        chromium: The path of the browser Chromium.
    """
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(device_scale_factor=SCALE)
        for svg in figures:
            page.goto(svg.resolve().as_uri())
            png = page.locator("svg").first.screenshot(omit_background=True)
            svg.with_suffix(".png").write_bytes(signed(_with_few_colors(page, png), svg.read_bytes()))
        browser.close()


def _with_few_colors(page: Page, png: bytes) -> bytes:
    """Return the picture as a PNG with a palette of few colors, which makes the file a third as large.

    Args:
        page: A browser page, which decodes the picture.
        png: The picture as the browser drew it.
    """
    page.goto("about:blank")
    width, height, text = page.evaluate(_PIXELS, base64.b64encode(png).decode("ascii"))
    pixels = numpy.frombuffer(base64.b64decode(text), numpy.uint8).reshape(height * width, 4)
    coarse = (pixels.astype(numpy.uint16) + 8) // 17 * 17
    colors, places, counts = numpy.unique(coarse, axis=0, return_inverse=True, return_counts=True)
    kept = numpy.argsort(-counts)[:COLORS]
    distances = ((colors[:, None, :].astype(int) - colors[None, kept, :]) ** 2).sum(axis=2)
    rows = distances.argmin(axis=1).astype(numpy.uint8)[places].reshape(height, width)
    palette = colors[kept].astype(numpy.uint8)
    # In a PNG, each line of pixels begins with the number of its filter; 0 means none.
    lines = numpy.insert(rows, 0, 0, axis=1).tobytes()
    header = width.to_bytes(4) + height.to_bytes(4) + bytes((8, 3, 0, 0, 0))
    return SIGNATURE + b"".join(
        (
            chunk(b"IHDR", header),
            chunk(b"PLTE", palette[:, :3].tobytes()),
            chunk(b"tRNS", palette[:, 3].tobytes()),
            chunk(b"IDAT", zlib.compress(lines, 9)),
            chunk(b"IEND", b""),
        )
    )


def signed(png: bytes, svg: bytes) -> bytes:
    """Return the PNG with an added text chunk that contains the digest of its SVG.

    Args:
        png: The picture.
        svg: The SVG from which it was drawn.
    """
    mark = chunk(b"tEXt", DIGEST_KEYWORD + b"\0" + figure_digest(svg))
    return png[:_HEADER_LENGTH] + mark + png[_HEADER_LENGTH:]


def chunk(kind: bytes, content: bytes) -> bytes:
    """Return a chunk of a PNG file: length, kind, content and checksum."""
    return len(content).to_bytes(4) + kind + content + zlib.crc32(kind + content).to_bytes(4)


def main() -> int:
    """Draw all figures that are out of date. Return the exit code, which is 2 if drawing fails."""
    course.use_the_one_around(Path.cwd())
    figures = stale_figures(course.root())
    chromium = find_program(*CHROMIUM_NAMES)
    if figures and chromium is None:
        print(
            "Figures are drawn with Chromium, which is not installed: install it, then try again.",
            file=sys.stderr,
        )
        return 2
    if figures and chromium:
        _draw(figures, chromium)
    for svg in figures:
        print(f"drawn  {svg.with_suffix('.png')}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
