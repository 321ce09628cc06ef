"""Build step: scenarios/ goes into the package. Everything else is in pyproject.toml."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py


class BuildWithScenarios(build_py):
    """Copies scenarios/*.toml to rotorsim/data/scenarios of what is built."""

    def run(self) -> None:
        """Build the package, then add the scenarios."""
        # What an earlier build left would go into the wheel, modules since deleted included.
        shutil.rmtree(Path(self.build_lib) / "rotorsim", ignore_errors=True)
        super().run()
        if self.editable_mode:  # the source tree's own are found there
            return
        target = Path(self.build_lib) / "rotorsim" / "data" / "scenarios"
        target.mkdir(parents=True, exist_ok=True)
        for path in sorted(Path("scenarios").glob("*.toml")):
            self.copy_file(str(path), str(target / path.name))


setup(cmdclass={"build_py": BuildWithScenarios})
