"""Recordings for the rerun viewer, which this package imports: import it where one is written.

`rotorsim.show.viewer` opens one and does without.
"""

from .write import RecordingContents, write_recording

__all__ = ["RecordingContents", "write_recording"]
