"""MAVLink FTP (https://mavlink.io/en/services/ftp.html)."""
