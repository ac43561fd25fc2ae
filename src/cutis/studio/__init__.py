"""A live face in the browser: a server on this machine, and the page that it serves.

The state of a face is a look. Whatever the page asks for is applied to it here, drawn by the code
that `cutis edit` runs, and kept in a history on disk; what is saved goes through `jobs`.
"""

from cutis.studio.opening import OpenFace, Opening
from cutis.studio.state import State
from cutis.studio.workshop import Workshop

__all__ = ["OpenFace", "Opening", "State", "Workshop"]
