"""The Drive screen: layout, instruments, panes, and the page shown while no vehicle is found."""
