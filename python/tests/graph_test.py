"""Graphs and what they are made of: numbers in and out, errors, copies."""

import copy
import os
import pickle
import tempfile
import unittest

import numpy as np

import graticule
from graticule import Factor, Graph, Key, Loss, Noise


def chain(count: int) -> Graph:
    graph = Graph()
    values = np.stack([np.arange(count) + 0.1, np.zeros(count), np.zeros(count)], axis=1)
    ids = graph.add_variables("pose", "se2/1", values)
    graph.add_factors(
        "between_se2/1",
        np.stack([ids[:-1], ids[1:]], axis=1),
        np.tile([1.0, 0, 0], (count - 1, 1)),
        noise=[0.1, 0.1, 0.02],
        source="odometry",
    )
    return graph


class Keys(unittest.TestCase):
    def test_are_ordered_by_number_and_equal_to_their_text(self):
        self.assertLess(Key("pose:9"), Key("pose:10"))
        self.assertEqual(Key("pose", 3), "pose:3")
        self.assertNotEqual(Key("pose", 3), "not a key")
        self.assertIn("pose:3", {Key("pose", 3)})
        self.assertIn(Key("pose", 3), {"pose:3": 1})
        self.assertNotEqual(Key("pose", 3), "pose:03")
        self.assertEqual(len({Key("a:1"), Key("a", 1)}), 1)
        self.assertEqual(pickle.loads(pickle.dumps(Key("robot1:7"))), Key("robot1:7"))

    def test_refuse_what_is_none(self):
        with self.assertRaisesRegex(graticule.InputError, "pose"):
            Key("pose")


class Adding(unittest.TestCase):
    def test_one_by_one_and_in_bulk_give_the_same_graph(self):
        bulk = chain(5)
        single = Graph()
        for i in range(5):
            single.add(Key("pose", i), "se2/1", [i + 0.1, 0, 0])
        for i in range(4):
            single.add(
                graticule.between_se2_factor(
                    Key("pose", i), Key("pose", i + 1), [1, 0, 0], [0.1, 0.1, 0.02], "odometry"
                )
            )
        write = graticule.io.write_problem
        read = graticule.io.read_file
        with tempfile.TemporaryDirectory() as folder:
            files = [os.path.join(folder, name) for name in ("bulk.fg", "single.fg")]
            for file, graph in zip(files, (bulk, single)):
                write(file, graticule.io.Recording(graph))
            self.assertEqual(read(files[0]), read(files[1]))

    def test_arrays_come_back_as_they_went_in(self):
        graph = chain(6)
        factors = graph.factors("between_se2/1", "odometry")
        np.testing.assert_array_equal(factors, np.arange(5))
        np.testing.assert_array_equal(graph.variables_of(factors)[:, 1], np.arange(1, 6))
        np.testing.assert_array_equal(graph.measurements_of(factors), np.tile([1.0, 0, 0], (5, 1)))
        np.testing.assert_array_equal(graph.ids("pose", [3, 0]), [3, 0])
        self.assertEqual(graph.factors(source="loop").size, 0)

    def test_numbers_go_on_where_a_family_ends(self):
        graph = chain(3)
        graph.add_variables("pose", "se2/1", np.zeros((2, 3)))
        self.assertEqual(graph.keys()[-1], "pose:4")
        graph.add_variables("pose", "se2/1", np.zeros((1, 3)), numbers=[17], fixed=[True])
        self.assertTrue(graph.is_fixed("pose:17"))
        graph.add_variables("pose", "se2/1", np.zeros((1, 3)))
        self.assertEqual(graph.keys()[-1], "pose:18")
        graph.add_variables("other", "se2/1", np.zeros((1, 3)))
        self.assertEqual(graph.keys()[-1], "other:0")

    def test_ids_are_integers(self):
        graph = chain(3)
        for call in (
            lambda: graph.ids("pose", [0.0, 1.7]),
            lambda: graph.variables_of(np.array([0.5])),
            lambda: graph.measurements_of(np.array([True, False])),
            lambda: graph.add_variables("pose", "se2/1", np.zeros((1, 3)), numbers=[8.5]),
            lambda: graph.add_factors("between_se2/1", np.array([[0.0, 2.0]]), [[2, 0, 0]]),
        ):
            with self.assertRaisesRegex(graticule.UsageError, "expected an array of integers"):
                call()
        self.assertEqual(graph.ids("pose", []).size, 0)
        np.testing.assert_array_equal(graph.ids("pose", np.array([2], np.uint8)), [2])

    def test_noise_may_differ_by_factor(self):
        for noise in (
            np.array([[0.1, 0.2, 0.3], [1.0, 1.0, 1.0]]),
            np.stack([np.diag([100, 25, 1 / 0.09]), np.eye(3)]),
        ):
            graph = Graph()
            ids = graph.add_variables("pose", "se2/1", np.zeros((3, 3)))
            graph.add_factors(
                "between_se2/1", [ids[:2], ids[1:]], [[1, 1, 0]] * 2, noise=noise
            )
            chi2 = graticule.factor_chi2(graph)
            np.testing.assert_allclose(chi2, [100 + 25, 2], rtol=1e-12)

    def test_errors_have_kinds_and_the_row(self):
        graph = chain(3)
        with self.assertRaisesRegex(graticule.InputError, "^row 1: ") as caught:
            graph.add_variables("other", "se2/1", [[0, 0, 0], [0, np.nan, 0]])
        self.assertEqual(caught.exception.kind, graticule.ErrorKind.INPUT)
        self.assertIsInstance(caught.exception, graticule.Error)
        with self.assertRaises(graticule.MissingTypeError):
            graph.add("x:0", "no_such/1", [0])
        with self.assertRaisesRegex(graticule.UsageError, r"expected an array of shape \(any, any\)"):
            graph.add_variables("other", "se2/1", [0.0, 0, 0])
        with self.assertRaisesRegex(graticule.UsageError, "there is no variable 99"):
            graph.add_factors("between_se2/1", [[0, 99]], [[1, 0, 0]])
        with self.assertRaisesRegex(graticule.UsageError, "there is no factor 99"):
            graph.factor(99)
        with self.assertRaisesRegex(graticule.UsageError, "not symmetric"):
            Noise.information([[1, 0], [1, 1]])
        with self.assertRaises(graticule.InputError):
            graph.initial_values()["pose:77"]


