# %% [markdown]
# # A map that keeps up with its pose graph
#
# Robots explore a town.  Their scans become a pose graph, and the pose graph's poses a map of square cells, which
# is kept up to date as poses move (thesis, chapter 2).

# %% A mission with truth
import numpy as np

from graticule import io, mapping

simulated = mapping.simulate_mission(
    robots=2, duration_s=60, people=4, vehicles=1,
    town=mapping.TownOptions(width_m=60, height_m=50),
)
mission = simulated.mission
log = mission.log
print(mission, log, log.geometries[0])

# %% Scans are arrays: no copy is made
ranges = log.ranges_of(0)
print(ranges.shape, ranges.dtype, "owns its memory:", ranges.flags.owndata)

# %% From raw scans to a solved pose graph
stages = []
built = mapping.build_mission(
    log,
    starts=simulated.world_from_robot[[log.robot_of_scan.tolist().index(r) for r in range(2)]],
    watch=lambda stage, done: stages.append(stage),
)
print(built.report)
print("stages:", ", ".join(dict.fromkeys(stages)))
off = np.linalg.norm(built.world_from_scan[:, :2] - simulated.world_from_robot[:, :2], axis=1)
print(f"scans are {np.median(off):.3f} m off (median), {off.max():.3f} m (most)")

# %% A live map: nodes come, poses move, cells follow
live = mapping.LiveMap(resolution=0.1, slice_size=4)
for scan, pose in zip(built.scans, built.world_from_node):
    live.add_node(int(log.robot_of_scan[scan]), log.geometries[0], log.ranges_of(int(scan)), pose)
first = live.update()
print(f"{first.nodes} nodes, {first.cover} of them in the cover; version {first.version}")

moved = built.world_from_node.copy()
moved[len(moved) // 2 :, 0] += 0.5  # a loop closes: the later half moves by half a metre
live.update_poses(moved)
second = live.update(deadline=1.0)
print(f"{second.regenerated_slices} of {second.slices} slices were drawn anew")
live.update_poses(built.world_from_node)
live.update_exactly()

# %% The map is an array: 0 unknown, 1 free, 2 structure; row 0 is the lowest
map_now = live.map()
grid = map_now.grid()
print(grid, {name: int((grid.cells == value).sum()) for name, value in
             [("unknown", 0), ("free", 1), ("structure", 2)]})
print(len(map_now.frontier()), "cells are frontier;", map_now.at_place(0.5, 0.5))

# %% The mission as it grew: a graph every 10 s, and the map of each
steps = mapping.replay_mission(mission, every_s=10)
mapped = mapping.map_mission(mission, steps)
print([update.nodes for update in mapped.updates])

# %% For ROS and others
io.write_occupancy(grid, "town")
again = io.read_occupancy("town.yaml")
assert np.array_equal(again.cells, grid.cells)
io.write_file("town.png", grid.png())
