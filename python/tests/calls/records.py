"""Plain records: made, read, set, compared, shown, copied and pickled, with a value in every member."""
from __future__ import annotations

import copy
import pickle
from collections.abc import Callable

import numpy as np

import dartcast as dc

from . import Calls, classes, is_record, refused


def is_empty(value: object) -> bool:
    return value is None or (hasattr(value, "__len__") and len(value) == 0)


def candidates() -> list[object]:
    """Values for members that are empty by default, of every type that members have."""
    records = [cls() for cls in classes().values() if is_record(cls)]
    return ["a text of more than fifteen letters", 1, (0, 1), (0.1, 0.2, 0.3), 0.5, [1, 2, 3], [0.5, 1.5],
            np.ones((2, 3)), ["one", "two"], [(0, 1), (1, 2)],
            [[1, 2], [3]], {"one": 1}, {"one": dc.Stick()}, {1: "one"}, [np.ones((2, 3))], [[[0, 0, 0], [0, 0, 1]]],
            [dc.generate_box()], dc.generate_box(), lambda k: np.ones((2, 3)), *([r] for r in records), *records]


def filled(cls: type, values: list[object]) -> dict[str, object]:
    """A value for each member that can be set: its own, or where that is empty the first that it takes."""
    record = cls()
    for name, member in vars(cls).items():
        if not isinstance(member, property) or member.fset is None or not is_empty(getattr(record, name)):
            continue
        for value in values:
            try:
                setattr(record, name, value)
            except (TypeError, ValueError, dc.Error):
                continue
            if not is_empty(getattr(record, name)):
                break
    return {name: getattr(record, name) for name, member in vars(cls).items()
            if isinstance(member, property) and member.fset is not None}


def use(cls: type, members: dict[str, object], can_pickle: bool) -> Callable[[], None]:
    readable = [name for name, member in vars(cls).items() if isinstance(member, property)]
    refuse_name = refused(lambda: cls(no_such_member=1))
    one = cls(**members)

    def call() -> None:
        record = cls(**members)
        for name in readable:
            getattr(record, name)
        for name, value in members.items():
            setattr(record, name, value)
            try:
                setattr(record, name, Ellipsis)
            except (TypeError, ValueError, dc.Error):
                pass
        assert (record == one) in (True, False) and record != 3
        repr(record)
        copy.copy(record)
        copy.deepcopy(record)
        if can_pickle:
            pickle.loads(pickle.dumps(record))
        refuse_name()
    return call


def has_function(members: dict[str, object]) -> bool:
    """Whether a member is a function, or has one: such records cannot be pickled."""
    try:
        pickle.dumps(members)
    except (TypeError, AttributeError, pickle.PicklingError):
        return True
    return False


def calls() -> Calls:
    values = candidates()
    table: Calls = {}
    for name, cls in classes().items():
        if is_record(cls):
            members = filled(cls, values)
            table[name] = use(cls, members, not has_function(members))
    return table
