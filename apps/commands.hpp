#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "console.hpp"

namespace graticule::apps {

/// How files are read: shared by every command that reads a problem.
struct Reading {
  std::vector<std::string> plugins;
  std::string g2o_rotation;  ///< "half", "double", "full"; "" as the file says, else half
  bool skip_unknown = false;
  bool repair_information = false;
};

/// Which configuration, and what is changed in it.
struct Choosing {
  std::string config;                 ///< "" or a file or, of solving, a name
  std::vector<std::string> settings;  ///< "threads=2", "matte.lambda=2"
};

/// What solutions are compared with.
struct Comparing {
  std::string ground_truth;  ///< "" or a trajectory or a problem
  std::string align = "se";  ///< "se", "sim", "first", "none"
  double rpe_distance_m = 10;
};

struct SolveCommand {
  std::string file;
  Reading reading;
  Choosing choosing;
  Comparing comparing;
  std::string output, report, trajectory, plot, marginals, marginals_output;
  bool binary = false;
  bool certify = false;
  bool json = false;
  std::string reject;                       ///< "" or a method: "gnc-tls"
  std::vector<std::string> trust, suspect;  ///< sources
  bool drop_rejected = false;
};

struct CompareCommand {
  std::vector<std::string> files, configs, settings;
  Reading reading;
  Comparing comparing;
  int repeats = 3;
  std::string report, best_known;
  std::string state;  ///< "" or where finished runs are kept
  bool json = false;
};

struct CalibrateTargetCommand {
  std::string output, kind, family;
  std::string size = "A3";
  double pitch_mm = 0;        ///< 0: what suits the page
  int columns = 0, rows = 0;  ///< 0: as many as fit
};

struct MapCommand {
  std::vector<std::string> logs;
  Reading reading;
  std::string output;
  std::vector<std::string> methods = {"incremental"};
  double every_s = 0;  ///< 0: kEveryS, of a recorded mission its own
  double resolution_m = 0.1, max_range_m = 25, deadline_ms = 0;
  double cover_news = -1;   ///< -1: the default of CoverOptions
  int slice = 0, bias = 0;  ///< slice 0: the default of LiveMapOptions
  bool no_cover = false, record = false, json = false, skip_bad = false;
  bool keep_poses = false;  ///< of logs: somebody has corrected them
  std::string datum, truth, relations;
  Comparing comparing;                     ///< of the nodes' poses
  std::vector<std::string> starts;         ///< "x,y,yaw", one a log
  std::vector<std::string> laser_offsets;  ///< "x" or "x,y,yaw", one for all logs or one a log
  std::string gnss;                        ///< "" or a file, or "log"
  std::string antenna;                     ///< "" or "x,y"
  std::string scan_topic, odom_topic;      ///< of bags; "": the usual one
};

struct CalibrateCommand {
  std::vector<std::string> sources;  ///< images, folders, videos or recorded detections
  Reading reading;
  std::vector<std::string> outputs;  ///< "camera.yaml", "ros:camera_info.yaml"
  std::string model = "auto", board = "auto";
  double accuracy_px = 1, sigma_px = 0;
  double range_m = 0;       ///< at which the error is expected; 0: at infinity
  std::string image_topic;  ///< of a bag; "": the only one
  std::string target;       ///< "" or its description's file
  std::string detections;   ///< "" or where the corners are written
  std::string record, report, pictures;
  bool json = false;
};

struct CalibrateEvaluateCommand {
  std::string camera;                ///< a camera file
  std::vector<std::string> sources;  ///< what it is tested on
  std::string image_topic;           ///< of a bag; "": the only one
  std::string target;                ///< "" or its description's file
  std::string against;               ///< "" or another camera file
  std::string picture;               ///< of the difference: .svg or .png
  Reading reading;
  bool json = false;
};

/// The session that says what to show the camera next.
struct CalibrateGuideCommand {
  int camera = -1;  ///< its number; -1: the first, where no other source is given
  std::string video, folder;
  std::string simulate;  ///< "", "images", or "corners"
  std::string lens = "c";
  double blur_px = 0.5, noise = 2;  ///< of rendered images
  std::uint64_t seed = 1;
  int width = 0, height = 0;  ///< asked of a camera; 0: its own
  std::string image_topic;    ///< of a bag; "": the only one
  std::string target;         ///< "" or its description's file
  double decimate = 2;
  double take_every_s = -1;  ///< 0: only what matches; -1: as suits the source
  std::string model = "angular4", board = "flat";
  double accuracy_px = 1, sigma_px = 0;
  std::vector<std::string> outputs;
  std::string detections;
  std::string listen = "127.0.0.1";
  int port = 0;
  bool is_mirrored = false, is_headless = false;
  std::size_t frames = 0;  ///< of the live picture, at most; 0: no end
  Reading reading;
  bool json = false;
};

/// Numbers of segmentation; below 0: as the method has them.
struct SegmentChoosing {
  double edge_cut_m = -1, grazing_deg = -1, k_colour = -1, k_normal = -1, concave_deg = -1;
  double normal_radius = -1, min_size = -1;  ///< whole numbers
  bool is_closed = false;
};

struct SegmentCommand {
  std::string cloud;       ///< a file that ReadCloud reads
  std::string image, rig;  ///< "" or a picture and how the LIDAR is to its camera
  std::string method = "convex";
  SegmentChoosing choosing;
  std::string output;                ///< "" or a cloud with labels
  std::string colours = "false";     ///< of the output: "false", "mean", "own"
  std::string picture, label_image;  ///< "" or .png
  std::string report;                ///< "" or .html
  bool json = false, keep_unseen = false;
  int score_from = 0;  ///< the least label of a thing; 0: the cloud's labels say nothing
  int stride = 1;      ///< every so many rows and columns
};

struct SegmentEvaluateCommand {
  std::vector<std::string> scans;  ///< with labels, or beside `truth`
  std::vector<std::string> truth;  ///< none, or a cloud with labels for each
  std::vector<std::string> methods = {"convex", "joint", "normals", "colour", "image"};
  SegmentChoosing choosing;
  std::vector<std::string> sweeps;  ///< "k-rgb=1000,3000"
  int least_object = 1;
  std::string plot, report;  ///< "" or files
  bool json = false;
};

struct CoregisterCommand {
  std::string camera, points;      ///< "" or files
  std::string detections, planes;  ///< both or neither
  Reading reading;
  std::string output, record, picture, error_map;
  std::string against;  ///< "" or another rig
  bool free_parameters = false;
  double sigma_px = 0;  ///< 0: as the residuals say
  double sigma_m = 0.02;
  double outlier_share = 0.01;
  std::vector<double> ranges_m;  ///< empty: those of the points
  bool json = false;
};

/// From graph to graph of a mission that has no sequence yet.
inline constexpr double kEveryS = 10;

struct ConvertCommand {
  std::string input, output;
  Reading reading;
  bool binary = false;
};

struct InspectCommand {
  std::string file;
  Reading reading;
  bool json = false;
};

struct CheckCommand {
  std::string file;
  Reading reading;
  double tolerance = 1e-5;
  bool json = false;
};

struct SimulateCommand {
  std::string kind = "city";
  std::string input;  ///< of corrupt
  Reading reading;
  std::string output, truth, outliers;
  std::string outlier_kind = "random";
  bool binary = false;
  int robots = 4, poses = 1000, dimension = 2, landmarks = 0;
  int cameras = 20, points = 500;
  double outlier_fraction = 0;
  double closures_per_pose = -1;  ///< -1: the simulator's own
  std::uint64_t seed = 1;
};

struct SimulateMissionCommand {
  std::string output, shape = "small";
  int robots = 0;      ///< 0: as the shape has them
  double minutes = 0;  ///< 0: as long as the shape
  std::uint64_t seed = 1;
  bool record = false;
  int street_things = 10;   ///< cars and trees, for each block
  int pictures = 16;        ///< of the target by each camera; 0: no cameras, and no scene
  double rate_hz = 2;       ///< packets of each radio; 0: no radios
  double gnss_sigma_m = 0;  ///< 0: no fixes
  int bad_fixes = 0;
  std::string datum = "42.293,-83.711,260";
};

struct SimulateSceneCommand {
  std::string scene, output;
  std::uint64_t seed = 1;
};

/// What signals were measured, and between what.
struct SignalInput {
  std::vector<std::string> logs;          ///< files, or folders with log.csv and map.yaml
  std::vector<std::string> maps;          ///< none, one for all, or one a log
  std::string anchors;                    ///< "" or positions of fixed radios: CSV
  std::vector<std::string> trajectories;  ///< "robot1=truth.tum"
  std::string mobile = "mobile";
  bool sort = false;
  double rate_hz = 0;  ///< of each link at most; 0: all
};

struct SignalFitCommand {
  SignalInput input;
  Choosing choosing;
  std::string method = "best", output, record;
  bool binary = false, json = false;
};

struct SignalPredictCommand {
  std::string model, map, pairs, output;
  std::string from;       ///< "X,Y" or "X,Y,Z"
  std::string radio, to;  ///< names of the model's radios, or ""
  std::string map_of;     ///< name of the pictures, without ending
  double step_m = 0;      ///< of the picture; 0: 120 steps along the longer side
};

struct SignalDrawCommand {
  std::string model, map, output;
};

/// How logs are replayed.
struct SignalReplayWords {
  std::string every = "2s";
  int horizons = 10;
  int predict_every = 1;
};

struct SignalEvaluateCommand {
  SignalInput input;
  Choosing choosing;
  SignalReplayWords replay;
  std::vector<std::string> methods;
  bool forget = false, json = false;
  int threads = 2;
  std::string plot;
};

struct SignalTuneCommand {
  SignalInput input;
  Choosing choosing;
  SignalReplayWords replay{"2s", 3, 1};
  std::vector<std::string> methods = {"mrt", "matte", "mrgp"}, only;
  std::string by = "mse", output;
  int threads = 2, most = 200;
};

struct SignalSimulateCommand {
  std::string place, output;
  int robots = 3;
  double seconds = 0;  ///< 0: as long as the place
  double rate_hz = 20, floor_dbm = -92;
  std::uint64_t seed = 1;
  bool maps = false;
};

struct SignalConnectCommand {
  std::string model, map, positions;
  double usable_dbm = -80;
  bool json = false;
};

struct SignalWhereCommand {
  std::string model, map, positions, robot;
  double reach_m = 15;
  int places = 5;
  bool json = false;
};

struct OptionsCommand {
  bool markdown = false;
};

struct TypesCommand {
  Reading reading;
};

struct ManualCommand;

struct WriteManualCommand {
  std::string what, output;
  std::shared_ptr<const ManualCommand> program;  ///< the command line, as it is declared
};

/// Each runs one subcommand and returns its exit code.  Results on stdout, everything else on
/// stderr.  Throws Error.
int Run(const SolveCommand& command, const Console& console);
int Run(const CompareCommand& command, const Console& console);
int Run(const MapCommand& command, const Console& console);
int Run(const CalibrateCommand& command, const Console& console);
int Run(const CalibrateEvaluateCommand& command, const Console& console);
int Run(const CalibrateGuideCommand& command, const Console& console);
int Run(const CalibrateTargetCommand& command, const Console& console);
int Run(const SegmentCommand& command, const Console& console);
int Run(const SegmentEvaluateCommand& command, const Console& console);
int Run(const CoregisterCommand& command, const Console& console);
int Run(const SignalFitCommand& command, const Console& console);
int Run(const SignalPredictCommand& command, const Console& console);
int Run(const SignalDrawCommand& command, const Console& console);
int Run(const SignalEvaluateCommand& command, const Console& console);
int Run(const SignalTuneCommand& command, const Console& console);
int Run(const SignalSimulateCommand& command, const Console& console);
int Run(const SignalConnectCommand& command, const Console& console);
int Run(const SignalWhereCommand& command, const Console& console);
int Run(const ConvertCommand& command, const Console& console);
int Run(const InspectCommand& command, const Console& console);
int Run(const CheckCommand& command, const Console& console);
int Run(const SimulateCommand& command, const Console& console);
int Run(const SimulateMissionCommand& command, const Console& console);
int Run(const SimulateSceneCommand& command, const Console& console);
int Run(const OptionsCommand& command, const Console& console);
int Run(const TypesCommand& command, const Console& console);
int Run(const WriteManualCommand& command, const Console& console);

/// What `graticule --version` says: of Graticule, and of all that its results depend on.
std::string Versions();

}  // namespace graticule::apps
