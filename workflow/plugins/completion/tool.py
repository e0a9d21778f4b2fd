"""Print a shell script that completes commands, options and names of scenes."""

import argparse

import shtab

from granchain.parts import cli

JOB = "Setting up"
PRINTS = True
EXAMPLES = (
    "completion bash > ~/.local/share/bash-completion/completions/granchain",
    "completion zsh > ~/.zfunc/_granchain",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the shell."""
    parser.add_argument("shell", choices=shtab.SUPPORTED_SHELLS)


def execute(arguments: argparse.Namespace) -> int:
    """Print the script."""
    print(shtab.complete(cli.parser(cli.COMMANDS), arguments.shell))
    return 0
