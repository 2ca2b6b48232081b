"""The rails as the reference will use them."""
