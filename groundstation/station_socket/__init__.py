"""How programs of one user find a running station: the folder, its sockets, the first packets."""
