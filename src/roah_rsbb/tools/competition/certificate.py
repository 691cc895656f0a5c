"""Makes the certificate of the web pages: new_competition --certificate DIR (docs/web.md, "Encryption").

Phones trust an authority of this competition, which signs one certificate. The key of the authority is forgotten at
once: nobody can sign another certificate that these phones would trust.
"""

import datetime
import ipaddress
import os
import secrets
import socket
from typing import List, NamedTuple, Sequence

from cryptography import x509
from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from roah_rsbb.ground import durable
from roah_rsbb.rulebook.errors import Place, Report, quote
from roah_rsbb.tools.ports import interfaces

CERTIFICATE, KEY, AUTHORITY = "web_cert.pem", "web_key.pem", "phones.crt"
# iPhones accept at most 825 days.
VALID_DAYS = 397
# The clocks of phones differ.
_EARLIER = datetime.timedelta(days=1)
_ANYBODY = 0o644


class Made(NamedTuple):
    """The files of a certificate, as PEM."""

    certificate: bytes  # and the authority that signed it
    key: bytes
    authority: bytes
    fingerprint: str  # of the authority, as phones show it


def own_names() -> List[str]:
    """Return the names and addresses by which browsers may call this computer."""
    name = socket.gethostname()
    names = [] if name == "localhost" else [name, f"{name.partition('.')[0]}.local"]
    return [*dict.fromkeys([*names, "localhost", *(one.address for one in interfaces())])]


def check_names(report: Report, place: Place, names: Sequence[str]) -> None:
    """Report names that a certificate cannot have."""
    for name in names:
        is_name = name and len(name) < 254 and all(
            0 < len(part) < 64 and part.isascii() and part.replace("-", "").isalnum() for part in name.split("."))
        if not is_name and not _is_address(name):
            report.error(place, quote(name), "a name or address of the box, such as rsbb.local or 192.168.1.10")


def make(names: Sequence[str], utc: datetime.datetime) -> Made:
    """Make a certificate for these names and addresses. `utc` is now, without a time zone."""
    authority_key, key = (ec.generate_private_key(ec.SECP256R1(), default_backend()) for _ in range(2))
    # Phones list authorities by name: those of several competitions must differ.
    authority_name = _name(f"RoAH RSBB {utc:%Y-%m-%d} {secrets.token_hex(2)}")
    authority = _builder(authority_name, authority_name, authority_key, utc).add_extension(
        x509.BasicConstraints(ca=True, path_length=0), critical=True
    ).add_extension(_usage(signs=True), critical=True).sign(authority_key, hashes.SHA256(), default_backend())
    alternatives = [x509.IPAddress(ipaddress.ip_address(name)) if _is_address(name) else x509.DNSName(name)
                    for name in names]
    certificate = (
        _builder(_name("roah_rsbb_web"), authority_name, key, utc)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(_usage(signs=False), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .add_extension(x509.SubjectAlternativeName(alternatives), critical=False)
        .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(authority_key.public_key()), critical=False)
        .sign(authority_key, hashes.SHA256(), default_backend()))
    pem = [one.public_bytes(serialization.Encoding.PEM) for one in (certificate, authority)]
    fingerprint = authority.fingerprint(hashes.SHA256()).hex().upper()
    return Made(b"".join(pem), key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    ), pem[1], ":".join(fingerprint[i:i + 2] for i in range(0, len(fingerprint), 2)))


def write(directory: str, made: Made) -> None:
    """Write the files, and replace old ones. Raises OSError."""
    for name, content, mode in ((KEY, made.key, durable.PRIVATE), (CERTIFICATE, made.certificate, _ANYBODY),
                                (AUTHORITY, made.authority, _ANYBODY)):
        durable.write_file(os.path.join(directory, name), content, mode)


def _builder(
    name: x509.Name, issuer: x509.Name, key: ec.EllipticCurvePrivateKey, utc: datetime.datetime
) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder().subject_name(name).issuer_name(issuer).public_key(key.public_key())
        .serial_number(x509.random_serial_number()).not_valid_before(utc - _EARLIER)
        .not_valid_after(utc + datetime.timedelta(days=VALID_DAYS))
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False))


def _usage(signs: bool) -> x509.KeyUsage:
    return x509.KeyUsage(
        digital_signature=not signs, content_commitment=False, key_encipherment=False, data_encipherment=False,
        key_agreement=False, key_cert_sign=signs, crl_sign=signs, encipher_only=False, decipher_only=False)


def _name(text: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, text)])


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
