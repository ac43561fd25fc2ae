"""Models by name: ours, those that other packages bring, and files of weights.

Other packages bring models by the entry point group `cutis.models`: the name of an entry point is
that of the model, and what it points to a `Model`, or a function without arguments that makes one.
Nothing of theirs is imported before it is asked for by name.
"""

import copyreg
import dataclasses
from collections.abc import Callable
from functools import cache
from pathlib import Path

from cutis.errors import CutisError
from cutis.inverse import shipped
from cutis.inverse.device import check_device
from cutis.inverse.model import Model

GROUP = "cutis.models"
"""Entry point group of other people's models."""
MODELS = tuple(shipped.FACTORIES)
"""Names of ours."""
_REGISTERED: dict[str, Callable[[], Model]] = {}


def register(name: str, make: Callable[[], Model]) -> None:
    """Adds a model to this process under a name; CutisError where the name is taken."""
    if name in model_names():
        raise CutisError(f"there is a model called {name} already; choose another name")
    _REGISTERED[name] = make


def model_names() -> tuple[str, ...]:
    """All names that `load_model` knows, ours first; nothing is loaded."""
    return tuple(dict.fromkeys((*MODELS, *_REGISTERED, *(name for name, _ in _entry_points()))))


def load_model(name: str, device: str = "cpu") -> Model:
    """The model called `name`, or that of the weights file `name`; made once per process.

    Networks may run on another `device`, "cuda"; tables are read by the processor. CutisError, one
    line, when there is no such model or device, when two packages bring one of this name, and when
    somebody's model does not load.
    """
    if device != "cpu":
        check_device(device)
    brought = [point for known, point in _entry_points() if known == name]
    takers = len(brought) + (name in MODELS) + (name in _REGISTERED)
    if takers > 1:
        packages = ", ".join(sorted(_package(point) for point in brought))
        raise CutisError(
            f"{takers} models are called {name} ({packages} among those who bring one); uninstall "
            "one of them"
        )
    if name in MODELS:
        return _ours(name, device)
    if name.endswith(".safetensors") and Path(name).is_file():
        return shipped.from_file(Path(name), device)
    if name in _REGISTERED:
        return _made(name, _REGISTERED[name], "registered here")
    if brought:
        return _made(name, lambda: _brought(brought[0]), f"of {_package(brought[0])}")
    raise CutisError(
        f"unknown model {name!r}; choose {', '.join(model_names())} or a .safetensors file of "
        "weights"
    )


def reopened(name: str, recipe: str, device: str, digest: str) -> Model:
    """A model that came from another process; CutisError where it is another one here."""
    model = load_model(recipe, device)
    if model.digest != digest:
        raise CutisError(
            f"the model {name} is not the same here as where this work was started; give both "
            "the same version of cutis and of its models"
        )
    return model


def _as_recipe(model: Model) -> tuple[Callable[..., Model], tuple[str, str, str, str]]:
    """A model travels as its recipe; what arrives is checked to be the same."""
    if model.recipe is None:
        raise CutisError(
            f"the model {model.name} lives in this process alone; register it under the entry "
            "point group cutis.models to use it in others"
        )
    return reopened, (model.name, *model.recipe, model.digest)


copyreg.pickle(Model, _as_recipe)


@cache
def _ours(name: str, device: str) -> Model:
    if device != "cpu" and name not in shipped.NETWORKS:
        raise CutisError(
            f"the model {name} is a table, read by the processor; --device cuda is for "
            "aliaga2022 and files of weights"
        )
    model = shipped.FACTORIES[name](device)
    return dataclasses.replace(model, recipe=(name, device))


@cache
def _made(name: str, make: Callable[[], Model], whose: str) -> Model:
    """A model that is not ours, which may do anything: whatever goes wrong is one line."""
    try:
        model = make()
        if callable(model) and not isinstance(model, Model):
            model = model()
    except Exception as error:
        what = f"{type(error).__name__}: {error}"
        raise CutisError(f"the model {name} ({whose}) does not load: {what}") from error
    if not isinstance(model, Model):
        raise CutisError(f"the model {name} ({whose}) is no cutis.Model but {type(model).__name__}")
    return dataclasses.replace(model, name=name, recipe=(name, "cpu"))


@cache
def _entry_points() -> tuple[tuple[str, object], ...]:
    from importlib.metadata import entry_points

    return tuple((point.name, point) for point in entry_points(group=GROUP))


def _brought(point: object) -> Model:
    return point.load()  # type: ignore[attr-defined]


def _package(point: object) -> str:
    dist = getattr(point, "dist", None)
    return str(getattr(dist, "name", None) or getattr(point, "value", "a package"))
