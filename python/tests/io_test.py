"""Every format, there and back."""

import os
import pickle
import tempfile
import unittest

import numpy as np

import graticule
from graticule import calibration, io, pose_graph


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name: str) -> str:
        return os.path.join(self.folder, name)

    def data(self, *parts: str) -> str:
        file = os.path.join(os.environ["GRATICULE_DATA_DIR"], *parts)
        if not os.path.exists(file):
            self.assertNotEqual(os.environ.get("CI"), "true", f"{file} is not there")
            self.skipTest(f"{file} is not there")
        return file


class Problems(Files):
    def test_come_back_to_the_bit(self):
        graph = pose_graph.simulate_city(robots=1, poses_per_robot=30).graph
        recording = io.Recording(graph, title="thirty poses")
        recording.frames = "city robot1"
        for name in ["a.fg", "a.fg.gz", "a.g2o", "a.graph"]:
            notes = io.write_problem(self.path(name), recording)
            again = io.read_problem(self.path(name))
            np.testing.assert_array_equal(
                again.graph.initial_values().data, graph.initial_values().data
            )
            self.assertEqual(again.graph.factor_count, graph.factor_count)
            self.assertIsInstance(notes, list)
        io.write_problem(self.path("b.fg"), recording, binary=True)
        again = io.read_problem(self.path("b.fg"))
        self.assertEqual((again.title, again.frames), ("thirty poses", "city robot1"))

    def test_bundles_too(self):
        graph = graticule.Graph()
        graph.add("camera:0", "bal_camera/1", [0, 0, 0, 0, 0, 0, 500, 0, 0])
        graph.add("point:0", "point3/1", [0.1, 0.2, -2])
        graph.add(graticule.bal_reprojection_factor("camera:0", "point:0", 25, 50, 1.0))
        graph.factor(0)
        plain = graticule.Graph()
        plain.add("camera:0", "bal_camera/1", graph.value_of("camera:0"))
        plain.add("point:0", "point3/1", graph.value_of("point:0"))
        plain.add(
            graticule.bal_reprojection_factor("camera:0", "point:0", 25, 50, graticule.Noise.unit())
        )
        io.write_problem(self.path("a.bal"), io.Recording(plain))
        again = io.read_problem(self.path("a.bal")).graph
        np.testing.assert_array_equal(again.initial_values().data, plain.initial_values().data)

    def test_say_where_they_are_wrong(self):
        with open(self.path("bad.g2o"), "w") as file:
            file.write("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 x 0 0\n")
        with self.assertRaisesRegex(graticule.InputError, r"bad\.g2o:2:14: expected .*'x'"):
            io.read_problem(self.path("bad.g2o"))
        with self.assertRaisesRegex(graticule.InputError, "nowhere"):
            io.read_problem(self.path("nowhere.fg"))
        with self.assertRaisesRegex(graticule.UsageError, "half, double or full"):
            io.read_problem(self.path("bad.g2o"), g2o_rotation="quarter")
        text = "VERTEX_SE2 0 0 0 0\nNOBODY_KNOWS 1\n"
        self.assertEqual(
            io.parse_problem(text, "t.g2o", skip_unknown=True).skipped, {"NOBODY_KNOWS": 1}
        )

    def test_recorded_ones_are_read(self):
        for name in ["CSAIL.g2o", "tinyGrid3D.g2o", "gtsam_w100.graph"]:
            recording = io.read_problem(self.data("posegraph", name))
            self.assertGreater(recording.graph.factor_count, 8)

    def test_configurations_are_options(self):
        with open(self.path("a.yaml"), "w") as file:
            file.write("method: dogleg\nthreads: 2\n")
        self.assertEqual(io.read_config(self.path("a.yaml")), {"method": "dogleg", "threads": "2"})
        graph = pose_graph.simulate_city(robots=1, poses_per_robot=30).graph
        report = graticule.solve_configured(graph, self.path("a.yaml")).report
        self.assertEqual(report.options["threads"], "2")


