"""The summary of a run: JSON Lines, a table and contact sheets."""

import io
from collections import Counter
from typing import List

from PIL import Image, ImageDraw, ImageFont
from worker import PICTURE_WIDTH, Outcome

MARGIN = 12
LABEL = 14
COLUMNS = 12
ROWS = 16


def counts(outcomes: List[Outcome]) -> str:
    """As the last line of the command line's bake."""
    by_status = Counter(outcome.status for outcome in outcomes)
    return ", ".join(f"{by_status[status]} {status}" for status in ["baked", "unchanged", "failed"])


def json_lines(outcomes: List[Outcome]) -> bytes:
    return "".join(outcome.line() + "\n" for outcome in outcomes).encode()


def table(outcomes: List[Outcome], wall: float) -> bytes:
    """A table in Markdown, failures first, and the totals."""
    rows = [["status", "input", "size", "seconds", "attempts", "output bytes", "worker", "notes"]]
    for outcome in sorted(outcomes, key=lambda outcome: outcome.status != "failed"):
        notes = "; ".join([outcome.error] if outcome.error else outcome.warnings)
        size = f"{outcome.width} x {outcome.height}" if outcome.width else ""
        seconds, attempts, written = (
            f"{outcome.seconds:.2f}",
            str(outcome.attempts),
            str(outcome.output_bytes),
        )
        cells = [outcome.status, outcome.input, size, seconds, attempts, written, outcome.worker, notes]
        rows.append([" ".join(cell.split()).replace("|", "\\|") for cell in cells])
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    widths[-1] = 0
    lines = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |" for row in rows]
    lines.insert(1, "|" + "|".join("-" * max(width + 2, 3) for width in widths) + "|")
    texels = sum(outcome.width * outcome.height for outcome in outcomes)
    seconds_of_work = sum(outcome.seconds for outcome in outcomes)
    written_bytes = sum(outcome.output_bytes for outcome in outcomes)
    workers = len({outcome.worker for outcome in outcomes if outcome.status == "baked"})
    millions = texels / 1e6
    totals = [
        counts(outcomes) + ".",
        f"{len(outcomes)} inputs of {millions:.1f} million texels, {written_bytes / 1e6:.1f} MB of outputs.",
        f"{wall:.1f} s on {workers} worker processes that took {seconds_of_work:.1f} s in all.",
    ]
    return ("\n".join([*totals, "", *lines]) + "\n").encode()


def sheets(outcomes: List[Outcome], heading: str) -> List[bytes]:
    """Contact sheets as PNG: each panorama above one of its levels, labelled."""
    each = COLUMNS * ROWS
    parts = [outcomes[start : start + each] for start in range(0, len(outcomes), each)]
    return [sheet(part, f"{heading} - sheet {at} of {len(parts)}") for at, part in enumerate(parts, 1)]


def sheet(outcomes: List[Outcome], heading: str) -> bytes:
    font = ImageFont.load_default(11)
    columns = min(COLUMNS, len(outcomes))
    rows = -(-len(outcomes) // columns)
    cell_width, cell_height = PICTURE_WIDTH + MARGIN, PICTURE_WIDTH + 3 * LABEL + MARGIN
    title = ImageFont.load_default(14)
    width = max(columns * cell_width, int(title.getlength(heading))) + 2 * MARGIN
    image = Image.new("RGB", (width, rows * cell_height + 2 * MARGIN + 24), "white")
    draw = ImageDraw.Draw(image)
    draw.text((MARGIN, MARGIN), heading, "black", title)
    for at, outcome in enumerate(outcomes):
        left, top = MARGIN + at % columns * cell_width, MARGIN + 24 + at // columns * cell_height
        if outcome.picture:
            image.paste(Image.open(io.BytesIO(outcome.picture)), (left, top))
            size = f"{outcome.width} x {outcome.height}"
            below = [size, f"{outcome.exposure:+.1f} EV, roughness {outcome.roughness:.2f}"]
        else:
            draw.rectangle(
                (left, top, left + PICTURE_WIDTH - 1, top + PICTURE_WIDTH - 1), "#eeeeee", "#bbbbbb"
            )
            draw.text((left + 8, top + 8), outcome.status, "#aa0000", font)
            below = []
        draw.text((left, top + PICTURE_WIDTH), fitting(legible(outcome.input, font), font), "black", font)
        for line, text in enumerate(below, 1):
            draw.text((left, top + PICTURE_WIDTH + line * LABEL), text, "#555555", font)
    file = io.BytesIO()
    image.save(file, "PNG")
    return file.getvalue()


def legible(name: str, font: "ImageFont.FreeTypeFont | ImageFont.ImageFont") -> str:
    """A name with the numbers of characters that the font lacks, so that names stay distinct."""
    missing = bytes(font.getmask("\uffff"))
    return "".join(c if bytes(font.getmask(c)) != missing else f"[{ord(c):04X}]" for c in name)


def fitting(name: str, font: "ImageFont.FreeTypeFont | ImageFont.ImageFont") -> str:
    """The end of a name, as much as fits under a picture."""
    if font.getlength(name) <= PICTURE_WIDTH:
        return name
    while font.getlength("..." + name) > PICTURE_WIDTH:
        name = name[1:]
    return "..." + name
