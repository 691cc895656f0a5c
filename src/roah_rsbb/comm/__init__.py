"""What travels between the box, the robots and the tablet: frames, ciphers, UDP channels. No ROS.

From the inside out: `ciphers` (passwords to keys, AES), `wire_check` and `frame` (bytes to messages and
back), `complaints` (what came in and was no message), `sender` (when to send a state), `sockets` and
`peer` (a UDP endpoint), `channels` (the public and the private channel, which is what others use).
"""
