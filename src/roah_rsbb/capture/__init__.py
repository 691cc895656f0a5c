"""Shows the datagrams between box, robots and tablet: `python -m roah_rsbb.capture --help`. No ROS.

`listening` (from the network) or a recording provide datagrams. `decoding.Decoder` turns each into a message, or the
reason why it is not one. `program` filters them and formats them as text or JSON.
"""
