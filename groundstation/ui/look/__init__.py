"""How it looks: themes, colours, roles of colours, ASCII replacements."""
