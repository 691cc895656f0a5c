"""A box with a small document behind a door on a real loopback socket, and a client of bare messages."""

import json
import threading

from tornado import httpclient, websocket

from helpers.toy_document import LOW, Box, Toy, Zone
from roah_rsbb.box.door import Door
from roah_rsbb.client.places import DoorPlace
from roah_rsbb.document.calls import Waiting
from roah_rsbb.document.document import Written
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused

HOST = "127.0.0.1"
TOKEN = "secret"


class ToyBox:
    """A core that counts, and its door. Everything is in the test's loop."""

    def __init__(self, running, port=0, utc=1000.0):
        self.running = running
        self.utc = utc
        self.done = []  # calls that were carried out
        self.toy = Toy(Box("Event"), {"Home": Zone("Home"), "Yard": Zone("Yard")})
        self.written = Written(Toy)
        self.written.update(self.toy, self.now())
        self.disk = threading.Event()  # set: what was done is on the disk
        self.trouble = ""  # why not
        calls = {"act": self.act, "save": self.save, "refuse": self.refuse, "break": self.fail, "stop": self.act}
        self.door = Door(running.loop, TOKEN, calls, self.now, self.written)
        self.port = self.door.open(HOST, port)

    @property
    def place(self):
        return DoorPlace(f"ws://{HOST}:{self.port}/door", TOKEN)

    @property
    def clients(self):
        """The clients of the door."""
        return self.door._all()

    @property
    def asked(self):
        """The calls for which a client that offers them has been asked."""
        return self.door._offers._asked

    def now(self):
        """A monotonic clock that is not that of this computer."""
        mono = self.running.loop.time() + 5000.0
        return Now(mono, mono + self.utc)

    def change(self, **fields):
        """Something happens in Home."""
        home = self.toy.zones["Home"]._replace(**fields)
        self.toy = self.toy._replace(zones={**self.toy.zones, "Home": home})
        if self.written.update(self.toy, self.now()):
            self.door.publish()

    def act(self, arguments, caller):
        self.done.append((arguments, caller))
        self.change(count=self.toy.zones["Home"].count + 1)
        return {"count": self.toy.zones["Home"].count}

    def save(self, arguments, caller):
        def wait():
            assert self.disk.wait(60)
            return self.trouble

        return Waiting(wait, self.act(arguments, caller))

    def refuse(self, arguments, caller):
        raise Refused([LOW(robot="r1", number=1), "typed"])

    def fail(self, arguments, caller):
        raise ZeroDivisionError("of a toy")


class Bare:
    """A client that sends and reads messages as they are."""

    def __init__(self, box, query="", headers=None, **how):
        self.running = box.running
        request = httpclient.HTTPRequest(
            f"ws://{HOST}:{box.port}/door{query}", headers=headers or {"Authorization": f"Bearer {TOKEN}"})
        self.connection = self.running.do(websocket.websocket_connect(request, **how))

    def send(self, **message):
        self.running.do(self.connection.write_message(json.dumps(message)))

    def read(self):
        """The next message; None: the connection was closed."""
        text = self.running.do(self.connection.read_message())
        return text and json.loads(text)

    def read_answer(self):
        """The next answer."""
        while True:
            message = self.read()
            if message is None or "id" in message:
                return message
