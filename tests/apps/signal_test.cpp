// graticule signal: from a simulated log to a model, predictions, drawings, tables and plans.

#include <cmath>

#include "../report/markup.hpp"
#include "command.hpp"

namespace graticule::test {
namespace {

using Json = nlohmann::json;

class SignalCommandTest : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    const Outcome outcome = RunCommand({"signal", "simulate", "house", "--seconds", "60", "--rate",
                                        "1", "--floor", "-70", "-o", Path("house"), "--maps"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  Outcome Fit(const std::string& method, const std::string& model) {
    return RunCommand({"signal", "fit", Path("house"), "--method", method, "-o", Path(model)});
  }
  std::string Map() const { return Path("house/map.yaml"); }
};

TEST_F(SignalCommandTest, SimulatesLogMapAndTruthTheSameEachTime) {
  for (const char* name : {"log.csv", "map.yaml", "map.pgm", "truth.yaml", "truth.cells",
                           "truth.json", "robot1.tum", "robot3.tum", "maps/00030.yaml"})
    EXPECT_TRUE(std::filesystem::exists(Path("house") + "/" + name)) << name;
  EXPECT_EQ(CountLines(ReadWhole(Path("house/log.csv"))), 1u + 60 * 6);
  EXPECT_EQ(Json::parse(ReadWhole(Path("house/truth.json")))["fillings"]["a"]["name"], "air");
  ASSERT_EQ(RunCommand({"signal", "simulate", "house", "--seconds", "60", "--rate", "1", "--floor",
                        "-70", "-o", Path("again")})
                .exit_code,
            0);
  EXPECT_EQ(ReadWhole(Path("again/log.csv")), ReadWhole(Path("house/log.csv")));
  EXPECT_EQ(RunCommand({"signal", "simulate", "moon", "-o", Path("x")}).exit_code, 2);
}

TEST_F(SignalCommandTest, FitsPredictsAndDrawsByEachGraph) {
  const std::string pairs = Write("pairs.csv",
                                  "receiver,transmitter,rx_x,rx_y,tx_x,tx_y\n"
                                  "robot1,robot2,3,3,8,4\nrobot2,robot1,8,4,3,3\n"
                                  "stranger,robot1,8,4,3,3\n");
  for (const char* method : {"log-fit", "one", "mrt", "matte"}) {
    const std::string model = std::string(method) + ".fg";
    const Outcome fit = RunCommand({"signal", "fit", Path("house"), "--method", method, "-o",
                                    Path(model), "--record", Path("asked.fg"), "--json"});
    ASSERT_EQ(fit.exit_code, 0) << method << fit.err;
    EXPECT_EQ(JsonOf(fit)["measurements"], 360);
    EXPECT_EQ(RunCommand({"inspect", Path("asked.fg")}).exit_code, 0);
    const Outcome predicted =
        RunCommand({"signal", "predict", Path(model), "--map", Map(), "--pairs", pairs});
    ASSERT_EQ(predicted.exit_code, 0) << method << predicted.err;
    ASSERT_EQ(CountLines(predicted.out), 4u);
    // Both ways are alike, and a stranger is less sure.
    const auto number = [&](int line, int column) {
      std::size_t at = 0;
      for (int i = 0; i < line; ++i) at = predicted.out.find('\n', at) + 1;
      for (int i = 0; i < column; ++i) at = predicted.out.find(',', at) + 1;
      return std::stod(predicted.out.substr(at));
    };
    EXPECT_NEAR(number(1, 3), number(2, 3), 1e-6) << predicted.out;
    EXPECT_GT(number(3, 4), number(1, 4)) << predicted.out;
  }
  ASSERT_EQ(RunCommand({"signal", "predict", Path("matte.fg"), "--map", Map(), "--from", "4,4",
                        "--map-of", Path("strength"), "--step", "1"})
                .exit_code,
            0);
  for (const char* name : {"strength.png", "strength.dbm.png", "strength.dbm.pgw",
                           "strength.sigma.png", "strength.sigma.pgw"})
    EXPECT_TRUE(std::filesystem::exists(Path(name))) << name;
  EXPECT_EQ(ReadWhole(Path("strength.dbm.pgw")).substr(0, 2), "1\n");
  ASSERT_EQ(RunCommand({"signal", "draw", Path("matte.fg"), "--map", Map(), "-o", Path("a.svg")})
                .exit_code,
            0);
  EXPECT_EQ(TagFault(ReadWhole(Path("a.svg"))), "");
  EXPECT_NE(ReadWhole(Path("a.svg")).find("attenuation of structure"), std::string::npos);
  EXPECT_EQ(RunCommand({"signal", "draw", Path("log-fit.fg"), "--map", Map(), "-o", Path("b.svg")})
                .exit_code,
            2);
}

TEST_F(SignalCommandTest, WritesTheBestSoFarOnCtrlC) {
  ASSERT_EQ(RunCommand({"signal", "simulate", "house", "--seconds", "1200", "--rate", "5", "-o",
                        Path("long"), "--quiet"})
                .exit_code,
            0);
  RunOptions interrupted;
  interrupted.terminal_stderr = true;
  interrupted.interrupt_at = "iteration 0,";
  const Outcome fit = RunCommand(
      {"signal", "fit", Path("long"), "--method", "fine-mrt", "-o", Path("fit.fg"), "--json"},
      interrupted);
  EXPECT_EQ(fit.exit_code, 4) << fit.err;
  EXPECT_EQ(JsonOf(fit)["termination"], "cancelled");
  EXPECT_EQ(RunCommand({"inspect", Path("fit.fg")}).exit_code, 0);
}

TEST_F(SignalCommandTest, KeepsWhatWasMeasuredWhereTheMethodIsNoGraph) {
  const std::string pairs = Write("pairs.csv", "rx_x,rx_y,tx_x,tx_y\n3,3,8,4\n");
  for (const char* method : {"gp", "best", "persistence", "matte+gp"}) {
    ASSERT_EQ(Fit(method, "model.txt").exit_code, 0) << method;
    EXPECT_EQ(ReadWhole(Path("model.txt")).find("graticule-signal-model 1\nmethod "), 0u);
    const Outcome predicted =
        RunCommand({"signal", "predict", Path("model.txt"), "--map", Map(), "--pairs", pairs});
    EXPECT_EQ(predicted.exit_code, 0) << method << predicted.err;
    EXPECT_EQ(CountLines(predicted.out), 2u);
  }
  // A fault in its log has its own line of the file, whatever blank lines are in its heading.
  std::string text = ReadWhole(Path("model.txt"));
  text.insert(text.find('\n'), "\n\n");
  text.replace(text.rfind("robot"), 5, "robot,");
  const Outcome broken = RunCommand(
      {"signal", "predict", Write("broken.txt", text), "--map", Map(), "--pairs", pairs});
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_NE(broken.err.find("broken.txt:" + std::to_string(CountLines(text))), std::string::npos)
      << broken.err;
}

TEST_F(SignalCommandTest, PredictsForTheLastMeasurementsTimeWhereNoneIsGiven) {
  ASSERT_EQ(Fit("persistence", "model.txt").exit_code, 0);
  const std::string pair = "robot1,robot2,3,3,8,4\n";
  const std::string without =
      Write("without.csv", "receiver,transmitter,rx_x,rx_y,tx_x,tx_y\n" + pair);
  const auto predict = [&](const std::string& pairs) {
    return RunCommand({"signal", "predict", Path("model.txt"), "--pairs", pairs}).out;
  };
  const std::string last = predict(without);
  const std::string time =
      last.substr(last.find('\n') + 1, last.find(",robot1") - last.find('\n') - 1);
  EXPECT_GT(std::stod(time), 50);
  const std::string with =
      Write("with.csv", "time,receiver,transmitter,rx_x,rx_y,tx_x,tx_y\n" + time + "," + pair);
  EXPECT_EQ(last, predict(with));
}

TEST_F(SignalCommandTest, LooksBeforeItPredictsWhetherItsFilesCanBeWritten) {
  ASSERT_EQ(Fit("matte", "model.fg").exit_code, 0);
  const std::string model = Path("model.fg"), nowhere = Path("nofolder/x");
  const std::string pairs =
      Write("pairs.csv", "receiver,transmitter,rx_x,rx_y,tx_x,tx_y\nrobot1,robot2,3,3,8,4\n");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"predict", model, "--pairs", pairs, "-o", nowhere},
        {"predict", model, "--map", Path("house/map.yaml"), "--from", "4,4", "--map-of", nowhere},
        {"draw", model, "--map", Path("house/map.yaml"), "-o", nowhere + ".png"}}) {
    std::vector<std::string> all = {"signal"};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = RunCommand(all);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find("there is no folder"), std::string::npos) << outcome.err;
  }
  // A picture that cannot be written does not cost the numbers.
  std::filesystem::create_symlink("/dev/full", Path("full.png"));
  const Outcome full = RunCommand({"signal", "predict", model, "--map", Path("house/map.yaml"),
                                   "--from", "4,4", "--map-of", Path("full")});
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_TRUE(std::filesystem::exists(Path("full.dbm.png"))) << full.err;
}

