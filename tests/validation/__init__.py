"""Evidence beside the product."""
