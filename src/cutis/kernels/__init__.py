"""Inner loops as machine code: compiled once, kept, run on all cores, each beside its plain form.

`compiling` makes machine code of functions and `keeping` keeps it between runs, `threads` runs it.
The rest is mathematics that several rooms need.
"""

from cutis.kernels.threads import threads, use_threads

__all__ = ["threads", "use_threads"]
