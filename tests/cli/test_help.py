"""Help is whole at any width: nothing is cut, and only examples may be wider than the terminal."""

from typing import Any

import pytest
import typer

from breakaway.cli.app import app

ROOT: Any = typer.main.get_command(app)
COMMANDS = {
    "breakaway": ROOT,
    **ROOT.commands,
    **{f"export {name}": command for name, command in ROOT.commands["export"].commands.items()},
}


def help_of(name: str, width: int) -> str:
    command = COMMANDS[name]
    context = typer.Context(command, info_name=name, terminal_width=width)
    shown: str = command.get_help(context)
    return shown


@pytest.mark.parametrize("width", [50, 60, 80, 120])
@pytest.mark.parametrize("name", COMMANDS)
def test_help_fits(name: str, width: int) -> None:
    shown = help_of(name, width)
    options = {word for option in COMMANDS[name].params for word in option.opts}
    assert {word for word in options if word[0] == "-"} <= set(shown.replace(",", " ").split())
    explained = shown.split("Examples:")[0].split("Start here:")[0]
    too_wide = [line for line in explained.splitlines() if len(line.rstrip()) > width]
    assert all(len(line.split()) == 2 for line in too_wide), too_wide  # an option and its values


@pytest.mark.parametrize("group", ["breakaway", "export"])
def test_lists_of_commands_are_whole(group: str) -> None:
    shown = " ".join(help_of(group, 60).split())
    for name, command in COMMANDS[group].commands.items():
        assert f"{name} {' '.join(command.short_help.split())}" in shown
