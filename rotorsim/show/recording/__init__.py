"""Recordings for the rerun viewer, which this package imports: import it where one is written.

`rotorsim.show.recording.viewer` opens one and does without.
"""

from .contents import RecordingContents
from .write import write_recording

__all__ = ["RecordingContents", "write_recording"]
