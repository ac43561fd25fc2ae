"""The JSON Schema of looks, for editors and other programs: python -m studies.look_schema."""

import json
from pathlib import Path

from cutis.looks import Look

PATH = Path(__file__).parents[1] / "docs" / "look.schema.json"


def text() -> str:
    """What the file holds."""
    return json.dumps(Look.published(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    PATH.write_text(text(), encoding="utf-8")
    print(f"wrote {PATH}")
