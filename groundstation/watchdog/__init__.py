"""The watchdog: a small process that sends neutral in the place of a station process that is killed or stands still."""
