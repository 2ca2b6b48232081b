"""What searches for the paper's unpublished inputs tell: ranges of every input, what the best set
leaves its rail with, data."""
