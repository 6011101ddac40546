# %% [markdown]
# # A pose graph, from numbers to a proof
#
# Two robots drive through a city; odometry says how they moved, loop closures where they had been before.  Run it
# as it is, or cell by cell.  Lengths are metres, angles radians.

# %% A graph by hand: a square of 5 m, and the loop that closes it
import numpy as np

import graticule
from graticule import io, pose_graph

square = graticule.Graph()
square.add("pose:0", "se2/1", [0, 0, 0], fixed=True)
poses = np.array([[2.0 * i, 0.5 * i, 1.4 * i] for i in range(1, 5)])
poses[:, 2] = np.arctan2(np.sin(poses[:, 2]), np.cos(poses[:, 2]))
ids = square.add_variables("pose", "se2/1", poses)  # pose:1 .. pose:4, no loop in Python
ids = np.concatenate([[square.id_of("pose:0")], ids])
edges = np.stack([ids[:-1], ids[1:]], axis=1)
steps = np.tile([5, 0, np.pi / 2], (4, 1))
square.add_factors("between_se2/1", edges, steps, noise=[0.1, 0.1, 0.02], source="odometry")
square.add(graticule.between_se2_factor("pose:4", "pose:0", [0.2, -0.1, 0.01], 0.05, "loop"))

solution = graticule.solve(square, max_iterations=50)
print(solution.report)
print(np.round(solution.values.array("pose"), 3))

# %% How sure is it?  Covariance blocks in the poses' own frames
marginals = graticule.compute_marginals(square, solution.values, ["pose:2"])
assert isinstance(marginals, graticule.Marginals)
print("deviations of pose:2 [m, m, rad]:", np.sqrt(np.diag(marginals.covariance("pose:2"))))

# %% A question without an answer is diagnosed, not answered
loose = graticule.Graph()
loose.add("pose:0", "se2/1", [0, 0, 0])
loose.add("landmark:0", "point2/1", [1, 0])
loose.add(graticule.Factor(type="range_se2/1", keys=["pose:0", "landmark:0"], measurement=np.array([1.0])))
diagnosis = graticule.compute_marginals(loose, keys=["pose:0", "landmark:0"])
assert isinstance(diagnosis, graticule.Diagnosis)
print(diagnosis.summary)

# %% A city with truth: 2 robots, 400 poses each
city = pose_graph.simulate_city(robots=2, poses_per_robot=400, seed=3)
graph = city.graph
print(graph, "objective at odometry", round(graticule.objective(graph)))
start = pose_graph.initialise(graph, "chordal")
print(start.summary)
solution = graticule.solve(graph)
print(solution.report)
truth = {
    family: pose_graph.trajectory(graph, city.truth, family)
    for family in pose_graph.pose_families(graph)
}
errors = pose_graph.trajectory_errors(graph, solution.values, truth)
print(f"absolute error {errors.together.ate.translation_m.rmse:.3f} m")
assert errors.together.ate.translation_m.rmse < 1

# %% Is that the best there is?
certificate = pose_graph.certify(graph, solution.values)
print(certificate.summary)

# %% A fifth of the closures are lies: find them
corrupted, lies = pose_graph.add_false_closures(graph, 0.2, seed=5)
robust = pose_graph.solve_without_outliers(corrupted, reject_outliers="gnc_tls")
rejected = {factor.id for factor in robust.rejection.rejected}
print(f"{len(rejected & set(lies.tolist()))} of {len(lies)} lies rejected,",
      f"{len(rejected - set(lies.tolist()))} true closures with them")

# %% Configurations side by side, as `graticule compare` does
comparison = graticule.compare(
    {"city": graph},
    {"default": {}, "dogleg": {"method": "dogleg"}, "from the tree": {"initialise": "spanning_tree"}},
)
print(comparison)

# %% Files: what other tools read and write
recording = io.Recording(graph, title="a simulated city")
recording.graph.set_values(solution.values)
for name in ["city.fg", "city.g2o", "city.graph"]:
    notes = io.write_problem(name, recording)
    print(name, io.read_problem(name), *notes)
io.write_tum("robot1.tum", pose_graph.trajectory(graph, solution.values, "robot1"))

# %% A factor of your own, in Python: slow, and good for trying things out
types = graticule.builtins()
graticule.add_python_factor(
    types,
    "distance/1",
    "a:se2/1 b:se2/1 | d:m",
    lambda a, b, measured: np.hypot(*(b[:2] - a[:2])) - measured,
    relative=True,
)
own = graticule.Graph(types)
own.add("pose:0", "se2/1", [0, 0, 0], fixed=True)
own.add("pose:1", "se2/1", [3, 4.5, 0])
own.add(graticule.prior_se2_factor("pose:1", [3, 4.5, 0], 1.0))
own.add(graticule.Factor(type="distance/1", keys=["pose:0", "pose:1"], measurement=np.array([5.0]), noise=0.01))
print(graticule.solve(own).values["pose:1"])

# %% A picture, where matplotlib is installed
try:
    import matplotlib.pyplot as plt
except ImportError:
    print("no matplotlib: no picture")
else:
    figure, axes = plt.subplots(figsize=(6, 6))
    for family in truth:
        before, after = graph.initial_values().array(family), solution.values.array(family)
        axes.plot(before[:, 0], before[:, 1], ":", alpha=0.5, label=f"{family}, chordal")
        axes.plot(after[:, 0], after[:, 1], label=family)
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=2)
    figure.savefig("pose_graph.png", dpi=100)
