"""The tablet: a web page with a call button and a map, served to any phone or tablet. No ROS.

`state` has the touches and their acknowledgement by the box, `radio` communicates with the box, `server` with the
pages; `maps` reads the map, and `dummy` is a tablet on the command line.
"""
