"""Reads a Whirl result file whole, so that damage shows before anything is drawn."""
import os
from dataclasses import dataclass, field

import h5py
import numpy as np


class ResultError(Exception):
    """The file cannot be drawn; the text is one line for the user."""


@dataclass
class Group:
    """A group of the file: attributes, columns (datasets) and subgroups, all in memory."""
    path: str = "/"
    attributes: dict = field(default_factory=dict)
    columns: dict = field(default_factory=dict)
    units: dict = field(default_factory=dict)
    descriptions: dict = field(default_factory=dict)
    groups: dict = field(default_factory=dict)

    def group(self, path):
        """The subgroup at a path; an empty one where the file has none."""
        here = self
        for name in path.strip("/").split("/"):
            here = here.groups.get(name, Group(f"{here.path.rstrip('/')}/{name}"))
        return here

    def column(self, name):
        if name not in self.columns:
            raise ResultError(f"lacks the column {self.path.rstrip('/')}/{name}")
        return self.columns[name]

    def rows(self):
        """Length of the table; columns of one table must agree."""
        lengths = {len(c) for c in self.columns.values() if np.ndim(c)}
        if len(lengths) > 1:
            raise ResultError(f"columns of {self.path} differ in length")
        return lengths.pop() if lengths else 0

    def __bool__(self):
        return bool(self.attributes or self.columns or self.groups)


def read(path):
    """The result file as a Group, or a ResultError that says in one line what is wrong."""
    check_readable(path)
    try:
        with h5py.File(path, "r") as file:
            root = group_of(file, "/")
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise ResultError(reason(error)) from None
    if "study" not in root.groups and "branches" not in root.groups:
        raise ResultError("is an HDF5 file but not a result of whirl: it has neither /study nor /branches")
    return root


def check_readable(path):
    if os.path.isdir(path):
        raise ResultError("is a directory, not a result file")
    try:
        with open(path, "rb") as file:
            if not file.read(1):
                raise ResultError("is empty")
    except OSError as error:
        raise ResultError(f"cannot be read: {error.strerror}") from None


def reason(error):
    text = " ".join(str(error).split())
    if "truncated" in text:
        return "is truncated: it was cut short while being written or copied"
    if "signature" in text:
        return "is not an HDF5 file"
    if "lock" in text:
        return "is in use: another program is writing it"
    return f"is damaged: {text.strip(chr(34) + chr(39))}"


def group_of(node, path):
    group = Group(path, {key: plain(value) for key, value in node.attrs.items()})
    for name, child in node.items():
        child_path = f"{path.rstrip('/')}/{name}"
        if isinstance(child, h5py.Group):
            group.groups[name] = group_of(child, child_path)
        else:
            group.columns[name] = plain(child[()])
            group.units[name] = str(plain(child.attrs.get("units", "")))
            group.descriptions[name] = str(plain(child.attrs.get("description", "")))
    group.rows()
    return group


def plain(value):
    """Text as str, numbers as numpy has them."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, np.ndarray) and value.dtype.kind in "OS":
        return np.array([plain(v) for v in value.ravel()], dtype=object).reshape(value.shape)
    return value
