"""The published schemas: made from the models, and strict about every key of every answer."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import fastjsonschema
import numpy as np
import pytest
from shapely import Geometry

import kilter
from kilter.analysis.placing.polygon_sets import rings_of
from kilter.assembly.bricks.brick_assembly import assembly_of_bricks
from kilter.cli import main
from kilter.errors import InputError
from kilter.files import schema, to_text
from kilter.files.packing.packing_lists import PackedBox, PackingPlan
from kilter.scenes.random_bricks import random_bricks
from kilter.tell.record import SCHEMA_VERSION, Answer, Record, json_value
from published import WRITERS, validator

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
FIGURE = str(EXAMPLES / "paper-figure-8.kilter.json")
INVALID = fastjsonschema.JsonSchemaValueException


def test_the_published_schemas_are_those_of_the_models():
    """After a change of a model: python docs/build_schemas.py."""
    from answer_schemas import build_all_schemas

    built = build_all_schemas()
    assert {name: schema(name) for name in built} == built
    with pytest.raises(InputError, match="no schema is named 'chek'") as caught:
        schema("chek")
    assert set(str(caught.value).partition("there are: ")[2].split(", ")) == set(built)


def test_every_class_of_answers_is_validated():
    bases = [Answer]
    for base in bases:
        bases += [kind for kind in base.__subclasses__() if not kind.answer]
    kinds = {kind for base in bases for kind in base.__subclasses__() if kind.answer}
    assert {kind.answer: f"{kind.__module__}.{kind.__qualname__}" for kind in kinds} == WRITERS


@pytest.fixture(scope="module")
def answers() -> dict[str, Answer]:
    """An answer of each verb about an assembly."""
    assembly = kilter.example("paper-figure-8")
    verbs = ("check", "contacts", "hold", "margin", "orient", "plan", "region", "transport")
    return {verb: getattr(kilter, verb)(assembly) for verb in verbs}


def test_a_text_matches_its_schema_and_a_wrong_key_does_not(answers):
    for verb, answer in answers.items():
        data = json.loads(answer.to_json())
        assert (data["answer"], data["schema"]) == (verb, SCHEMA_VERSION)
        judge = validator(verb)
        judge(data)
        for wrong in _wrong(data):
            with pytest.raises(INVALID):
                judge(wrong)


def _wrong(data: dict[str, Any]) -> list[dict[str, Any]]:
    """Data of an answer with an unlisted key, without a key, and of another answer or version."""
    lacking = [{k: v for k, v in data.items() if k != key} for key in data]
    others = [data | {"answer": "another"}, data | {"schema": SCHEMA_VERSION + 1}]
    return [data | {"unlisted": None}, *others, *lacking[2:]]  # the first two keys are optional


def test_each_key_of_an_answer_is_an_attribute_with_its_value(answers, tmp_path):
    assembly = kilter.example("tower")
    (tmp_path / "in").mkdir()
    kilter.dump(assembly, tmp_path / "in" / "tower.kilter.json")
    box = kilter.box_to_place([0.5, 0.5, 0.5], 1.0)
    upper = PackedBox("b", (1, 1, 1), 1, (0.6, 0, 1), 2, max_load=1.0)
    more = [
        kilter.scene(assembly),
        kilter.settle(assembly),
        kilter.place(assembly, box),
        kilter.place(assembly, box, at=[0, 0]),
        kilter.check_plan(PackingPlan((PackedBox("a", (1, 1, 1), 1, (0, 0, 0), 1), upper), "m")),
        kilter.verify(assembly, kilter.check(assembly).proof()),
        kilter.margin(assembly_of_bricks(random_bricks(5, seed=3)), improve=True),
        kilter.batch(tmp_path / "in", tmp_path / "out"),
    ]
    for answer in (*answers.values(), *more):
        require_attributes(answer, answer.to_dict())


def require_attributes(value: Any, data: Any) -> None:
    """Require that each key of the data of a value, and of its pieces, is an attribute."""
    if isinstance(value, Record):
        for key, entry in data.items():
            require_attributes(getattr(value, key), entry)
    elif isinstance(value, Mapping):
        for key, entry in data.items():
            require_attributes(value[key], entry)
    elif isinstance(value, list | tuple):
        for one, entry in zip(value, data, strict=True):
            require_attributes(one, entry)
    else:
        assert not isinstance(data, dict)  # a piece that is no record
        assert (rings_of(value) if isinstance(value, Geometry) else json_value(value)) == data


def test_an_unlisted_key_of_an_entry_fails(answers):
    data = json.loads(answers["check"].to_json())
    data["parts"][0]["unlisted"] = 1
    with pytest.raises(INVALID, match="unlisted"):
        validator("check")(data)
    del data["parts"][0]["unlisted"]
    data["parts"][0]["acceleration"] = [0.0] * 5
    with pytest.raises(INVALID, match="acceleration"):
        validator("check")(data)


def test_a_writer_with_an_unlisted_key_fails_in_every_test():
    """The session validates `to_dict`: an answer with a wrong word raises an error."""
    verdict = kilter.check(kilter.example("paper-figure-8"))
    verdict.to_dict()
    object.__setattr__(verdict, "require", "wished")
    with pytest.raises(INVALID, match="require"):
        verdict.to_dict()


def _of_file(verb: str) -> Callable[[Path], list[str]]:
    return lambda folder: [verb, FIGURE]


def _suggesting(folder: Path) -> list[str]:
    return ["check", FIGURE, "--suggest-joints", "--friction", "0.3"]


def _verifying(folder: Path) -> list[str]:
    proof = str(folder / "proof.json")
    main(["check", FIGURE, "--proof", proof, "--quiet", "-o", str(folder / "text")])
    return ["verify", FIGURE, proof]


def _batching(folder: Path) -> list[str]:
    (folder / "in").mkdir()
    text = to_text(kilter.example("paper-figure-8"))
    (folder / "in" / "a.kilter.json").write_text(text, encoding="utf-8")
    return ["batch", str(folder / "in"), "-o", str(folder / "rows"), "--processes", "1"]


def _packing(folder: Path) -> list[str]:
    path = folder / "plan.csv"
    path.write_text("length,width,height,mass,x,y,z\n1,1,1,1,0,0,0\n", encoding="utf-8")
    return ["check-plan", str(path)]


def _ball(folder: Path) -> str:
    """Path of a scene of MuJoCo with a ball above a floor."""
    path = folder / "ball.xml"
    ball = '<body name="ball" pos="0 0 1"><freejoint/><geom size=".1"/></body>'
    floor = '<geom type="plane" size="1 1 1"/>'
    path.write_text(f"<mujoco><worldbody>{floor}{ball}</worldbody></mujoco>", encoding="utf-8")
    return str(path)


def _explaining(folder: Path) -> list[str]:
    pytest.importorskip("mujoco")
    return ["why", _ball(folder), "--creep", "0.01"]


def _settling_states(folder: Path) -> list[str]:
    pytest.importorskip("mujoco")
    states = folder / "states.npy"
    np.save(states, [[0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0]])
    return ["settle", _ball(folder), "--states", str(states)]


def _placing(folder: Path) -> list[str]:
    path = folder / "tower.kilter.json"
    path.write_text(to_text(kilter.example("tower")), encoding="utf-8")
    return ["place", str(path), "--box", "1x1x1", "--mass", "1"]


COMMANDS: dict[str, Callable[[Path], list[str]]] = {
    **{
        verb: _of_file(verb)
        for verb in (
            *("contacts", "hold", "margin", "orient", "plan", "region", "scene", "settle"),
            "transport",
        )
    },
    "check": _suggesting,
    "check-plan": _packing,
    "place": _placing,
    "settle-states": _settling_states,
    "verify": _verifying,
    "why": _explaining,
    "batch": _batching,
}


@pytest.mark.quick("check", "verify")
@pytest.mark.parametrize("verb", sorted(WRITERS))
def test_the_printed_data_of_a_command_match_the_schema(verb, tmp_path, capsys):
    words = COMMANDS[verb](tmp_path)
    capsys.readouterr()
    assert main([*words, "--json"]) in (0, 1, 3, 4)
    validator(verb)(json.loads(capsys.readouterr().out))
