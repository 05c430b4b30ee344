"""Parts that all verbs share: arguments, output, exit codes, files on this machine."""
