"""What all commands share: options, help, and from options to a study."""
