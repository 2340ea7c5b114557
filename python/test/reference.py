# SPDX-License-Identifier: BSD-3-Clause
"""The same queries in Python and in the C++ program fcl_ccd_python_reference."""

import os
import subprocess

import numpy as np

import fcl_ccd

_NO_LIMIT = 2**64 - 1


def _text(numbers):
    array = np.asarray(numbers)
    if array.dtype.kind == "f":
        return " ".join(x.hex() for x in array.ravel().tolist())
    return " ".join(map(str, array.ravel().tolist()))


def deformable(previous, current, triangles):
    sizes = f"deformable {len(previous)} {len(triangles)}"
    return " ".join([sizes, _text(previous), _text(current), _text(triangles)])


def rigid(vertices, triangles):
    return f"rigid {len(vertices)} {len(triangles)} {_text(vertices)} {_text(triangles)}"


def shape(name, *sizes):
    """The command of a shape, and the shape. Of a Convex only tetrahedra are known."""
    numbers = sizes[0] if name == "Convex" else np.concatenate([np.ravel(x) for x in sizes])
    return f"{name} {_text(np.asarray(numbers, float))}", getattr(fcl_ccd, name)(*sizes)


def _filter(group=1, mask=2**32 - 1, triangle_groups=(), triangle_masks=()):
    lists = [f"{len(bits)} {_text(np.asarray(bits, int))}" for bits in (triangle_groups, triangle_masks)]
    return f"{group} {mask} {' '.join(lists)}"


def request(
    query="all",
    toc_err=1e-4,
    t_max=1.0,
    num_max_contacts=_NO_LIMIT,
    min_distance=0.0,
    ignore_initially_closer=False,
    min_approach_speed=0.0,
    enable_contact=True,
    enable_crossings=False,
    filter1={},
    filter2={},
    accepts_triangles=None,
):
    return " ".join(
        [
            query,
            float(toc_err).hex(),
            float(t_max).hex(),
            str(num_max_contacts),
            f"{float(min_distance).hex()} {int(ignore_initially_closer)}",
            float(min_approach_speed).hex(),
            f"{int(enable_contact)} {int(enable_crossings)}",
            _filter(**filter1),
            _filter(**filter2),
            str(int(accepts_triangles is not None)),
        ]
    )


def in_python(options):
    """The keywords of a query in Python. Filters are given as their keywords."""
    options = dict(options)
    for name in ("filter1", "filter2"):
        if name in options:
            options[name] = fcl_ccd.Filter(**options[name])
    return options


def features(kind, t0, t1, toc_err, min_distance=0.0):
    both = np.concatenate([t0, t1], axis=1)
    return f"{kind} {len(t0)} {toc_err.hex()} {min_distance.hex()} {_text(both)}"


def poses(begin, end):
    return f"{_text(begin)} {_text(end)}"


def run(commands):
    """The lines of each answer, as lists of words."""
    program = os.environ["FCL_CCD_PYTHON_REFERENCE"]
    done = subprocess.run(
        [program], input="\n".join(commands), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    answers = [[]]
    for line in done.stdout.splitlines():
        if line == "end":
            answers.append([])
        else:
            answers[-1].append(line.split())
    return answers[:-1]


def _columns(records):
    """The records as a table of numbers, in the order of the fields."""
    columns = [records[name].reshape(len(records), -1) for name in records.dtype.names]
    return np.concatenate(columns, axis=1, dtype=float) if len(records) else np.empty((0, 0))


def _number(word):
    return float.fromhex(word) if "x" in word else float(word)


def _table(lines):
    return np.array([[_number(word) for word in line] for line in lines])


def require_same_records(records, lines):
    assert len(records) == len(lines)
    if lines:
        np.testing.assert_array_equal(_columns(records), _table(lines))


def require_same(result, lines, with_poses=True):
    collides, toc, cut, crossing, num_contacts, num_crossings = lines[0]
    assert result.is_collide == bool(int(collides))
    assert bool(result) == result.is_collide
    assert result.time_of_contact == _number(toc)
    assert result.contacts_cut == bool(int(cut))
    assert result.initially_crossing == bool(int(crossing))
    if with_poses:
        np.testing.assert_array_equal(result.contact_tf1.ravel(), _table(lines[1:2])[0])
        np.testing.assert_array_equal(result.contact_tf2.ravel(), _table(lines[2:3])[0])
    records = lines[3:]
    end = int(num_contacts)
    require_same_records(result.contacts, records[:end])
    require_same_records(result.crossing, records[end : end + int(crossing)])
    require_same_records(result.crossings, records[end + int(crossing) :])
    assert len(result.crossings) == int(num_crossings)
