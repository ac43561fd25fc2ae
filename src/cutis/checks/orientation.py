"""A picture that is stored turned: viewers show it upright, meshes and engines do not."""

from collections.abc import Iterator

from cutis.checks.evidence import Evidence
from cutis.checks.finding import Finding
from cutis.checks.thresholds import Limits
from cutis.textures import TextureFile
from cutis.textures.turning import TURNS


def check(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """An orientation tag that was never applied to the texels."""
    tag = seen.gathered.stored.tag
    if tag in TURNS:
        yield Finding(
            "orientation", "finding" if limits["finding"] else "note",
            f"its tag says that it is to be {TURNS[tag]}; renderers and meshes show it as stored.",
            "Look which is right: --fix stores it upright, without the tag; --orientation ignore "
            "takes it as stored.",
            {"tag": tag},
        )  # fmt: skip


def tag_of(texture: TextureFile) -> int:
    """The number of the orientation tag of an open texture, applied or not; 1 without one."""
    if texture.turned != 1:
        return texture.turned
    return int(texture.spec.get_int_attribute("Orientation", 1))
