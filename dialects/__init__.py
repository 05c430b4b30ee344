"""The MAVLink dialect: messages, enums, modes and codec. The only package that imports pymavlink."""
