"""A file is the old one or the new one."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from rotorsim.atomic import replacing, write_text


def test_an_interrupted_write_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "table.nc"
    target.write_text("old")

    def interrupted():
        with replacing(target) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["table.nc"]


def test_a_finished_write_replaces_the_file_and_makes_folders(tmp_path):
    target = tmp_path / "new" / "folder" / "text.toml"
    write_text(target, "first\n")
    write_text(target, "second\n")
    assert target.read_bytes() == b"second\n"
    assert os.listdir(target.parent) == ["text.toml"]


@pytest.mark.skipif(os.name == "nt", reason="POSIX")
def test_a_link_stays_and_what_it_points_to_is_replaced(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "a.txt").write_text("old")
    os.chmod(tmp_path / "there" / "a.txt", 0o640)
    for name, to in (("link", "there/a.txt"), ("dangling", "there/b.txt"), ("folder", "there")):
        os.symlink(to, tmp_path / name)
    write_text(tmp_path / "link", "new")
    write_text(tmp_path / "dangling", "new")
    write_text(tmp_path / "folder" / "c.txt", "new")
    assert sorted(os.listdir(tmp_path)) == ["dangling", "folder", "link", "there"]
    assert all((tmp_path / name).is_symlink() for name in ("dangling", "folder", "link"))
    for name in "abc":
        assert (tmp_path / "there" / f"{name}.txt").read_text() == "new"
    assert os.stat(tmp_path / "there" / "a.txt").st_mode & 0o777 == 0o640


@pytest.mark.skipif(os.name == "nt", reason="POSIX")
def test_what_goes_wrong_names_the_file_and_not_the_temporary_one(tmp_path):
    limited = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))\n"
        "from rotorsim.atomic import write_text\n"
        "try: write_text(sys.argv[1], 'x' * 1000)\n"
        "except OSError as error: print(error.filename, error.strerror)"
    )
    target = tmp_path / ("long" * 60)
    target.write_text("old")
    done = subprocess.run(
        [sys.executable, "-c", limited, target], capture_output=True, text=True, check=True
    )
    assert done.stdout == f"{target} File too large\n"
    assert os.listdir(tmp_path) == [target.name]
    assert target.read_text() == "old"


def test_the_temporary_file_keeps_suffix_and_folder(tmp_path):
    with replacing(tmp_path / "a.nc") as temporary:
        assert temporary.suffix == ".nc"
        assert temporary.parent == tmp_path
        temporary.touch()
