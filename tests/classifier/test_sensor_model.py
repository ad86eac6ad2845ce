"""The sensor model: its numbers, its file, and what it refuses."""

import json
from pathlib import Path

import msgspec
import numpy as np
import pytest

from bus.facts import Facts, Ring
from bus.features import (
    CONCAVE_CORNER,
    CONVEX_CORNER,
    DOOR_JAMB,
    FLAT_WALL,
    USUAL,
    WedgeError,
    Wedges,
)
from modules.classifier.geometry import enterable, presence, presence_table
from modules.classifier.process import build
from modules.classifier.sensor_model import (
    SHIPPED,
    SensorModel,
    SensorModelError,
    load_sensor_model,
    shape_of,
)
from modules.classifier.settings import Settings

SHAPE = shape_of(USUAL)


def some_model(seed: int = 0, wedges: Wedges = USUAL) -> SensorModel:
    rng = np.random.default_rng(seed)
    shape = shape_of(wedges)
    return SensorModel(
        counts=rng.integers(0, 200, shape),
        durations_s=rng.uniform(30.0, 60.0, shape[:2]),
        ring={"transducers": 24.0, "dropout": 0.02},
        made_by="a test",
    )


def test_smoothing_by_hand() -> None:
    counts = np.zeros(SHAPE, dtype=np.int64)
    counts[1, 2, 1] = (0, 1, 2, 5)
    model = SensorModel(counts, np.ones(SHAPE[:2]), {}, "a test")
    # (0 + 1 + 2 + 5) + 4 * 0.5 = 10, so 0.5/10, 1.5/10, 2.5/10, 5.5/10.
    assert np.allclose(model.probability[1, 2, 1], (0.05, 0.15, 0.25, 0.55), atol=1e-15)
    assert np.array_equal(model.probability[0, 0, 0], np.full(4, 0.25))


@pytest.mark.parametrize(("feature", "wedge"), [(FLAT_WALL, 2), (DOOR_JAMB, 1), (DOOR_JAMB, 3)])
def test_class_given_type_sums_x_out(feature: int, wedge: int) -> None:
    model = some_model()
    absent, there = model.probability[feature, wedge]
    for (n, j), present in np.ndenumerate(presence_table()[..., feature, wedge]):
        expected = ((1.0 - present) * absent + present * there) * enterable(1 << n)[j]
        assert np.allclose(model.class_given_type[n, feature * 8 + wedge, j], expected, atol=1e-15)


@pytest.mark.parametrize("count", [4, 8, 12])
def test_searched_are_the_detectors_of_features_that_some_types_show_and_some_not(
    count: int,
) -> None:
    # Surely, where no corridor has a doorway; doorways make corners less sure, but tell enough.
    wedges = Wedges(count)
    even = np.broadcast_to(np.array([(90, 8, 1, 1), (1, 1, 8, 90)]), shape_of(wedges))
    model = SensorModel(even, np.full((5, count), 40.0), {}, "a test")
    for number, heading in enumerate((1, 2, 4, 8)):
        entered = np.flatnonzero(enterable(heading)).tolist()
        present = np.array([presence(j, heading, wedges).ravel() for j in entered])
        codes, detectors = model.informative[number]
        assert codes.tolist() == np.flatnonzero(np.ptp(present, axis=0) == 1.0).tolist()
        assert detectors.class_given_type.shape == (len(codes), 4, 8)
        assert np.allclose(detectors.class_given_type.sum(axis=1), 1.0)
        assert np.array_equal(detectors.seconds, model.duration_by_detector_s[codes])


