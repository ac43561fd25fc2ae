"""`cutis bench`: a line for everything that can be timed here, one for what cannot."""

import io
import sys

from cutis.apps.bench import fastest_rival, table
from cutis.apps.timing import Timed
from cutis.maps import DEFAULT


def timed(system, step, seconds):
    return Timed(system, step, lambda: None, 10**9, list(seconds), 5_000_000)


def rows(rendered):
    from rich.console import Console

    text = io.StringIO()
    Console(width=120, file=text).print(rendered)
    return [" ".join(line.split()) for line in text.getvalue().splitlines()]


def test_bench_on_a_few_texels(cutis):
    ended = cutis("bench", "--size", "16", "--repeats", "1")
    assert (ended.code, ended.err) == (0, "")
    assert "16 × 16 texels" in ended.out
    for word in (DEFAULT, "aliaga2022", "exact space", "41 bands", "GFLOP/s", "copying"):
        assert word in ended.out


def test_packages_that_are_missing_are_named(cutis, monkeypatch):
    for package in ("torch", "onnx"):
        monkeypatch.setitem(sys.modules, package, None)
    ended = cutis("bench", "--size", "16", "--repeats", "1")
    assert ended.code == 0
    assert "PyTorch is not timed: torch is missing; pip install 'cutis[train]'\n" in ended.out
    assert "ONNX is not timed: onnx is missing; pip install 'cutis[onnx]'\n" in ended.out
    assert "ratio:" not in ended.out


def test_ratios_are_to_the_faster_form_of_the_rival():
    entries = [
        timed("default", "encode", [0.5, 0.4, 0.6]),
        timed("default", "decode", [0.1]),
        timed("PyTorch, one call", "encode", [9]),
        timed("PyTorch, one call", "decode", [9]),
        timed("PyTorch, tiles", "encode", [8]),
        timed("PyTorch, tiles", "decode", [2]),
        timed("exact space", "41 bands", [1]),
    ]
    assert fastest_rival(entries) == "PyTorch, tiles"
    assert fastest_rival(entries[:2]) is None
    heading, encode, decode, both, *_, spectra = rows(table(entries, 1e10))
    assert heading == "best median ratio copying memory"
    assert encode == "default encode 0.400 s 0.500 s 20.00 25.0 % 5 MB"
    assert decode == "decode 0.100 s 0.100 s 20.00 100.0 % 5 MB"
    assert both == "both 0.500 s 20.00"
    assert spectra == "exact space 41 bands 1.000 s 1.000 s 10.0 % 5 MB"


def test_a_device_that_is_unknown(cutis):
    ended = cutis("bench", "--size", "16", "--device", "abacus")
    assert (ended.code, ended.out) == (1, "")
    assert ended.err == "cutis: unknown device 'abacus'; choose cpu or cuda\n"
