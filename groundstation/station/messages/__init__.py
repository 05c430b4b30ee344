"""Messages that arrive: rates, fields, filters, captures."""
