"""Verbs that show, record or send messages and commands."""
