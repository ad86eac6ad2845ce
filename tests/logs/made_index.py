"""An index of made-up messages and handlers, for chains whose numbers are known."""

from __future__ import annotations

from dataclasses import dataclass, field

from bus.wire import MessageId
from logs.ancestry import Node


@dataclass
class MadeIndex:
    nodes: dict[MessageId, Node] = field(default_factory=dict)
    spans: dict[tuple[str, MessageId], tuple[int, int]] = field(default_factory=dict)

    def say(
        self, topic: str, source: str, sequence: int, said_ns: int, *parents: MessageId
    ) -> Node:
        node = Node(topic, source, sequence, said_ns, parents)
        self.nodes[node.id] = node
        return node

    def handle(self, process: str, node: Node, start_ns: int, end_ns: int) -> None:
        self.spans[process, node.id] = (start_ns, end_ns)

    def find(self, name: MessageId) -> Node | None:
        return self.nodes.get(name)

    def span(self, process: str, name: MessageId) -> tuple[int, int] | None:
        return self.spans.get((process, name))