TEST_F(SignalCommandTest, KeepsWhatWasSetWhateverTheMethodMakesOfIt) {
  for (const auto& [method, setting] :
       {std::pair("gp", "pair-gp.length_m=7"), std::pair("one+gp", "gp.radio_db=0")}) {
    const Outcome fit = RunCommand({"signal", "fit", Path("house"), "--method", method, "--set",
                                    setting, "-o", Path("model.txt")});
    ASSERT_EQ(fit.exit_code, 0) << fit.err;
    std::string line = setting;
    line.replace(line.find('='), 1, " ");
    EXPECT_NE(ReadWhole(Path("model.txt")).find("\n" + line + "\n"), std::string::npos) << line;
  }
}

TEST_F(SignalCommandTest, RefusesAModelThatSaysWhatCannotBe) {
  ASSERT_EQ(Fit("mrt", "model.fg").exit_code, 0);
  std::string text = ReadWhole(Path("model.fg"));
  text.erase(text.rfind(" xxh64"));
  text += '\n';
  const auto predicted = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    for (std::size_t at = 0; (at = changed.find(from, at)) != std::string::npos; at += to.size())
      changed.replace(at, from.size(), to);
    EXPECT_NE(changed, text) << from;
    const Outcome outcome =
        RunCommand({"signal", "predict", Write("changed.fg", changed), "--map", Map(), "--pairs",
                    Write("pairs.csv", "rx_x,rx_y,tx_x,tx_y\n3,3,8,4\n")});
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_EQ(outcome.err.find("graticule: " + Path("changed.fg") + ": "), 0u) << outcome.err;
    return outcome.err;
  };
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(predicted("\"graticule-signal-model/1\"", "7"), "no signal model");
  expect(predicted("\"cell_m\":", "\"cell_m\":true,\"cell\":"),
         "report: cell_m: expected a number");
  expect(predicted("\"x0\":", "\"x0\":99999999999,\"x\":"),
         "report: cells.x0: expected a whole number in");
  expect(predicted("\"cell_m\":3.0", "\"cell_m\":-3"), "cell_m is -3; expected zero or above");
  expect(predicted("cell_all:7 ", "cell_all:999999999 "), "cells are too far apart");
}

