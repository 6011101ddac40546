#include "arguments_parts.hpp"

namespace graticule::apps {
namespace {

void AddProblem(CLI::App* sub, SimulateCommand* command) {
  sub->add_option("-o,--output", command->output, "the problem; the format by its ending")
      ->required();
  sub->add_flag("--binary", command->binary, "write .fg with binary numbers");
  sub->add_option("--seed", command->seed)->capture_default_str();
}

void AddTruth(CLI::App* sub, SimulateCommand* command) {
  sub->add_option("--truth", command->truth, "the true values: .tum (poses) or a problem file");
}

void AddOutliers(CLI::App* sub, SimulateCommand* command) {
  sub->add_option("--outliers", command->outliers,
                  "the ids of the factors that were made wrong: .json");
  sub->add_option("--outlier-fraction", command->outlier_fraction, "of the loop closures")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
}

void AddCity(CLI::App* simulate, Chosen* chosen) {
  auto command = std::make_shared<SimulateCommand>();
  command->kind = "city";
  CLI::App* sub = AddCommand(
      simulate, "city", "make the pose graph of several robots in a city of square blocks",
      "  graticule simulate city --robots 4 --poses 1000 -o city.fg --truth truth.tum\n"
      "  graticule simulate city --robots 2 --outlier-fraction 0.1 --outliers wrong.json -o "
      "city.fg",
      command, chosen);
  AddProblem(sub, command.get());
  AddTruth(sub, command.get());
  AddOutliers(sub, command.get());
  sub->add_option("--robots", command->robots)->check(CLI::Range(1, 1000))->capture_default_str();
  sub->add_option("--poses", command->poses, "of each robot")
      ->check(CLI::Range(2, 100000000))
      ->capture_default_str();
  sub->add_option("--dimension", command->dimension)
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  sub->add_option("--landmarks", command->landmarks)
      ->check(CLI::Range(0, 10000000))
      ->capture_default_str();
  sub->add_option("--closures-per-pose", command->closures_per_pose,
                  "loop closures tried a pose, on average")
      ->check(CLI::Range(0.0, 100.0));
}

void AddBundle(CLI::App* simulate, Chosen* chosen) {
  auto command = std::make_shared<SimulateCommand>();
  command->kind = "bundle";
  CLI::App* sub =
      AddCommand(simulate, "bundle", "make a bundle adjustment: cameras on a ring round points",
                 "  graticule simulate bundle --cameras 20 --points 500 -o ring.fg\n"
                 "  graticule simulate bundle --seed 7 -o ring.fg --truth truth.fg",
                 command, chosen);
  AddProblem(sub, command.get());
  AddTruth(sub, command.get());
  sub->add_option("--cameras", command->cameras)
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  sub->add_option("--points", command->points)
      ->check(CLI::Range(4, 10000000))
      ->capture_default_str();
}

void AddCorrupt(CLI::App* simulate, Chosen* chosen) {
  auto command = std::make_shared<SimulateCommand>();
  command->kind = "corrupt";
  CLI::App* sub = AddCommand(
      simulate, "corrupt", "add false loop closures to a recorded pose graph",
      "  graticule simulate corrupt intel.g2o --outlier-fraction 0.3 --seed 7 -o bad.g2o\n"
      "  graticule simulate corrupt intel.g2o --outlier-fraction 0.3 --outlier-kind grouped "
      "--outliers wrong.json -o bad.g2o",
      command, chosen);
  sub->add_option("IN", command->input, "the problem to corrupt")->required();
  AddProblem(sub, command.get());
  AddOutliers(sub, command.get());
  sub->add_option("--outlier-kind", command->outlier_kind,
                  "false closures one by one, in runs that agree with each other, or between near "
                  "poses")
      ->check(CLI::IsMember({"random", "grouped", "local"}))
      ->capture_default_str();
  AddReading(sub, &command->reading);
}

void AddMission(CLI::App* simulate, Chosen* chosen) {
  auto command = std::make_shared<SimulateMissionCommand>();
  CLI::App* sub = AddCommand(
      simulate, "mission",
      "make one mission of a team of robots in a town that every chapter can be run on: laser "
      "logs, "
      "radios, cameras and a LIDAR, with the truth",
      "  graticule simulate mission -o mission/\n"
      "  graticule simulate mission --shape phase2-like --pictures 0 --rate 0 -o mission/ && "
      "graticule map mission/*.log --truth mission/truth/map.yaml -o out/",
      command, chosen);
  sub->add_option("-o,--output", command->output,
                  "a new folder, or an empty one; its README.md says what is what")
      ->required();
  sub->add_option("--shape", command->shape,
                  "small: 4 robots, 10 minutes; keswick-like, phase2-like: as the thesis' sets")
      ->check(CLI::IsMember({"small", "keswick-like", "phase2-like"}))
      ->capture_default_str();
  sub->add_option("--robots", command->robots, "instead of the shape's")
      ->check(CLI::Range(1, 1000));
  sub->add_option("--minutes", command->minutes, "instead of the shape's")
      ->check(CLI::Range(0.1, 10000.0));
  sub->add_option("--seed", command->seed)->capture_default_str();
  sub->add_option("--street-things", command->street_things,
                  "cars and trees that stand along the streets, for each block")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  sub->add_option("--pictures", command->pictures,
                  "of a calibration target by each robot's camera; 0: no cameras, and no scan of "
                  "a street")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  sub->add_option("--rate", command->rate_hz, "Hz, packets of each radio; 0: no radios")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  sub->add_flag("--record", command->record,
                "write it as a recorded mission as well, with its sequence of graphs");
  sub->add_option("--gnss", command->gnss_sigma_m,
                  "write satellite fixes, one in 5 s, of this deviation in m (gnss.csv)")
      ->check(CLI::Range(0.001, 1000.0));
  sub->add_option("--bad-fixes", command->bad_fixes, "so many of them are 50 m off")
      ->check(CLI::Range(0, 1000000));
  sub->add_option("--datum", command->datum, "where on the Earth the town's origin is")
      ->capture_default_str();
}

void AddScene(CLI::App* simulate, Chosen* chosen) {
  auto command = std::make_shared<SimulateSceneCommand>();
  CLI::App* sub = AddCommand(
      simulate, "scene", "make a scan and a picture of a scene whose labels are known",
      "  graticule simulate scene hallway -o hallway\n"
      "  graticule segment hallway/scan.pcd --image hallway/image.png --rig hallway/rig.yaml "
      "--picture labels.png",
      command, chosen);
  sub->add_option("SCENE", command->scene,
                  "hallway (bins, a box, a ball) or hill (barrels, a tree)")
      ->required()
      ->check(CLI::IsMember({"hallway", "hill"}));
  sub->add_option("-o,--output", command->output, "the folder: scan.pcd, image.png, rig.yaml")
      ->required();
  sub->add_option("--seed", command->seed, "of the noise")->capture_default_str();
}

}  // namespace

void AddSimulate(CLI::App* app, Chosen* chosen) {
  CLI::App* simulate = app->add_subcommand("simulate", "make something whose truth is known");
  simulate->require_subcommand(1);
  AddCity(simulate, chosen);
  AddBundle(simulate, chosen);
  AddCorrupt(simulate, chosen);
  AddMission(simulate, chosen);
  AddScene(simulate, chosen);
  simulate->footer(
      "Examples:\n  graticule simulate mission -o mission/\n"
      "  graticule simulate bundle --cameras 20 --points 500 -o ring.fg");
}

}  // namespace graticule::apps
