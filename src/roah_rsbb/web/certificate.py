"""The certificate of encrypted web pages, from the files of the organisers (docs/web.md, "Encryption")."""

import datetime
import ipaddress
import os
import ssl
from typing import List, NamedTuple, Optional, Tuple

from cryptography import x509
from cryptography.hazmat.backends import default_backend

MAKE = "'rosrun roah_rsbb new_competition --certificate DIR'"
# A certificate that ends sooner is reported.
SOON = datetime.timedelta(days=3)


class CertificateError(OSError):
    """The certificate cannot be used. The text names the remedy."""


class CertificateFiles(NamedTuple):
    """The files of a certificate, as PEM."""

    certificate: str  # with those that signed it, if there are any
    key: str


class Certificate:
    """The certificate of the pages. Call `renew` from time to time: the files may be replaced while it is in use."""

    def __init__(self, files: CertificateFiles) -> None:
        self._files = files
        self._stamps: List[Optional[Tuple[int, int, int]]] = []
        self._parsed: Optional[x509.Certificate] = None
        self.context = _new_context()

    def renew(self) -> bool:
        """Load the files if they have changed, or were not loaded yet; returns whether it did.

        New connections use the new certificate. Raises `CertificateError` once for each change, and the certificate
        before it stays in use. Without one, it raises each time.
        """
        stamps = _stamps(self._files)
        if stamps == self._stamps and self._parsed is not None:
            return False
        self._stamps = stamps
        parsed = _parse(self._files)
        _load(_new_context(), self._files)  # a pair that does not fit must not reach the context in use
        _load(self.context, self._files)
        self._parsed = parsed
        return True

    def trouble(self, utc: datetime.datetime, host: str) -> str:
        """Return why browsers will warn of the page on this host; empty: they will not, if they trust the certificate.

        `utc` is a time without a time zone. Call `renew` first.
        """
        parsed, path = self._parsed, self._files.certificate
        if parsed is None:
            return ""
        first, last = parsed.not_valid_before, parsed.not_valid_after
        if utc < first:
            return (f"the certificate in {path} is valid from {first:%Y-%m-%d %H:%M} UTC only: set the clock of this "
                    "computer")
        if utc + SOON > last:
            what = "has expired" if utc > last else "expires"
            return f"the certificate in {path} {what} on {last:%Y-%m-%d %H:%M} UTC: make a new one with {MAKE}"
        if host not in _names(parsed):
            return (f"the certificate in {path} is not for {host}, so browsers warn: make one with {MAKE} --names "
                    f"'{host}'")
        return ""


def _stamps(files: CertificateFiles) -> List[Optional[Tuple[int, int, int]]]:
    """What changes when a file is replaced or written."""
    stamps: List[Optional[Tuple[int, int, int]]] = []
    for path in files:
        try:
            found = os.stat(path)
            stamps.append((found.st_ino, found.st_size, found.st_mtime_ns))
        except OSError:
            stamps.append(None)
    return stamps


def _parse(files: CertificateFiles) -> x509.Certificate:
    """Read the certificate, and check that both files can be read."""
    data = b""
    for path in reversed(files):
        try:
            with open(path, "rb") as file:
                data = file.read()
        except OSError as error:
            raise CertificateError(
                f"cannot read {path}: {error.strerror}. Correct web_cert and web_key, or make a certificate with {MAKE}"
            ) from error
    try:
        return x509.load_pem_x509_certificate(data, default_backend())
    except ValueError as error:
        raise CertificateError(f"{files.certificate} is not a certificate in PEM format: correct web_cert, or make one "
                               f"with {MAKE}") from error


def _new_context() -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    return context


def _load(context: ssl.SSLContext, files: CertificateFiles) -> None:
    try:
        context.load_cert_chain(files.certificate, files.key, _no_password)
    except _HasPassword as error:
        raise CertificateError(f"the key in {files.key} has a password: remove it with 'openssl pkey -in "
                               f"{files.key} -out NEW_KEY', and give the new file as web_key") from error
    except ssl.SSLError as error:
        if error.reason == "KEY_VALUES_MISMATCH":
            raise CertificateError(f"the key in {files.key} does not belong to the certificate in "
                                   f"{files.certificate}: correct web_cert or web_key, or make a new pair with "
                                   f"{MAKE}") from error
        raise CertificateError(f"{files.key} and {files.certificate} cannot be used ({error.reason or error}): both "
                               f"must be in PEM format. {MAKE} makes such files") from error


class _HasPassword(Exception):
    pass


def _no_password() -> str:
    """OpenSSL would ask at the terminal."""
    raise _HasPassword


def _names(certificate: x509.Certificate) -> List[str]:
    """The names and addresses that a certificate is for."""
    try:
        found = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return []
    addresses: List[ipaddress.IPv4Address] = found.get_values_for_type(x509.IPAddress)
    return [*found.get_values_for_type(x509.DNSName), *map(str, addresses)]
