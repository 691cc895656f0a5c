"""Shows what passes between box, robots and tablet: `python -m roah_rsbb.tools.capture --help`. No ROS.

From the network or a recording to the screen: `packets` (what a raw socket brings) or plain sockets make
`records.Datagram`, which `decoding.Decoder` turns into an `Entry`: a message, or why it is none. `filters`
choose, `lines` and `fields` make text or JSON of it. Only `listening`, `routes` and `program` do I/O.
"""
