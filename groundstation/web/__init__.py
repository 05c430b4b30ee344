"""The screens in a browser: a web server on this machine whose tabs are screens of one running station."""
