"""Whether a texture is an albedo of skin at all: findings and notes, with how to go on."""

from cutis.checks.examine import Examined, examine, gather, watch
from cutis.checks.finding import Finding
from cutis.checks.thresholds import thresholds

__all__ = ["Examined", "Finding", "examine", "gather", "thresholds", "watch"]
