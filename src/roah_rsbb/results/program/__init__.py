"""`rosrun roah_rsbb results`: its commands, and the files that it writes."""
