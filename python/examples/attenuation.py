# %% [markdown]
# # How strong will the signal be over there?
#
# Robots explore an office, map it, and measure each other's signal as they go.  Methods learn from that and
# predict links that nobody has measured (thesis, chapter 3).  Positions are metres, strengths dBm.

# %% A mission with truth
import numpy as np

from graticule import attenuation, io

place = attenuation.place_by_name("house")
simulated = attenuation.simulate_signal(place=place, robots=3, rate_hz=2)
log = simulated.log
print(log, simulated.map)
print(f"strengths from {log.dbm.min():.0f} to {log.dbm.max():.0f} dBm")

# %% A predictor learns the first two thirds, and predicts the rest
print(attenuation.method_names())
half = 2 * len(log) // 3
past, future = log.rows(0, half), log.rows(half, len(log))
heard = future.heard
for method in ["mean", "log-fit", "matte", attenuation.best_method]:
    predictor = attenuation.make_predictor(method)
    predictor.set_map(simulated.map)
    predictor.add_measurements(past)
    predictor.update(past.times_s[-1])
    dbm, sigma_db = predictor.predict(future)
    rmse = np.sqrt(np.mean((dbm - future.dbm)[heard] ** 2))
    print(f"{method:14} {rmse:.2f} dB off, says it is {np.median(sigma_db):.2f} dB off")

# %% In a planner's loop: links between any two places
receivers = np.array([[2.0, 2.0], [4.0, 3.0]])
dbm, sigma_db = predictor.predict_links(receivers, np.array([[6.0, 5.0], [6.0, 5.0]]))
print("predicted", np.round(dbm, 1), "+-", np.round(sigma_db, 1))
team = attenuation.connect(
    predictor, [0, 1, 2], [np.array([2.0, 2, 0]), np.array([5.0, 3, 0]), np.array([8.0, 6, 0])], -75,
    log.times_s[-1],
)
print(f"the team is connected with probability {team.connected:.2f}")

# %% Evaluated as in the thesis: step by step, each prediction before its measurement
for method in ["log-fit", "matte"]:
    result = attenuation.replay_signal(log, method, simulated.map, every=5)
    print(f"{method:8} rmse {result.all.rmse:.2f} dB, crps {result.all.crps:.2f} dB,"
          f" 90 % interval holds {100 * result.all.coverage[2]:.0f} %")

# %% Or on links that were held out
split = attenuation.random_links(log, part=0.3, seed=1)
result = attenuation.evaluate_hold_out(log, [split], "matte", simulated.map)
print(f"held out: rmse {result.all.rmse:.2f} dB over {result.all.count} links")

# %% Settings by name
print(attenuation.signal_settings("matte"))
attenuation.make_predictor("matte", {"matte.lambda": 2.0})

# %% Files
io.write_signal_log(log, "office.csv.gz")
again = io.read_signal_log("office.csv.gz")
assert np.array_equal(again.dbm, log.dbm)
