"""The page of reproductions: Markdown with its pictures beside it."""

import io
from collections.abc import Sequence
from pathlib import Path

from cutis.textures import replacing
from studies.figures.section import Section

QUALITY = 88
"""JPEG quality of the pictures."""
HEAD = """# The paper, reproduced

What Aliaga, Hery and Xia 2022 show, drawn by this project's own systems, so that the two can be
put side by side. `python -m studies.figures -o docs` writes this page, its numbers and its
pictures. The faces are those named with each figure, not the paper's, which are not public; most
dark ones are painted.
"""


def write_page(sections: Sequence[Section], folder: Path) -> Path:
    """Writes `folder`/reproduction.md and its pictures into `folder`/reproduction/."""
    pictures = folder / "reproduction"
    pictures.mkdir(parents=True, exist_ok=True)
    text = [HEAD]
    for section in sections:
        title, paper, found = section.words()
        text += [f"## {title}", f"**The paper.** {paper}", f"**Here.** {found}"]
        for number, (figure, caption) in enumerate(section.pictures, 1):
            name = f"{section.name}-{number}.jpg"
            data = io.BytesIO()
            figure.savefig(data, format="jpg", facecolor="white", pil_kwargs={"quality": QUALITY})
            with replacing(pictures / name) as partial:
                partial.write_bytes(data.getvalue())
            text.append(f"![{caption}](reproduction/{name})\n*{caption}*")
        text.append(section.table)
        if section.credits:
            text.append("Textures: " + "; ".join(section.credits) + ".")
    path = folder / "reproduction.md"
    with replacing(path) as partial:
        partial.write_text("\n\n".join(text) + "\n", encoding="utf-8")
    return path
