"""Clients of an HTTP server on a real loopback socket."""

import asyncio

from tornado import httpclient

HOST = "127.0.0.1"
BROKEN_REQUESTS = (
    b"\0\1\2\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n",
    b"POST / HTTP/1.1\r\nContent-Length: 99999999\r\n\r\n",
    b"GET / HTTP/1.1\r\nx: " + b"y" * 20000 + b"\r\n\r\n",
    b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nffffffff\r\n",
)


class HttpClients:
    """For a class that has the loop, `running`, and the server's `port`."""

    def get(self, path, **how):
        client = httpclient.AsyncHTTPClient(force_instance=True)
        return self.running.do(client.fetch(f"http://{HOST}:{self.port}{path}", raise_error=False, **how))

    def raw(self, data):
        """What the server answers to these bytes, until it closes the connection."""
        async def ask():
            reader, writer = await asyncio.open_connection(HOST, self.port)
            writer.write(data)
            try:
                return await reader.read()
            except ConnectionError:
                return b""
            finally:
                writer.close()
        return self.running.do(ask())


def closed(connections):
    """Those of these sockets that the server has closed."""
    def is_closed(connection):
        connection.setblocking(False)
        try:
            return connection.recv(4096) == b""
        except BlockingIOError:
            return False
        except ConnectionError:
            return True
    return [connection for connection in connections if is_closed(connection)]
