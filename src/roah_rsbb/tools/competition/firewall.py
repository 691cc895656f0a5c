"""The firewall file of a competition: what the robots' network may reach on the box's computer."""

from typing import List, Optional

from roah_rsbb.core.connections import PORTS

TABLE = "roah_rsbb"
TABLET_PORT = 8080
# The name in the file if the interface is not known. The organiser writes the right one.
UNKNOWN_INTERFACE = "eth0"

_TEXT = """\
#!/usr/sbin/nft -f
# Firewall of this competition's box: what the robots' network may reach on this computer.
#
#   sudo nft -f {name}             load it (again after each start of the computer)
#   sudo nft list table inet {table}    show it, and how much was dropped
#   sudo nft delete table inet {table}  remove it
#
# ROS has no password: anyone who reaches its ports can stop, score and end the box. Only the box's own ports are open
# to the robots' network, and nothing is forwarded to or from that network. Other interfaces are not affected.

# The interface to the robots, as 'ip -4 address' names it.{check}
define robots = "{interface}"

table inet {table}
delete table inet {table}
table inet {table} {{
  chain input {{
    type filter hook input priority 0; policy accept;
    iifname != $robots accept
    ct state established,related accept
    udp dport {first}-{last} accept comment "the box: public channel, and a port for each run"
{tablet}    udp dport 123 accept comment "NTP, if this computer is the time server"
    udp sport 67 udp dport 68 accept comment "DHCP"
    meta l4proto {{ icmp, ipv6-icmp }} accept
    # If referees' computers are in the robots' network: only these addresses reach ROS.
    # ip saddr {{ 192.168.1.20, 192.168.1.21 }} accept
    counter drop
  }}
  chain forward {{
    type filter hook forward priority 0; policy accept;
    iifname $robots counter drop
    oifname $robots counter drop
  }}
}}
"""
_TABLET = '    tcp dport {port} accept comment "the page of the tablet"\n'


def firewall_text(name: str, interface: Optional[str], rsbb_port: int, tablet: bool) -> str:
    """Return the file `name` for nft. `interface`: the one to the robots; None: not known. `tablet`: serve its page."""
    return _TEXT.format(
        name=name, table=TABLE, interface=interface or UNKNOWN_INTERFACE, first=rsbb_port, last=rsbb_port + PORTS - 1,
        check="" if interface else " CHECK THIS NAME.", tablet=_TABLET.format(port=TABLET_PORT) if tablet else "",
    )


def loaded_for(listing: str) -> List[str]:
    """Return the interfaces that a loaded table protects. `listing`: the output of `nft list table`."""
    chain = listing.partition("chain input")[2].partition("}")[0]
    words = chain.replace('"', "").split()
    return [words[i + 2] for i, word in enumerate(words[:-2]) if word == "iifname" and words[i + 1] == "!="]
