"""One error at a time over size and direction: where growth ends, which faces bear, whether the
thrust outlasts the rail."""
