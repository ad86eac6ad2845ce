"""The zenoh star: one router-mode session, every other process a client of it.

Keys are ``waywiser/RUN/t/TOPIC`` for messages, ``.../grant/PROCESS`` and ``.../done`` for the
clock, ``.../t/.commit`` for the recorder, ``.../refused`` for what was not let in,
``.../alive/PROCESS`` for liveliness. RUN is unique to a launch, so a straggler of another run
is never heard.
"""

from __future__ import annotations

import json
import socket
from collections.abc import Callable
from typing import Any

import zenoh

_BASE: dict[str, Any] = {
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    "scouting/delay": 0,
    "timestamping/enabled": False,
    "transport/shared_memory/enabled": False,
    # A virtual run may compute for long with nobody reading: never cut a slow process off.
    "transport/link/tx/lease": 60_000,
    "transport/link/tx/queue/congestion_control/block/wait_before_close": 60_000_000,
    "connect/retry": {"period_init_ms": 20, "period_max_ms": 250, "period_increase_factor": 1.5},
}


_WITHOUT_BOUND = 1 << 40
"""So many samples do not come."""


class PortError(ValueError):
    """The port that the bus should listen on cannot be had."""


class Keys:
    """The keys of one run."""

    def __init__(self, run: str) -> None:
        self.root = f"waywiser/{run}"
        self.done = f"{self.root}/done"
        self.commit = f"{self.root}/t/.commit"  # in one queue with the messages; no topic's name
        self.refused = f"{self.root}/refused"
        self.every_topic = f"{self.root}/t/**"
        self.all_alive = f"{self.root}/alive/*"

    def topic(self, name: str) -> str:
        """Where a topic's messages go."""
        return f"{self.root}/t/{name}"

    def topic_of(self, key: str) -> str:
        """The topic of a message's key."""
        return key.removeprefix(f"{self.root}/t/")

    def grant(self, process: str) -> str:
        """Where a process gets its grants."""
        return f"{self.root}/grant/{process}"

    def alive(self, process: str) -> str:
        """The liveliness token of a process, declared when it is ready."""
        return f"{self.root}/alive/{process}"


def endpoint(port: int) -> str:
    """A loopback endpoint; port 0 picks a free one. Raises PortError if it is taken."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as error:
            raise PortError(
                f"bus.port: found port {port} taken on 127.0.0.1 ({error.strerror}), "
                f"expected a free port (0 picks one)"
            ) from None
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def _config(settings: dict[str, Any]) -> zenoh.Config:
    config = zenoh.Config()
    for key, value in (_BASE | settings).items():
        config.insert_json5(key, json.dumps(value))
    return config


def open_hub(at: str) -> zenoh.Session:
    """The star's centre, listening at an endpoint."""
    return zenoh.open(_config({"mode": "router", "listen/endpoints": [at]}))


def open_client(at: str) -> zenoh.Session:
    """A point of the star. Waits up to 20 s for the centre, then raises zenoh.ZError."""
    return zenoh.open(
        _config(
            {
                "mode": "client",
                "listen/endpoints": [],
                "connect/endpoints": [at],
                "connect/timeout_ms": 20_000,
                "connect/exit_on_failure": True,
            }
        )
    )


def publisher(session: zenoh.Session, key: str) -> zenoh.Publisher:
    """A reliable, ordered publisher: nothing is dropped, nothing overtakes."""
    return session.declare_publisher(
        key,
        congestion_control=zenoh.CongestionControl.BLOCK,
        reliability=zenoh.Reliability.RELIABLE,
    )


def subscribe(
    session: zenoh.Session, key: str, put: Callable[[tuple[str, bytes]], None]
) -> zenoh.Subscriber[None]:
    """Hand (key, payload) of every sample to ``put`` on zenoh's own thread, in order."""

    def received(sample: zenoh.Sample) -> None:
        put((str(sample.key_expr), sample.payload.to_bytes()))

    return session.declare_subscriber(key, zenoh.handlers.Callback(received, indirect=False))


def queue_up(
    session: zenoh.Session, key: str
) -> zenoh.Subscriber[zenoh.handlers.Handler[zenoh.Sample]]:
    """Let samples wait in zenoh's own queue until they are asked for: many a second, none lost."""
    return session.declare_subscriber(key, zenoh.handlers.FifoChannel(_WITHOUT_BOUND))


def watch_alive(
    session: zenoh.Session, keys: Keys, changed: Callable[[str, bool], None]
) -> zenoh.Subscriber[None]:
    """Call ``changed(process, is it alive)`` whenever a process gets ready or goes."""

    def received(sample: zenoh.Sample) -> None:
        process = str(sample.key_expr).rsplit("/", 1)[1]
        changed(process, sample.kind == zenoh.SampleKind.PUT)

    return session.liveliness().declare_subscriber(
        keys.all_alive, zenoh.handlers.Callback(received, indirect=False), history=True
    )
