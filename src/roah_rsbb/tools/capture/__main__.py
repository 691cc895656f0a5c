"""`python -m roah_rsbb.tools.capture`."""

from roah_rsbb.tools.capture.program import main

main()
