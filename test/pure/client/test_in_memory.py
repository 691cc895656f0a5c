"""A simulation has the document and the calls without a connection."""

from helpers.running_loop import running
from helpers.toy_box import ToyBox
from helpers.toy_document import LOW, Toy
from roah_rsbb.client.client import Answer
from roah_rsbb.client.in_memory import InMemory

__all__ = ["running"]


def test_the_document_and_calls(running):
    box = ToyBox(running)
    client = InMemory(Toy, box.written, box.door._calls, box.now)
    assert client.document == box.toy
    first = client.document
    answer = client.call("act", zone="Home")
    assert answer == Answer(box.written.number, {"count": 1})
    assert client.document == box.toy and client.document.zones["Yard"] is first.zones["Yard"]
    assert client.call("refuse").reasons == (LOW(robot="r1", number=1), "typed")
    box.trouble = "full"
    box.disk.set()
    assert client.call("save").reasons == ("full",)
    box.door.close()
