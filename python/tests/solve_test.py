"""Solving: options, watching, stopping, uncertainty, growing; and the same digits as the program's."""

import os
import signal
import subprocess
import tempfile
import threading
import time
import unittest

import numpy as np

import graticule
from graticule import io, pose_graph
from graph_test import chain

PROGRAM = os.environ["GRATICULE_PROGRAM"]


def city(**options) -> graticule.Graph:
    return pose_graph.simulate_city(robots=2, poses_per_robot=150, seed=4, **options).graph


class Options(unittest.TestCase):
    def test_have_the_names_of_the_docs(self):
        options = graticule.SolveOptions(max_iterations=3, method="dogleg", jacobi_scaling=False)
        self.assertEqual(options.max_iterations, 3)
        self.assertIs(options.jacobi_scaling, False)
        self.assertIsInstance(options.function_tolerance, float)
        options.function_tolerance = np.float64(1e-3)
        self.assertEqual(options.function_tolerance, 1e-3)
        report = graticule.solve(city(), options).report
        self.assertEqual(report.options["method"], "dogleg")
        self.assertEqual(report.options["function_tolerance"], "0.001")

    def test_that_do_not_exist_or_fit_are_refused(self):
        with self.assertRaisesRegex(graticule.UsageError, "max_iterations"):
            graticule.solve(chain(3), max_iteration=3)
        with self.assertRaisesRegex(graticule.UsageError, "an integer >= 0"):
            graticule.solve(chain(3), max_iterations="many")


class Watching(unittest.TestCase):
    def test_sees_every_iteration_and_may_stop(self):
        seen = []
        solution = graticule.solve(city(), on_iteration=seen.append)
        self.assertEqual(len(seen), len(solution.report.iterations))
        stopped = graticule.solve(city(), on_iteration=lambda i: i.number < 1).report
        self.assertEqual(stopped.termination, graticule.Termination.CANCELLED)

    def test_lets_what_is_thrown_through(self):
        def fail(iteration):
            raise LookupError("from within")

        with self.assertRaisesRegex(LookupError, "from within"):
            graticule.solve(city(), on_iteration=fail)

    def test_may_change_the_graph_for_the_next_solve(self):
        def add_more(graph):
            for _ in range(2000):
                graph.add(graticule.between_se2_factor("robot1:0", "robot1:5", [1, 0, 0], 0.1))

        for solve in (graticule.solve, pose_graph.initialise_and_solve):
            with self.subTest(solve.__name__):
                graph = city()
                before = graph.factor_count
                expected = solve(city(), on_iteration=lambda i: True)
                found = solve(graph, on_iteration=lambda i: add_more(graph))
                self.assertGreater(graph.factor_count, before)
                expected, found = (getattr(s, "solution", s).report for s in (expected, found))
                self.assertEqual(found.final_objective, expected.final_objective)

    def test_control_c_ends_a_solve(self):
        def interrupt(iteration):
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            graticule.solve(city(), on_iteration=interrupt)

    def test_other_threads_run_meanwhile(self):
        graph = pose_graph.simulate_city(robots=4, poses_per_robot=2000, seed=1).graph
        done = threading.Event()
        ticks = []

        def count():
            while not done.is_set():
                ticks.append(time.perf_counter())
                time.sleep(0.001)

        counter = threading.Thread(target=count)
        counter.start()
        began = time.perf_counter()
        solution = graticule.solve(graph)
        ended = time.perf_counter()
        done.set()
        counter.join()
        self.assertEqual(solution.report.termination, graticule.Termination.CONVERGED)
        within = [tick for tick in ticks if began < tick < ended]
        self.assertGreater(len(within), 5)


class Uncertainty(unittest.TestCase):
    def test_is_a_matrix_or_a_diagnosis(self):
        graph = chain(3)
        found = graticule.compute_marginals(graph, keys=["pose:1", "pose:2"], joint=True)
        self.assertIsInstance(found, graticule.Marginals)
        self.assertEqual(found.anchors, ["pose:0"])
        block = found.covariance("pose:1")
        np.testing.assert_allclose(np.diag(block), [0.01, 0.01, 0.0004], rtol=1e-9)
        np.testing.assert_array_equal(block, block.T)
        np.testing.assert_array_equal(
            found.covariance("pose:1", "pose:2"), found.covariance("pose:2", "pose:1").T
        )
        with self.assertRaises(graticule.Error):
            found.covariance("pose:0", "pose:1")
        graph.add("point:0", "point2/1", [1, 1])
        graph.add(graticule.bearing_range_se2_factor("pose:0", "point:0", 0.8, 1.4, [1e9, 0.1]))
        loose = graticule.diagnose(chain(3))
        self.assertEqual(loose.free_directions, 3)
        self.assertEqual({entry.key.family for entry in loose.loose}, {"pose"})

    def test_a_variable_without_a_factor_is_ill_posed(self):
        graph = chain(3)
        graph.add("pose:9", "se2/1", [0, 0, 0])
        with self.assertRaises(graticule.IllPosedError):
            graticule.solve(graph)
        structure = graticule.analyse_structure(graph)
        self.assertEqual([graph.key_of(id) for id in structure.isolated], ["pose:9"])

    def test_jacobians_are_checked(self):
        [check] = graticule.check_jacobians(chain(4))
        self.assertEqual((check.type, check.checked, check.wrong), ("between_se2/1", 3, 0))


