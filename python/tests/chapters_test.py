"""Each chapter's entries: what they promise, and what they refuse."""

import unittest

import numpy as np

import graticule
from graticule import attenuation, calibration, io, mapping, pose_graph, segmentation


class PoseGraph(unittest.TestCase):
    def test_initialises_solves_and_certifies(self):
        city = pose_graph.simulate_city(robots=1, poses_per_robot=200, loops_per_pose=1, seed=2)
        graph = city.graph
        before = graticule.objective(graph)
        report = pose_graph.initialise(graph, "chordal")
        self.assertEqual(report.used, pose_graph.InitialGuess.CHORDAL)
        self.assertLess(graticule.objective(graph), before)
        values = graticule.solve(graph).values
        certificate = pose_graph.certify(graph, values)
        self.assertEqual(certificate.verdict, pose_graph.Verdict.OPTIMAL)
        self.assertLess(certificate.relative_gap, 1e-5)
        with self.assertRaisesRegex(graticule.UsageError, "chordal"):
            pose_graph.initialise(graph, "chord")

    def test_tells_how_far_from_the_truth(self):
        city = pose_graph.simulate_city(robots=1, poses_per_robot=50)
        rows = pose_graph.trajectory(city.graph, city.truth, "robot1")
        errors = pose_graph.trajectory_errors(city.graph, city.truth, {"robot1": rows})
        self.assertLess(errors.together.ate.translation_m.max, 1e-9)

    def test_same_seed_same_digits(self):
        a, b = (pose_graph.simulate_city(robots=1, poses_per_robot=50) for _ in range(2))
        np.testing.assert_array_equal(a.truth.data, b.truth.data)