def test_door_jambs_tell_less_than_an_eighth_of_what_the_best_detectors_tell() -> None:
    def bits(by_class: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
        """Mutual information of class and type, the types as probable: H(S) - H(S|J)."""

        def entropy(p: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
            return float(-(p * np.log2(p)).sum())

        return entropy(by_class.mean(axis=0)) - float(np.mean([entropy(p) for p in by_class]))

    model = load_sensor_model()
    of_types = model.class_given_type[0][:, enterable(1)]
    told = np.array([bits(by_class) for by_class in of_types])
    codes = model.informative[0][0]
    assert told[codes].min() > told.max() / 2
    others = np.delete(told, codes)
    assert others.max() < told.max() / 8
    assert (np.flatnonzero(told > 1e-9).tolist()) == sorted(
        [*codes.tolist(), USUAL.code(DOOR_JAMB, 1), USUAL.code(DOOR_JAMB, 7)]
    )


def test_intervals_are_those_of_the_posterior() -> None:
    counts = np.zeros(SHAPE, dtype=np.int64)
    counts[0, 0, 1] = (0, 0, 100, 0)
    interval = SensorModel(counts, np.ones(SHAPE[:2]), {}, "a test").interval_95
    # Beta(100.5, 1.5): drawn independently of how it is reckoned.
    drawn = np.random.default_rng(1).dirichlet([0.5, 0.5, 100.5, 0.5], 200_000)
    expected = np.quantile(drawn, [0.025, 0.975], axis=0).T
    assert np.allclose(interval[0, 0, 1], expected, atol=2e-3)
    model = some_model()
    assert (model.interval_95[..., 0] <= model.probability + 1e-4).all()
    assert (model.interval_95[..., 1] >= model.probability - 1e-4).all()


def test_a_written_model_reads_back(tmp_path: Path) -> None:
    model, path = some_model(), tmp_path / "model.json"
    path.write_text(model.as_json())
    read = load_sensor_model(path, expected_ring=model.ring)
    assert np.array_equal(read.counts, model.counts)
    assert np.array_equal(read.durations_s, model.durations_s)
    assert (read.ring, read.made_by) == (model.ring, model.made_by)
    assert read.as_json() == model.as_json()


def test_the_shipped_model_separates_what_it_should() -> None:
    model = load_sensor_model()
    assert ((model.durations_s >= 30.0) & (model.durations_s <= 60.0)).all()
    both = model.counts.sum(axis=-1).min(axis=-1) > 0
    informative = np.zeros(both.shape, dtype=bool)
    informative[:2, [0, 1, 7]] = True
    informative[FLAT_WALL, [2, 6]] = True
    informative[CONVEX_CORNER, [1, 2, 6, 7]] = True
    informative[CONCAVE_CORNER, [1, 7]] = True
    informative[DOOR_JAMB, [1, 3, 5, 7]] = True
    assert np.array_equal(both, informative)
    wrong = np.maximum(model.probability[..., 0, 2:].sum(-1), model.probability[..., 1, :2].sum(-1))
    # A fiftieth of the walls beside are open doors, which no detector tells from corridors.
    assert (wrong[:DOOR_JAMB][informative[:DOOR_JAMB]] < 0.025).all()
    assert (wrong[DOOR_JAMB, [3, 5]] < 0.1).all()
    # From nearer, where sides are looked into, the jambs of a wide door are beside the view.
    assert (wrong[DOOR_JAMB, [1, 7]] < 0.28).all()


def _refused(path: Path, text: str, change: dict[str, object] | None = None) -> None:
    content = json.loads(some_model().as_json())
    path.write_text(json.dumps(content | (change or {})))
    with pytest.raises(SensorModelError, match=text) as refusal:
        load_sensor_model(path, expected_ring={"transducers": 24.0, "dropout": 0.02})
    assert str(path) in str(refusal.value)


def test_refuses_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(SensorModelError, match=r"none\.json: no sensor model there"):
        load_sensor_model(tmp_path / "none.json")


def test_refuses_what_is_not_a_model(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    _refused(path, "expected version 3, found 2", {"version": 2})
    _refused(path, "dropout is 0.5, expected 0.02", {"ring": {"transducers": 24, "dropout": 0.5}})
    _refused(path, "transducers is None", {"ring": {"dropout": 0.02}})
    _refused(path, "expected features", {"features": ["opening"]})
    _refused(path, "the key 'flat_wall' is missing", {"counts": {"opening": []}})
    _refused(path, "malformed", {"duration_s": 3})
    path.write_text("[")
    with pytest.raises(SensorModelError, match="not JSON"):
        load_sensor_model(path)
    path.write_text("[]")
    with pytest.raises(SensorModelError, match="found 'list'"):
        load_sensor_model(path)


def test_refuses_numbers_that_cannot_be() -> None:
    model = some_model()
    with pytest.raises(SensorModelError, match="negative, found -1"):
        SensorModel(model.counts * 0 - 1, model.durations_s, {}, "a test")
    with pytest.raises(SensorModelError, match=r"positive, found 0\.0 s"):
        SensorModel(model.counts, model.durations_s * 0, {}, "a test")
    with pytest.raises(SensorModelError, match=r"found \(4, 8, 2, 4\)"):
        SensorModel(model.counts[:4], model.durations_s, {}, "a test")


def test_a_model_is_for_its_number_of_wedges(tmp_path: Path) -> None:
    path = tmp_path / "twelve.json"
    path.write_text(some_model(wedges=Wedges(12)).as_json())
    assert load_sensor_model(path, expected_wedges=12).wedges == Wedges(12)
    with pytest.raises(SensorModelError, match=r"twelve\.json: made with 12 wedges, expected 8"):
        load_sensor_model(path, expected_wedges=8)
    facts = msgspec.structs.replace(Facts(2, 1, 0, 2, 0.085), wedges=16)
    with pytest.raises(SensorModelError, match=r"made with 8 wedges, expected 16; `waywiser cal"):
        build(facts, Settings(), 1)
    _refused(path, "made with 8 wedges, expected 12", {"wedges": 12})
    three = SHAPE[0], 3, 2, 4
    with pytest.raises(WedgeError, match="found 3, expected 4 to 360"):
        SensorModel(np.ones(three, np.int64), np.ones(three[:2]), {}, "a test")


def test_the_shipped_file_is_what_the_model_writes() -> None:
    assert load_sensor_model().as_json() == SHIPPED.read_text()


def test_the_classifier_refuses_a_model_of_another_ring(tmp_path: Path) -> None:
    facts = Facts(2, 1, 0, 2, 0.085)
    for ring, says in (
        (Ring(transducers=16), r"json: made with another ring: transducers is 24\.0, expected 16"),
        (Ring(farthest_m=6.0), r"farthest_m is 10\.7, expected 6\.0"),
    ):
        with pytest.raises(SensorModelError, match=says):
            build(msgspec.structs.replace(facts, ring=ring), Settings(), 1)
    path = tmp_path / "model.json"
    noisy = {**msgspec.structs.asdict(facts.ring), "dropout": 0.5}
    shipped = load_sensor_model()
    path.write_text(SensorModel(shipped.counts, shipped.durations_s, noisy, "a test").as_json())
    # How well the ring hears is not its build: such a model is used where it is asked for.
    build(facts, Settings(sensor_model=str(path)), 1)
    with pytest.raises(SensorModelError, match=r"none\.json: no sensor model there"):
        build(facts, Settings(sensor_model=str(tmp_path / "none.json")), 1)