class ValuesTest(unittest.TestCase):
    def test_are_arrays_of_the_same_memory(self):
        values = chain(4).initial_values()
        self.assertFalse(values.data.flags.owndata)
        self.assertTrue(np.shares_memory(values.data, values["pose:2"]))
        values["pose:2"][0] = 42
        self.assertEqual(values.data[6], 42)
        self.assertFalse(np.shares_memory(copy.copy(values).data, values.data))

    def test_arrays_outlive_what_they_are_of(self):
        data = graticule.solve(chain(1000)).values.data
        kept = data.copy()
        for _ in range(10):
            chain(1000).initial_values()
        np.testing.assert_array_equal(data, kept)

    def test_a_family_is_ordered_by_number(self):
        graph = Graph()
        graph.add("p:5", "point2/1", [5, 0])
        graph.add("p:2", "point2/1", [2, 0])
        values = graph.initial_values()
        np.testing.assert_array_equal(values.array("p"), [[2, 0], [5, 0]])
        np.testing.assert_array_equal(values.numbers("p"), [2, 5])

    def test_replace_a_graphs_own(self):
        graph = chain(3)
        values = graph.initial_values()
        values["pose:1"][:] = [7, 8, 0.5]
        np.testing.assert_array_equal(graph.value_of("pose:1"), [1.1, 0, 0])
        graph.set_values(values)
        np.testing.assert_array_equal(graph.value_of("pose:1"), [7, 8, 0.5])


class PlainTypes(unittest.TestCase):
    def test_fields_are_copies_that_cannot_be_written_to(self):
        factor = chain(3).factor(0)
        with self.assertRaises(ValueError):
            factor.measurement[0] = 3
        factor.measurement = [1, 2, 3]
        np.testing.assert_array_equal(factor.measurement, [1, 2, 3])

    def test_are_pickled_and_copied(self):
        factor = Factor(
            type="between_se2/1", keys=["a:0", "a:1"], measurement=[1, 2, 3],
            noise=Noise.sigma(0.5), loss=Loss("huber", 2), source="loop",
        )
        again = pickle.loads(pickle.dumps(factor))
        self.assertEqual(repr(again), repr(factor))
        self.assertEqual(again.loss, Loss("huber", 2))
        self.assertIsNot(copy.deepcopy(factor), factor)

    def test_refuse_names_that_they_do_not_have(self):
        with self.assertRaisesRegex(graticule.UsageError, "no 'surce'.*source"):
            Factor(surce="odometry")

    def test_noise_is_what_numbers_stand_for(self):
        between = graticule.between_se2_factor
        self.assertEqual(between("a:0", "a:1", [0, 0, 0], 0.1).noise.kind, graticule.NoiseKind.SIGMA)
        self.assertEqual(between("a:0", "a:1", [0, 0, 0], [1, 2, 3]).noise.values.tolist(), [1, 2, 3])
        matrix = Noise.information(np.diag([1.0, 2, 3]))
        self.assertEqual(matrix.values.tolist(), [1, 0, 0, 2, 0, 3])

    def test_losses_have_names(self):
        self.assertIn("huber", graticule.loss_names())
        rho = Loss("huber", 1).evaluate(4.0)
        np.testing.assert_allclose(rho[:2], [3, 0.5])
        with self.assertRaisesRegex(graticule.Error, "huber"):
            Loss("hubr")


class Types(unittest.TestCase):
    def test_are_described(self):
        types = graticule.builtins()
        se2 = types.find_variable_type("se2/1")
        self.assertEqual(se2.fields, [("x", "m"), ("y", "m"), ("yaw", "rad")])
        moved = se2.plus([1, 2, np.pi / 2], [1, 0, 0])
        np.testing.assert_allclose(moved, [1, 3, np.pi / 2], atol=1e-12)
        np.testing.assert_allclose(se2.minus(moved, [1, 2, np.pi / 2]), [1, 0, 0], atol=1e-12)
        self.assertIsNone(types.find_factor_type("no_such/1"))
        self.assertIn("between_se2/1", [kind.name for kind in types.factor_types()])

    def test_everything_has_a_docstring(self):
        bare = []
        for name, value in vars(graticule._graticule).items():
            if name.startswith("__"):
                continue
            if callable(value) and not (value.__doc__ or "").strip():
                bare.append(name)
            if not isinstance(value, type) or hasattr(value, "__members__"):
                continue
            for member, attribute in vars(value).items():
                if isinstance(attribute, property) and not (attribute.__doc__ or "").strip():
                    bare.append(f"{name}.{member}")
                elif callable(attribute) and not member.startswith("_"):
                    if "\n\n" not in (attribute.__doc__ or "").strip():
                        bare.append(f"{name}.{member}")
        self.assertEqual(bare, [])


if __name__ == "__main__":
    unittest.main()
