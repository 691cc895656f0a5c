"""The texts of refusals."""

from roah_rsbb.model.reason import Refused
from roah_rsbb.wording.texts import did_you_mean


def test_a_refusal_has_every_reason():
    refused = Refused(["no robot", "no port"])
    assert refused.reasons == ["no robot", "no port"]
    assert str(refused) == "no robot; no port"


def test_the_nearest_choice_or_else_all():
    assert did_you_mean("tmb", ["tbm", "fbm"]) == ": did you mean 'tbm'?"
    assert did_you_mean("xyz", ["tbm", "fbm"]) == ": there is 'tbm', 'fbm'"
    assert did_you_mean("", iter(["tbm"])) == ": there is 'tbm'"
