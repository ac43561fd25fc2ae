"""The race against rivals, on a few texels."""

import sys

from benchmarks import encoding
from cutis.maps import DEFAULT


def run(monkeypatch, capsys, *flags):
    monkeypatch.setattr(sys, "argv", ["encoding", "--size", "16", "--repeats", "1", *flags])
    encoding.main()
    return capsys.readouterr()


def test_everything_that_is_installed_takes_part(monkeypatch, capfd):
    said = run(monkeypatch, capfd)
    for word in (DEFAULT, "aliaga2022", "exact space", "GFLOP/s", "copying"):
        assert word in said.out
    assert "encode: run 1 of 1" in said.err


def test_packages_that_are_missing_are_named(monkeypatch, capfd):
    for package in ("torch", "onnx"):
        monkeypatch.setitem(sys.modules, package, None)
    said = run(monkeypatch, capfd)
    assert "PyTorch is not timed: torch is missing; pip install 'cutis[train]'\n" in said.out
    assert "ONNX is not timed: onnx is missing; pip install 'cutis[onnx]'\n" in said.out
    assert "ratio:" not in said.out