TEST_F(SignalCommandTest, EvaluatesAndTunes) {
  const Outcome table = RunCommand({"signal", "evaluate", Path("house"), "--methods", "log-fit",
                                    "matte", "--horizons", "3", "--plot", Path("figure.svg")});
  ASSERT_EQ(table.exit_code, 0) << table.err;
  EXPECT_NE(table.out.find("4-6 s"), std::string::npos);
  EXPECT_EQ(TagFault(ReadWhole(Path("figure.svg"))), "");
  const Outcome json =
      RunCommand({"signal", "evaluate", Path("house"), Path("house"), "--methods", "mean",
                  "persistence", "--every", "4s", "--horizons", "2", "--json"});
  const Json result = JsonOf(json);
  EXPECT_EQ(result["step_s"], 4);
  ASSERT_EQ(result["methods"].size(), 2u);
  EXPECT_EQ(result["methods"][0]["horizons"].size(), 2u);
  EXPECT_EQ(result["methods"][0]["by_log"].size(), 1u);  // the same log twice

  const std::vector<std::string> tune = {"signal", "tune", Path("house"), "--methods",       "mrt",
                                         "--most", "6",    "-o",          Path("tuned.yaml")};
  const Outcome first = RunCommand(tune);
  EXPECT_TRUE(first.exit_code == 0 || first.exit_code == 4) << first.err;
  EXPECT_NE(ReadWhole(Path("tuned.yaml")).find("mrt.lambda: "), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(Path("tuned.yaml.mrt.state")));
  EXPECT_EQ(RunCommand({"signal", "evaluate", Path("house"), "--methods", "mrt", "--horizons", "1",
                        "--config", Path("tuned.yaml")})
                .exit_code,
            0);
}

