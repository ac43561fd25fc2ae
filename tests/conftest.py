"""Fixtures that every room's tests may use."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SHARED_DATA = Path(os.environ.get("CUTIS_SHARED_DATA") or ROOT.parent / "shared" / "data")


def _skip_without_shared_data() -> None:
    if not SHARED_DATA.is_dir():
        pytest.skip(
            "the larger data is not here: put it in ../shared/data beside the repository, "
            "or name its folder in CUTIS_SHARED_DATA"
        )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Whatever uses the fixture is `shared` too, so that `-m "not shared"` leaves it out."""
    for item in items:
        if "shared_data" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.shared)


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("shared"):
        _skip_without_shared_data()


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of the larger data (spectra/, albedo/, mesh/); the test is skipped where absent."""
    _skip_without_shared_data()
    return SHARED_DATA


@pytest.fixture(scope="session")
def capture1() -> tuple[Path, Path]:
    """The example capture: (8-bit sRGB albedo, mask)."""
    folder = ROOT / "examples"
    return folder / "bioskin_capture1.jpg", folder / "bioskin_capture1_mask.jpg"
