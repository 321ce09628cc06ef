"""Build step: what is shipped goes into the package; everything else is in pyproject.toml."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

SHIPPED = (
    "scenarios/*.toml",
    "scenarios/machines/*.toml",
    "scenarios/machines/bearings/*.toml",
    "coefficients/dal.nc",
)


class BuildWithShippedFiles(build_py):
    """Copies what is shipped to rotorsim/data of what is built."""

    def run(self) -> None:
        """Build the package, then add the files."""
        # What an earlier build left would go into the wheel, modules since deleted included.
        shutil.rmtree(Path(self.build_lib) / "rotorsim", ignore_errors=True)
        super().run()
        if self.editable_mode:  # the source tree's own are found there
            return
        for pattern in SHIPPED:
            for path in sorted(Path().glob(pattern)):
                target = Path(self.build_lib) / "rotorsim" / "data" / path
                target.parent.mkdir(parents=True, exist_ok=True)
                self.copy_file(str(path), str(target))


setup(cmdclass={"build_py": BuildWithShippedFiles})
