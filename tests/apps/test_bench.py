"""`cutis bench`: a line for everything that can be timed here, and a word on what is going on."""

import time

from cutis.maps import DEFAULT


def test_bench_on_a_few_texels(cutis):
    ended = cutis("bench", "--size", "16", "--repeats", "2")
    assert ended.code == 0
    assert "16 × 16 texels" in ended.out
    for word in (DEFAULT, "aliaga2022", "exact space", "41 bands", "GFLOP/s", "copying"):
        assert word in ended.out
    assert "ratio" not in ended.out
    assert "python -m benchmarks.encoding" in ended.out
    told = ended.err.splitlines()  # nobody watches a bar here
    assert told[0] == "making 16 × 16 skins"
    assert f"{DEFAULT}, encode: run 1 of 2" in told
    assert f"{DEFAULT}, encode: run 2 of 2" in told


def test_quiet_is_quiet(cutis):
    ended = cutis("bench", "--size", "16", "--repeats", "1", "-q")
    assert (ended.code, ended.err) == (0, "")


def test_it_ends_when_its_time_is_over(cutis):
    start = time.monotonic()
    ended = cutis("bench", "--size", "16", "--repeats", "1000000", "--seconds", "0.5", "-q")
    assert ended.code == 0
    assert time.monotonic() - start < 60


def test_a_device_that_is_unknown(cutis):
    ended = cutis("bench", "--size", "16", "--device", "abacus")
    assert (ended.code, ended.out) == (1, "")
    assert ended.err == "cutis: unknown device 'abacus'; choose cpu or cuda\n"
