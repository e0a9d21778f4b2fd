"""One module a command: ``add_arguments(parser)``, ``execute(arguments) -> exit code``. `workflow.cli` lists them."""