TEST_F(SignalCommandTest, RanksPlacesByTheCombinationsOwnNoise) {
  ASSERT_EQ(Fit("best", "best.txt").exit_code, 0);
  const std::string team = Write("team.csv", "id,x,y\nrobot1,3,3\nrobot2,8,4\nrobot3,12,9\n");
  const Outcome where = RunCommand({"signal", "where", Path("best.txt"), team, "--robot", "robot2",
                                    "--map", Map(), "--reach", "20", "--places", "2", "--json"});
  ASSERT_EQ(where.exit_code, 0) << where.err;
  const Json said = JsonOf(where);
  ASSERT_EQ(said["places"].size(), 2u);
  for (const Json& place : said["places"]) EXPECT_GT(place["gain_nats"], 0.0);
}

TEST_F(SignalCommandTest, PlansForTheTeam) {
  ASSERT_EQ(Fit("matte", "model.fg").exit_code, 0);
  const std::string team = Write("team.csv", "id,x,y\nrobot1,3,3\nrobot2,8,4\nrobot3,12,9\n");
  const Outcome connect =
      RunCommand({"signal", "connect", Path("model.fg"), team, "--map", Map(), "--json"});
  const Json links = JsonOf(connect);
  EXPECT_EQ(links["links"].size(), 3u);
  EXPECT_GE(links["connected"], 0.0);
  EXPECT_LE(links["connected"], 1.0);
  const Outcome where = RunCommand({"signal", "where", Path("model.fg"), team, "--robot", "robot2",
                                    "--map", Map(), "--reach", "20", "--places", "2", "--json"});
  ASSERT_EQ(where.exit_code, 0) << where.err;
  const Json places = JsonOf(where)["places"];
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NE(std::pair(places[0]["x"], places[0]["y"]), std::pair(places[1]["x"], places[1]["y"]));
  EXPECT_EQ(
      RunCommand({"signal", "where", Path("model.fg"), team, "--robot", "robot9", "--map", Map()})
          .exit_code,
      2);
}

TEST_F(SignalCommandTest, RefusesWithOneLineThatSaysWhere) {
  const auto refused = [&](const std::vector<std::string>& words, int code,
                           const std::string& said) {
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(said), std::string::npos) << outcome.err;
  };
  const std::string head = "time,receiver,transmitter,rx_x,rx_y,tx_x,tx_y,dbm\n";
  const std::string good = "0,a,b,3,3,8,4,-50\n";
  const auto fit = [&](const std::string& log, const std::string& method) {
    return std::vector<std::string>{"signal",   "fit",  log,  "--map",     Map(),
                                    "--method", method, "-o", Path("m.fg")};
  };
  const std::string back = Write("back.csv", head + "5,a,b,3,3,8,4,-50\n" + good);
  refused(fit(back, "matte"), 3, "back.csv:3:");
  const std::string loud = Write("loud.csv", head + good + "1,a,b,3,3,8,4,40\n");
  refused(fit(loud, "matte"), 3, "loud.csv:3:");
  const std::string nan = Write("nan.csv", head + "0,a,b,3,3,8,4,nan\n");
  refused(fit(nan, "matte"), 3, "nan.csv:2:");
  const std::string away = Write("away.csv", head + good + "1,a,b,300,3,8,4,-50\n");
  refused(fit(away, "matte"), 3, "outside of the map");
  refused(fit(Write("good.csv", head + good), "mate"), 2, "no method");
  refused({"signal", "fit", Path("good.csv"), "--method", "matte", "-o", Path("m.fg")}, 2, "--map");
  refused({"signal", "predict", Path("good.csv"), "--pairs", Path("good.csv")}, 3, "good.csv:1:1");
  refused(
      {"signal", "fit", Path("house"), "--method", "mrt", "-s", "mrt.lamda=2", "-o", Path("m.fg")},
      2, "mrt.lambda");
  // Robots that stand still: what is not determined is said, and the model is written.
  for (const char* method : {"matte", "mrgp", "best"}) {
    const Outcome still = RunCommand(fit(Path("good.csv"), method));
    EXPECT_EQ(still.exit_code, 0) << method << still.err;
    EXPECT_NE(still.err.find("not determined: slope"), std::string::npos) << method << still.err;
  }
  refused({"signal", "predict", Path("m.fg"), "--from", "3,3", "--radio", "nobody", "--map-of",
           Path("to"), "--map", Map()},
          2, "'nobody'");
}

}  // namespace
}  // namespace graticule::test
