"""State that screens draw: snapshot, alerts, hints, running tasks, wrapped texts."""
