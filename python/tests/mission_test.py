"""Recorded missions, satellite fixes, and where a map lies on the Earth."""

import os
import subprocess
import tempfile
import unittest

import numpy as np

import graticule
from graticule import io, mapping

DATUM = mapping.Geodetic(latitude=42.293, longitude=-83.711, height=260.0)


class RecordedMissions(unittest.TestCase):
    def test_are_read_as_the_program_wrote_them(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "mission")
            subprocess.run(
                [os.environ["GRATICULE_PROGRAM"], "simulate", "mission", "--robots", "2", "--minutes", "1",
                 "--pictures", "0", "--rate", "0", "--record", "--quiet", "-o", path],
                check=True, stdout=subprocess.DEVNULL)
            mission = mapping.read_mission(path)
            steps = mapping.read_mission_steps(path)
            some = mapping.read_mission_steps(path, every_s=30)
        self.assertEqual(mission.log.robots, ["robot1", "robot2"])
        self.assertGreater(len(mission), 50)
        self.assertEqual(len(mission.scans), len(mission))
        self.assertTrue(all(a.nodes <= b.nodes for a, b in zip(steps, steps[1:])))
        self.assertEqual(steps[-1].nodes, len(mission))
        np.testing.assert_array_equal(steps[-1].world_from_robot, mission.world_from_node)
        self.assertLess(len(some), len(steps))
        self.assertEqual(some[-1].time, steps[-1].time)
        with self.assertRaisesRegex(graticule.InputError, "mission.index"):
            mapping.read_mission(tempfile.gettempdir())


class Gnss(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulated = mapping.simulate_mission(robots=1, duration_s=90, people=2, vehicles=1)
        cls.fixes = mapping.simulate_gnss(cls.simulated, DATUM, every_s=2, sigma_m=0.3, bad=1)

    def test_lays_a_mission_onto_the_earth(self):
        mission = self.simulated.mission
        mission.graph.set_values(graticule.solve(mission.graph).values)
        factors = mission.graph.factor_count
        report = mapping.add_gnss(mission, self.fixes, datum=DATUM)
        self.assertGreater(report.used, 30)
        self.assertEqual(report.outside + report.used, len(self.fixes))
        self.assertGreaterEqual(report.off, 1)
        self.assertLess(report.rms_m, 1)
        self.assertEqual(report.without, [])
        self.assertEqual(mission.datum.latitude, DATUM.latitude)
        self.assertGreater(mission.graph.factor_count, factors)
        # The town's frame is the datum's.
        truth = self.simulated.world_from_robot[mission.scans]
        off = np.linalg.norm(mission.world_from_node[:, :2] - truth[:, :2], axis=1)
        self.assertLess(off.mean(), 0.5)
        with self.assertRaisesRegex(graticule.UsageError, "datum"):
            mapping.add_gnss(mission, self.fixes, datun=DATUM)
        with self.assertRaisesRegex(graticule.UsageError, "world_from_scan"):
            mapping.add_gnss(mission, self.fixes, [[0.0, 0.0, 0.0]])

    def test_fixes_come_back_to_the_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "gnss.csv")
            io.write_gnss(path, self.fixes)
            again = io.read_gnss(path)
        self.assertEqual([(f.time, f.robot, f.sigma_m, f.antenna.latitude, f.antenna.longitude) for f in again],
                         [(f.time, f.robot, f.sigma_m, f.antenna.latitude, f.antenna.longitude)
                          for f in self.fixes])

    def test_a_factor_holds_a_pose_to_a_place(self):
        antenna = mapping.geodetic_of(DATUM, [[30.0, -20.0]])[0]
        graph = graticule.Graph()
        graph.add("pose:0", "se2/1", [0, 0, 0.5])
        graph.add(graticule.prior_se2_factor("pose:0", [0, 0, 0.5], noise=[100, 100, 0.001]))
        graph.add(graticule.geodetic_se2_factor(
            "pose:0", mapping.Geodetic(latitude=antenna[0], longitude=antenna[1], height=antenna[2]), DATUM,
            [0, 0], noise=0.1))
        pose = graticule.solve(graph).values["pose:0"]
        np.testing.assert_allclose(pose, [30, -20, 0.5], atol=1e-3)


class OnTheGround(unittest.TestCase):
    def test_points_go_there_and_back(self):
        points = np.array([[0.0, 0.0], [120.0, -40.0], [-3000.0, 2500.0]])
        places = mapping.geodetic_of(DATUM, points)
        np.testing.assert_allclose(places[0], [DATUM.latitude, DATUM.longitude, DATUM.height], atol=1e-12)
        np.testing.assert_allclose(mapping.map_points_of(DATUM, places), points, atol=1e-6)

    def test_a_map_is_laid_onto_points_of_which_some_are_wrong(self):
        rng = np.random.default_rng(3)
        in_map = rng.uniform(-50, 50, (40, 2))
        c, s = np.cos(0.7), np.sin(0.7)
        on_ground = in_map @ np.array([[c, s], [-s, c]]) + [100, -30]
        on_ground[:10] += rng.uniform(20, 60, (10, 2))
        aligned = mapping.align_to_ground(in_map, on_ground, sigma=0.5)
        np.testing.assert_allclose(aligned.ground_from_map, [100, -30, 0.7], atol=0.05)
        self.assertEqual(aligned.agreeing, 30)


if __name__ == "__main__":
    unittest.main()
