"""`python -m roah_rsbb.comm.capture`."""

from roah_rsbb.comm.capture.program import main

main()