class Planar(Files):
    def test_trajectories(self):
        rows = np.array([[0, 1, 2, 0, 0, 0, 0, 1], [1.5, 2, 2, 0, 0, 0, np.sin(0.1), np.cos(0.1)]])
        io.write_tum(self.path("a.tum"), rows)
        np.testing.assert_array_equal(io.read_tum(self.path("a.tum")), rows)
        with self.assertRaises(graticule.UsageError):
            io.write_tum(self.path("a.tum"), rows[:, :7])

    def test_laser_logs(self):
        geometry = io.LaserGeometry(first_angle=-1.5, step=0.1, max_range=30)
        ranges = np.linspace(1, 20, 62).reshape(2, 31).astype(np.float32)
        log = io.LaserLog(ranges, [0.0, 0.5], [[0, 0, 0], [1, 0, 0.1]], geometry)
        with open(self.path("a.clf"), "w") as file:
            file.write(io.format_carmen(log))
        again = io.read_carmen(self.path("a.clf"), robot="r")
        self.assertEqual((again.robots, len(again)), (["r"], 2))
        np.testing.assert_array_equal(again.ranges_of(1), ranges[1])
        np.testing.assert_array_equal(again.odometry, [[0, 0, 0], [1, 0, 0.1]])
        np.testing.assert_array_equal(again.times, [0, 0.5])
        self.assertTrue(np.shares_memory(again.ranges, again.ranges_of(1)))
        with self.assertRaises(ValueError):
            again.ranges[0] = 1
        with self.assertRaises(graticule.UsageError):
            again.ranges_of(2)
        kept = again.ranges
        del again
        np.testing.assert_array_equal(kept, ranges.ravel())

    def test_occupancy(self):
        cells = np.array([[0, 1, 2], [2, 2, 1]], dtype=np.uint8)
        grid = io.OccupancyGrid(cells, resolution=0.25, map_from_grid=[1, -2, 0])
        io.write_occupancy(grid, self.path("map"))
        again = io.read_occupancy(self.path("map.yaml"))
        np.testing.assert_array_equal(again.cells, cells)
        self.assertEqual((again.resolution, again.map_from_grid.tolist()), (0.25, [1, -2, 0]))
        self.assertFalse(again.cells.flags.owndata)
        self.assertFalse(again.cells.flags.writeable)
        self.assertTrue(grid.png().startswith(b"\x89PNG"))
        with self.assertRaisesRegex(graticule.UsageError, "found 3"):
            io.OccupancyGrid([[3]])


class Space(Files):
    def test_clouds(self):
        points = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
        points[1, 2] = np.nan
        colours = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
        labels = np.arange(8, dtype=np.uint32).reshape(2, 4)
        cloud = io.PointCloud(points, colours=colours, intensities=labels, labels=labels)
        for name in ["a.pcd", "a.ply"]:
            io.write_cloud(self.path(name), cloud)
            again = io.read_cloud(self.path(name))
            np.testing.assert_array_equal(again.points, points)
            np.testing.assert_array_equal(again.colours, colours)
            np.testing.assert_array_equal(again.labels, labels)
            np.testing.assert_array_equal(again.intensities, labels)
        self.assertFalse(cloud.points.flags.owndata)
        self.assertFalse(cloud.points.flags.writeable)
        self.assertIsNone(io.PointCloud(points.reshape(-1, 3)).colours)
        with self.assertRaisesRegex(graticule.UsageError, "labels: expected one for each of 8"):
            io.PointCloud(points, labels=labels[:1])

    def test_sweeps(self):
        scan = io.SweptScan(servo_rad=0.1, bearing_step_rad=0.01, ranges_m=[1, 2, np.nan])
        later = io.SweptScan(stamp_s=1, servo_rad=0.2, bearing_step_rad=0.01, ranges_m=[3, 4, 5])
        sweep = io.Sweep(scans=[scan, later])
        io.write_sweep(self.path("a.csv"), sweep)
        again = io.read_sweep(self.path("a.csv"))
        np.testing.assert_array_equal(again.ranges, [[1, 2, np.nan], [3, 4, 5]])
        self.assertEqual(again.to_cloud().points.shape, (2, 3, 3))

    def test_pictures(self):
        grey = np.arange(12, dtype=np.uint8).reshape(3, 4)
        colour = np.arange(36, dtype=np.uint8).reshape(3, 4, 3)
        io.write_file(self.path("grey.png"), io.format_png(grey))
        io.write_file(self.path("colour.png"), io.format_png(colour))
        np.testing.assert_array_equal(io.read_grey_photo(self.path("grey.png")), grey)
        np.testing.assert_array_equal(io.read_colour_photo(self.path("colour.png")), colour)


