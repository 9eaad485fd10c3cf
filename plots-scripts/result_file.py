"""Reads a Whirl result file whole, so that damage shows before anything is drawn."""
import os
import pickle
import resource
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


# Of processor time: ten times what the slowest figures of a good file take.
LEAST_SECONDS, BYTES_PER_SECOND = 100, 200_000
BEST_COMPRESSION = 1032  # of deflate: a damaged header claims more


def in_process_of_its_own(path, work):
    """What work() returns: HDF5 crashes on some damaged files and never ends on others, and figures of any number may take any time."""
    receive, send = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(receive)
        code = 1
        try:
            seconds = LEAST_SECONDS + os.path.getsize(path) // BYTES_PER_SECOND
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            with os.fdopen(send, "wb") as pipe:
                pickle.dump(result_or_error(work), pipe)
            code = 0
        finally:
            os._exit(code)
    os.close(send)
    with os.fdopen(receive, "rb") as pipe:
        content = pipe.read()
    if os.waitpid(child, 0)[1] != 0:
        raise ResultError("is damaged")
    result, error = pickle.loads(content)  # of our own making
    if error is not None:
        raise ResultError(error)
    return result


def result_or_error(work):
    try:
        return work(), None
    except ResultError as error:
        return None, str(error)
    except KeyError as error:
        return None, f"lacks {error}: the run ended early or the file is of another version"
    except (ArithmeticError, AttributeError, IndexError, MemoryError, OSError, RuntimeError, TypeError, ValueError) as error:
        return None, f"cannot be drawn, it may be damaged: {' '.join(str(error).split())}"


def read(path):
    """The result file as a Group, or a ResultError that says in one line what is wrong."""
    check_readable(path)
    try:
        with h5py.File(path, "r") as file:
            root = group_of(file, "/", BEST_COMPRESSION * os.path.getsize(path))
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, MemoryError, OverflowError) as error:
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


def group_of(node, path, most_bytes):
    group = Group(path, {key: plain(value) for key, value in node.attrs.items()})
    for name, child in node.items():
        child_path = f"{path.rstrip('/')}/{name}"
        if isinstance(child, h5py.Group):
            group.groups[name] = group_of(child, child_path, most_bytes)
        elif isinstance(child, h5py.Dataset):
            if child.size and child.size * child.dtype.itemsize > most_bytes:
                raise ResultError(f"is damaged: {child_path} claims more rows than the file holds")
            group.columns[name] = plain(child[()])
            group.units[name] = str(plain(child.attrs.get("units", "")))
            group.descriptions[name] = str(plain(child.attrs.get("description", "")))
    group.rows()
    return group


def plain(value):
    """Text as str, numbers as numpy has them."""
    if isinstance(value, h5py.Empty):
        return np.array([])
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, np.ndarray) and value.dtype.kind in "OS":
        return np.array([plain(v) for v in value.ravel()], dtype=object).reshape(value.shape)
    return value
