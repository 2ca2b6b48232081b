"""Tables, text and figures as HTML, Markdown, terminal lines and images."""
