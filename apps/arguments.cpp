#include "arguments.hpp"

#include <algorithm>
#include <iostream>

#include "arguments_parts.hpp"
#include "commands.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule::apps {

void AddPlugins(CLI::App* sub, Reading* reading) {
  sub->add_option("--plugin", reading->plugins, "a plug-in's shared library; may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
}

void AddReading(CLI::App* sub, Reading* reading) {
  AddPlugins(sub, reading);
  sub->add_option("--g2o-rotation", reading->g2o_rotation,
                  "what 3D rotation weights in .g2o mean: half (as the tool g2o: the quaternion's "
                  "vector part; the "
                  "default), double (as Ceres' example: twice that), full (as GTSAM: the angle)")
      ->check(CLI::IsMember({"half", "double", "full"}));
  sub->add_flag("--skip-unknown", reading->skip_unknown,
                "go on past tags that are not known, and say which");
  sub->add_flag("--repair-information", reading->repair_information,
                "project information matrices that are not positive definite onto the nearest that "
                "are, and say how many");
}

void AddChoosing(CLI::App* sub, Choosing* choosing, const char* config, const char* setting) {
  sub->add_option("-c,--config", choosing->config, config);
  sub->add_option("-s,--set", choosing->settings, setting)
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
}

namespace {

void AddComparing(CLI::App* sub, Comparing* comparing) {
  sub->add_option(
      "--ground-truth", comparing->ground_truth,
      "the true poses, to say how far the solution's are from them: TUM (of several "
      "robots truth.robot1.tum, ... for truth.tum; of logs by their times), or a problem whose "
      "values are true");
  sub->add_option("--align", comparing->align,
                  "how a solution is laid onto the truth: se (rotation and translation), sim (and "
                  "scale), first (its first pose), none")
      ->check(CLI::IsMember({"se", "sim", "first", "none"}))
      ->capture_default_str();
  sub->add_option("--rpe-distance", comparing->rpe_distance_m,
                  "driven metres between the poses of a relative error")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

void AddSolve(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<SolveCommand>();
  CLI::App* sub =
      AddCommand(app, "solve", "solve a recorded problem",
                 "  graticule solve city10000.g2o.gz -o solved.g2o --plot city.svg\n"
                 "  graticule solve problem.fg --config robust-huber --set threads=2 --json\n"
                 "  graticule solve map.g2o --reject-outliers -o map.fg",
                 command, chosen);
  sub->add_option("FILE", command->file, ".fg .g2o .graph (TORO) .txt/.bal (BAL), each also .gz")
      ->required();
  sub->add_option("-o,--output", command->output,
                  "write the solved problem; the format by its ending");
  sub->add_flag("--binary", command->binary, "write .fg with binary numbers");
  sub->add_option("--report", command->report, "write a report: .html or .json");
  sub->add_option("--trajectory", command->trajectory, "write the poses: TUM");
  sub->add_option("--plot", command->plot, "draw the graph before and after: .svg or .png");
  sub->add_option("--marginals", command->marginals,
                  "covariance of these keys (pose:1,pose:2) or `all`");
  sub->add_option("--marginals-output", command->marginals_output, "write the covariances: .json");
  sub->add_flag("--certify", command->certify,
                "prove that a pose graph's solution is globally optimal; where that is refused, "
                "look for a cheaper one");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  sub->add_flag("--reject-outliers{gnc-tls}", command->reject,
                "find factors that are wrong, and solve without them: =gnc-tls (the default), "
                "=gnc-gm, =pcm")
      ->check(CLI::IsMember({"gnc-tls", "gnc-gm", "pcm"}));
  sub->add_option("--trust", command->trust, "sources whose factors are never rejected: a,b")
      ->delimiter(',')
      ->type_name("SOURCE")
      ->allow_extra_args(false);
  sub->add_option("--suspect", command->suspect,
                  "sources whose factors may be rejected, beside closures between poses: a,b")
      ->delimiter(',')
      ->type_name("SOURCE")
      ->allow_extra_args(false);
  sub->add_flag("--drop-rejected", command->drop_rejected,
                "write the solved problem without the rejected factors");
  AddChoosing(sub, &command->choosing, "a ready configuration (`graticule options`) or a YAML file",
              "one option; may be repeated");
  AddComparing(sub, &command->comparing);
  AddReading(sub, &command->reading);
}

void AddCompare(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<CompareCommand>();
  CLI::App* sub = AddCommand(
      app, "compare", "solve files with several configurations, side by side",
      "  graticule compare *.g2o --configs default dogleg my.yaml --report compare.html\n"
      "  graticule compare sphere2500.g2o --configs default eigen-sparse --repeats 5 --json",
      command, chosen);
  sub->add_option("FILES", command->files, "recorded problems")->required();
  sub->add_option("--configs", command->configs, "ready configurations or YAML files")->required();
  sub->add_option("-s,--set", command->settings,
                  "one option, in every configuration; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  sub->add_option("--repeats", command->repeats, "counted runs of each, after one that is not")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--report", command->report, "write a page (.html) or data (.json)");
  sub->add_option("--state", command->state,
                  "keep each run in this file as it ends: the same command goes on where it was "
                  "stopped")
      ->type_name("FILE");
  sub->add_option("--best-known", command->best_known,
                  "YAML: file name: best known cost (0.5 r'Wr)");
  sub->add_flag("--json", command->json, "JSON on stdout instead of the table");
  AddComparing(sub, &command->comparing);
  AddReading(sub, &command->reading);
}

void AddMap(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<MapCommand>();
  CLI::App* sub = AddCommand(
      app, "map", "make the occupancy map of recorded missions",
      "  graticule map intel.clf.gz -o out/\n"
      "  graticule map killian.g2o.gz --method incremental naive cover-composite -o out/\n"
      "  graticule map robot1.log robot2.log --gnss fixes.csv --record -o out/\n"
      "  graticule map out/ --method incremental naive -o again/",
      command, chosen);
  sub->add_option("LOGS", command->logs,
                  "CARMEN logs or ROS bags (.bag), one a robot; or one .g2o with ROBOTLASER1 "
                  "scans, and a .pgseq where "
                  "its sequence of graphs is known; each also .gz; or the folder of a recorded "
                  "mission")
      ->required();
  sub->add_option("-o,--output", command->output, "the folder for map, graph, pictures and report")
      ->required();
  sub->add_option("--method", command->methods,
                  "how the map is kept up to date; of several, the first is written and the others "
                  "are compared: incremental, naive, naive-cover, cover-composite")
      ->check(CLI::IsMember({"incremental", "naive", "naive-cover", "cover-composite"}))
      ->capture_default_str();
  sub->add_option("--every", command->every_s,
                  "seconds of the log from update to update (10; a recorded mission's own)")
      ->check(CLI::PositiveNumber);
  sub->add_option("--resolution", command->resolution_m, "m, a cell's side")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  sub->add_option("--max-range", command->max_range_m, "m; beams count up to here")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  sub->add_option("--slice", command->slice, "nodes of a robot that are drawn anew together")
      ->check(CLI::Range(1, 100000));
  sub->add_flag("--no-cover", command->no_cover, "draw every node, not only those that add");
  sub->add_option("--cover-news", command->cover_news,
                  "a node is left out whose share of cells that are news is at most this")
      ->check(CLI::Range(0.0, 1.0));
  sub->add_option("--bias", command->bias,
                  "votes for structure: above 0 walls stay, below 0 doorways clear")
      ->check(CLI::Range(-100, 100))
      ->capture_default_str();
  sub->add_option("--deadline", command->deadline_ms, "ms for an update; 0: none")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  sub->add_option("--datum", command->datum,
                  "where on the Earth the map's origin is: LAT,LON or LAT,LON,HEIGHT; x is east");
  sub->add_option("--gnss", command->gnss,
                  "satellite fixes that say where on the Earth the map is: a file of lines "
                  "time,robot,latitude,longitude,height,sigma, or `log` for NMEAGGA lines of the "
                  "logs; --datum is then the origin, else the first fix")
      ->type_name("FILE");
  sub->add_option("--antenna", command->antenna,
                  "where the receiver's antenna is on the robot: X,Y in m, ahead and to the left")
      ->type_name("X,Y");
  sub->add_option("--truth", command->truth, "a true map (map_server YAML) to compare with");
  AddComparing(sub, &command->comparing);
  sub->add_option("--start", command->starts,
                  "where the robot of each log begins, in order: x,y,yaw in m and rad; without it, "
                  "robots are joined where they meet")
      ->type_name("X,Y,YAW")
      ->allow_extra_args(false);
  sub->add_flag("--keep-poses", command->keep_poses,
                "the logs' poses are corrected already: draw the map with them");
  sub->add_option(
         "--laser-offset", command->laser_offsets,
         "where the laser is on the robot, whatever the logs say: X ahead, or X,Y,YAW in m "
         "and rad; once for all logs, or for each in order")
      ->type_name("X[,Y,YAW]")
      ->allow_extra_args(false);
  sub->add_option("--scan-topic", command->scan_topic,
                  "of bags: sensor_msgs/LaserScan; by default /scan, or the only one");
  sub->add_option("--odom-topic", command->odom_topic,
                  "of bags: nav_msgs/Odometry; by default /odom, or the only one, else the "
                  "transforms from the frame odom");
  sub->add_option("--relations", command->relations,
                  "true relations between a robot's poses at two times (Kuemmerle et al. 2009), of "
                  "one log: t1 t2 x y z roll pitch yaw");
  sub->add_flag("--record", command->record,
                "record the mission in the folder: the factor graph of every update, the "
                "scans and an index");
  sub->add_flag("--skip-bad", command->skip_bad, "pass over bad lines of a log, and count them");
  sub->add_flag("--json", command->json, "one JSON object on stdout instead of the summary");
  AddReading(sub, &command->reading);
}

void AddConvert(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<ConvertCommand>();
  CLI::App* sub = AddCommand(app, "convert", "rewrite a problem in another format",
                             "  graticule convert sphere2500.g2o sphere2500.fg\n"
                             "  graticule convert big.g2o.gz big.fg --binary",
                             command, chosen);
  sub->add_option("IN", command->input)->required();
  sub->add_option("OUT", command->output)->required();
  sub->add_flag("--binary", command->binary, "write .fg with binary numbers");
  AddReading(sub, &command->reading);
}

void AddInspect(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<InspectCommand>();
  CLI::App* sub =
      AddCommand(app, "inspect", "say what is in a problem: counts, keys, pieces, anchors, rank",
                 "  graticule inspect victoria_park.g2o\n"
                 "  graticule inspect problem.fg --json",
                 command, chosen);
  sub->add_option("FILE", command->file)->required();
  sub->add_flag("--json", command->json, "JSON on stdout");
  AddReading(sub, &command->reading);
}

void AddCheck(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<CheckCommand>();
  CLI::App* sub = AddCommand(
      app, "check",
      "check a problem's structure, rank, and every factor's Jacobian against differences",
      "  graticule check problem.fg\n"
      "  graticule check problem.fg --plugin ./libradar.so --tolerance 1e-6",
      command, chosen);
  sub->add_option("FILE", command->file)->required();
  sub->add_option("--tolerance", command->tolerance, "largest relative disagreement of a Jacobian")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  sub->add_flag("--json", command->json, "JSON on stdout");
  AddReading(sub, &command->reading);
}

void AddLists(CLI::App* app, Chosen* chosen) {
  auto options = std::make_shared<OptionsCommand>();
  AddCommand(app, "options", "list every option and the ready configurations",
             "  graticule options\n  graticule options --markdown > docs/options.md", options,
             chosen)
      ->add_flag("--markdown", options->markdown, "as the page in the docs");
  auto types = std::make_shared<TypesCommand>();
  CLI::App* sub =
      AddCommand(app, "types", "list the variable and factor types that are loaded",
                 "  graticule types\n  graticule types --plugin ./libradar.so", types, chosen);
  AddPlugins(sub, &types->reading);
}

// CLI11 says of `graticule slove` only that a subcommand is missing.
void ExpectCommand(const CLI::App& app, int argc, char** argv) {
  const CLI::App* above = &app;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (!word.empty() && word[0] == '-') continue;
    std::vector<std::string_view> names;
    const CLI::App* named = nullptr;
    for (const CLI::App* sub : above->get_subcommands({})) {
      names.push_back(sub->get_name());
      if (sub->get_name() == word) named = sub;
    }
    if (!named)
      throw Error("there is no command '" + word.substr(0, 60) + "'" + DidYouMean(word, names) +
                      "; graticule " + (above == &app ? "" : above->get_name() + " ") +
                      "--help lists them",
                  ErrorKind::kUsage);
    if (named->get_require_subcommand_min() == 0) return;
    above = named;
  }
}

}  // namespace

int RunFromArguments(int argc, char** argv) {
  CLI::App app("Factor graphs as data, solved by Ceres.", "graticule");
  Console console;
  Chosen chosen;
  app.require_subcommand(1);
  app.fallthrough();
  app.add_flag("-q,--quiet", console.quiet, "nothing on stderr but errors");
  app.set_version_flag("--version", Versions);
  app.footer(
      "Exit codes: 0 done, 1 failed, 2 usage, 3 input refused, 4 not converged, 5 ill-posed, 6 "
      "type or plug-in "
      "missing, 70 internal.\nExamples:\n  graticule solve sphere2500.g2o -o solved.g2o\n"
      "  graticule compare *.g2o --configs default dogleg --report compare.html");
  AddSolve(&app, &chosen);
  AddCompare(&app, &chosen);
  AddMap(&app, &chosen);
  AddCalibrate(&app, &chosen);
  AddSegment(&app, &chosen);
  AddCoregister(&app, &chosen);
  AddSignal(&app, &chosen);
  AddConvert(&app, &chosen);
  AddInspect(&app, &chosen);
  AddCheck(&app, &chosen);
  AddSimulate(&app, &chosen);
  AddLists(&app, &chosen);
  AddManual(&app, &chosen);
  ExpectCommand(app, argc, argv);
  try {
    std::vector<std::string> words = GuideAsCommand({argv + 1, argv + argc});
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    if (LaunchedAs().rank > 0) return error.get_exit_code() == 0 ? kDone : kUsage;
    if (error.get_exit_code() == 0) return app.exit(error, std::cout, std::cerr);  // help, version
    std::cerr << "graticule: " << error.what() << "\nRun with --help for more information.\n";
    return kUsage;
  }
  return chosen(console);
}

}  // namespace graticule::apps
