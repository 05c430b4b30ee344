"""Views: data that one screen needs beside the snapshot."""
