from roah_rsbb.capture.program import main

main()
