"""Factors whose residual is a Python function."""

import os
import signal
import unittest

import numpy as np

import graticule


def wrapped(angle):
    return np.arctan2(np.sin(angle), np.cos(angle))


def between(a, b, measured):
    c, s = np.cos(a[2]), np.sin(a[2])
    dx, dy = b[:2] - a[:2]
    return [
        c * dx + s * dy - measured[0],
        c * dy - s * dx - measured[1],
        wrapped(b[2] - a[2] - measured[2]),
    ]


SCHEMA = "a:se2/1 b:se2/1 | x:m y:m yaw:rad"


def square(types: graticule.Registry, kind: str) -> graticule.Graph:
    graph = graticule.Graph(types)
    ids = graph.add_variables("pose", "se2/1", [[2 * i, 0.5 * i, wrapped(1.4 * i)] for i in range(5)])
    graph.set_fixed("pose:0", True)
    edges = [*zip(ids[:-1], ids[1:]), (ids[4], ids[0])]
    measured = [*([5, 0, np.pi / 2] for _ in range(4)), [0.2, -0.1, 0.01]]
    graph.add_factors(kind, edges, measured, noise=[0.1, 0.1, 0.02])
    return graph


class PythonFactors(unittest.TestCase):
    def test_solve_as_those_of_the_library_do(self):
        types = graticule.builtins()
        graticule.add_python_factor(types, "mine/1", SCHEMA, between, relative=True)
        ours, theirs = square(types, "mine/1"), square(types, "between_se2/1")
        np.testing.assert_allclose(
            graticule.factor_chi2(ours), graticule.factor_chi2(theirs), rtol=1e-12
        )
        solved = graticule.solve(ours)
        self.assertEqual(solved.report.termination, graticule.Termination.CONVERGED)
        np.testing.assert_allclose(
            solved.values.data, graticule.solve(theirs).values.data, atol=1e-6
        )
        [check] = graticule.check_jacobians(ours)
        self.assertEqual((check.wrong, check.failed), (0, 0))

    def test_run_in_several_threads_one_at_a_time(self):
        types = graticule.builtins()
        graticule.add_python_factor(types, "mine/1", SCHEMA, between, relative=True)
        graph = square(types, "mine/1")
        one, two = graticule.solve(graph, threads=1), graticule.solve(graph, threads=2)
        np.testing.assert_allclose(one.values.data, two.values.data, atol=1e-9)

    def test_take_given_jacobians(self):
        types = graticule.builtins()
        calls = []

        def jacobians(x, y, measured):
            calls.append(1)
            return [np.diag(2 * x), -np.eye(2)]

        graticule.add_python_factor(
            types, "parabola/1", "x:vector2/1 y:vector2/1 | d d2",
            lambda x, y, measured: x**2 - y - measured, jacobians,
        )
        graph = graticule.Graph(types)
        graph.add("x:0", "vector2/1", [1.0, 5.0])
        graph.add("y:0", "vector2/1", [2.0, 2.0], fixed=True)
        graph.add(graticule.Factor(type="parabola/1", keys=["x:0", "y:0"], measurement=[2, 7]))
        np.testing.assert_allclose(graticule.solve(graph).values["x:0"], [2, 3], atol=1e-6)
        self.assertGreater(len(calls), 2)
        self.assertEqual(graticule.check_jacobians(graph)[0].wrong, 0)

    def test_wrong_jacobians_are_found(self):
        types = graticule.builtins()
        graticule.add_python_factor(
            types, "wrong/1", "x:vector1/1 | d", lambda x, m: x - m, lambda x, m: [[[2.0]]]
        )
        graph = graticule.Graph(types)
        graph.add("x:0", "vector1/1", [1.0])
        graph.add(graticule.Factor(type="wrong/1", keys=["x:0"], measurement=[0]))
        self.assertEqual(graticule.check_jacobians(graph)[0].wrong, 1)

    def test_what_they_throw_is_told(self):
        types = graticule.builtins()

        def fail(x, measured):
            raise RuntimeError("no such place")

        graticule.add_python_factor(types, "fails/1", "x:vector1/1 | d", fail)
        graticule.add_python_factor(types, "long/1", "x:vector1/1 | d", lambda x, m: [1, 2])
        for kind, text in [("fails/1", "no such place"), ("long/1", r"expected.*\(1,\).*found \(2,\)")]:
            graph = graticule.Graph(types)
            graph.add("x:0", "vector1/1", [1.0])
            graph.add(graticule.Factor(type=kind, keys=["x:0"], measurement=[0]))
            report = graticule.solve(graph).report
            self.assertEqual(report.termination, graticule.Termination.FAILED)
            self.assertRegex(report.message, text)

    def test_control_c_within_one_is_not_lost(self):
        types = graticule.builtins()

        def interrupted(x, measured):
            os.kill(os.getpid(), signal.SIGINT)
            for _ in range(100000):  # where Python looks for signals
                pass
            return x - measured

        graticule.add_python_factor(types, "interrupted/1", "x:vector1/1 | d", interrupted)
        graph = graticule.Graph(types)
        graph.add("x:0", "vector1/1", [1.0])
        graph.add(graticule.Factor(type="interrupted/1", keys=["x:0"], measurement=[0]))
        with self.assertRaises(KeyboardInterrupt):
            graticule.solve(graph)

    def test_schemas_are_checked(self):
        types = graticule.builtins()
        add = graticule.add_python_factor
        with self.assertRaises(graticule.MissingTypeError):
            add(types, "a/1", "x:nothing/1 | d", between)
        with self.assertRaises(graticule.UsageError):
            add(types, "b/1", "x:vector1/1 | d | d*", between)
        with self.assertRaises(graticule.MissingTypeError):
            add(types, "between_se2/1", SCHEMA, between)
        with self.assertRaises(TypeError):
            add(types, "c/1", SCHEMA, "not a function")

    def test_survive_their_registry(self):
        def make():
            types = graticule.builtins()
            graticule.add_python_factor(types, "kept/1", SCHEMA, lambda *blocks: between(*blocks))
            return square(types, "kept/1")

        self.assertEqual(
            graticule.solve(make()).report.termination, graticule.Termination.CONVERGED
        )


if __name__ == "__main__":
    unittest.main()
