#include "graticule/io/signal_log.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "graticule/io/file.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

std::string Refusal(const std::string& text, const SignalLogOptions& options = {}) {
  try {
    ParseSignalLog(text, "a.csv", options);
  } catch (const Error& error) {
    EXPECT_EQ(error.Kind(), ErrorKind::kInput);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

bool Says(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
  return true;
}

SignalLogOptions TwoAnchors() {
  SignalLogOptions options;
  options.anchors = {{"1", {5, 2, 2}}, {"2", {0, 6, 2.5}}};
  return options;
}

const char* const kLong =
    "time,receiver,transmitter,rx_x,rx_y,rx_z,tx_x,tx_y,tx_z,dbm\n"
    "12.25,a,b,1,2,0.5,4.1,5,1,-61.123456789012345\n"
    "12.25,b,a,4.1,5,1,1,2,0.5,-62\n"
    "13,c,a,7,8,0,1.5,2,0.5,-70\n";

TEST(SignalLog, IsReadAndWrittenToTheBit) {
  const SignalLog log = ParseSignalLog(kLong, "a.csv");
  EXPECT_EQ(log.radios, (std::vector<std::string>{"a", "b", "c"}));
  ASSERT_EQ(log.measurements.size(), 3u);
  EXPECT_TRUE(log.has_height);
  EXPECT_TRUE(log.has_time);
  const SignalMeasurement& first = log.measurements[0];
  EXPECT_EQ(first.link.time_s, 12.25);
  EXPECT_EQ(first.link.receiver, 0u);
  EXPECT_EQ(first.link.transmitter, 1u);
  EXPECT_EQ(first.link.transmitter_m, Eigen::Vector3d(4.1, 5, 1));
  EXPECT_EQ(first.dbm, -61.123456789012345);
  EXPECT_TRUE(first.is_heard);
  const std::string text = FormatSignalLog(log);
  EXPECT_EQ(FormatSignalLog(ParseSignalLog(text, "b.csv")), text);
}

TEST(SignalLog, KeepsWhatWasNotHeardAndWhatHasNoTime) {
  const std::string text =
      "receiver,transmitter,rx_x,rx_y,tx_x,tx_y,dbm,heard\n"
      "a,b,1,2,3,4,-91,0\n"
      "b,a,3,4,1,2,-90,1\n";
  const SignalLog log = ParseSignalLog(text, "a.csv");
  EXPECT_FALSE(log.has_time);
  EXPECT_FALSE(log.has_height);
  EXPECT_FALSE(log.measurements[0].is_heard);
  EXPECT_TRUE(log.measurements[1].is_heard);
  EXPECT_EQ(FormatSignalLog(log), text);
}

TEST(SignalLog, TakesOtherNamesOfColumnsAByteOrderMarkAndOtherLineEnds) {
  const SignalLog log = ParseSignalLog(
      "\xef\xbb\xbfTX,RX,tx_x,tx_y,rx_x,rx_y,n_ch,rssi_mean,t\r\n"
      "\r\n# a comment\r\n"
      "\"m3-2\", m3-3 ,1,2,3,4,13,-90.3,5\r\n",
      "a.csv");
  ASSERT_EQ(log.measurements.size(), 1u);
  EXPECT_EQ(log.radios, (std::vector<std::string>{"m3-3", "m3-2"}));
  EXPECT_EQ(log.measurements[0].link.receiver_m, Eigen::Vector3d(3, 4, 0));
  EXPECT_EQ(log.measurements[0].dbm, -90.3);
  EXPECT_EQ(log.measurements[0].link.time_s, 5);
}

TEST(SignalLog, ReadsTheWideFormWithAnchors) {
  const SignalLog log = ParseSignalLog(
      ",ts,x,heading,y,rssi_1,rssi_2\n"
      "0,1.628e18,3,0.5,4,-54.5,\n"
      "1,1.628000001e18,3.5,0.5,4,,\n"
      "2,1.628000002e18,4,0.5,4,-55,-70\n",
      "a.csv", TwoAnchors());
  ASSERT_EQ(log.measurements.size(), 3u) << "an empty cell is no measurement";
  EXPECT_EQ(log.radios, (std::vector<std::string>{"mobile", "1", "2"}));
  EXPECT_TRUE(log.has_height);
  EXPECT_EQ(log.measurements[0].link.time_s, 1628000000);
  EXPECT_EQ(log.measurements[0].link.receiver_m, Eigen::Vector3d(3, 4, 0));
  EXPECT_EQ(log.measurements[0].link.transmitter_m, Eigen::Vector3d(5, 2, 2));
  EXPECT_NEAR(log.measurements[2].link.time_s, 1628000002, 1e-6);
  EXPECT_EQ(log.measurements[2].dbm, -70);
}

TEST(SignalLog, TakesPositionsFromTrajectories) {
  SignalLogOptions options = TwoAnchors();
  options.trajectories["r"] = {StampPlanar(10, {0, 0, 0}), StampPlanar(20, {4, 2, 0})};
  const SignalLog log = ParseSignalLog(
      "time,receiver,transmitter,dbm\n9.5,r,1,-40\n15,r,1,-50\n20.5,1,r,-60\n", "a.csv", options);
  EXPECT_EQ(log.measurements[0].link.receiver_m, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(log.measurements[1].link.receiver_m, Eigen::Vector3d(2, 1, 0));
  EXPECT_EQ(log.measurements[2].link.transmitter_m, Eigen::Vector3d(4, 2, 0));
  Says(Refusal("time,receiver,transmitter,dbm\n25,r,1,-40\n", options),
       "a.csv:2:4: the trajectory of 'r' does not reach");
  Says(Refusal("time,receiver,transmitter,dbm\n15,r,9,-40\n", options),
       "a.csv:2:6: where the radio '9' is is not known");
  std::swap(options.trajectories["r"][0], options.trajectories["r"][1]);
  Says(Refusal("time,receiver,transmitter,dbm\n15,r,1,-40\n", options),
       "the trajectory of 'r': expected stamps in order, found 10 s after 20 s");
}

TEST(SignalLog, SaysWhatIsWrongAndWhere) {
  const std::string head = "time,receiver,transmitter,rx_x,rx_y,tx_x,tx_y,dbm\n";
  Says(Refusal(""), "a.csv: there is no line");
  Says(Refusal(head), "there is no measurement");
  Says(Refusal(head + "2,a,b,0,0,1,1,-50\n1.5,a,b,0,0,1,1,-50\n"),
       "a.csv:3:1: the time goes backwards, from 2 by 0.5 s");
  Says(Refusal(head + "1,a,b,0,0,1,1,+40\n"), "a.csv:2:15: expected a strength within");
  Says(Refusal(head + "1,a,b,0,0,1,1,nan\n"), "a.csv:2:15: expected a number (dbm)");
  Says(Refusal(head + "1,a,b,0,inf,1,1,-50\n"), "a.csv:2:9: expected a number (rx_y)");
  Says(Refusal(head + "1,a,b,0,0,1,1\n"),
       "a.csv:2: expected 8 cells, as the first line has, found 7");
  Says(Refusal(head + "1,a,a,0,0,1,1,-5\n"), "a.csv:2:5: a radio does not hear itself");
  Says(Refusal(head + "1,,a,0,0,1,1,-5\n"), "a.csv:2:3: expected the name of a radio");
  Says(Refusal("time,receiver,rx_x,rx_y,dbm\n"), "no column transmitter");
  Says(Refusal("time,transmitter,dbm\n"), "no column receiver");
  Says(Refusal("time,receiver,transmitter,rx_x,dbm\n"), "needs both its x and its y");
  Says(Refusal("t,time,dbm\n"), "'t' and 'time' say the same");
  Says(Refusal("time,x,y\n"), "no column dbm, and no column rssi_ID");
  Says(Refusal("time,x,y,rssi_1,rssi_3\n", TwoAnchors()),
       "a.csv:1:17: where the radio '3' stands is not known");
  Says(Refusal("time,rssi_1\n", TwoAnchors()), "no columns x and y");
}

TEST(SignalLog, IsSortedWhereAsked) {
  SignalLogOptions options;
  options.sort = true;
  const SignalLog log = ParseSignalLog(
      "time,receiver,transmitter,rx_x,rx_y,tx_x,tx_y,dbm\n"
      "2,a,b,0,0,1,1,-50\n1.5,a,b,0,0,1,1,-51\n",
      "a.csv", options);
  EXPECT_EQ(log.measurements[0].dbm, -51);
}

TEST(SignalLog, RefusesEveryLineThatWasCutShort) {
  // A number that is cut short may still be one: what is shown is that no cell goes missing.
  const std::string whole = kLong;
  const std::size_t header = whole.find('\n') + 1;
  const std::size_t last_cell = whole.rfind(',');
  for (std::size_t n = 0; n <= header; ++n) EXPECT_NE(Refusal(whole.substr(0, n)), "") << n;
  for (std::size_t n = whole.rfind('\n', last_cell) + 2; n <= last_cell; ++n)
    EXPECT_NE(Refusal(whole.substr(0, n)), "") << n;
}

TEST(SignalLog, IsReadFromGzipAndWrittenBack) {
  const std::string path =
      (std::filesystem::path(testing::TempDir()) / "signal_log_test.csv.gz").string();
  const SignalLog log = ParseSignalLog(kLong, "a.csv");
  WriteSignalLog(log, path);
  EXPECT_EQ(FormatSignalLog(ReadSignalLog(path)), FormatSignalLog(log));
  std::filesystem::remove(path);
}

TEST(SignalLog, DoesNotWriteANameThatWouldNotReadBack) {
  SignalLog log = ParseSignalLog(kLong, "a.csv");
  for (const char* name : {"", "a,b", " a", "a\n", "\"a", "#a"}) {
    log.radios[1] = name;
    EXPECT_THROW(FormatSignalLog(log), Error) << name;
  }
}

TEST(Anchors, AreReadAndRefused) {
  const auto anchors = ParseAnchors("id,x,y,z\n1,5.48,2.41,2.08\n7,0,1,2\n", "a.csv");
  EXPECT_EQ(anchors.at("1"), Eigen::Vector3d(5.48, 2.41, 2.08));
  EXPECT_EQ(anchors.size(), 2u);
  EXPECT_THROW(ParseAnchors("id,x\n1,2\n", "a.csv"), Error);
  EXPECT_THROW(ParseAnchors("id,x,y\n1,2,3\n1,2,4\n", "a.csv"), Error);
  EXPECT_THROW(ParseAnchors("id,x,y\n1,2,nan\n", "a.csv"), Error);
}

class RecordedSignal : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << folder_ << " is not there";
  }
  const std::string folder_ = std::string(GRATICULE_DATA_DIR) + "/signal";
};

TEST_F(RecordedSignal, KolakIsReadWithItsAnchors) {
  SignalLogOptions options;
  const std::string anchors = folder_ + "/kolak_ble_flat/anchors.csv";
  options.anchors = ParseAnchors(ReadFile(anchors), anchors);
  const SignalLog log =
      ReadSignalLog(folder_ + "/kolak_ble_flat/calibration/calibration_df.csv", options);
  EXPECT_EQ(log.measurements.size(), 22277u);
  EXPECT_EQ(log.radios.size(), 7u);
}

TEST_F(RecordedSignal, GrenobleIsReadWithoutTime) {
  const SignalLog log = ReadSignalLog(folder_ + "/iotlab_mercator/grenoble_links.csv");
  EXPECT_EQ(log.measurements.size(), 24574u);
  EXPECT_FALSE(log.has_time);
  EXPECT_TRUE(log.has_height);
}

TEST_F(RecordedSignal, HarvardIsReadPackedAndSorted) {
  SignalLogOptions options;
  options.sort = true;
  const SignalLog log = ReadSignalLog(folder_ + "/harvard_wsr/rss_20hz.csv.gz", options);
  EXPECT_EQ(log.measurements.size(), 168967u);
}

}  // namespace
}  // namespace graticule
