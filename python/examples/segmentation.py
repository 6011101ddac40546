# %% [markdown]
# # Objects in a coloured cloud, and the camera that colours it
#
# A LIDAR on a servo sweeps a hallway, a camera beside it sees the same.  The two are co-registered, the cloud
# coloured, and parted into objects (thesis, chapter 4).

# %% A scene with labels that are known
import numpy as np

from graticule import calibration, io, segmentation

scene = segmentation.simulate_scene("hallway", scans=120, bearings=360, bearing_step_rad=0.0087)
cloud = scene.cloud
print(cloud, "points", cloud.points.shape, cloud.points.dtype)

# %% Extrinsics from points that both have seen, one of them wrong
camera = calibration.Camera(scene.camera)
generator = np.random.default_rng(1)
points = cloud.points.reshape(-1, 3)
points = points[np.isfinite(points).all(axis=1)]
x, y, z, w = scene.camera_from_lidar[3:]
rotation = np.array([
    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
])
pixels = camera.project(points @ rotation.T + scene.camera_from_lidar[:3])
inside = (pixels > 20).all(axis=1) & (pixels < [scene.camera.width - 20, scene.camera.height - 20]).all(axis=1)
chosen = generator.choice(np.flatnonzero(inside), 20, replace=False)
seen = pixels[chosen] + generator.normal(0, 0.5, (20, 2))
seen[0] += [60, -40]
pairs = [
    io.Correspondence(in_lidar=points[i].astype(float), pixel=pixel, name=str(n))
    for n, (i, pixel) in enumerate(zip(chosen, seen))
]
solved = segmentation.coregister(pairs, scene.camera)
print(solved, "outliers:", solved.outliers, "off by",
      np.round(solved.camera_from_lidar[:3] - scene.camera_from_lidar[:3], 3), "m")
held_out = segmentation.leave_one_out(pairs, solved)
print(f"points left out are {held_out.median_px:.2f} px off (median)")
io.write_rig("rig.yaml", solved.rig())

# %% The cloud in the picture's colours
coloured = segmentation.colour_cloud(cloud, scene.image, camera, solved.camera_from_lidar)
print(int(np.isfinite(coloured.points[..., 0]).sum()), "points have a colour")

# %% Segments, frame after frame
assert cloud.labels is not None
for method in ["convex", "joint", "normals"]:
    segmenter = segmentation.Segmenter(method)
    labels = segmenter.segment(coloured)
    score = segmentation.score_of(cloud.labels, labels, least_object=20)
    print(f"{method:8} {segmenter.segment_count} segments, mean F {score.mean_f:.2f},"
          f" weighted overlap {score.weighted_overlap:.2f}")

# %% What a segment is like
largest = max(segmentation.statistics_of(coloured, labels), key=lambda segment: segment.points)
print("largest:", largest.points, "points about", np.round(largest.centre, 2), "m, normal",
      np.round(largest.normal, 2))

# %% Files
painted = io.PointCloud(coloured.points, colours=segmentation.false_colours(labels), labels=labels)
io.write_cloud("segments.ply", painted)
again = io.read_cloud("segments.ply").labels
assert again is not None and np.array_equal(again, labels)
