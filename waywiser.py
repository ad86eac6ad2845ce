"""The command line, nothing else."""

from __future__ import annotations


def main() -> None:
    """Run the command line."""
    from scenarios.commands import app

    app()


if __name__ == "__main__":
    main()
