"""The points of pictures, as their headers say them, and what a page does with too many of them."""

from __future__ import annotations

import base64
import struct

import nbformat
import pytest

from autograder.grading.returning.picture_sizes import MOST_PIXELS, PixelBudget, pixels_of
from autograder.grading.returning.sanitize import as_typed, make_harmless

WIDTH, HEIGHT = 640, 480


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + bytes(4)


def png(width: int = WIDTH, height: int = HEIGHT, frames: int = 1) -> bytes:
    animated = chunk(b"acTL", struct.pack(">II", frames, 0)) if frames > 1 else b""
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"tEXt", b"a\0b") + animated + chunk(b"IDAT", b"")


def jpeg(width: int = WIDTH, height: int = HEIGHT, kind: int = 0xC0) -> bytes:
    thumbnail = b"\xff\xc0" + bytes(60)
    before = b"\xff\xe1" + struct.pack(">H", len(thumbnail) + 2) + thumbnail + b"\xff\xff\xc4\x00\x03\x00"
    return b"\xff\xd8" + before + bytes((0xFF, kind)) + struct.pack(">HBHHB", 17, 8, height, width, 3)


def encoded(picture: bytes) -> str:
    return base64.b64encode(picture).decode()


@pytest.mark.parametrize("picture", [png(), *(jpeg(kind=kind) for kind in (0xC0, 0xC1, 0xC2))])
def test_the_size_is_that_of_the_header(picture: bytes) -> None:
    assert pixels_of(encoded(picture)) == WIDTH * HEIGHT


def test_each_frame_of_an_animated_picture_counts() -> None:
    assert pixels_of(encoded(png(frames=7))) == 7 * WIDTH * HEIGHT


@pytest.mark.parametrize(
    "picture", [png(), jpeg(), b"", b"BM" + bytes(60), b"GIF89a" + bytes(60), b"\xff\xd8" * 9]
)
def test_what_is_cut_off_or_of_another_kind_has_no_size(picture: bytes) -> None:
    for length in range(min(len(picture), 20)):
        assert pixels_of(encoded(picture[:length])) is None
    assert pixels_of("no base64") is None


@pytest.mark.parametrize(
    "picture",
    [
        png()[:-12] + chunk(b"tEXt", b"") * 100_000 + chunk(b"IDAT", b""),
        b"\xff\xd8" + b"\xff" * 100_000 + jpeg()[2:],
    ],
    ids=["png", "jpeg"],
)
def test_a_file_of_countless_empty_parts_is_no_picture(picture: bytes) -> None:
    # Each byte of ten million was looked at on its own, four times for a page.
    assert pixels_of(encoded(picture)) is None


def typed(text: str) -> str:
    return as_typed(text, (), PixelBudget())


def outputs_of(*pictures: bytes) -> list[str]:
    """What is shown of pictures that cells have shown: the types of the first output of each."""
    notebook = nbformat.v4.new_notebook()
    for picture in pictures:
        data = {"image/png": encoded(picture), "text/plain": "<Figure>"}
        notebook.cells.append(
            nbformat.v4.new_code_cell("x", outputs=[nbformat.v4.new_output("display_data", data)])
        )
    for _ in range(2):  # once before it is written, once more when the page is made
        notebook = make_harmless(notebook)
    return [",".join(sorted(cell.outputs[0].data)) for cell in notebook.cells]


def test_a_picture_of_sixteen_thousand_points_a_side_is_left_out() -> None:
    large, usual = png(16_000, 16_000), png(1920, 1080)
    assert outputs_of(large, usual, usual) == ["text/plain", "image/png,text/plain", "image/png,text/plain"]
    for name in ("![a graph]({})", '<div><img src="{}" alt="a graph"></div>'):
        assert "base64" not in typed(name.format("data:image/png;base64," + encoded(large)))
        assert f'src="data:image/png;base64,{encoded(usual)}"' in typed(
            name.format("data:image/png;base64," + encoded(usual))
        )


def test_many_pictures_have_one_budget() -> None:
    of_4k = png(3840, 2160)
    shown = outputs_of(*[of_4k] * 20)
    assert shown.count("image/png,text/plain") == MOST_PIXELS // (3840 * 2160)
    texts = [f"![{n}](data:image/png;base64,{encoded(png(3840, 2160 + n))})" for n in range(20)]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_markdown_cell(text) for text in texts])
    notebook = make_harmless(notebook, range(20))
    kept = ["base64" in cell.source for cell in notebook.cells]
    assert kept == [True] * 11 + [False] * 9 or kept == [True] * 12 + [False] * 8
    assert "picture left out" in notebook.cells[-1].source


def test_a_picture_that_tests_show_counts_too() -> None:
    # The outputs of a check cell stay as they are, because they show the verdict; but an answer may draw among them.
    drawn = nbformat.v4.new_output("display_data", {"image/png": encoded(png(16_000, 16_000))})
    card = nbformat.v4.new_output("display_data", {"text/html": "<article></article>", "text/plain": "card"})
    cell = nbformat.v4.new_code_cell("assert draw()", outputs=[card, drawn])
    cell.metadata["nbgrader"] = {"grade": True, "locked": True, "solution": False, "grade_id": "test"}
    shown = make_harmless(nbformat.v4.new_notebook(cells=[cell])).cells[0].outputs
    assert [",".join(sorted(output.data)) for output in shown] == ["text/html,text/plain", "text/plain"]


def test_what_a_browser_would_show_in_place_of_a_png_is_left_out() -> None:
    bitmap = b"BM" + bytes(16) + struct.pack("<II", 16_000, 16_000) + bytes(40)
    assert outputs_of(bitmap, b"GIF89a" + bytes(60)) == ["text/plain"] * 2
    assert "base64" not in typed(f"![a](data:image/png;base64,{encoded(bitmap)})")
