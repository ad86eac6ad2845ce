"""Schemas that strict protobuf readers take: Rerun refuses a file for one field's name."""

from __future__ import annotations

from collections import Counter

import pytest

from bus.topics import TOPICS
from logs.schema import schema


@pytest.mark.parametrize("topic", TOPICS)
def test_no_two_fields_differ_only_in_case_and_underscores(topic: str) -> None:
    """``corridors`` and ``corridor_s`` have one camel-case name, which proto3 does not allow."""
    (file,) = schema(topic).file
    for record in (*file.message_type, *file.message_type[0].nested_type):
        names = Counter(field.name.replace("_", "").lower() for field in record.field)
        assert max(names.values()) == 1, names.most_common(1)
