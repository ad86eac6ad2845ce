"""A module's process: ``python -m scenarios.module_process ORDER``."""

from __future__ import annotations

import sys

from bus import link
from bus.process import ModuleProcess
from bus.turns import Worker
from scenarios.module_order import read_module_order
from scenarios.modules import build_module
from scenarios.parent import end_with_parent


def main(order_path: str) -> None:
    """Build the module, join the star, take turns until the run is over."""
    end_with_parent()
    order = read_module_order(order_path)
    module = build_module(order.name, order.facts, order.settings, order.seed)
    worker = Worker(order.name, module, order.prices.costs)
    with link.open_client(order.endpoint) as session:
        ModuleProcess(session, link.Keys(order.run), worker).run()


if __name__ == "__main__":
    main(*sys.argv[1:])
