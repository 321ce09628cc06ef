"""A file is the old one or the new one."""

from __future__ import annotations

import os

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


def test_the_temporary_file_keeps_suffix_and_folder(tmp_path):
    with replacing(tmp_path / "a.nc") as temporary:
        assert temporary.suffix == ".nc"
        assert temporary.parent == tmp_path
        temporary.touch()
