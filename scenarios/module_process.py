"""A module's process: ``python -m scenarios.module_process ORDER``."""

from __future__ import annotations

import sys

from bus import link
from bus.process import ModuleProcess
from bus.turns import Worker
from scenarios.module_order import read_module_order
from scenarios.modules import REFUSED, ModuleRefusedError, build_module
from scenarios.parent import end_with_parent


def main(order_path: str) -> int:
    """Build the module, join the star, take turns until the run is over."""
    end_with_parent()
    order = read_module_order(order_path)
    try:
        module = build_module(order.name, order.facts, order.settings, order.seed)
    except ModuleRefusedError as error:
        print(error.__cause__, flush=True)
        return REFUSED
    worker = Worker(order.name, module, order.prices.costs)
    with link.open_client(order.endpoint) as session:
        ModuleProcess(session, link.Keys(order.run), worker).run()
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
