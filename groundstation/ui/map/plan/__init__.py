"""Plans as they are edited on the Map screen: rows, fields, commands, checks, files."""
