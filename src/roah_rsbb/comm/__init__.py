"""Communication between the box, the robots and the tablet: frames, ciphers, UDP channels. No ROS.

From bottom to top: `ciphers` (keys from passwords, AES), `frame` (bytes to messages and back), `complaints` (invalid
datagrams), `sender` (when to send a state), `sockets` and `peer` (a UDP endpoint), `channels` (the public and the
private channel, which other packages use).
"""
