"""Read and check measured logs. Nothing in a log is repaired or resampled unless asked for."""

from breakaway.measure.logs.channel import Channel
from breakaway.measure.logs.derived import Motion, NoiseFloor, derive_motion, noise_floor
from breakaway.measure.logs.findings import Finding
from breakaway.measure.logs.listed import ListedChannel
from breakaway.measure.logs.listing import Listing, list_channels
from breakaway.measure.logs.log import Log
from breakaway.measure.logs.read import FORMATS, read_log

__all__ = [
    "FORMATS",
    "Channel",
    "Finding",
    "ListedChannel",
    "Listing",
    "Log",
    "Motion",
    "NoiseFloor",
    "derive_motion",
    "list_channels",
    "noise_floor",
    "read_log",
]
