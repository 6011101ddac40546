# %% [markdown]
# # A camera, how wrong it may be, and where to hold the target next
#
# A target is seen in some pictures; that makes a calibration, and the calibration says how far off it may be
# anywhere in the image: Max ERE (thesis, chapter 5).  Lengths are metres, pixels count from the centre of the upper
# left one.

# %% A camera to be found, and a target
import numpy as np

from graticule import calibration, io

name, truth = calibration.study_lenses()[1]
target = calibration.Target(
    kind=calibration.TargetKind.TAG_MOSAIC, columns=8, rows=6, pitch_m=0.0381, family="tag36h11",
)
layout = calibration.layout_of(target)
print(name, truth, target, sep="\n")

# %% Detection: in a picture as the camera would take it
camera = calibration.Camera(truth)
middle = layout.corners.mean(axis=0)
pose = np.array([-middle[0], -middle[1], 0.35, 0, 0, 0, 1])
picture = calibration.render_target(target, camera, pose)
view = calibration.TargetDetector(target).detect(picture, "picture.png")
ideal = camera.project(view.in_target + pose[:3])
print(f"{len(view)} corners, {np.abs(view.pixels - ideal).mean():.3f} px off (mean)")
io.write_file("picture.png", io.format_png(picture))

# %% Calibration from detections alone: no focal length, no start
frames = calibration.simulate_detections(truth, layout, frames=12, sigma_px=0.2, seed=2)
solved = calibration.calibrate(frames)
print(solved, np.round(solved.state.cameras[0].parameters, 2))
test = calibration.simulate_detections(truth, layout, frames=8, sigma_px=0.2, seed=9)
print("on views that it has not seen:", calibration.evaluate_on(solved.state, test))

# %% How wrong may it be?
posterior = calibration.compute_posterior(frames, solved, raise_by_jackknife=True)
found = calibration.Camera(solved.state.cameras[0])
ere = calibration.max_ere(found, posterior.of_camera(0))
print(f"Max ERE {ere.max_px:.2f} px, at {ere.worst}")
print(np.round(ere.ere_px, 2))
apart = calibration.difference(camera, found)
print(f"in truth it is {apart.max_px:.2f} px off at most")

# %% Where should the target be held next?
suggestion = calibration.suggest_pose(frames, solved, posterior, layout)
assert suggestion is not None
print(f"with one more picture there: Max ERE {suggestion.max_ere_px:.2f} px; target at",
      np.round(suggestion.camera_from_target[:3], 2), "m")

# %% The same from the first frame on, guided
session = calibration.CalibrationSession(
    layout, io.ImageSize(camera="cam0", width=truth.width, height=truth.height), accuracy_px=1.0,
)
for shown in frames.views[:6]:
    verdict = session.add_frame(shown)
    print(verdict.name, f"Max ERE {session.max_ere().max_px:.2f} px",
          "(bootstrapping)" if session.is_bootstrapping else "")

# %% Files that other tools read; an image without its distortion
io.write_cameras("camera.yaml", solved.rig())
io.write_detections("frames.json", frames)
view_of = calibration.Camera(calibration.rectified_view(found))
straight = calibration.Rectifier(found, view_of).image(picture)
io.write_file("straight.png", io.format_png(straight))
