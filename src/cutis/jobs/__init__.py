"""Work: one value per job, sets of captures, and where they run.

A job is made of parsed values and run by whoever wants it done: the command line, a server, a
renderer's add-on. All of them get the same results, bit for bit.
"""

from cutis.jobs.edit import Edited, EditJob
from cutis.jobs.edit_frames import EditFramesJob
from cutis.jobs.estimate import EstimateJob
from cutis.jobs.export import ExportJob
from cutis.jobs.fit import FitJob, Fitted
from cutis.jobs.job import Cancel, Cancelled, Job
from cutis.jobs.outcome import CaptureFiles, Estimated
from cutis.jobs.runners import Runner, cluster, here, processes
from cutis.jobs.sets import estimate_sets
from cutis.jobs.spectrum import SpectrumJob
from cutis.jobs.train import TrainJob

__all__ = [
    "Cancel",
    "Cancelled",
    "CaptureFiles",
    "EditFramesJob",
    "EditJob",
    "Edited",
    "EstimateJob",
    "Estimated",
    "ExportJob",
    "FitJob",
    "Fitted",
    "Job",
    "Runner",
    "SpectrumJob",
    "TrainJob",
    "cluster",
    "estimate_sets",
    "here",
    "processes",
]