class Mapping(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulated = mapping.simulate_mission(
            robots=1, duration_s=25, town=mapping.TownOptions(width_m=60, height_m=50),
            people=2, vehicles=1,
        )

    def test_front_end_follows_the_truth(self):
        log, truth = self.simulated.mission.log, self.simulated.world_from_robot
        built = mapping.build_mission(log, starts=[truth[0]])
        self.assertEqual(built.world_from_scan.shape, (len(log), 3))
        off = np.linalg.norm(built.world_from_scan[:, :2] - truth[:, :2], axis=1)
        self.assertLess(np.median(off), 0.1)
        mission = mapping.Mission(log, built)
        np.testing.assert_array_equal(np.sort(mission.scans), np.sort(built.scans))

        def fail(stage, done):
            raise LookupError(stage)

        with self.assertRaises(LookupError):
            mapping.build_mission(log, watch=fail)

    def test_live_map_equals_the_one_from_scratch(self):
        mission = self.simulated.mission
        poses = mission.world_from_node
        rng = np.random.default_rng(0)

        def made(moves):
            live = mapping.LiveMap(resolution=0.1)
            for scan, pose in zip(mission.scans, poses):
                live.add_node(0, mission.log.geometries[0], mission.log.ranges_of(int(scan)), pose)
            for move in moves:
                live.update()
                live.update_poses(move)
            live.update_exactly()
            return live

        there_and_back = [poses + rng.normal(0, 0.05, poses.shape), poses]
        moved, fresh = made(there_and_back), made([])
        self.assertEqual(moved.node_count, len(poses))
        np.testing.assert_array_equal(moved.cover, fresh.cover)
        np.testing.assert_array_equal(moved.map().grid().cells, fresh.map().grid().cells)
        cells = fresh.map().grid().cells
        self.assertEqual(set(np.unique(cells)), {0, 1, 2})
        x, y = poses[0, :2] + 0.5 * np.array([np.cos(poses[0, 2]), np.sin(poses[0, 2])])
        self.assertEqual(fresh.map().at_place(x, y), io.Occupancy.FREE)
        with self.assertRaises(graticule.Error):
            fresh.update_pose(10_000, [0, 0, 0])
        with self.assertRaisesRegex(graticule.UsageError, "hit_votes|1 .. 15|votes"):
            mapping.LiveMap(votes=mapping.VoteRule(hit_votes=99))

    def test_options_of_options_are_set_in_place(self):
        options = mapping.LiveMapOptions(resolution=0.2)
        options.cover.views = 3
        self.assertEqual(options.cover.views, 3)
        self.assertIn("resolution=0.2", repr(options))


class Attenuation(unittest.TestCase):
    def test_log_fit_finds_what_it_was_made_from(self):
        rng = np.random.default_rng(1)
        receivers, transmitters = rng.uniform(0, 30, (2, 400, 2))
        distance = np.linalg.norm(receivers - transmitters, axis=1)
        dbm = -35 - 22 * np.log10(np.maximum(distance, 0.1)) + rng.normal(0, 1, 400)
        log = io.SignalLog(dbm, receivers, transmitters, times_s=np.arange(400.0))
        predictor = attenuation.make_predictor("log-fit")
        predictor.add_measurements(log)
        predictor.update(400.0)
        predicted, sigma = predictor.predict_links([[0, 0]], [[10, 0]])
        self.assertAlmostEqual(predicted[0], -57, delta=0.5)
        self.assertAlmostEqual(sigma[0], 1, delta=0.2)
        again, _ = predictor.predict(log)
        self.assertLess(np.std(again - dbm), 1.1)

    def test_map_outlives_its_python_object(self):
        predictor = attenuation.make_predictor("matte")
        cells = np.ones((50, 50), dtype=np.uint8)
        predictor.set_map(io.OccupancyGrid(cells, 0.2))
        log = io.SignalLog([-50.0, -60], [[1, 1], [2, 2]], [[5, 5], [8, 8]], times_s=[0, 1])
        predictor.add_measurements(log)
        predictor.update(1.0)
        self.assertTrue(np.isfinite(predictor.predict(log)[0]).all())

    def test_tuning_finds_what_predicts_better(self):
        rng = np.random.default_rng(2)
        count = 300
        receivers = np.stack([np.linspace(0, 60, count), np.zeros(count)], axis=1)
        slow = np.cumsum(rng.normal(0, 0.5, count))  # what shadows the link changes slowly
        dbm = -40 - 20 * np.log10(receivers[:, 0] + 5) + slow + rng.normal(0, 1, count)
        log = io.SignalLog(dbm, receivers, np.full((count, 2), [-5.0, 0]), times_s=np.arange(count) * 0.5)
        tuned = attenuation.tune_signal([log], "persistence", horizons=2, max_evaluations=12)
        self.assertEqual(tuned.evaluations, 12)
        self.assertLess(tuned.score, tuned.start_score)
        self.assertEqual(set(tuned.settings), set(attenuation.signal_settings("persistence")))
        again = attenuation.replay_signal(log, "persistence", settings=tuned.settings, horizons=2)
        self.assertAlmostEqual(again.all.mse, tuned.score, delta=1e-9 * tuned.score)
        with self.assertRaisesRegex(graticule.UsageError, "nothing to tune"):
            attenuation.tune_signal([log], "log-fit")
        with self.assertRaisesRegex(graticule.UsageError, "maps"):
            attenuation.tune_signal([log], "persistence", maps=[None, None])

    def test_measures_where_least_is_known(self):
        predictor = attenuation.make_predictor("log-fit+gp")
        receivers = np.random.default_rng(4).uniform(0, 5, (60, 2))
        log = io.SignalLog(np.full(60, -50.0), receivers, np.zeros((60, 2)), times_s=np.arange(60.0))
        predictor.add_measurements(log)
        predictor.update(60.0)
        candidates = [[2.0, 2.0, 0], [40.0, 0, 0], [3.0, 1.0, 0]]
        places = attenuation.where_to_measure(
            predictor, noise_db=4, now_s=61, radio=0, others=[1], others_m=[[0, 0, 0]],
            candidates_m=candidates, count=2)
        self.assertEqual(len(places), 2)
        np.testing.assert_array_equal(places[0].at_m, candidates[1])  # far from all that was measured
        self.assertGreater(places[0].gain_nats, places[1].gain_nats)
        self.assertGreater(places[0].sigma_db, 0)

    def test_names_are_checked(self):
        with self.assertRaises(graticule.UsageError):
            attenuation.make_predictor("no such method")
        with self.assertRaises(graticule.UsageError):
            attenuation.make_predictor("matte", {"matte.no_such": 1})


class Segmentation(unittest.TestCase):
    def test_parts_two_planes(self):
        rows, columns = np.mgrid[0:60, 0:80]
        points = np.stack(
            [np.full(rows.shape, 3.0), (40 - columns) * 0.02, (30 - rows) * 0.02], axis=-1
        )
        points[40:, :, 0] = 3 - (rows[40:] - 40) * 0.02  # a floor towards the sensor
        points[40:, :, 2] = -0.2
        labels = segmentation.segment(io.PointCloud(points), "convex")
        self.assertEqual(labels.shape, (60, 80))
        wall, floor = labels[10, 40], labels[55, 40]
        self.assertNotEqual(wall, floor)
        self.assertGreater(np.mean(labels[:37] == wall), 0.99)
        options = segmentation.segment_defaults("convex")
        options.convex.min_size = 10_000
        self.assertEqual(len(np.unique(segmentation.segment(io.PointCloud(points), options=options))), 1)
        with self.assertRaises(graticule.InputError):
            segmentation.segment(io.PointCloud(points.reshape(-1, 3)), "normals")

    def test_coregistration_needs_enough_points(self):
        scene = segmentation.simulate_scene("hallway", scans=20, bearings=40)
        with self.assertRaises(graticule.IllPosedError):
            segmentation.coregister([], scene.camera)


class Calibration(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.truth = calibration.study_lenses()[0][1]
        cls.layout = calibration.layout_of(calibration.aprilcal_mosaic())
        cls.frames = calibration.simulate_detections(cls.truth, cls.layout, frames=8, seed=3)
        cls.solved = calibration.calibrate(cls.frames)

    def test_finds_the_camera(self):
        found, truth = (calibration.Camera(c) for c in (self.solved.state.cameras[0], self.truth))
        self.assertLess(calibration.difference(truth, found).rms_px, 0.5)
        rays = found.unproject([[100.0, 120.0], [300.0, 200.0]])
        np.testing.assert_allclose(found.project(2 * rays), [[100, 120], [300, 200]], atol=1e-6)

    def test_graph_reads_back_as_the_state(self):
        graph = calibration.build_calibration(self.frames, self.solved, self.solved.sigma_px)
        values = graticule.solve(graph, max_iterations=1).values
        state = calibration.read_back_calibration(graph, values, self.solved.state)
        np.testing.assert_allclose(
            state.cameras[0].parameters, self.solved.state.cameras[0].parameters, rtol=1e-5, atol=1e-5
        )
        posterior = calibration.compute_posterior(self.frames, self.solved)
        marginals = graticule.compute_marginals(
            graph, graph.initial_values(), keys=["camera:0"]
        )
        np.testing.assert_allclose(
            np.diag(posterior.of_camera(0)), np.diag(marginals.covariance("camera:0")), rtol=1e-4
        )

    def test_suggestion_lowers_what_may_be_wrong(self):
        posterior = calibration.compute_posterior(self.frames, self.solved)
        camera = calibration.Camera(self.solved.state.cameras[0])
        now = calibration.max_ere(camera, posterior.of_camera()).max_px
        suggestion = calibration.suggest_pose(self.frames, self.solved, posterior, self.layout)
        self.assertLess(suggestion.max_ere_px, 1.5 * now)
        self.assertEqual(suggestion.pixels.shape, (len(suggestion.ids), 2))
        with self.assertRaises(graticule.UsageError):
            calibration.max_ere(camera, np.eye(3))

    def test_a_picture_is_detected(self):
        target = calibration.Target(
            kind=calibration.TargetKind.CHESSBOARD, columns=8, rows=6, pitch_m=0.03
        )
        camera = calibration.Camera(self.truth)
        middle = calibration.layout_of(target).corners.mean(axis=0)
        pose = [-middle[0], -middle[1], 0.3, 0, 0, 0, 1]
        picture = calibration.render_target(target, camera, pose)
        self.assertEqual(picture.shape, (self.truth.height, self.truth.width))
        view = calibration.TargetDetector(target).detect(picture)
        self.assertEqual(len(view), 48)
        np.testing.assert_allclose(view.pixels, camera.project(view.in_target + pose[:3]), atol=0.3)


if __name__ == "__main__":
    unittest.main()
