#include "arguments_parts.hpp"
#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/simulate_plan.hpp"

namespace graticule::apps {
namespace {

void AddInput(CLI::App* sub, SignalInput* input) {
  sub->add_option("LOG", input->logs,
                  "logs (CSV, also .gz; docs/formats.md), or folders with log.csv and map.yaml")
      ->required();
  sub->add_option("--map", input->maps,
                  "the map (map_server YAML) that the positions are in: one for all logs or one a "
                  "log")
      ->type_name("YAML")
      ->allow_extra_args(false);
  sub->add_option("--anchors", input->anchors, "where fixed radios are: CSV of id,x,y[,z]");
  sub->add_option("--trajectory", input->trajectories,
                  "where a radio of a log without positions was: TUM; may be repeated")
      ->type_name("RADIO=FILE")
      ->allow_extra_args(false);
  sub->add_option("--mobile", input->mobile, "the radio that a wide log's x, y belong to")
      ->capture_default_str();
  sub->add_flag("--sort", input->sort,
                "put lines in the order of time, instead of refusing a log whose times go back");
  sub->add_option("--rate", input->rate_hz,
                  "Hz: of each link, take no more measurements than so many; 0: all")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

void AddSettings(CLI::App* sub, Choosing* choosing) {
  AddChoosing(sub, choosing, "the methods' numbers: YAML, as signal tune writes (docs/signal.md)",
              "one of them, matte.lambda=2; may be repeated");
}

void AddReplay(CLI::App* sub, SignalReplayWords* words) {
  sub->add_option("--every", words->every, "from step to step, and a horizon's length: 2s")
      ->capture_default_str();
  sub->add_option("--horizons", words->horizons, "how many steps ahead")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--predict-every", words->predict_every, "predict at each so many'th step only")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
}

void AddModel(CLI::App* sub, std::string* model, std::string* map) {
  sub->add_option("MODEL", *model, "as signal fit writes")->required();
  sub->add_option("--map", *map,
                  "the map (map_server YAML) to predict through; it need not be the one that the "
                  "model was fitted with");
}

void AddFit(CLI::App* signal, Chosen* chosen) {
  auto command = std::make_shared<SignalFitCommand>();
  CLI::App* sub =
      AddCommand(signal, "fit", "learn how signals are weakened, from a log and a map",
                 "  graticule signal fit log.csv --map map.yaml --method matte -o model.fg\n"
                 "  graticule signal fit nw1/ --method best -o model.txt",
                 command, chosen);
  AddInput(sub, &command->input);
  sub->add_option("--method", command->method,
                  "log-fit, one (attenuation a class), mrt, matte, fine-mrt: a factor graph, "
                  "solved; mean, persistence, mrgp, gp, any with +gp, best: what was measured")
      ->capture_default_str();
  sub->add_option("-o,--output", command->output, "the model: .fg of a factor graph, else any name")
      ->required();
  sub->add_option("--record", command->record, "write the factor graph before it is solved: .fg");
  sub->add_flag("--binary", command->binary, "write .fg with binary numbers");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  AddSettings(sub, &command->choosing);
}

void AddPredict(CLI::App* signal, Chosen* chosen) {
  auto command = std::make_shared<SignalPredictCommand>();
  CLI::App* sub = AddCommand(
      signal, "predict", "predict signal strengths with their standard deviations",
      "  graticule signal predict model.fg --map map.yaml --from 12.5,8 --map-of out\n"
      "  graticule signal predict model.fg --map map.yaml --pairs pairs.csv -o predicted.csv",
      command, chosen);
  AddModel(sub, &command->model, &command->map);
  sub->add_option("--from", command->from, "where one radio is: X,Y or X,Y,Z in m");
  sub->add_option("--map-of", command->map_of,
                  "from there to everywhere: OUT.png with a colour bar; OUT.dbm.png (shade = dBm + "
                  "200) and OUT.sigma.png (shade = 10 dB^-1) with world files")
      ->type_name("OUT");
  sub->add_option("--step", command->step_m, "m, a pixel of that; by default 1/120 of the map")
      ->check(CLI::PositiveNumber);
  sub->add_option("--radio", command->radio, "which of the model's radios is there; else any");
  sub->add_option("--to", command->to, "which of them is everywhere; else any");
  sub->add_option(
      "--pairs", command->pairs,
      "links: CSV of [time,][receiver,transmitter,]rx_x,rx_y[,rx_z],tx_x,tx_y[,tx_z][,dbm]; "
      "where strengths are given, it is said how far the predictions are from them");
  sub->add_option("-o,--output", command->output,
                  "where the predictions of --pairs go: CSV; by default stdout");
}

void AddDraw(CLI::App* signal, Chosen* chosen) {
  auto command = std::make_shared<SignalDrawCommand>();
  CLI::App* sub = AddCommand(signal, "draw", "draw the attenuation of each class over the map",
                             "  graticule signal draw model.fg --map map.yaml -o attenuation.png",
                             command, chosen);
  AddModel(sub, &command->model, &command->map);
  sub->add_option("-o,--output", command->output, "the drawing: .png or .svg")->required();
}

void AddEvaluate(CLI::App* signal, Chosen* chosen) {
  auto command = std::make_shared<SignalEvaluateCommand>();
  CLI::App* sub = AddCommand(
      signal, "evaluate", "replay logs, and say how well each method predicted what came next",
      "  graticule signal evaluate log.csv --map map.yaml --every 2s --horizons 10\n"
      "  graticule signal evaluate nw1/ bbb3/ --methods log-fit matte --plot figure.svg --json",
      command, chosen);
  AddInput(sub, &command->input);
  AddReplay(sub, &command->replay);
  sub->add_option("--methods", command->methods,
                  "as signal fit's; by default log-fit, persistence, one, mrt, mrgp, matte, best");
  sub->add_flag("--forget", command->forget, "learn each drive of a log from nothing");
  sub->add_option("--threads", command->threads, "methods and logs that are replayed at once")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  sub->add_option("--plot", command->plot,
                  "draw the mean squared error by horizon (the thesis' Figure 3.4): .svg or .png");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the table");
  AddSettings(sub, &command->choosing);
}

void AddTune(CLI::App* signal, Chosen* chosen) {
  auto command = std::make_shared<SignalTuneCommand>();
  CLI::App* sub = AddCommand(
      signal, "tune", "find the methods' numbers by compass search on training logs",
      "  graticule signal tune nw2/ bbb3/ -o tuned.yaml\n"
      "  graticule signal tune log.csv --map map.yaml --methods matte --threads 4 -o tuned.yaml",
      command, chosen);
  AddInput(sub, &command->input);
  sub->add_option("-o,--output", command->output,
                  "the numbers found: YAML; beside it OUT.METHOD.state, from which a search that "
                  "was stopped goes on")
      ->required();
  sub->add_option("--methods", command->methods, "each is tuned by itself")->capture_default_str();
  sub->add_option("--only", command->only,
                  "the settings to search (docs/signal.md), matte.lambda; by default all that a "
                  "method depends on");
  sub->add_option("--by", command->by,
                  "what is to be least: the mean squared error, or the negative log likelihood, "
                  "which judges the deviations too")
      ->check(CLI::IsMember({"mse", "nll"}))
      ->capture_default_str();
  AddReplay(sub, &command->replay);
  sub->add_option("--most", command->most, "replays of all logs, for each method")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  sub->add_option("--threads", command->threads,
                  "replays at once; started by mpirun or srun, each process does one")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  AddSettings(sub, &command->choosing);
}

void AddSimulateSignal(CLI::App* signal, Chosen* chosen) {
  auto command = std::make_shared<SignalSimulateCommand>();
  CLI::App* sub = AddCommand(signal, "simulate",
                             "let robots explore a floor plan and measure each other's signal",
                             "  graticule signal simulate nw1 -o nw1/\n"
                             "  graticule signal simulate house --seconds 60 --rate 5 -o house/",
                             command, chosen);
  std::string names;
  for (const PlaceOptions& place : KnownPlaces()) names += (names.empty() ? "" : ", ") + place.name;
  sub->add_option("PLACE", command->place, names)->required();
  sub->add_option("-o,--output", command->output,
                  "the folder for log.csv, the map that the robots drew (map.yaml), their "
                  "trajectories, and the truth")
      ->required();
  sub->add_option("--robots", command->robots)->check(CLI::Range(2, 100))->capture_default_str();
  sub->add_option("--seconds", command->seconds, "instead of the place's own")
      ->check(CLI::Range(1.0, 100000.0));
  sub->add_option("--rate", command->rate_hz, "Hz, packets of each radio")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  sub->add_option("--floor", command->floor_dbm, "dBm; weaker packets are not heard")
      ->check(CLI::Range(-200.0, 30.0))
      ->capture_default_str();
  sub->add_option("--seed", command->seed, "of ways, radios and fading; the place has its own")
      ->capture_default_str();
  sub->add_flag("--maps", command->maps, "also the map as it was every 30 s: maps/00030.yaml, ...");
}

void AddConnect(CLI::App* signal, Chosen* chosen) {
  auto command = std::make_shared<SignalConnectCommand>();
  CLI::App* sub = AddCommand(
      signal, "connect", "who can talk to whom, with which probability, at given places",
      "  graticule signal connect model.fg team.csv --map map.yaml --usable -80", command, chosen);
  AddModel(sub, &command->model, &command->map);
  sub->add_option("POSITIONS", command->positions, "CSV of id,x,y[,z]: a radio each")->required();
  sub->add_option("--usable", command->usable_dbm, "dBm that a link needs")
      ->check(CLI::Range(-200.0, 30.0))
      ->capture_default_str();
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the table");
}

void AddWhere(CLI::App* signal, Chosen* chosen) {
  auto command = std::make_shared<SignalWhereCommand>();
  CLI::App* sub = AddCommand(
      signal, "where", "where a robot should measure next, by what that would tell",
      "  graticule signal where model.fg team.csv --robot robot2 --map map.yaml --reach 20",
      command, chosen);
  AddModel(sub, &command->model, &command->map);
  sub->add_option("POSITIONS", command->positions, "CSV of id,x,y[,z]: a radio each")->required();
  sub->add_option("--robot", command->robot, "the one that drives; the others stay")->required();
  sub->add_option("--reach", command->reach_m, "m, how far it may drive over free cells")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  sub->add_option("--places", command->places, "how many, one after the other")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the table");
}

}  // namespace

void AddSignal(CLI::App* app, Chosen* chosen) {
  CLI::App* signal = app->add_subcommand(
      "signal", "predict signal strength between moving robots, with its uncertainty");
  signal->require_subcommand(1);
  AddFit(signal, chosen);
  AddPredict(signal, chosen);
  AddDraw(signal, chosen);
  AddEvaluate(signal, chosen);
  AddTune(signal, chosen);
  AddSimulateSignal(signal, chosen);
  AddConnect(signal, chosen);
  AddWhere(signal, chosen);
}

}  // namespace graticule::apps
