"""What all commands share: options, help text, and running a command."""
