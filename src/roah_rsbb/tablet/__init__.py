"""The tablet: a web page with a call button and a map, served to any phone or tablet. No ROS.

`radio` has the touches and communicates with the box, `server` with the pages; `maps` reads the map, and `dummy` is a
tablet on the command line.
"""
