"""Looks that come with cutis, each with a picture of this face."""

from typing import Any

from cutis.errors import CutisError
from cutis.looks import presets
from cutis.studio.drawing import codes, jpeg
from cutis.studio.opening import OpenFace
from cutis.studio.tracks import thumbnail


def preset_list(face: OpenFace) -> list[tuple[dict[str, Any], bytes]]:
    """Of each preset its name, note and layers, and a JPEG of the face with it.

    Those that do not fit the model of the face are left out.
    """
    found = []
    for name in presets.names():
        look = presets.preset(name)
        try:
            picture = jpeg(codes(thumbnail(face, look)), 85)
        except CutisError:
            continue
        document = look.as_json()
        layers = [
            {**layer, "name": layer.get("name") or look.name or name}
            for layer in document.get("layers", ())
        ]
        found.append(({"name": name, "note": look.note, "layers": layers}, picture))
    return found
