"""Encryption of the pages: the certificate, and connections with and without it at one port (docs/web.md)."""
