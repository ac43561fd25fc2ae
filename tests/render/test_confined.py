import subprocess
import sys
import time

import pytest

from cutis.errors import CutisError
from cutis.render.confined import end, spoken, started, without_network, words

linux = pytest.mark.skipif(sys.platform != "linux", reason="limits are Linux's")


def lines(script, folder, patience=60.0):
    process = started([sys.executable, "-c", script], folder)
    try:
        return list(spoken(process, patience))
    finally:
        end(process)


def test_lines_come_as_they_are_said(tmp_path):
    assert lines("print('a'); print('CUTIS {}'); print('é')", tmp_path) == ["a", "CUTIS {}", "é"]


def test_a_process_that_gets_no_further_is_ended(tmp_path):
    chatter = "import time\nwhile True: print('still here', flush=True); time.sleep(0.05)"
    process = started([sys.executable, "-c", chatter], tmp_path)
    start = time.monotonic()
    with pytest.raises(CutisError, match="got no further in 1 s"):
        list(spoken(process, 1.0))
    assert time.monotonic() - start < 30
    end(process)
    assert process.poll() is not None


def test_events_are_signs_of_life(tmp_path):
    script = "import time\nfor i in range(8): print('CUTIS {}', flush=True); time.sleep(0.3)"
    assert len(lines(script, tmp_path, 1.5)) == 8


@linux
def test_memory_is_bounded_by_that_of_the_machine(tmp_path):
    script = "import resource; print(resource.getrlimit(resource.RLIMIT_DATA)[0])"
    wait = f"import time; time.sleep(0.5)\n{script}"
    assert 0 < int(lines(wait, tmp_path)[0]) < 1 << 50


@linux
def test_there_is_no_network_where_the_system_allows_it(tmp_path):
    if not without_network():
        pytest.skip("this system lets nobody leave the network")
    script = "print(open('/proc/net/dev').read().count(':'))"
    assert lines(script, tmp_path) == ["1"]  # its own loopback alone
    alone = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert int(alone.stdout) >= 1


def test_words_of_a_script_are_one_short_line():
    assert "\n" not in words("a\nb\x1b]0;c\x07")
    assert "\x1b" not in words("a\x1b]0;c\x07")
    assert len(words("x" * 10_000)) == 500