class Cameras(Files):
    def test_every_format(self):
        camera = io.CameraIntrinsics(
            model="brown4", width=640, height=480, parameters=[500, 501, 320, 240, 0.1, -0.05, 0.001, 0.002]
        )
        for kind in ["graticule", "opencv", "ros", "kalibr", "mrcal"]:
            name = self.path("a.cameramodel" if kind == "mrcal" else "a.yaml")
            io.write_camera(name, camera, kind)
            again = io.read_camera(name)
            self.assertEqual((again.width, again.height), (640, 480))
            np.testing.assert_allclose(again.parameters[:8], camera.parameters, rtol=1e-15)
        self.assertIn("angular4", calibration.camera_models())
        with self.assertRaisesRegex(graticule.UsageError, "kalibr"):
            io.write_camera(self.path("a.yaml"), camera, "no such format")

    def test_rigs_and_correspondences(self):
        camera = io.CameraIntrinsics(model="pinhole", width=64, height=48, parameters=[50, 50, 32, 24])
        rig = io.LidarRig(camera=camera, camera_from_lidar=[1, 2, 3, 0, 0, 0, 1])
        io.write_rig(self.path("rig.yaml"), rig)
        np.testing.assert_array_equal(
            io.read_rig(self.path("rig.yaml")).camera_from_lidar, [1, 2, 3, 0, 0, 0, 1]
        )
        pair = io.Correspondence(in_lidar=[1, 2, 3], pixel=[4.5, 5.25], name="door")
        io.write_correspondences(self.path("pairs.csv"), [pair])
        [again] = io.read_correspondences(self.path("pairs.csv"))
        self.assertEqual(repr(again), repr(pair))

    def test_detections(self):
        views = [
            io.TargetView(
                ids=[1, 2], in_target=[[0, 0, 0], [1, 0, 0]], pixels=[[10.5, 11], [20, 21.25 + i]],
                image=f"{i}.png", exposure=i,
            )
            for i in range(2)
        ]
        size = io.ImageSize(camera="cam0", width=64, height=48)
        io.write_detections(
            self.path("a.json"), io.Detections(cameras=[size], views=views, exposures=2)
        )
        again = io.read_detections([self.path("a.json")])
        np.testing.assert_array_equal(again.views[1].pixels, [[10.5, 11], [20, 22.25]])
        np.testing.assert_array_equal(again.views[0].ids, [1, 2])
        self.assertEqual(again.exposures, 2)
        copied = pickle.loads(pickle.dumps(again))
        np.testing.assert_array_equal(copied.views[1].pixels, again.views[1].pixels)


class Signals(Files):
    def test_logs(self):
        log = io.SignalLog(
            [-40.5, -70], [[0, 0], [1, 1.5]], [[5, 5], [6, 6]], times_s=[0, 1.25],
            heard=[True, False], radios=["a", "b"],
        )
        io.write_signal_log(log, self.path("a.csv.gz"))
        again = io.read_signal_log(self.path("a.csv.gz"))
        for column in ["dbm", "heard", "times_s", "receivers", "transmitters", "receivers_m"]:
            np.testing.assert_array_equal(getattr(again, column), getattr(log, column))
        self.assertEqual(again.radios, ["a", "b"])
        self.assertEqual(len(again.rows(1, 9)), 1)
        with self.assertRaisesRegex(graticule.UsageError, "backwards at row 1"):
            io.SignalLog([-40, -40], [[0, 0]] * 2, [[5, 5]] * 2, times_s=[1, 0])


if __name__ == "__main__":
    unittest.main()