class Growing(unittest.TestCase):
    def test_comes_to_the_same_as_solving_at_once(self):
        graph = city()
        online = graticule.Online(relinearise_every=1)
        for id, key in enumerate(graph.keys()):
            online.add(key, "se2/1", graph.value_of(key), graph.is_fixed(key))
        self.assertIsNone(online.latest())
        for id in range(graph.factor_count):
            online.add(graph.factor(id))
        report = online.update_exactly()
        self.assertEqual(report.new_factors, graph.factor_count)
        self.assertEqual(report.termination, graticule.Termination.CONVERGED)
        self.assertNotEqual(report.message, "")
        whole = graticule.solve(graph)
        self.assertAlmostEqual(report.objective, whole.report.final_objective, delta=1e-6)
        self.assertEqual(online.covariance("robot1:3").shape, (3, 3))
        self.assertEqual(online.problem().factor_count, graph.factor_count)


class TheProgram(unittest.TestCase):
    """`graticule solve` and Python, from the same file."""

    def check_same_digits(self, problem: str, *words: str, **options):
        with tempfile.TemporaryDirectory() as folder:
            theirs, ours = os.path.join(folder, "a.fg"), os.path.join(folder, "b.fg")
            sets = [word for option in words for word in ("--set", option)]
            subprocess.run([PROGRAM, "solve", problem, "-o", theirs, *sets],
                           check=True, capture_output=True)
            solved = graticule.solve_configured(io.read_problem(problem), **options)
            io.write_problem(ours, solved.recording())
            a, b = io.read_problem(theirs).graph, io.read_problem(ours).graph
            self.assertEqual(a.keys(), b.keys())
            np.testing.assert_array_equal(a.initial_values().data, b.initial_values().data)
            self.assertGreater(solved.report.steps, 1)

    def test_solves_to_the_same_digits(self):
        with tempfile.TemporaryDirectory() as folder:
            for dimension in (2, 3):
                problem = os.path.join(folder, f"city{dimension}.g2o")
                io.write_problem(problem, io.Recording(city(dimension=dimension)))
                self.check_same_digits(problem)
                self.check_same_digits(
                    problem, "initialise=spanning_tree", "method=dogleg", "max_iterations=7",
                    initialise="spanning_tree", method="dogleg", max_iterations=7,
                )

    def test_rejects_to_the_same_digits(self):
        corrupted, lies = pose_graph.add_false_closures(city(), 0.1, seed=2)
        with tempfile.TemporaryDirectory() as folder:
            problem = os.path.join(folder, "lies.fg")
            io.write_problem(problem, io.Recording(corrupted))
            solved = graticule.solve_configured(
                io.read_problem(problem), reject_outliers="gnc_tls"
            )
            theirs = os.path.join(folder, "a.fg")
            subprocess.run([PROGRAM, "solve", problem, "-o", theirs, "--set",
                            "reject_outliers=gnc_tls"], check=True, capture_output=True)
            a = io.read_problem(theirs).graph.initial_values()
            np.testing.assert_array_equal(a.data, solved.values.data)
            rejected = {factor.id for factor in solved.rejection.rejected}
            self.assertGreater(len(rejected & set(lies.tolist())), 0.9 * len(lies))

    def test_recorded_files_too(self):
        file = os.path.join(os.environ["GRATICULE_DATA_DIR"], "posegraph", "CSAIL.g2o")
        if not os.path.exists(file):
            self.assertNotEqual(os.environ.get("CI"), "true", f"{file} is not there")
            self.skipTest(f"{file} is not there")
        self.check_same_digits(file)


class Comparing(unittest.TestCase):
    def test_is_a_loop(self):
        comparison = graticule.compare(
            {"city": city()}, {"default": {}, "short": {"max_iterations": 1}}, repeats=2
        )
        good, short = comparison.runs
        self.assertEqual(good.gap, 0)
        self.assertGreater(short.gap, 0)
        self.assertGreater(good.median.total.wall, 0)
        self.assertIn("short", str(comparison))
        self.assertIn("<html", comparison.html())

    def test_keeps_errors_and_refuses_wrong_options(self):
        loose = chain(3)
        loose.add("pose:9", "se2/1", [0, 0, 0])
        comparison = graticule.compare({"loose": loose}, {"default": {}})
        self.assertIn("pose:9", comparison.runs[0].error)
        with self.assertRaises(graticule.UsageError):
            graticule.compare({"chain": chain(3)}, {"default": {"no_such": 1}})

    def test_reports_are_dictionaries(self):
        report = graticule.solve(city()).report
        plain = graticule.report_dict(report)
        self.assertEqual(plain["termination"], "converged")
        self.assertIn("<html", graticule.report_html(report))

    def test_graphs_are_drawn(self):
        graph = city()
        before = graph.initial_values()
        solution = graticule.solve(graph)
        one = graticule.draw_graph(graph, solution.values)
        both = graticule.draw_graph(graph, solution.values, before, title="a city")
        self.assertTrue(one.startswith("<svg"))
        self.assertNotIn("Before", one)
        self.assertIn("Before", both)
        self.assertIn("a city", both)
        self.assertIn(one[:200], graticule.report_html(solution.report, graph_svg=one))
        png = graticule.io.png_from_svg(one, 300)
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(int.from_bytes(png[16:20], "big"), 300)


if __name__ == "__main__":
    unittest.main()
