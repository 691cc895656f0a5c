"""`rosrun roah_rsbb standby`: runs on the second computer and takes the box over."""
