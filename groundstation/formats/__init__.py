"""Files of other ground stations: parameters and plans, read and written. No I/O: text in, text out.

To add or change:
- a file with texts of parameters: a module in `groundstation/formats/`; `groundstation/formats/docs_files.py` chooses
  it.
- a file of another ground station: a module in `groundstation/formats/`; errors name the file and the line.
"""
