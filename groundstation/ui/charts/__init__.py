"""What the Charts screen and the chart pane of Drive show, without widgets."""
