"""The tablet: a web page with a call button and a map, served to any phone or tablet. No ROS.

`state` holds what was touched and what the box said of it, `radio` speaks with the box, `server` with the
pages, `maps` reads the map; `dummy` is a tablet on the command line.
"""
